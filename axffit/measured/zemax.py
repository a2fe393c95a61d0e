"""Zemax BSDF text: scatter about the mirror direction, per rotation of the sample and angle of incidence.

Keywords, each on a line: Source, Symmetry, SpectralContent (Monochrome, XYZ), ScatterType (BRDF), then SampleRotation,
AngleOfIncidence, ScatterAzimuth and ScatterRadial with their numbers of angles (degrees) and the angles. Per spectral
part follow its name (Monochrome, or TristimulusX, Y, Z), DataBegin, and for each rotation and incidence a line TIS with
a number and one row a scatter azimuth with one value a radial angle; DataEnd. Values are f in 1/sr.

The radial angle is measured from the mirror direction; azimuth 0 lies in the plane of incidence on the normal's side,
180° toward the horizon. Zeros stand for directions below the horizon or out of the instrument's reach.
"""

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import about_mirror, cell_edges, polar_cells
from axffit.measured.files import numbers, read_lines
from axffit.measured.measurements import Measurements, RGBChannels

LISTS = ("SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial")
WORDS = ("Source", "Symmetry", "SpectralContent", "ScatterType")
PARTS = {"monochrome": ("monochrome",), "xyz": ("tristimulusx", "tristimulusy", "tristimulusz")}
"""Spectral parts by content, in lower case."""

# IEC 61966-2-1: linear sRGB from XYZ, white D65.
_RGB_FROM_XYZ = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
_WHAT = "Zemax BSDF"


class ZemaxTable(NamedTuple):
    """What the file says.

    ``words`` by keyword; ``angles`` by keyword, degrees; ``values`` (part, rotation, incidence, azimuth, radial);
    ``tis`` (part, rotation, incidence).
    """

    words: dict[str, str]
    angles: dict[str, np.ndarray]
    values: np.ndarray
    tis: np.ndarray


