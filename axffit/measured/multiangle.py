"""Multi-angle spectrophotometers (BYK-mac i, X-Rite MA-T6 and MA-T12 and the like): CSV by geometry.

Two forms: a column ``geometry`` and columns of values (R, G, B, or wavelengths in nm), a row a geometry; or a column
``wavelength`` (nm) and a column a geometry. Values are reflectance factors R, 1 for the perfect diffuser, f = R / pi; a
comment ``# values: percent`` says that it is 100, ``# values: f`` that they are f in 1/sr.

A geometry is ``45as15``: light at 45°, viewer 15° from the mirror direction toward the light (aspecular angle; negative
on the far side). ``45as25az90`` turns the viewer by an azimuth about the mirror direction, 0 in the plane of incidence
and toward the light. A leading r (``r45as25``) says reflection and changes nothing.
"""

import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import about_mirror
from axffit.measured.columns import RULE, channels_of
from axffit.measured.csv_table import CsvTable, note, read_csv
from axffit.measured.measurements import Measurements, RGBChannels, Wavelengths

GEOMETRY = re.compile(r"r?([0-9]+(?:\.[0-9]+)?)as(-?[0-9]+(?:\.[0-9]+)?)(?:az(-?[0-9]+(?:\.[0-9]+)?))?", re.IGNORECASE)
SCALES = {"reflectance_factor": 1.0 / np.pi, "percent": 0.01 / np.pi, "f": 1.0}
"""What values are multiplied by to be f, by ``# values:``."""

_BY_WAVELENGTH = ("wavelength", "lambda", "nm")
_WHAT = "multi-angle CSV"


def recognizes(names: list[str]) -> bool:
    """Whether a header (lower case) is that of such a table."""
    by_column = len(names) > 1 and names[0] in _BY_WAVELENGTH and GEOMETRY.fullmatch(names[1]) is not None
    return bool(names) and (names[0] == "geometry" or by_column)


def directions(geometries: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """wi and wo, (N, 3), of geometries such as ``45as15``; light and viewer in the plane of azimuth 0 without ``az``.

    Raises:
        InputError: a name is no geometry, or its light or viewer lies at or below the horizon.
    """
    found = [GEOMETRY.fullmatch(name.strip()) for name in geometries]
    for name, match in zip(geometries, found, strict=True):
        if match is None:
            raise InputError(f"{name!r} is no geometry; give names such as 45as15, 15as-15 or 45as25az90")
    angles = np.radians([[float(part or 0.0) for part in m.groups()] for m in found if m is not None])
    wi, wo = about_mirror(angles[:, 0], angles[:, 1], angles[:, 2])
    for name, z in zip(geometries, np.minimum(wi[:, 2], wo[:, 2]), strict=True):
        if z <= 0:
            raise InputError(f"{name!r}: light or viewer lies at or below the horizon; check the two angles")
    return wi, wo


def read(path: str | os.PathLike) -> Measurements:
    """A multi-angle file; weights are equal.

    Raises:
        InputError: the file cannot be read, or a geometry, a column or a value does not fit.
    """
    path = Path(path)
    table = read_csv(path, _WHAT)
    scale = note(path, table, "values", tuple(SCALES))
    geometries, stored, channels, repeat, words = _contents(path, table)
    try:
        wi, wo = directions(geometries)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    values = np.repeat(stored * SCALES[scale], repeat, axis=1)
    said = {
        "reflectance_factor": "reflectance factors, f = R / pi",
        "percent": "reflectance factors in percent, f = R / (100 pi)",
        "f": "f without the cosine, as stored",
    }
    provenance = {
        "file": path.name,
        "format": "multi-angle spectrophotometer CSV",
        "cosine": said[scale],
        "color": words,
        "grid": f"{len(geometries)} geometries, equal weights: {', '.join(dict.fromkeys(geometries))}",
        "noise": "not stated by the file",
        **{key: value for key, value in table.notes.items() if value and key != "values"},
    }
    n = len(values)
    name = table.notes.get("name") or path.stem
    return Measurements(wi, wo, values, np.ones(n, bool), np.ones(n), None, channels, provenance, name)


def _contents(path: Path, table: CsvTable) -> tuple[list[str], np.ndarray, RGBChannels | Wavelengths, int, str]:
    """Geometries, values (geometry, channel), channels, how often to repeat them, and words."""
    white = table.notes.get("white", "not stated")
    if table.names[0].lower() in _BY_WAVELENGTH:
        rows = table.numbers(path)
        known = channels_of([f"{x:g}" for x in rows[:, 0]], white)
        if known is None:
            raise InputError(f"{path}: wavelengths {rows[:, 0].tolist()}: give nm, rising, above 100")
        return table.names[1:], rows[:, 1:].T, *known
    if table.names[0].lower() != "geometry":
        raise InputError(f"{path}: the first column is {table.names[0]!r}; give 'geometry' or 'wavelength'")
    known = channels_of(table.names[1:], white)
    if known is None:
        raise InputError(f"{path}: columns {', '.join(table.names[1:]) or '(none)'} beside geometry; give {RULE}")
    values = table.numbers(path, first=1)
    return [fields[0] for _, fields in table.rows], values, *known
