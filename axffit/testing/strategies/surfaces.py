"""Textures as a GPU reads them, and reflectances that vary over a surface."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from hypothesis import strategies as st

from axffit import axf, brdf
from axffit.testing.strategies.materials import car_paint_materials, svbrdf_materials
from axffit.testing.strategies.values import Draw, built, composite


def _levels(side: tuple[int, int], count: int) -> list[tuple[int, int]]:
    return [(max(side[0] >> level, 1), max(side[1] >> level, 1)) for level in range(count)]


def texture_maps(
    *, channels: int = 3, most: int = 8, slices: int = 1, lowest: float = 0.0, highest: float = 1.0
) -> st.SearchStrategy[brdf.TextureMap]:
    """Texture maps: constant, of any size, with mip levels, tiled, mirrored.

    Args:
        channels: of each texel.
        most: largest side in texels.
        slices: number of slices, 1 for a plain texture.
        lowest: smallest value of a texel.
        highest: largest value.
    """
    if min(channels, most, slices) < 1:
        raise ValueError(f"channels={channels}, most={most}, slices={slices}: at least one of each")
    if not -np.inf < lowest <= highest < np.inf:
        raise ValueError(f"texels from {lowest} to {highest}: give a finite range")

    @composite
    def texture(draw: Draw) -> brdf.TextureMap:
        side = draw(st.tuples(st.integers(1, most), st.integers(1, most)))
        shapes = _levels(side, draw(st.integers(1, max(side).bit_length())))
        tiles = draw(st.just((1.0, 1.0)) | st.tuples(st.floats(0.25, 4.0), st.floats(0.25, 4.0)))
        mirrored, seed = draw(st.booleans()), draw(st.integers(0, 2**32 - 1))
        # Many texels: drawn from a seed, but for the ends of the range, which every texture holds.
        rng = np.random.default_rng(seed)
        levels = [rng.uniform(lowest, highest, (slices, *shape, channels)) for shape in shapes]
        levels[0].flat[0], levels[0].flat[-1] = lowest, highest
        return built(lambda: brdf.texture_map(levels, tiles=tiles, mirrored=mirrored))

    return texture()


def _build(shared: dict[str, Any], texel: Mapping[str, Any]) -> brdf.AbstractBRDF:
    return brdf.Framed(
        brdf.Sum((brdf.Lambert(texel["diffuse"]), brdf.GGX(shared["specular"], texel["roughness"][0]))),
        texel["normal"],
        texel["rotation"][0],
    )


def _composed(most: int) -> st.SearchStrategy[brdf.SVBRDF]:
    """Maps that every parameter has of its own: Lambert and GGX in a tilted, turned frame."""

    @composite
    def surface(draw: Draw) -> brdf.SVBRDF:
        def of(channels: int, lowest: float, highest: float) -> brdf.TextureMap:
            return draw(texture_maps(channels=channels, most=most, lowest=lowest, highest=highest))

        maps = {
            "diffuse": of(3, 0.0, 1.0),
            "roughness": of(1, 0.02, 1.0),
            "normal": of(3, 0.1, 1.0),
            "rotation": of(1, -np.pi, np.pi),
        }
        alpha, height = (draw(st.none() | texture_maps(channels=1, most=most)) for _ in range(2))
        size = draw(st.tuples(*[st.floats(0.1, 1000.0)] * 2))
        shared = {"specular": np.asarray(draw(st.tuples(*[st.floats(0.0, 1.0)] * 3)))}
        return built(lambda: brdf.SVBRDF(maps, _build, shared, size, alpha, height))

    return surface()


def svbrdfs(*, most: int = 4) -> st.SearchStrategy[brdf.SVBRDF]:
    """Reflectances that vary over a surface: of SVBRDF materials, of car paints with flakes, and made of bare maps.

    Args:
        most: largest side of a map in texels.
    """
    if most < 1:
        raise ValueError(f"most={most}: at least one texel")
    materials = svbrdf_materials(most=most) | car_paint_materials(most=most)
    return _composed(most) | materials.map(lambda material: built(axf.to_svbrdf, material))
