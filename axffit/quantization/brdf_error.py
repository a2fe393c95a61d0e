"""How far quantized textures change the BRDF: found on a sample of texels and directions, not yet a bound.

Two definitions, each over views and lights at least 1° above the horizon, f the original's value, f' the packed one's:

    (b)  max |f' - f| i_z / max_i (f i_z), the peak taken per view and over the three channels
    (c)  max |log f' - log f| where f i_z >= 1e-3 of that view's peak

Plain relative error over the whole hemisphere means nothing for Gaussian lobes (far out it reaches any value), and one
peak for all views is ill-defined where f i_z grows without bound at grazing. Two things are reported apart, as the
strip: lights and views within 1° of a tilted normal's horizon, where f jumps to 0 somewhere inside the normal's error,
and views whose mirror direction lies there or below, which see only a lobe's tail and no peak to compare with.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..axf import AxfMaterial, MaterialKind, to_brdf
from ..axf.maps import gather
from ..axf.ranges import ROUGHNESS_FLOOR
from ..brdf import AbstractBRDF, ClearCoat
from ..frames import dot, refract
from ..numerics import normalize
from .directions import LOWEST, VIEW_POLAR, LobeFrames, even_lights, half_vectors, lobe_lights, views
from .measures import COLORS
from .statistics import finite_or_none

RINGS, SPOKES, EVEN_LIGHTS = 24, 12, 60
RELEVANT = 1e-3
"""Definition (c) looks where f i_z is at least this part of the view's peak."""

BATCH = 32
"""Texels evaluated at once."""

Normals = tuple[jax.Array, jax.Array, jax.Array]
"""Base normals (n, 3), coat normals (n, 3), indices of refraction (n,)."""


@dataclass(frozen=True)
class Found:
    """The largest error found under one definition, and where.

    Attributes:
        value: the error; infinite where f' is 0 and f is not.
        uv: texture coordinates of the texel.
        wi: direction to the light.
        wo: direction to the viewer.
    """

    value: float
    uv: tuple[float, float]
    wi: tuple[float, float, float]
    wo: tuple[float, float, float]

    def to_json(self) -> dict[str, Any]:
        """As a JSON object; an infinite error is null."""
        where = {"uv": list(self.uv), "wi": list(self.wi), "wo": list(self.wo)}
        return {"found": finite_or_none(self.value), "where": where}


@dataclass(frozen=True)
class BrdfErrors:
    """The BRDF error of a material.

    Attributes:
        peak_relative: definition (b).
        log_ratio: definition (c).
        strip: definition (b) within 1° of a shading normal's horizon, and in views whose mirror direction is there.
        texels: texels sampled.
        views: views of each.
        lights: lights of each view.
    """

    peak_relative: Found
    log_ratio: Found
    strip: Found
    texels: int
    views: int
    lights: int


def brdf_errors(
    before: AxfMaterial, after: AxfMaterial, uv: np.ndarray, progress: Callable[[float], None] = lambda fraction: None
) -> BrdfErrors:
    """Largest errors found at texture coordinates ``uv`` (n, 2); needs JAX with x64 enabled.

    Negative colors of the original count as 0.

    Args:
        before: the original material.
        after: what the shader sees.
        uv: where; see `samples.sample_texels`.
        progress: called with the part that is done.

    Raises:
        InputError: a model that axffit does not evaluate.
    """
    before = without_negative_colors(before)
    models = [_texels(material, uv) for material in (before, after)]
    frames = [_lobe_frames(material, uv) for material in (before, after)]
    wo, even = views(len(uv)), even_lights(EVEN_LIGHTS)
    worst: dict[str, Found] = {}
    lights = 0
    for start in range(0, len(uv), BATCH):
        part = np.arange(start, min(start + BATCH, len(uv)))
        wi = _lights(frames[0], wo, even, part)
        lights = wi.shape[2]
        # Every batch has the same shape, so that one compilation serves all.
        full = np.resize(part, BATCH)
        errors = _errors(
            (models[0].take(full), models[1].take(full)),
            (_normals(frames[0], full), _normals(frames[1], full)),
            wi,
            jnp.asarray(wo[full]),
        )
        for name, values in errors.items():
            values = np.asarray(values)[: len(part)]
            texel, view, light = (int(i) for i in np.unravel_index(np.argmax(values), values.shape))
            value = float(values[texel, view, light])
            if name not in worst or value > worst[name].value:
                direction = tuple(float(x) for x in wi[texel, view, light])
                viewer = tuple(float(x) for x in wo[part[texel], view])
                place = tuple(float(x) for x in uv[part[texel]])
                worst[name] = Found(value, place, direction, viewer)  # pyright: ignore[reportArgumentType]
        progress((part[-1] + 1) / len(uv))
    return BrdfErrors(**worst, texels=len(uv), views=len(VIEW_POLAR), lights=lights)