def read_table(path: str | os.PathLike) -> ZemaxTable:
    """The file's angles and values as they stand.

    Raises:
        InputError: the file cannot be read, a keyword is missing, or rows do not match the lists of angles.
    """
    path = Path(path)
    # Line numbers, without comments and blank lines.
    lines = [
        (k, line.strip())
        for k, line in enumerate(read_lines(path, _WHAT), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    start = next((at for at, (_, line) in enumerate(lines) if line.lower() in sum(PARTS.values(), ())), len(lines))
    words, angles = _header(path, lines[:start])
    parts = PARTS.get(words["SpectralContent"].lower())
    if parts is None:
        raise InputError(f"{path}: SpectralContent {words['SpectralContent']!r}; known are Monochrome and XYZ")
    if words["ScatterType"].upper() != "BRDF":
        raise InputError(f"{path}: ScatterType {words['ScatterType']!r}; only BRDF is read")
    shape = tuple(len(angles[name]) for name in LISTS)
    values, tis, position = [], [], start
    for part in parts:
        position = _expect(path, lines, position, part)
        position = _expect(path, lines, position, "databegin")
        for _ in range(shape[0] * shape[1]):
            end = position + 1 + shape[2]
            block = lines[position:end]
            if len(block) < 1 + shape[2] or not block[0][1].upper().startswith("TIS"):
                found = block[0][1][:40] if block else "the end of the file"
                raise InputError(
                    f"{path}: {found!r} where a block of TIS and {shape[2]} rows is due; "
                    "the file may be truncated: copy it again"
                )
            tis.append(numbers(path, [(block[0][0], block[0][1].split()[1:])], 1, "TIS"))
            rows = ((k, line.split()) for k, line in block[1:])
            values.append(numbers(path, rows, shape[3], "row of radial angles"))
            position = end
        position = _expect(path, lines, position, "dataend")
    if position != len(lines):
        raise InputError(f"{path}: line {lines[position][0]}: text after the last DataEnd; remove it")
    size = (len(parts), *shape)
    return ZemaxTable(words, angles, np.array(values).reshape(size), np.array(tis).reshape(size[:3]))


def _expect(path: Path, lines: list[tuple[int, str]], position: int, word: str) -> int:
    found = lines[position][1] if position < len(lines) else "the end of the file"
    if found.lower() != word:
        raise InputError(f"{path}: {found[:40]!r} where {word!r} is due; the file may be truncated: copy it again")
    return position + 1


def _header(path: Path, lines: list[tuple[int, str]]) -> tuple[dict[str, str], dict[str, np.ndarray]]:
    words: dict[str, str] = {}
    angles: dict[str, np.ndarray] = {}
    at = 0
    while at < len(lines):
        number, line = lines[at]
        key, *rest = line.split()
        if key in WORDS:
            words[key] = " ".join(rest)
        elif key in LISTS:
            count = int(rest[0]) if len(rest) == 1 and rest[0].isdigit() else 0
            at += 1
            following = [(lines[at][0], lines[at][1].split())] if at < len(lines) else []
            if not count:
                raise InputError(f"{path}: line {number}: {line!r}; {key} is followed by the number of its angles")
            angles[key] = numbers(path, following, count, f"list of {key}")[0]
        else:
            raise InputError(f"{path}: line {number}: unknown keyword {key!r}; known are {', '.join((*WORDS, *LISTS))}")
        at += 1
    missing = [key for key in (*WORDS, *LISTS) if key not in words and key not in angles]
    if missing:
        raise InputError(f"{path}: no {', '.join(missing)} before the data; the file may be truncated: copy it again")
    for key in LISTS:
        if not (np.diff(angles[key]) > 0).all():
            raise InputError(f"{path}: the angles of {key} do not rise: {angles[key].tolist()}")
    return words, angles


def read(path: str | os.PathLike) -> Measurements:
    """A Zemax BRDF file; a plane-symmetric one keeps the half of azimuths that it lists.

    Raises:
        InputError: as :func:`read_table`.
    """
    path = Path(path)
    table = read_table(path)
    rotation, incidence, azimuth, radial = (np.radians(table.angles[name]) for name in LISTS)
    turn, i, a, r = (x.ravel() for x in np.meshgrid(rotation, incidence, azimuth, radial, indexing="ij"))
    wi, wo = about_mirror(i, r, a)
    # The sample turned by +angle sees light and viewer turned by -angle.
    wi, wo = _turned(wi, -turn), _turned(wo, -turn)
    stored = table.values.reshape(len(table.values), -1).T
    values = np.repeat(stored, 3, axis=1) if stored.shape[1] == 1 else stored @ _RGB_FROM_XYZ.T
    # The node at the mirror direction itself stands once per azimuth.
    cells = np.outer(np.diff(cell_edges(azimuth, azimuth[0], azimuth[-1])), polar_cells(radial, np.pi)).ravel()
    weights = np.tile(np.outer(polar_cells(incidence), cells).ravel(), len(rotation))
    provenance = {
        "file": path.name,
        "format": f"Zemax BSDF, {table.words['SpectralContent']}, {table.words['Symmetry']}",
        "source": table.words["Source"],
        "grid": " x ".join(f"{len(table.angles[name])} {name}" for name in LISTS),
        "cosine": "values are f without the cosine, as stored",
        "color": "one channel, repeated as gray" if stored.shape[1] == 1 else "XYZ to linear sRGB, D65 (IEC 61966-2-1)",
        "geometry": "radial angles from the mirror direction, azimuth 0 on the normal's side",
        "validity": "zeros lie below the horizon or out of reach and are invalid",
        "noise": "not stated by the file",
    }
    white = "not stated" if stored.shape[1] == 1 else "D65"
    valid = (stored != 0).all(axis=1)
    return Measurements(wi, wo, values, valid, weights, None, RGBChannels(white=white), provenance, path.stem)


def _turned(v: np.ndarray, angle: np.ndarray) -> np.ndarray:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine * v[:, 0] - sine * v[:, 1], sine * v[:, 0] + cosine * v[:, 1], v[:, 2]], axis=1)
