"""Every texel of a material, before and after packing, side by side, in tiles of bounded memory.

A 4096² material has 16.8 million texels of some 20 channels: what looks at all of them (texel classes, the extremes of
a sample) takes them tile by tile, and what looks at a few takes a material of only those. Nothing here decodes a whole
map. The flakes and the color table of a car paint are not part of it: they do not vary over the surface alone.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..axf import AxfMaterial, AxfTexture
from ..axf.maps import DEFAULTS, SPATIAL_KEYS, grid_shape, nearest, reference_map, stretch, texel_centers
from ..axf.scratch import let_go
from ..targets import PackedMaterial, PackedTexture, target_named
from ..targets.encoding import decode_rows

TILE_TEXELS = 2**16
"""Texels of a tile: about 10 MiB of values, both sides together."""


@dataclass(frozen=True, eq=False)
class Tile:
    """A run of texels of the material's grid, in the order of its rows.

    Attributes:
        start: the first texel's number in the grid: row · width + column.
        uv: texture coordinates of the texels' centers, (n, 2).
        before: AxF name to AxF's own values (n, channels), float32: negative colors and unusable indices included.
        after: AxF name to what the shader sees (n, channels), float32.
    """

    start: int
    uv: np.ndarray
    before: Mapping[str, np.ndarray]
    after: Mapping[str, np.ndarray]


def tiles(material: AxfMaterial, packed: PackedMaterial, texels: int = TILE_TEXELS) -> Iterator[Tile]:
    """All texels of the material's grid (`axf.maps.grid_shape`), every map that varies over the surface.

    A map of another size is taken at the same place in millimeters; an absent one at its default.

    Args:
        material: the original.
        packed: the packed material, with the names and values of the target that reads it.
        texels: texels of a tile.
    """
    height, width = grid_shape(material)
    reference = reference_map(material)
    before = {key: _axf_side(material, key, reference) for key in SPATIAL_KEYS}
    after = {key: _packed_side(packed, key, reference) for key in SPATIAL_KEYS}
    held = [level for texture in (*material.textures.values(), *packed.textures.values()) for level in texture.levels]
    for start in range(0, height * width, texels):
        run = slice(start, min(start + texels, height * width))
        rows, columns = np.divmod(np.arange(run.start, run.stop), width)
        uv = texel_centers(material, rows, columns)
        yield Tile(start, uv, *({key: side(uv, run) for key, side in sides.items()} for sides in (before, after)))
        let_go(*held)


def of_texels(material: AxfMaterial, uv: np.ndarray) -> AxfMaterial:
    """The material of only the texels at texture coordinates ``uv`` (n, 2): every varying map is [1, n, C].

    Its own coordinates of the k-th are `centers`; everything that does not vary over the surface is as it was.
    """
    reference = reference_map(material)
    textures = dict(material.textures)
    for key in SPATIAL_KEYS:
        texture = textures.get(key)
        if texture is not None and not texture.is_constant:
            rows, columns = nearest(texture.data.shape, uv * stretch(texture, reference))
            picked = np.asarray(texture.data[rows, columns])[None]
            let_go(texture.data)
            textures[key] = AxfTexture((picked,), float(len(uv)), 1.0, texture.source)
    return replace(material, textures=textures)


def of_packed_texels(packed: PackedMaterial, material: AxfMaterial, uv: np.ndarray) -> PackedMaterial:
    """The packed material of only the texels at ``uv`` (n, 2) of the original's grid: codes [1, n, C] a varying map.

    ``unpack`` of it is what the shader sees at these texels, at the cost of these texels. The flakes are left out.
    """
    reference = reference_map(material)
    textures = {}
    for name, texture in packed.textures.items():
        if texture.axf_name == "btfflakes":
            continue
        textures[name] = texture
        if texture.axf_name in SPATIAL_KEYS and not _is_constant(texture):
            rows, columns = nearest(texture.levels[0].shape, uv * _stretch(texture, reference))
            codes = np.asarray(texture.levels[0][rows, columns])[None]
            let_go(texture.levels[0])
            textures[name] = replace(texture, levels=(codes,), width_mm=float(len(uv)), height_mm=1.0)
    return replace(packed, textures=textures)


def centers(count: int) -> np.ndarray:
    """Texture coordinates (n, 2) of the texels of a material of ``count`` of them (`of_texels`)."""
    return np.stack([(np.arange(count) + 0.5) / count, np.full(count, 0.5)], axis=-1)


Side = Callable[[np.ndarray, slice], np.ndarray]
"""(texture coordinates (n, 2), the same texels as a run of the grid) -> values (n, channels) of one map, float32."""


def _axf_side(material: AxfMaterial, key: str, reference: AxfTexture | None) -> Side:
    texture = material.textures.get(key)
    if texture is None:
        return _default(key)
    tiled = None if texture.is_constant else stretch(texture, reference)
    return _looked_up(texture.data, tiled, reference, lambda rows: rows.astype(np.float32))


def _packed_side(packed: PackedMaterial, key: str, reference: AxfTexture | None) -> Side:
    texture = next((texture for texture in packed.textures.values() if texture.axf_name == key), None)
    if texture is None:
        return _default(key)
    form = texture.number_format
    reading = target_named(packed.target).reading(texture, packed.values)

    def seen(codes: np.ndarray) -> np.ndarray:
        with np.errstate(over="ignore"):
            return decode_rows(codes, reading, form, texture.channels).astype(np.float32)

    tiled = None if _is_constant(texture) else _stretch(texture, reference)
    return _looked_up(texture.levels[0], tiled, reference, seen)


def _looked_up(
    level: np.ndarray,
    tiled: np.ndarray | None,
    reference: AxfTexture | None,
    values: Callable[[np.ndarray], np.ndarray],
) -> Side:
    """A level by place; ``tiled`` turns the material's coordinates into the map's, None for a constant map."""
    if tiled is None:
        single = values(level[0, :1])
        return lambda uv, run: np.broadcast_to(single, (len(uv), single.shape[-1]))
    if reference is not None and level.shape[:2] == reference.data.shape[:2] and np.all(tiled == 1.0):
        flat = level.reshape(-1, level.shape[-1])
        return lambda uv, run: values(flat[run])
    return lambda uv, run: values(level[nearest(level.shape, uv * tiled)])


def _default(key: str) -> Side:
    values = np.asarray(DEFAULTS[key], np.float32)
    return lambda uv, run: np.broadcast_to(values, (len(uv), values.size))


def _is_constant(texture: PackedTexture) -> bool:
    return texture.levels[0].shape[-3:-1] == (1, 1) or texture.width_mm <= 0 or texture.height_mm <= 0


def _stretch(texture: PackedTexture, reference: AxfTexture | None) -> np.ndarray:
    if reference is None or _is_constant(texture):
        return np.ones(2)
    return np.array([reference.width_mm / texture.width_mm, reference.height_mm / texture.height_mm])