def without_negative_colors(material: AxfMaterial) -> AxfMaterial:
    """The material whose negative colors are 0, as the specification wants them: the reference of the BRDF error.

    How many texels that changes, and how far they were below 0, the map level says.
    """
    textures = dict(material.textures)
    for key in COLORS:
        texture = textures.get(key)
        if texture is not None and any(float(level.min()) < 0 for level in texture.levels):
            textures[key] = replace(texture, levels=tuple(np.maximum(level, 0) for level in texture.levels))
    return replace(material, textures=textures)


class Texels(eqx.Module):
    """BRDFs that differ between texels in some array leaves and share the others.

    Attributes:
        own: the BRDF with only the leaves that have the texels' axis.
        shared: the BRDF with all the others (a car paint's lobes, color table and flakes).
    """

    own: AbstractBRDF
    shared: AbstractBRDF

    def take(self, part: np.ndarray) -> "Texels":
        """Some of the texels."""
        return Texels(jax.tree.map(lambda leaf: leaf[part], self.own), self.shared)

    def reflect(self, wi: jax.Array, wo: jax.Array) -> jax.Array:
        """f i_z for directions (n, ..., 3), each texel its own."""

        def single(own: AbstractBRDF, wi: jax.Array, wo: jax.Array) -> jax.Array:
            return eqx.combine(own, self.shared).evaluate(wi, wo) * wi[..., 2:]

        return eqx.filter_vmap(single)(self.own, wi, wo)


def _texels(material: AxfMaterial, uv: np.ndarray) -> Texels:
    """The BRDFs at texture coordinates; of a car paint only the coat's normal belongs to the texel."""
    model = to_brdf(material, uv=uv)
    if material.kind is MaterialKind.SVBRDF:
        return Texels(*eqx.partition(model, eqx.is_array))
    assert isinstance(model, ClearCoat)
    normals = jnp.asarray(gather(material, uv)["clearcoatnormal"])
    model = eqx.tree_at(lambda m: m.normal, model, normals)
    own = eqx.tree_at(lambda m: m.normal, jax.tree.map(lambda leaf: False, model), replace=True)
    return Texels(*eqx.partition(model, own))


def _lobe_frames(material: AxfMaterial, uv: np.ndarray) -> LobeFrames:
    """Normals, rotations and roughness at the texels, in float64."""
    maps = {key: value.astype(np.float64) for key, value in gather(material, uv).items()}
    if material.kind is MaterialKind.CAR_PAINT:
        spreads = np.atleast_1d(material.properties.get("CT_spreads", np.ones(1))).astype(np.float64)
        roughness = np.broadcast_to(spreads[:, None], (len(uv), len(spreads), 2))
        normal, rotation = np.broadcast_to([0.0, 0.0, 1.0], (len(uv), 3)), np.zeros(len(uv))
        ior = np.full(len(uv), float(material.properties.get("IOR", 1.5)))
    else:
        lobe = maps["specularlobe"]
        if material.specular_model in ("BlinnPhong", "Phong"):
            # The map holds log2 of an exponent n; a Gaussian of roughness sqrt(2 / (n + 2)) is about as wide.
            lobe = np.sqrt(2.0 / (np.exp2(lobe) + 2.0))
        roughness = np.broadcast_to(np.maximum(lobe, ROUGHNESS_FLOOR), (len(uv), 2))[:, None]
        normal, rotation = maps["normal"], maps["anisrotation"][..., 0] * material.anisotropic
        ior = maps["clearcoatior"][..., 0]
    bends = material.has_clear_coat and material.coat_refracts
    ior = np.where(bends & (ior > 0) & np.isfinite(ior), ior, 1.5 if bends else 1.0)
    return LobeFrames(normal, rotation, np.minimum(roughness, 1.0), maps["clearcoatnormal"], ior)


