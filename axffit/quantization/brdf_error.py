"""How far quantized textures change the BRDF: the largest errors found at sampled texels, by gradient ascent.

Two definitions, each over views and lights at least 1° above the horizon, f the original's value, f' the packed one's:

    (b)  max |f' - f| i_z / max_i (f i_z), the peak taken per view and over the three channels
    (c)  max |log f' - log f| where f i_z >= 1e-3 of that view's peak

Horizon and cosines are those of the original's outermost normal (`local`). Plain relative error over the whole
hemisphere means nothing for Gaussian lobes (far out it reaches any value), and one peak for all views is ill-defined
where f i_z grows without bound at grazing. Reported apart, as the strip, is (b) in what is left: lights and views
nearer to the horizon than 1°, where f jumps to 0 somewhere inside the normal's error; and under a coat directions that
enter within 1° of the base's horizon or below it, and views whose mirror direction does so, which see only a tail.

What is found is a lower bound of the texels' largest error; `material_bounds` is the upper one, of all texels.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..axf import AxfMaterial
from .ascent import ascend
from .colors import ILLUMINANTS, ColorError, color_differences, color_errors, exposed
from .definitions import BATCH, Pairs, errors_at, lights_of, normals_of
from .directions import VIEW_POLAR, even_lights, views
from .expected import UNIFORM, Expected, Lighting, Tally, posed, uniform_irradiance
from .local import local_texels
from .measures import COLORS, has_color_science
from .statistics import finite_or_none
from .tolerances import KINDS

EVEN_LIGHTS = 60
STARTS = 512
"""Ascents for each definition."""

STRIDE = 4
"""Every so many lights are looked at as colors."""


@dataclass(frozen=True)
class Found:
    """The largest error found under one definition, and where.

    Attributes:
        value: the error; infinite where f' is 0 and f is not.
        uv: texture coordinates of the texel.
        wi: direction to the light, in the frame of the texel's outermost normal.
        wo: direction to the viewer, in the same frame.
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
        strip: definition (b) near the horizon, see above.
        colors: dE2000 of the reflected color by illuminant; empty without colour-science.
        expected: expected errors by lighting, the uniform one first.
        texels: texels sampled.
        views: views of each.
        lights: lights of each view.
        ascents: ascents for each of the first two, from the worst of these.
    """

    peak_relative: Found
    log_ratio: Found
    strip: Found
    colors: tuple[ColorError, ...]
    expected: tuple[Expected, ...]
    texels: int
    views: int
    lights: int
    ascents: int

    def placed(self, uv: np.ndarray) -> "BrdfErrors":
        """The same with texture coordinates (n, 2) in place of `tiles.centers` (n)."""
        places = [tuple(float(x) for x in row) for row in uv]
        found = {name: getattr(self, name) for name in (*KINDS, "strip")}
        moved = {name: replace(each, uv=places[int(each.uv[0] * len(uv))]) for name, each in found.items()}
        return replace(self, **moved)


def brdf_errors(
    before: AxfMaterial,
    after: AxfMaterial,
    uv: np.ndarray,
    progress: Callable[[float], None] = lambda fraction: None,
    lightings: Sequence[Lighting] = (),
) -> BrdfErrors:
    """Largest errors found at texture coordinates ``uv`` (n, 2); needs JAX with x64 enabled.

    Negative colors of the original count as 0.

    Args:
        before: the original material.
        after: what the shader sees.
        uv: where; see `samples.sample_texels`.
        progress: called with the part that is done.
        lightings: for the expected errors, beside the uniform one.

    Raises:
        InputError: a model that axffit does not evaluate.
    """
    texels = local_texels(without_negative_colors(before), after, uv)
    wo, even = views(len(uv)), even_lights(EVEN_LIGHTS)
    per_view = max(4, -(-STARTS // (len(uv) * len(VIEW_POLAR))))
    worst: dict[str, Pairs] = {}
    starts: dict[str, list[Pairs]] = {kind: [] for kind in KINDS}
    tallies = [Tally(UNIFORM), *(Tally(lighting.name) for lighting in lightings)]
    differences: dict[str, list[np.ndarray]] = {name: [] for name in ILLUMINANTS if has_color_science()}
    lights = 0
    for start in range(0, len(uv), BATCH):
        part = np.arange(start, min(start + BATCH, len(uv)))
        # Every batch has the same shape, so that one compilation serves all.
        full = np.resize(part, BATCH)
        wi = lights_of(texels.frames, full, wo[full], even)
        lights = wi.shape[2]
        normals, viewers = normals_of(texels.frames, full), jnp.asarray(wo[full])
        sides = texels.before.take(full), texels.after.take(full)
        errors, brightest, seen = errors_at(*sides, normals, wi, viewers)
        f, g, clear = (np.asarray(x)[: len(part)] for x in seen)
        old, new = exposed(f[:, :, ::STRIDE], g[:, :, ::STRIDE], clear[:, :, ::STRIDE])
        for illuminant, found in differences.items():
            found.append(color_differences(old, new, illuminant))
        uniform = uniform_irradiance(texels.frames, full, np.asarray(wi), wo[full])
        tallies[0].add(f, g, uniform[: len(part)])
        for lighting, tally in zip(lightings, tallies[1:], strict=True):
            # As many lights as before, so that nothing is compiled again; those too many are dark.
            turned = np.resize(np.moveaxis(posed(lighting, wo[full], start), 2, 0), (lights, *wo[full].shape))
            _, _, (f, g, _) = errors_at(*sides, normals, jnp.asarray(np.moveaxis(turned, 0, 2)), viewers)
            lit = np.arange(lights)[:, None] < len(lighting.directions)
            irradiance = np.where(lit, np.resize(lighting.irradiance, (lights, 3)), 0.0)
            tally.add(np.asarray(f)[: len(part)], np.asarray(g)[: len(part)], irradiance)
        for name, values in errors.items():
            pairs = _worst(np.asarray(values)[: len(part)], part, np.asarray(wi), wo, np.asarray(brightest), per_view)
            starts.get(name, []).append(pairs)
            worst[name] = Pairs.concatenate([worst[name], pairs]).largest(1) if name in worst else pairs.largest(1)
        progress(0.7 * (part[-1] + 1) / len(uv))
    if all(0 < worst[kind].error[0] < np.inf for kind in KINDS):
        best = {kind: Pairs.concatenate(candidates).largest(STARTS) for kind, candidates in starts.items()}
        worst |= {kind: pairs.largest(1) for kind, pairs in ascend(texels, best, even).items()}
    progress(1.0)
    found = {name: _found(pairs, uv) for name, pairs in worst.items()}
    return BrdfErrors(
        **found,
        colors=color_errors(differences),
        expected=tuple(tally.expected() for tally in tallies),
        texels=len(uv),
        views=len(VIEW_POLAR),
        lights=lights,
        ascents=STARTS,
    )


def _worst(
    errors: np.ndarray, texels: np.ndarray, wi: np.ndarray, wo: np.ndarray, brightest: np.ndarray, per_view: int
) -> Pairs:
    """The lights of the largest errors (n, views, lights) of each view."""
    light = np.argpartition(-errors, per_view, axis=-1)[..., :per_view]
    texel, view, _ = np.indices(light.shape)
    texel, view, light = texel.reshape(-1), view.reshape(-1), light.reshape(-1)
    values = errors[texel, view, light]
    return Pairs(texels[texel], wi[texel, view, light], wo[texels[texel], view], brightest[texel, view], values)


def _found(pairs: Pairs, uv: np.ndarray) -> Found:
    place, wi, wo = (tuple(float(x) for x in row) for row in (uv[pairs.texel[0]], pairs.wi[0], pairs.wo[0]))
    return Found(float(pairs.error[0]), place, wi, wo)  # pyright: ignore[reportArgumentType]


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
