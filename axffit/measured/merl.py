"""MERL ``.binary``: an isotropic BRDF on 90 x 90 x 180 cells of Rusinkiewicz's angles (Matusik et al. 2003).

Layout: little-endian int32 (90, 90, 180), then three planes (R, G, B) of 90·90·180 float64. Within a plane the index
is phi_d + 180 (theta_d + 90 theta_h) with theta_h index = 90 sqrt(2 theta_h / pi), theta_d index = 180 theta_d / pi
and phi_d index = 180 phi_d / pi, all rounded down; phi_d + pi where phi_d is negative (reciprocity).

f in 1/sr is the stored number times 1/1500, 1.15/1500 and 1.66/1500 for R, G and B. Negative numbers mark cells below
the horizon or without a measurement. Since indices are rounded down, a number stands for its cell, and samples sit at
the cells' centers.
"""

import os
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.files import read_bytes, write_whole
from axffit.measured.grid import reference_grid
from axffit.measured.measurements import Measurements, RGBChannels

SHAPE = (90, 90, 180)
"""Cells over theta_h, theta_d and phi_d."""

SCALE = np.array([1.0, 1.15, 1.66]) / 1500.0
"""What the stored R, G and B are multiplied by to be f in 1/sr."""

HEADER = np.array(SHAPE, "<i4").tobytes()
SIZE = len(HEADER) + 3 * 8 * int(np.prod(SHAPE))


def read_table(path: str | os.PathLike) -> np.ndarray:
    """f in 1/sr, (90, 90, 180, 3) float64, negative where the file says that nothing was measured.

    Raises:
        InputError: the file cannot be read, has another header, or not the 34 992 012 bytes of the format.
    """
    path = Path(path)
    data = read_bytes(path, "MERL .binary", most=SIZE + 1)
    if data[: len(HEADER)] != HEADER:
        sizes = np.frombuffer(data[:12].ljust(12, b"\0"), "<i4")
        swapped = " (big-endian: swap its bytes)" if sizes.byteswap().tolist() == list(SHAPE) else ""
        raise InputError(
            f"{path}: not a MERL .binary file: its header says {' x '.join(map(str, sizes))}{swapped}; "
            f"expected {' x '.join(map(str, SHAPE))}"
        )
    if len(data) != SIZE:
        state = "truncated" if len(data) < SIZE else "too long"
        raise InputError(f"{path}: {state}: {path.stat().st_size} bytes, {SIZE} expected; copy the file again")
    planes = np.frombuffer(data, "<f8", offset=len(HEADER)).reshape(3, *SHAPE)
    return np.moveaxis(planes, 0, -1) * SCALE


def write_table(path: str | os.PathLike, table: np.ndarray) -> None:
    """Write f in 1/sr, (90, 90, 180, 3), negative where there is none."""
    table = np.asarray(table, np.float64)
    if table.shape != (*SHAPE, 3):
        raise ValueError(f"table has shape {table.shape}: give {(*SHAPE, 3)}")
    write_whole(path, HEADER + np.ascontiguousarray(np.moveaxis(table / SCALE, -1, 0), "<f8").tobytes())


def read(path: str | os.PathLike) -> Measurements:
    """The cells whose directions are both above the horizon; negative numbers are invalid.

    Raises:
        InputError: as :func:`read_table`.
    """
    path = Path(path)
    grid = reference_grid(*SHAPE)
    values = read_table(path).reshape(-1, 3)[grid.index]
    provenance = {
        "file": path.name,
        "format": "MERL .binary (Matusik et al. 2003)",
        "grid": "90 x 90 x 180 cells of theta_h, theta_d, phi_d, at their centers, both directions above the horizon",
        "cosine": "values are f without the cosine; stored numbers times 1/1500, 1.15/1500, 1.66/1500",
        "color": "RGB of the camera as stored, taken as linear sRGB; the file states no space and no white",
        "validity": "negative numbers are not measured and invalid",
        "noise": "not stated by the file",
    }
    valid = (values >= 0).all(axis=1)
    return Measurements(
        grid.wi, grid.wo, values, valid, grid.weights, None, RGBChannels(white="not stated"), provenance, path.stem
    )
