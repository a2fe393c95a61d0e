"""ASTM E1392 / E2387 text: a header of keywords, a line VARS that names the columns, then rows.

Each header line is a KEY and its value. ``VARS`` lists the columns, separated by commas: theta_i and theta_s (also
theta_r, theta_v), phi_i and phi_s (0 where missing), in radians, then the values: one column f (or BRDF), R, G, B, or
wavelengths (465nm). Columns ``sigma_*`` are the standard deviations of the values, in their order; other columns are
ignored. ``NUM_POINTS``, where it stands, must be the number of rows. Values are f in 1/sr.
"""

import os
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import direction
from axffit.measured.columns import RULE, channels_of
from axffit.measured.files import numbers, read_lines
from axffit.measured.measurements import Measurements

ANGLES = {
    "theta_i": ("theta_i",),
    "phi_i": ("phi_i",),
    "theta_s": ("theta_s", "theta_r", "theta_v", "theta_o"),
    "phi_s": ("phi_s", "phi_r", "phi_v", "phi_o"),
}
_WHAT = "ASTM E1392 text"
_SIGMA = "sigma"


def read(path: str | os.PathLike) -> Measurements:
    """An ASTM file; weights are equal, as the standard prescribes no grid.

    Raises:
        InputError: the file cannot be read, has no VARS, or rows or columns that do not fit.
    """
    path = Path(path)
    lines = read_lines(path, _WHAT)
    at = next((k for k, line in enumerate(lines) if line.split(None, 1)[:1] == ["VARS"]), None)
    if at is None:
        raise InputError(f"{path}: no line VARS; an {_WHAT} names its columns there; is the file truncated?")
    header = dict(_pair(line) for line in lines[:at] if line.strip() and not line.startswith("#"))
    names = [name.strip() for name in lines[at].split(None, 1)[-1].split(",")]
    if len(set(names)) != len(names):
        raise InputError(f"{path}: VARS names a column twice: {', '.join(names)}")
    filled = ((k, line.split(",")) for k, line in enumerate(lines[at + 1 :], at + 2) if line.strip())
    rows = numbers(path, filled, len(names), "row of VARS")
    _check_count(path, header, len(rows))
    column = {name: rows[:, k] for k, name in enumerate(names)}
    found = {key: next((name for name in known if name in column), None) for key, known in ANGLES.items()}
    if found["theta_i"] is None or found["theta_s"] is None:
        raise InputError(f"{path}: VARS names {', '.join(names)}; theta_i and theta_s are needed")
    zero = np.zeros(len(rows))
    theta_i, phi_i, theta_s, phi_s = (column.get(name or "", zero) for name in found.values())
    largest = max(np.abs(theta_i).max(), np.abs(theta_s).max())
    if not largest <= np.pi:
        raise InputError(f"{path}: a polar angle of {largest:g}; angles are radians, at most pi")
    others = [name for name in names if name not in sum(ANGLES.values(), ())]
    stored = [name for name in others if not name.lower().startswith(_SIGMA)]
    known = channels_of(stored, "not stated")
    if known is None:
        raise InputError(f"{path}: columns of values {', '.join(stored) or '(none)'}; give {RULE}")
    channels, repeat, words = known
    values = np.repeat(np.stack([column[name] for name in stored], axis=1), repeat, axis=1)
    noise = [column[name] for name in others if name.lower().startswith(_SIGMA)]
    sigma = np.repeat(np.stack(noise, axis=1), repeat, axis=1) if len(noise) == len(stored) else None
    missing = [key for key in ("phi_i", "phi_s") if found[key] is None]
    provenance = {
        "file": path.name,
        "format": "ASTM E1392 / E2387 text",
        "cosine": "values are f without the cosine, as the standard defines the BRDF",
        "color": words,
        "grid": "as listed, equal weights" + (f"; {' and '.join(missing)} not stated, taken as 0" if missing else ""),
        "noise": "sigma columns" if sigma is not None else "not stated by the file",
        **{key: value for key, value in header.items() if value},
    }
    name = header.get("SAMPLE_NAME", "").strip('"') or path.stem
    valid = np.ones(len(rows), bool)
    return Measurements(
        direction(theta_i, phi_i),
        direction(theta_s, phi_s),
        values,
        valid,
        np.ones(len(rows)),
        sigma,
        channels,
        provenance,
        name,
    )


def _pair(line: str) -> tuple[str, str]:
    key, _, value = line.strip().partition(" ")
    return key, value.strip()


def _check_count(path: Path, header: dict[str, str], rows: int) -> None:
    stated = header.get("NUM_POINTS")
    if stated is not None and stated != str(rows):
        raise InputError(f"{path}: NUM_POINTS {stated}, but {rows} rows; the file may be truncated: copy it again")
