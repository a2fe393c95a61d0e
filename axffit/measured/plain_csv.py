"""Plain CSV: four angles and values a row, with rules that leave nothing to guess.

The header names ``theta_i, phi_i, theta_o, phi_o`` (i the light, o the viewer, in any place), then the values: one
column f, three columns R, G, B, or wavelengths in nm; optionally ``valid`` (0 or 1), ``weight`` (solid angle of both
directions, >= 0) and ``sigma`` (standard deviation of every value of the row) or ``sigma_NAME`` for each column NAME.
Comments ``# key: value`` above the header state ``angles`` (degrees, or radians), ``values`` (f in 1/sr; f_cos_i or
f_cos_o: f times the light's or the viewer's cosine; reflectance_factor: f = R / pi), ``name`` and ``white``; any other
is kept as provenance.
"""

import os
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import direction
from axffit.measured.columns import RULE, channels_of
from axffit.measured.csv_table import note, read_csv
from axffit.measured.files import as_text, write_whole
from axffit.measured.measurements import Measurements, Wavelengths

ANGLES = ("theta_i", "phi_i", "theta_o", "phi_o")
VALUES = ("f", "f_cos_o", "f_cos_i", "reflectance_factor")
LEAST_COSINE = 1e-3
"""Samples with a smaller cosine are invalid where it is divided out."""

_EXTRA = ("valid", "weight", "sigma")
_SAID = {
    "f": "values are f without the cosine, as stored",
    "f_cos_o": f"f cos(theta_o) as stored, divided by cos(theta_o); invalid below {LEAST_COSINE:g}",
    "f_cos_i": f"f cos(theta_i) as stored, divided by cos(theta_i); invalid below {LEAST_COSINE:g}",
    "reflectance_factor": "reflectance factors, f = R / pi",
}


def recognizes(names: list[str]) -> bool:
    """Whether a header (lower case) has the four angles."""
    return set(ANGLES) <= set(names)


def read(path: str | os.PathLike) -> Measurements:
    """A plain CSV file.

    Raises:
        InputError: the file cannot be read, or a column, a comment or a value breaks the rules.
    """
    path = Path(path)
    table = read_csv(path, "plain CSV")
    lowered = [name.lower() for name in table.names]
    missing = [name for name in ANGLES if name not in lowered]
    if missing:
        raise InputError(f"{path}: no column {', '.join(missing)}; a plain CSV has {', '.join(ANGLES)} and values")
    in_degrees = note(path, table, "angles", ("degrees", "radians")) == "degrees"
    kind = note(path, table, "values", VALUES)
    stored = [name for name in table.names if not _is_extra(name)]
    known = channels_of(stored, table.notes.get("white", "not stated"))
    if known is None:
        raise InputError(f"{path}: columns of values {', '.join(stored) or '(none)'}; give {RULE}")
    channels, repeat, words = known
    column = dict(zip(lowered, table.numbers(path).T, strict=True))
    angles = [np.radians(column[name]) if in_degrees else column[name] for name in ANGLES]
    largest = max(np.abs(angles[0]).max(), np.abs(angles[2]).max())
    if not largest <= np.pi:
        raise InputError(f"{path}: a polar angle beyond 180 degrees; state the unit: # angles: degrees or radians")
    wi, wo = direction(angles[0], angles[1]), direction(angles[2], angles[3])
    factor, valid = _to_f(kind, wi, wo)
    values = np.stack([column[name.lower()] for name in stored], axis=1)
    sigma = _sigma(path, column, [name.lower() for name in stored])
    if "valid" in column:
        if not np.isin(column["valid"], (0, 1)).all():
            raise InputError(f"{path}: column valid holds other numbers than 0 and 1")
        valid = valid & (column["valid"] == 1)
    weights = column.get("weight", np.ones(len(values)))
    if not (np.isfinite(weights).all() and (weights >= 0).all() and weights.any()):
        raise InputError(f"{path}: column weight must be finite, >= 0 and not all 0")
    provenance = {
        "file": path.name,
        "format": "plain CSV",
        "cosine": _SAID[kind],
        "color": words,
        "grid": "as listed, " + ("weights as stated" if "weight" in column else "equal weights"),
        "noise": "not stated by the file" if sigma is None else "sigma as stated",
        **{key: text for key, text in table.notes.items() if text and key not in ("angles", "values")},
    }
    return Measurements(
        wi,
        wo,
        np.repeat(values * factor, repeat, axis=1),
        valid,
        weights,
        None if sigma is None else np.repeat(sigma * factor, repeat, axis=1),
        channels,
        provenance,
        table.notes.get("name") or path.stem,
    )


def _is_extra(name: str) -> bool:
    return name.lower() in (*ANGLES, *_EXTRA) or name.lower().startswith("sigma_")


def _to_f(kind: str, wi: np.ndarray, wo: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What the stored numbers are multiplied by, (N, 1), and where that means something, (N,)."""
    if kind not in ("f_cos_i", "f_cos_o"):
        return np.full((len(wi), 1), 1.0 / np.pi if kind == "reflectance_factor" else 1.0), np.ones(len(wi), bool)
    cosine = (wi if kind == "f_cos_i" else wo)[:, 2]
    valid = cosine >= LEAST_COSINE
    return 1.0 / np.where(valid, cosine, 1.0)[:, None], valid


def _sigma(path: Path, column: dict[str, np.ndarray], stored: list[str]) -> np.ndarray | None:
    """Standard deviations of the stored numbers, (N, columns)."""
    own = [name for name in column if name.startswith("sigma_")]
    if "sigma" in column and not own:
        return np.repeat(column["sigma"][:, None], len(stored), axis=1)
    if not own:
        return None
    if "sigma" in column or {f"sigma_{name}" for name in stored} != set(own):
        raise InputError(f"{path}: columns {', '.join(own)}; give sigma, or sigma_NAME for each of {', '.join(stored)}")
    return np.stack([column[f"sigma_{name}"] for name in stored], axis=1)


def write(path: str | os.PathLike, measurements: Measurements) -> None:
    """Write any samples as plain CSV, complete and to the last digit of the values; angles go through degrees.

    Raises:
        ValueError: the channels are neither RGB nor wavelengths.
    """
    channels = measurements.channels
    if isinstance(channels, Wavelengths):
        names = [f"{x:g}nm" for x in channels.nanometers]
        notes = ""
    elif measurements.values.shape[1] == 3:
        names = ["R", "G", "B"]
        notes = f"# white: {channels.white}\n"
    else:
        raise ValueError(f"{measurements.values.shape[1]} channels: give RGB or wavelengths")
    angles = [angle for v in (measurements.wi, measurements.wo) for angle in _angles(v)]
    parts = [*angles, *measurements.values.T, measurements.valid, measurements.weights]
    if measurements.sigma is not None:
        parts += list(measurements.sigma.T)
    header = [*ANGLES, *names, "valid", "weight"]
    header += [f"sigma_{name}" for name in names] if measurements.sigma is not None else []
    text = f"# name: {measurements.name}\n# angles: degrees\n# values: f\n{notes}" + ",".join(header) + "\n"
    write_whole(path, text + as_text(np.stack([np.asarray(part, np.float64) for part in parts], axis=1)))


def _angles(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    polar = np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2])
    return np.degrees(polar), np.degrees(np.arctan2(v[:, 1], v[:, 0]))
