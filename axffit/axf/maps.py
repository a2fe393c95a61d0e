"""A material's maps at chosen positions: nearest texel, every map by its own size in texels and in millimeters."""

from collections.abc import Mapping

import numpy as np

from .material import AxfMaterial, AxfTexture

SPATIAL_KEYS = (
    "diffusecolor",
    "normal",
    "specularcolor",
    "specularlobe",
    "anisrotation",
    "fresnel",
    "opacity",
    "height",
    "clearcoatcolor",
    "clearcoatnormal",
    "clearcoatior",
)
"""The textures that vary over the surface (the color table does not, the flakes also vary over angles)."""

DEFAULTS: Mapping[str, tuple[float, ...]] = {
    "diffusecolor": (0.0, 0.0, 0.0),
    "normal": (0.0, 0.0, 1.0),
    "specularcolor": (1.0, 1.0, 1.0),
    "specularlobe": (1.0,),
    "anisrotation": (0.0,),
    "fresnel": (0.0,),
    "opacity": (1.0,),
    "height": (0.0,),
    "clearcoatcolor": (1.0, 1.0, 1.0),
    "clearcoatnormal": (0.0, 0.0, 1.0),
    "clearcoatior": (1.5,),
}
"""What an absent map stands for, in AxF's own ranges."""


def reference_map(material: AxfMaterial) -> AxfTexture | None:
    """The map with the most texels among those that vary over the surface: its grid is the material's."""
    maps = [material.textures[key] for key in SPATIAL_KEYS if key in material.textures]
    varying = [texture for texture in maps if not texture.is_constant]
    return max(varying, key=lambda texture: texture.data.shape[0] * texture.data.shape[1], default=None)


def grid_shape(material: AxfMaterial) -> tuple[int, int]:
    """(height, width) of the material's grid of texels; (1, 1) when nothing varies."""
    reference = reference_map(material)
    return (1, 1) if reference is None else (reference.data.shape[0], reference.data.shape[1])


def texel_centers(material: AxfMaterial, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Texture coordinates (..., 2) of texels of the material's grid; u runs along columns, v along rows."""
    height, width = grid_shape(material)
    rows, columns = np.broadcast_arrays(rows, columns)
    return np.stack([(columns + 0.5) / width, (rows + 0.5) / height], axis=-1)


def gather(material: AxfMaterial, uv: np.ndarray) -> dict[str, np.ndarray]:
    """Every spatial map at texture coordinates, absent ones by their default.

    A coordinate is a position in millimeters over the size of the reference map in millimeters; maps repeat. A map
    of another size in millimeters is looked up at the same position.

    Args:
        material: the material.
        uv: coordinates (..., 2).

    Returns:
        Canonical name to values (..., channels), float32, in AxF's own ranges.
    """
    reference = reference_map(material)
    values = {}
    for key in SPATIAL_KEYS:
        texture = material.textures.get(key)
        if texture is None:
            default = np.asarray(DEFAULTS[key], np.float32)
            values[key] = np.broadcast_to(default, (*uv.shape[:-1], default.size))
        else:
            values[key] = _nearest(texture, uv * stretch(texture, reference))
    return values


def stretch(texture: AxfTexture, reference: AxfTexture | None) -> np.ndarray:
    """What turns coordinates (u, v) of the reference map into coordinates of this map, (2,)."""
    if reference is None or texture.is_constant:
        return np.ones(2)
    return np.array([reference.width_mm / texture.width_mm, reference.height_mm / texture.height_mm])


def nearest(shape: tuple[int, ...], uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns (...) of the texels of a map [H, W, C] that hold coordinates (..., 2) of it; maps repeat."""
    height, width = shape[:2]
    columns, rows = np.moveaxis(np.floor(uv * (width, height)).astype(np.int64) % (width, height), -1, 0)
    return np.asarray(rows), np.asarray(columns)


def _nearest(texture: AxfTexture, uv: np.ndarray) -> np.ndarray:
    # A map without a size in millimeters is a constant, whatever its texels: its mean would invent a value.
    shape = (1, 1) if texture.is_constant else texture.data.shape
    return texture.data[nearest(shape, uv)].astype(np.float32)
