"""Where on a material the laws are checked: its extreme texels and some at random."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from axffit import axf
from axffit.axf.maps import SPATIAL_KEYS, reference_map, stretch
from axffit.brdf import AbstractBRDF
from axffit.quantization.brdf_error import without_negative_colors

MOST_EXTREME = 24
"""Extreme texels that are used at most, those of the first maps first."""


@dataclass(frozen=True)
class Place:
    """A place of a material.

    Attributes:
        name: where it is and why it was chosen, or "" where a material has only one.
        brdf: what is reflected there.
        extreme: whether it was chosen for being so; the others stand for the surface.
    """

    name: str
    brdf: AbstractBRDF
    extreme: bool = False


def places(material: axf.AxfMaterial, *, count: int = 8, seed: int = 0) -> tuple[Place, ...]:
    """Places of a material that stand for all of it.

    Of an SVBRDF the texels where a channel of a map is smallest and largest, and ``count`` at random, each map at its
    nearest texel. Of a car paint with flakes or coat maps, ``count`` places at random; without, the one BRDF.

    Negative colors are 0, as engines read them (``axffit.testing.negatives`` counts them).

    Args:
        material: the material.
        count: places at random, besides the extreme ones.
        seed: of those.

    Raises:
        InputError: the material has a model that axffit does not evaluate.
    """
    material = without_negative_colors(material)
    random = np.random.default_rng(seed).random((count, 2))
    if material.kind is axf.MaterialKind.CAR_PAINT:
        return _paint_places(material, random)
    extremes = _extremes(material)
    chosen = {**extremes, **{(float(u), float(v)): "at random" for u, v in random}}
    uv = np.array(list(chosen), np.float64)
    brdfs = jax.tree.map(np.asarray, axf.to_brdf(material, uv=uv))
    one = reference_map(material) is None
    found = []
    for index, (place, why) in enumerate(chosen.items()):
        brdf = jax.tree.map(lambda leaf, index=index: jnp.asarray(leaf[index]), brdfs)
        name = "" if one else f"uv ({place[0]:.6g}, {place[1]:.6g}), {why}"
        found.append(Place(name, brdf, extreme=place in extremes and not one))
    return tuple(found[:1] if one else found)


def _paint_places(material: axf.AxfMaterial, uv: np.ndarray) -> tuple[Place, ...]:
    surface = axf.to_svbrdf(material)
    varies = "btfflakes" in material.textures or reference_map(material) is not None
    if not varies or not len(uv):
        return (Place("", surface.at(jnp.zeros(2))),)
    return tuple(Place(f"uv ({u:.6g}, {v:.6g})", surface.at(jnp.asarray([u, v], jnp.float32))) for u, v in uv)


def _extremes(material: axf.AxfMaterial) -> dict[tuple[float, float], str]:
    """Texture coordinates of extreme texels, and what is extreme there; the material's first texel if all is flat."""
    reference = reference_map(material)
    found: dict[tuple[float, float], str] = {}
    for key in SPATIAL_KEYS:
        texture = material.textures.get(key)
        if texture is None or texture.is_constant:
            continue
        height, width, channels = texture.data.shape
        for channel in range(channels):
            values = texture.data[..., channel]
            if np.isnan(values).all() or np.nanmin(values) == np.nanmax(values):
                continue
            named = f"channel {channel} of {key}" if channels > 1 else key
            for why, index in (("smallest", np.nanargmin(values)), ("largest", np.nanargmax(values))):
                row, column = divmod(int(index), width)
                uv = np.array([(column + 0.5) / width, (row + 0.5) / height]) / stretch(texture, reference)
                found.setdefault((float(uv[0]), float(uv[1])), f"{why} {named}")
    return dict(list(found.items())[:MOST_EXTREME]) or {(0.0, 0.0): "first texel"}
