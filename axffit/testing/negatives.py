"""Negative colors: legal in AxF files, where measurements and changes of color space leave them, and read as 0."""

import numpy as np

from axffit.axf import AxfMaterial
from axffit.quantization.measures import COLORS


def negative_colors(material: AxfMaterial) -> str | None:
    """How many values of which color textures are below 0, over all mip levels, and how far; None if none is."""
    found = []
    for key in COLORS:
        texture = material.textures.get(key)
        levels = () if texture is None else texture.levels
        negative = sum(int(np.count_nonzero(level < 0)) for level in levels)
        if negative:
            total, least = sum(level.size for level in levels), min(float(level.min()) for level in levels)
            found.append(f"{negative} of {total} values of {key}, down to {least:.4g}")
    return "; ".join(found) or None
