"""NIST's tables of sintered PTFE (Germer 2017): CSV of f and the Mueller matrix over four angles and wavelength.

Columns: lambda (micrometers), thetai, phi (also phii), thetar, phir (degrees, polar angles signed), f_r11 (also fr11),
the unpolarized f in 1/sr, then Mueller ratios, which are not read. Where the rows of all wavelengths list the same
directions in the same order, the samples have one channel a wavelength; else the file must hold a single wavelength.
"""

import os
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import direction
from axffit.measured.csv_table import read_csv
from axffit.measured.measurements import Measurements, Wavelengths

COLUMNS = {
    "lambda": ("lambda",),
    "thetai": ("thetai",),
    "phii": ("phi", "phii"),
    "thetar": ("thetar",),
    "phir": ("phir",),
    "f": ("f_r11", "fr11"),
}


def recognizes(names: list[str]) -> bool:
    """Whether a header (lower case) is that of these tables."""
    return names[:2] == ["lambda", "thetai"]


def read(path: str | os.PathLike) -> Measurements:
    """A NIST table; weights are equal.

    Raises:
        InputError: the file cannot be read, a column is missing, or wavelengths do not share their directions.
    """
    path = Path(path)
    table = read_csv(path, "NIST PTFE table")
    names = [name.lower() for name in table.names]
    places = {}
    for key, known in COLUMNS.items():
        found = [names.index(name) for name in known if name in names]
        if not found:
            raise InputError(f"{path}: no column {' or '.join(known)}; the header names {', '.join(table.names)}")
        places[key] = found[0]
    rows = table.numbers(path)
    wavelength, f = rows[:, places["lambda"]], rows[:, places["f"]]
    angles = np.radians(rows[:, [places[key] for key in ("thetai", "phii", "thetar", "phir")]])
    steps = np.unique(wavelength)
    groups = [angles[wavelength == step] for step in steps]
    if any(group.shape != groups[0].shape or not np.array_equal(group, groups[0]) for group in groups):
        raise InputError(
            f"{path}: the wavelengths {', '.join(f'{step:g}' for step in steps)} um do not list the same directions; "
            "give a file with the rows of one wavelength"
        )
    if not (steps[0] > 0.1 and steps[-1] < 100):
        raise InputError(f"{path}: lambda from {steps[0]:g} to {steps[-1]:g}; micrometers are expected")
    values = np.stack([f[wavelength == step] for step in steps], axis=1)
    wi, wo = direction(groups[0][:, 0], groups[0][:, 1]), direction(groups[0][:, 2], groups[0][:, 3])
    provenance = {
        "file": path.name,
        "format": "NIST table of PTFE (Germer 2017)",
        "cosine": "f_r11 is f without the cosine, unpolarized",
        "color": f"{len(steps)} wavelengths: {', '.join(f'{1000 * step:g}' for step in steps)} nm",
        "grid": "as listed, equal weights",
        "noise": "not stated by the file",
    }
    n = len(values)
    channels = Wavelengths(np.round(1000.0 * steps, 6))
    return Measurements(wi, wo, values, np.ones(n, bool), np.ones(n), None, channels, provenance, path.stem)
