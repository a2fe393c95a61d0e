"""N images of a flat sample under known light, listed in a table of directions.

The table is a CSV file with a header. ``file`` is an EXR image, relative to the table's folder; its direction to the
light and to the viewer are given either as vectors of any length (``light_x, light_y, light_z, view_x, view_y,
view_z``) or as polar angle and azimuth in degrees (``light_theta, light_phi, view_theta, view_phi``). x points along
the image's columns, y along its rows (row 0 is v = 0), z out of the surface. ``irradiance`` (optional, 1) divides the
image: what a perfect diffuser facing the light, times pi, would show.

One light and one view direction hold for a whole image: distant lights, an orthographic camera, images that lie on
each other texel by texel.
"""

import csv
import hashlib
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from axffit.errors import InputError
from axffit.textures.files import exr

_VECTORS = tuple(f"{side}_{axis}" for side in ("light", "view") for axis in "xyz")
_ANGLES = tuple(f"{side}_{angle}" for side in ("light", "view") for angle in ("theta", "phi"))


@dataclass(frozen=True, eq=False)
class Stack:
    """The rows of a directions table.

    Attributes:
        source: the table.
        files: the images.
        wi: unit vectors to the light, (n, 3).
        wo: unit vectors to the viewer, (n, 3).
        irradiance: what each image is divided by, (n,).
    """

    source: Path
    files: tuple[Path, ...]
    wi: Float[np.ndarray, "n 3"]
    wo: Float[np.ndarray, "n 3"]
    irradiance: Float[np.ndarray, " n"]

    def image(self, index: int) -> Float[np.ndarray, "height width channels"]:
        """An image divided by its irradiance, 1 or 3 channels, float32; alpha is left out.

        Raises:
            InputError: it cannot be read, or has two channels.
        """
        path = self.files[index]
        stored = exr.read(path)
        if len(stored.levels) != 1 or stored.is_array:
            raise InputError(f"{path}: has several parts; give an image of one")
        values = stored.number_format.decode(stored.levels[0])
        channels = values.shape[-1]
        if channels == 2:
            raise InputError(f"{path}: has 2 channels; give R, G and B, or R alone")
        return (values[..., : min(channels, 3)] / self.irradiance[index]).astype(np.float32)

    def fingerprints(self) -> dict[str, str]:
        """SHA-256 of the table and of every image, by name."""
        names = {str(path): path for path in (self.source, *self.files)}
        return {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in names.items()}


def read_stack(table: Path) -> Stack:
    """The table of directions.

    Raises:
        InputError: no such file, a missing column, a number or direction that cannot be used, or an image that is not
            there.
    """
    if not table.is_file():
        raise InputError(f"{table}: no such file; give a CSV table of images and directions")
    try:
        with table.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, skipinitialspace=True)
            columns, rows = tuple(reader.fieldnames or ()), list(reader)
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{table}: is no CSV text ({error})") from error
    kind = next((names for names in (_VECTORS, _ANGLES) if set(names) <= set(columns)), None)
    if "file" not in columns or kind is None:
        raise InputError(
            f"{table}: has columns {', '.join(columns) or 'none'}; needed are file and either {', '.join(_VECTORS)} or "
            f"{', '.join(_ANGLES)}"
        )
    if not rows:
        raise InputError(f"{table}: has a header and no images; give one a line")
    files, directions, irradiance = [], [], []
    for number, row in enumerate(rows, 2):
        where = f"{table}: line {number}"
        path = table.parent / (row["file"] or "")
        if not path.is_file():
            raise InputError(f"{where}: no such image {row['file']!r}; paths are relative to the table")
        files.append(path)
        values = [_number(row, name, where) for name in kind]
        half = len(values) // 2
        directions.append([_direction(part, where) for part in (values[:half], values[half:])])
        scale = _number(row, "irradiance", where) if "irradiance" in columns else 1.0
        if scale <= 0:
            raise InputError(f"{where}: irradiance {scale:g}; give a number above 0")
        irradiance.append(scale)
    wi, wo = np.moveaxis(np.array(directions), 1, 0)
    return Stack(table, tuple(files), wi, wo, np.array(irradiance))


def _number(row: dict[str, str], name: str, where: str) -> float:
    try:
        value = float(row[name] or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{where}: {name} is {row[name]!r}; give a finite number")
    return value


def _direction(values: list[float], where: str) -> Float[np.ndarray, "3"]:
    if len(values) == 2:
        theta, phi = np.radians(values)
        vector = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    else:
        vector = np.array(values)
    length = np.linalg.norm(vector)
    if not (length > 0 and vector[2] > 0):
        raise InputError(f"{where}: direction ({', '.join(f'{v:g}' for v in values)}) is not above the surface")
    return vector / length
