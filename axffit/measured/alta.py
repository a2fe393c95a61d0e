"""ALTA text: ``#`` keywords, then rows of input and output numbers (Barla, Belcour and Pacanowski, ALTA library).

``#DIM nX nY`` gives the number of input and output columns, ``#PARAM_IN`` what the inputs are (:data:`INPUTS`),
``#PARAM_OUT`` what the outputs are: INV_STERADIAN (f), INV_STERADIAN_COSINE_FACTOR (f times the viewer's cosine, which
is divided out) or RGB_COLOR (f). Angles are radians, l the light's and v the viewer's.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from axffit.errors import InputError
from axffit.frames import half_difference_to_directions
from axffit.measured.angles import direction
from axffit.measured.columns import channels_of
from axffit.measured.files import numbers, read_lines
from axffit.measured.measurements import Measurements

LEAST_COSINE = 1e-3
"""Samples whose viewer has a smaller cosine are invalid where the cosine is divided out."""

_WHAT = "ALTA text"


class Input(NamedTuple):
    """A parametrization: number of columns, columns (N, n) to (wi, wo), and what it means."""

    columns: int
    directions: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    words: str


def _half_difference(
    theta_h: np.ndarray, theta_d: np.ndarray, phi_d: np.ndarray, phi_h: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    with jax.enable_x64(new_val=True):
        wi, wo = half_difference_to_directions(*(jnp.asarray(a) for a in (theta_h, theta_d, phi_d, phi_h)))
        return np.array(wi), np.array(wo)


def _projected(light: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The viewer from theta_v (cos, sin) of the azimuth difference; the light at azimuth 0."""
    return direction(light, 0.0), direction(np.hypot(x, y), np.arctan2(y, x))


def _from_cosine(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Light and viewer along the half vector."""
    half = direction(np.arccos(np.clip(x[:, 0], -1.0, 1.0)), 0.0)
    return half, half


def _zero(x: np.ndarray) -> np.ndarray:
    return np.zeros(len(x))


INPUTS = {
    "COS_TH": Input(1, _from_cosine, "cos theta_h; theta_d is not stated and taken as 0 (light = viewer)"),
    "RUSIN_TH_TD": Input(
        2, lambda x: _half_difference(x[:, 0], x[:, 1], np.full(len(x), np.pi / 2), _zero(x)), "phi_d taken as 90°"
    ),
    "RUSIN_TH_TD_PD": Input(
        3, lambda x: _half_difference(x[:, 0], x[:, 1], x[:, 2], _zero(x)), "theta_h, theta_d, phi_d"
    ),
    "RUSIN_TH_PH_TD_PD": Input(
        4, lambda x: _half_difference(x[:, 0], x[:, 2], x[:, 3], x[:, 1]), "theta_h, phi_h, theta_d, phi_d"
    ),
    "ISOTROPIC_TV_TL": Input(
        2, lambda x: (direction(x[:, 1], 0.0), direction(x[:, 0], 0.0)), "theta_v, theta_l, in one plane and signed"
    ),
    "ISOTROPIC_TV_TL_DPHI": Input(
        3, lambda x: (direction(x[:, 1], 0.0), direction(x[:, 0], x[:, 2])), "theta_v, theta_l, azimuth difference"
    ),
    "ISOTROPIC_TL_TV_PROJ_DPHI": Input(
        3, lambda x: _projected(x[:, 0], x[:, 1], x[:, 2]), "theta_l, theta_v times cos and sin of the difference"
    ),
    "SPHERICAL_TL_PL_TV_PV": Input(
        4, lambda x: (direction(x[:, 0], x[:, 1]), direction(x[:, 2], x[:, 3])), "theta_l, phi_l, theta_v, phi_v"
    ),
    "CARTESIAN": Input(6, lambda x: (_unit(x[:, 3:]), _unit(x[:, :3])), "the viewer's vector, then the light's"),
}
"""By ``#PARAM_IN``."""

OUTPUTS = ("INV_STERADIAN", "INV_STERADIAN_COSINE_FACTOR", "RGB_COLOR")


def _unit(v: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return v / np.where(length > 0, length, 1.0)


def read(path: str | os.PathLike) -> Measurements:
    """An ALTA file; weights are equal.

    Raises:
        InputError: the file cannot be read, its header lacks something or names what is not known, or rows do not fit.
    """
    path = Path(path)
    lines = read_lines(path, _WHAT)
    header = {}
    for line in lines:
        key, _, value = line[1:].strip().partition(" ") if line.startswith("#") else ("", "", "")
        if key.isupper() and value.strip():
            header.setdefault(key, value.strip())
    missing = [key for key in ("DIM", "PARAM_IN", "PARAM_OUT") if key not in header]
    if missing:
        raise InputError(f"{path}: no #{', #'.join(missing)}; an {_WHAT} states them; is the file truncated?")
    known = INPUTS.get(header["PARAM_IN"])
    if known is None:
        raise InputError(f"{path}: #PARAM_IN {header['PARAM_IN']}; known are {', '.join(INPUTS)}")
    if header["PARAM_OUT"] not in OUTPUTS:
        raise InputError(f"{path}: #PARAM_OUT {header['PARAM_OUT']}; known are {', '.join(OUTPUTS)}")
    sizes = header["DIM"].split()
    outputs = int(sizes[1]) if len(sizes) == 2 and sizes[1].isdigit() else 0
    if sizes[0] != str(known.columns) or outputs not in (1, 3):
        raise InputError(
            f"{path}: #DIM {header['DIM']}; {header['PARAM_IN']} has {known.columns} inputs, and outputs are 1 or 3"
        )
    if set(header.get("VS", "0").split()) != {"0"}:
        raise InputError(f"{path}: #VS {header['VS']}: columns of ranges are not read; write the file with #VS 0")
    filled = ((k, line.split()) for k, line in enumerate(lines, 1) if line.strip() and not line.startswith("#"))
    rows = numbers(path, filled, known.columns + outputs, "row")
    return _measurements(path, header, known, rows, outputs)


def _measurements(path: Path, header: dict[str, str], known: Input, rows: np.ndarray, outputs: int) -> Measurements:
    wi, wo = known.directions(rows[:, : known.columns])
    values = rows[:, known.columns :]
    valid = np.ones(len(rows), bool)
    cosine = "values are f without the cosine, as stored"
    if header["PARAM_OUT"] == "INV_STERADIAN_COSINE_FACTOR":
        valid = wo[:, 2] >= LEAST_COSINE
        values = values / np.where(valid, wo[:, 2], 1.0)[:, None]
        cosine = f"f cos(theta_v) as stored, divided by cos(theta_v); invalid below {LEAST_COSINE:g}"
    described = channels_of(("R", "G", "B") if outputs == 3 else ("f",), "not stated")
    assert described is not None
    channels, repeat, words = described
    provenance = {
        "file": path.name,
        "format": f"ALTA text, {header['PARAM_IN']} -> {header['PARAM_OUT']}",
        "geometry": known.words,
        "cosine": cosine,
        "color": words,
        "grid": "as listed, equal weights",
        "noise": "not stated by the file",
        **{key.lower(): header[key] for key in ("SAMPLE", "ORIGIN", "URL") if key in header},
    }
    name = header.get("SAMPLE", "").strip('"') or path.stem
    return Measurements(
        wi,
        wo,
        np.repeat(values, repeat, axis=1),
        valid,
        np.ones(len(rows)),
        None,
        channels,
        provenance,
        name,
    )
