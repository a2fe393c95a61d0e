"""A form's models in JAX, before and after quantization, for the search: compiled once for all of a kind."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ... import brdf
from ...frames import dot, refract, spherical_to_direction
from ...numerics import normalize
from .form import Form
from .texel_class import TexelClass

Numbers = Mapping[str, jax.Array]
"""A texel's parameters by `TexelClass`'s names, and the arrays of a paint."""

BEFORE = ("roughness", "roughness_y", "f0", "specular", "diffuse", "gap", "gap_azimuth", "ior")
ERRORS = ("roughness_ratio", "roughness_y_ratio", "f0_change", "specular_ratio", "diffuse_ratio", "ior_change")


@dataclass(frozen=True)
class Kindred:
    """What compiled code depends on: everything of a form that is not a number, and which numbers have ranges."""

    diffuse: type[brdf.AbstractBRDF] | None
    specular: type[brdf.AbstractBRDF] | None
    fresnel: type[brdf.AbstractFresnel]
    coat: str | None
    paint: bool
    isotropic: bool
    exponents: bool
    turning: bool

    def model(self, at: Numbers, errors: Numbers | None = None) -> brdf.AbstractBRDF:
        """The BRDF of a texel in the base's frame before; with errors, after.

        ``errors`` holds `ERRORS`, the angles tilt, twist and coat_tilt, and the azimuths of the two tilts.
        """
        get, base_normal, twist = dict(at), jnp.asarray([0.0, 0.0, 1.0]), jnp.zeros(())
        coat_normal = spherical_to_direction(at["gap"], at["gap_azimuth"])
        if errors is not None:
            for name in ("roughness", "roughness_y", "specular", "diffuse"):
                get[name] = at[name] * errors[f"{name}_ratio"]
            for name in ("f0", "ior"):
                get[name] = at[name] + errors[f"{name}_change"]
            if self.paint:
                get["colors"] = at["colors_after"]
            base_normal = spherical_to_direction(errors["tilt"], errors["tilt_azimuth"])
            twist = errors["twist"]
            first, second = self.axes(at)
            c, s = jnp.cos(errors["coat_azimuth"]), jnp.sin(errors["coat_azimuth"])
            away = jnp.sin(errors["coat_tilt"]) * (c * first + s * second)
            coat_normal = jnp.cos(errors["coat_tilt"]) * coat_normal + away
        base = brdf.Framed(self._base(get), base_normal, twist)
        if self.coat is None:
            return base
        return brdf.ClearCoat(base, get["ior"], coat_normal, refracting=self.coat == "refracting")

    def brightest(self, at: Numbers) -> brdf.AbstractBRDF:
        """The BRDF that views peak by: before, and of a paint all its channels."""
        return self.model({**at, "colors": at["channels"]} if self.paint else at)

    def _base(self, get: Numbers) -> brdf.AbstractBRDF:
        ones = jnp.ones(3)
        if self.paint:
            table = brdf.ColorTable(get["colors"])
            return brdf.CarPaint(get["paint_diffuse"], get["coefficients"], get["f0s"], get["spreads"], table)
        terms: list[brdf.AbstractBRDF] = []
        if self.diffuse is brdf.OrenNayar1994:
            terms.append(brdf.OrenNayar1994(get["diffuse"] * ones, np.pi / 4, interreflection=True))
        elif self.diffuse is not None:
            terms.append(_make(self.diffuse, get["diffuse"] * ones))
        if self.specular is not None:
            lobe = get["roughness"] if self.isotropic else jnp.stack([get["roughness"], get["roughness_y"]])
            fresnel = brdf.NoFresnel() if self.fresnel is brdf.NoFresnel else _make(self.fresnel, get["f0"])
            terms.append(_make(self.specular, get["specular"] * ones, lobe, fresnel))
        return brdf.Sum(tuple(terms))

    def width(self, at: Numbers) -> tuple[jax.Array, jax.Array]:
        """Reference roughness along x and y, as in `terms`."""
        if self.paint:
            least = jnp.min(at["spreads"])
            return least, least
        if self.specular is None:
            return jnp.ones(()), jnp.ones(())
        x = at["roughness"]
        y = x if self.isotropic else at["roughness_y"]
        return (
            (jnp.sqrt(2.0 / jnp.maximum(x, 2.0**-6)), jnp.sqrt(2.0 / jnp.maximum(y, 2.0**-6)))
            if self.exponents
            else (x, y)
        )

    def normal(self, at: Numbers) -> jax.Array:
        """The outermost normal."""
        if self.coat is None:
            return jnp.asarray([0.0, 0.0, 1.0])
        return spherical_to_direction(at["gap"], at["gap_azimuth"])

    def axes(self, at: Numbers) -> tuple[jax.Array, jax.Array]:
        """Two axes across the coat's normal, the base's tilted without a twist; azimuths count from the first."""
        normal = self.normal(at)
        x, y, z = jnp.eye(3)
        towards = (normal + z) / (1.0 + normal[2])
        return x - normal[0] * towards, y - normal[1] * towards

    def inwards(self, at: Numbers, w: jax.Array) -> jax.Array:
        """A direction below the coat."""
        return normalize(refract(w, self.normal(at), at["ior"])) if self.coat == "refracting" else w

    def outwards(self, at: Numbers, w: jax.Array) -> tuple[jax.Array, jax.Array]:
        """A direction outside, and its cosine with the outermost normal; -1 where it does not leave."""
        normal = self.normal(at)
        below = dot(w, normal)
        if self.coat != "refracting":
            return w, below
        n = at["ior"]
        square = 1.0 - n * n * (1.0 - below * below)
        leaves = (square > 0) & (below > 0)
        cosine = jnp.sqrt(jnp.where(leaves, square, 1.0))
        outside = normalize(n * w - (n * below - cosine) * normal)
        return jnp.where(leaves, outside, normal), jnp.where(leaves, cosine, -1.0)

    def lowest(self, at: Numbers, wi: jax.Array, wo: jax.Array) -> jax.Array:
        """The smallest cosine of the domain, of directions below the coat: outside, at the base, of the mirror."""
        mirror = wo * jnp.array([-1.0, -1.0, 1.0])
        outside = [self.outwards(at, w)[1] for w in (wi, wo, mirror)]
        return jnp.min(jnp.stack([*outside, wi[2], wo[2]]))

    def radiance(self, model: brdf.AbstractBRDF, at: Numbers, wi: jax.Array, wo: jax.Array) -> jax.Array:
        """f i_z of directions outside, of the brightest channel."""
        return jnp.max(model.masked_value(wi, wo)) * dot(wi, self.normal(at))


def _make(kind: Callable[..., Any], *arguments: Any) -> Any:
    """An instance; the classes share no signature."""
    return kind(*arguments)


def _gray(table: np.ndarray) -> np.ndarray:
    return np.repeat(table[..., None], 3, axis=-1)


def kindred(form: Form, *, isotropic: bool, exponents: bool, turning: bool) -> Kindred:
    """The part of a form that code is compiled for."""
    paint = form.paint is not None
    return Kindred(form.diffuse, form.specular, form.fresnel, form.coat, paint, isotropic, exponents, turning)


def numbers(form: Form, texels: TexelClass, ranges: Mapping[str, tuple[float, float]]) -> tuple[dict, dict]:
    """Middles of the parameters with a paint's arrays; and lows and highs of all that may vary, as arrays.

    Returns:
        Parameters for the peaks; ranges of `BEFORE`, `ERRORS` and of tilt, twist and coat_tilt.
    """
    given = {name: ranges.get(name, (1.0, 1.0)) for name in BEFORE}
    given |= {name: getattr(texels, name) for name in ERRORS}
    at = {name: jnp.float64(0.5 * sum(given[name])) for name in BEFORE}
    if form.paint is not None:
        paint = form.paint
        arrays = {"paint_diffuse": paint.diffuse, "coefficients": paint.coefficients, "f0s": paint.f0}
        arrays |= {"spreads": paint.spreads, "channels": paint.channels}
        arrays |= {name: _gray(getattr(paint, name)) for name in ("colors", "colors_after")}
        at |= {name: jnp.asarray(value, jnp.float64) for name, value in arrays.items()}
    given |= {"tilt": (texels.tilt,) * 2, "twist": (-texels.twist, texels.twist), "coat_tilt": (texels.coat_tilt,) * 2}
    return at, {name: jnp.asarray(pair, jnp.float64) for name, pair in given.items()}
