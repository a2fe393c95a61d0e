"""UTIA ``.bin``: an anisotropic BRDF at 6 polar and 48 azimuth angles of light and viewer (Filip and Vavra 2014).

Layout: no header; three planes (R, G, B) of 288 x 288 little-endian float64. Rows are the light's directions, columns
the viewer's, each index = 48 theta + phi with theta = 0°, 15° … 75° and phi = 0°, 7.5° … 352.5°. Values are f in 1/sr,
linear RGB. An ``.exr`` of the same holds the planes as channels R, G and B of a 288 x 288 image.
"""

import os
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import direction, polar_cells
from axffit.measured.files import read_bytes, write_whole
from axffit.measured.measurements import Measurements, RGBChannels

THETA = np.radians(np.arange(0.0, 76.0, 15.0))
PHI = np.radians(np.arange(0.0, 360.0, 7.5))
COUNT = len(THETA) * len(PHI)
SIZE = 3 * 8 * COUNT * COUNT
EXR_MAGIC = b"\x76\x2f\x31\x01"

_LARGEST, _SMALLEST = 1e6, 1e-30
"""Beyond these no f in 1/sr of a measurement lies; numbers with swapped bytes do."""


def read_table(path: str | os.PathLike) -> np.ndarray:
    """f, (light 288, viewer 288, 3) float64.

    Raises:
        InputError: the file cannot be read, has not the 1 990 656 bytes of the format, or holds numbers that no f is.
    """
    path = Path(path)
    data = read_bytes(path, "UTIA .bin")
    if data.startswith(EXR_MAGIC):
        return _read_exr(path)
    if len(data) != SIZE:
        raise InputError(
            f"{path}: {len(data)} bytes; a UTIA .bin has {SIZE}, 3 x {COUNT} x {COUNT} float64; copy the file again"
        )
    planes = np.frombuffer(data, "<f8").reshape(3, COUNT, COUNT)
    if not _plausible(planes):
        order = "big-endian: swap its bytes" if _plausible(planes.byteswap()) else "is it float64?"
        raise InputError(
            f"{path}: holds numbers that no f is (not finite, beyond {_LARGEST:g}, below {_SMALLEST:g}); {order}"
        )
    return np.moveaxis(planes, 0, -1)


def _plausible(planes: np.ndarray) -> bool:
    with np.errstate(invalid="ignore"):
        size = np.abs(planes)
        return bool(((size == 0) | ((size >= _SMALLEST) & (size <= _LARGEST))).all())


def _read_exr(path: Path) -> np.ndarray:
    import OpenEXR

    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: c.pixels for part in file.parts for name, c in part.channels.items()}
    except Exception as error:  # noqa: BLE001 (OpenEXR's errors have no common type of their own)
        raise InputError(f"{path}: cannot be read as EXR ({error}); copy the file again") from None
    planes = [channels.get(name) for name in "RGB"]
    if any(plane is None or plane.shape != (COUNT, COUNT) for plane in planes):
        shapes = {name: pixels.shape for name, pixels in channels.items()}
        raise InputError(f"{path}: holds channels {shapes}; a UTIA .exr has R, G and B of {COUNT} x {COUNT}")
    table = np.stack([np.asarray(plane, np.float64) for plane in planes], axis=-1)
    if not np.isfinite(table).all():
        raise InputError(f"{path}: holds values that are not finite; copy the file again")
    return table


def write_table(path: str | os.PathLike, table: np.ndarray) -> None:
    """Write f, (288, 288, 3), as ``.bin``."""
    table = np.asarray(table, np.float64)
    if table.shape != (COUNT, COUNT, 3):
        raise ValueError(f"table has shape {table.shape}: give {(COUNT, COUNT, 3)}")
    write_whole(path, np.ascontiguousarray(np.moveaxis(table, -1, 0), "<f8").tobytes())


def read(path: str | os.PathLike) -> Measurements:
    """A UTIA file; weights are the solid angles of both directions' cells.

    Raises:
        InputError: as :func:`read_table`.
    """
    path = Path(path)
    values = read_table(path).reshape(-1, 3)
    directions = direction(THETA[:, None], PHI[None, :]).reshape(-1, 3)
    cells = np.repeat(polar_cells(THETA), len(PHI))
    provenance = {
        "file": path.name,
        "format": "UTIA BRDF, anisotropic (Filip and Vavra 2014)",
        "grid": "6 x 48 directions of light and viewer, polar angles every 15° to 75°, azimuths every 7.5°",
        "cosine": "values are f without the cosine, as stored",
        "color": "RGB as stored, taken as linear sRGB; the file states no space and no white",
        "noise": "not stated by the file",
    }
    return Measurements(
        np.repeat(directions, COUNT, axis=0),
        np.tile(directions, (COUNT, 1)),
        values,
        np.ones(COUNT * COUNT, bool),
        np.outer(cells, cells).ravel(),
        None,
        RGBChannels(white="not stated"),
        provenance,
        path.stem,
    )