def _lights(frames: LobeFrames, wo: np.ndarray, even: np.ndarray, part: np.ndarray) -> jax.Array:
    """Lights (BATCH, views, lights, 3) of a batch of texels."""
    full = np.resize(part, BATCH)
    h = half_vectors(frames.roughness[full], RINGS, SPOKES)
    crowded = lobe_lights(
        *(jnp.asarray(x) for x in (wo[full], h)),
        *(jnp.asarray(x[full]) for x in (frames.normal, frames.rotation, frames.coat_normal, frames.coat_ior)),
    )
    spread = jnp.broadcast_to(jnp.asarray(even), (*crowded.shape[:2], *even.shape))
    return jnp.concatenate([crowded, spread], axis=2)


def _normals(frames: LobeFrames, part: np.ndarray) -> Normals:
    """Base normal, coat normal and index of the texels, from which the strip near a horizon is known."""
    unit = [x / np.linalg.norm(x, axis=-1, keepdims=True) for x in (frames.normal[part], frames.coat_normal[part])]
    return jnp.asarray(unit[0]), jnp.asarray(unit[1]), jnp.asarray(frames.coat_ior[part])


@eqx.filter_jit
def _errors(
    models: tuple[Texels, Texels],
    normals: tuple[Normals, Normals],
    wi: jax.Array,
    wo: jax.Array,
) -> dict[str, jax.Array]:
    """The three errors at every (texel, view, light); 0 where a definition does not look."""
    wo = jnp.broadcast_to(wo[:, :, None], wi.shape)
    f, g = (model.reflect(wi, wo) for model in models)
    high = (wi[..., 2] >= LOWEST) & (wo[..., 2] >= LOWEST)
    clear = high
    for vectors in normals:
        clear = clear & (_lowest_cosine(wi, *vectors) >= LOWEST) & (_lowest_cosine(wo, *vectors) >= LOWEST)
    # The first light is the mirror direction.
    clear = clear & clear[:, :, :1]
    difference = jnp.max(jnp.abs(g - f), axis=-1)
    peak, strip_peak = (jnp.max(jnp.where(m[..., None], f, 0.0), axis=(2, 3), keepdims=True) for m in (clear, high))
    lit = peak > 0
    relevant = lit & (f >= RELEVANT * peak)
    ratio = jnp.abs(jnp.log(jnp.where(relevant & (g > 0), g, 1.0)) - jnp.log(jnp.where(relevant & (g > 0), f, 1.0)))
    ratio = jnp.max(jnp.where(relevant & ~(g > 0), jnp.inf, ratio), axis=-1)
    return {
        "peak_relative": _over_peak(difference, peak, clear),
        "log_ratio": jnp.where(clear, ratio, 0.0),
        "strip": _over_peak(difference, strip_peak, high & ~clear),
    }


def _over_peak(difference: jax.Array, peak: jax.Array, where: jax.Array) -> jax.Array:
    """|f' - f| i_z over the view's peak; 0 elsewhere and where the view sees no light at all."""
    peak = peak[..., 0]
    return jnp.where(where & (peak > 0), difference / jnp.where(peak > 0, peak, 1.0), 0.0)


def _lowest_cosine(v: jax.Array, base: jax.Array, coat: jax.Array, ior: jax.Array) -> jax.Array:
    """The smaller cosine of a direction with the coat's normal, and of what enters with the base's normal."""
    coat = jnp.broadcast_to(coat[:, None, None], v.shape)
    inside = refract(v, coat, jnp.broadcast_to(ior[:, None, None], v.shape[:-1]))
    return jnp.minimum(dot(v, coat), dot(normalize(inside), jnp.broadcast_to(base[:, None, None], v.shape)))
