"""What a picture shows at each of its points: one BRDF everywhere, an AxF material, or its textures in an engine."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from axffit.axf import AxfMaterial, AxfTexture, MaterialKind, to_svbrdf
from axffit.axf.appearance import model_parameters, texel_model
from axffit.axf.maps import DEFAULTS, SPATIAL_KEYS, reference_map, stretch
from axffit.brdf import AbstractBRDF, CarPaint, ClearCoat
from axffit.preview.textures import SampledTexture, original_texture, packed_texture
from axffit.targets import PackedMaterial, target_named

FLAKE_PROPERTIES = ("thetaFI_sliceLUT", "num_thetaF", "num_thetaI", "max_thetaI")
"""Without these a stack of flakes cannot be looked up."""

Shown = AbstractBRDF | AxfMaterial | PackedMaterial
"""What can be put on a shape."""


class Looked(NamedTuple):
    """BRDFs of P points, and what of them covers the background.

    The BRDF of a point is ``equinox.combine`` of its row of ``varying`` and of ``fixed``.
    """

    varying: AbstractBRDF
    """Array leaves with a leading axis of P; None where all points share one."""
    fixed: AbstractBRDF
    """The rest."""
    opacity: np.ndarray
    """(P,), 0 to 1."""


def look_up(shown: Shown, uv: np.ndarray, footprint: np.ndarray) -> Looked:
    """The BRDFs at texture coordinates ``uv`` (P, 2), averaged over about ``footprint`` (P,), a side in uv.

    Flakes of a car paint are looked up with their own mip levels. Heights are not shown.
    """
    if isinstance(shown, AbstractBRDF):
        nothing, everything = eqx.partition(shown, lambda leaf: False)
        return Looked(nothing, everything, np.ones(len(uv)))
    seen = _drawable(shown if isinstance(shown, AxfMaterial) else target_named(shown.target).unpack(shown))
    maps = _maps(shown, seen)
    if seen.kind is MaterialKind.CAR_PAINT:
        return _car_paint(seen, maps, uv, footprint)
    values = {key: _values(maps, key, uv, footprint) for key in SPATIAL_KEYS}
    parameters, _, _ = model_parameters(seen, values)
    model = eqx.filter_vmap(texel_model(seen))({name: jnp.asarray(v) for name, v in parameters.items()})
    varying, fixed = eqx.partition(model, eqx.is_inexact_array)
    return Looked(varying, fixed, np.clip(values["opacity"][:, 0], 0.0, 1.0))


def _drawable(material: AxfMaterial) -> AxfMaterial:
    """``material`` without flakes whose slices cannot be found, such as a target's default ones."""
    if all(name in material.properties for name in FLAKE_PROPERTIES):
        return material
    textures = {key: texture for key, texture in material.textures.items() if key != "btfflakes"}
    return replace(material, textures=textures)


def _maps(shown: AxfMaterial | PackedMaterial, seen: AxfMaterial) -> Mapping[str, SampledTexture]:
    """The maps that vary over the surface, by AxF name; ``seen`` is ``shown`` in AxF's ranges."""
    reference = reference_map(seen) or seen.textures.get("btfflakes")
    if isinstance(shown, AxfMaterial):
        return {
            key: original_texture(key, texture, _tiles(texture, reference))
            for key, texture in shown.textures.items()
            if key in SPATIAL_KEYS
        }
    module = target_named(shown.target)
    return {
        texture.axf_name: packed_texture(
            texture, module.reading(texture, shown.values), _tiles(seen.textures[texture.axf_name], reference)
        )
        for texture in shown.textures.values()
        if texture.axf_name in SPATIAL_KEYS
    }


def _tiles(texture: AxfTexture, reference: AxfTexture | None) -> np.ndarray:
    return np.asarray(stretch(texture, reference), np.float64)


def _values(maps: Mapping[str, SampledTexture], key: str, uv: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    """AxF values (P, C) of a map, by its default where there is none, float32."""
    if key not in maps:
        default = np.asarray(DEFAULTS[key], np.float32)
        return np.broadcast_to(default, (len(uv), default.size))
    return maps[key].fetch(uv, footprint).astype(np.float32)


def _car_paint(seen: AxfMaterial, maps: Mapping[str, SampledTexture], uv: np.ndarray, footprint: np.ndarray) -> Looked:
    shared = to_svbrdf(seen).shared
    base = shared["base"].with_flakes(shared.get("flakes"))
    paint = ClearCoat(base, shared["ior"], refracting=seen.coat_refracts)
    normals, colors = (_values(maps, key, uv, footprint) for key in ("clearcoatnormal", "clearcoatcolor"))

    def parts(coat: ClearCoat) -> tuple:
        coated = (coat.normal, coat.color)
        flakes = coat.base.flakes if isinstance(coat.base, CarPaint) else None
        return coated if flakes is None else (*coated, flakes.uv, flakes.level)

    new: list[np.ndarray] = [normals, colors]
    if base.flakes is not None:
        level = jax.vmap(base.flakes.slices.level_of)(jnp.asarray(footprint, jnp.float32))
        new += [uv.astype(np.float32), np.asarray(level)]
    places = eqx.tree_at(parts, jax.tree.map(lambda leaf: False, paint), (True,) * len(new))
    fixed = eqx.partition(paint, places)[1]
    varying = eqx.tree_at(parts, eqx.partition(paint, places)[0], tuple(jnp.asarray(x) for x in new))
    return Looked(varying, fixed, np.ones(len(uv)))
