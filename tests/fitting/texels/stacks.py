"""Stacks of images on disk, made of synthetic texels."""

from pathlib import Path

import numpy as np

from axffit.fitting.texels.synthetic import SyntheticTexels
from axffit.textures.files import exr
from axffit.textures.files.image import TextureImage


def write_image(path: Path, values: np.ndarray) -> None:
    """An EXR of single floats."""
    codes = np.ascontiguousarray(values, np.float32).view(np.uint32)
    exr.write(path, TextureImage("RGBA"[: values.shape[-1]] + "32F", (codes,)))


def write_stack(folder: Path, texels: SyntheticTexels, shape: tuple[int, int]) -> Path:
    """The table of directions and an image a direction; the irradiance is 2."""
    folder.mkdir(exist_ok=True)
    lines = ["file,light_x,light_y,light_z,view_x,view_y,view_z,irradiance"]
    values = np.asarray(texels.samples.values)
    for index, (wi, wo) in enumerate(zip(texels.wi, texels.wo, strict=True)):
        name = f"image_{index:02d}.exr"
        write_image(folder / name, 2.0 * values[:, index].T.reshape(*shape, -1))
        lines.append(",".join([name, *(repr(float(2 * v)) for v in wi), *(repr(float(v)) for v in wo), "2"]))
    table = folder / "directions.csv"
    table.write_text("\n".join(lines) + "\n")
    return table
