"""A clear coat over any base (AxF >= 1.1; without refraction >= 1.3)."""

from typing import Literal

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Angles, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import (
    dielectric_reflectance,
    dielectric_transmittance,
    schlick_reflectance,
    schlick_transmittance,
)
from axffit.brdf.geometry import half_geometry
from axffit.brdf.ggx import GGX
from axffit.brdf.sampling import DOWN, Uniforms, choose, shares
from axffit.frames import NORMAL, dot, reflect, refract, tangent_frame, to_local, to_world
from axffit.numerics import floor_cosine, normalize, safe_sqrt

CoatFresnel = Literal["exact", "schlick"]


class ClearCoat(AbstractBRDF):
    """A perfectly transparent, infinitely thin dielectric layer over ``base``.

        f(i, o) = f_c(i, o) + (1 - F(i)) f_b(i*, o*) (1 - F(o))

    F is taken at the cosine with the coat's ``normal``. With ``refracting``, i* and o* are the refracted directions and
    every angle of the base is taken after refraction, without a 1/n² radiance factor; otherwise i* = i, o* = o.
    Reflection inside the layer is not modelled: AxF's own fits put it into the base. f_c is a mirror, 0 for almost all
    pairs of directions; renderers take it from :meth:`mirror`. With ``mirror_roughness`` it is a narrow
    GGX lobe instead (Weidlich & Wilkie 2007 for the layering; AxF SDK for the rest).

    Attributes:
        base: what lies below the coat.
        ior: index of refraction n > 0, (). At 1, with the exact Fresnel, the coat vanishes.
        normal: the coat's normal (3,) in the surface's frame; need not have unit length.
        color: linear RGB factor (3,) of the coat's own reflection f_c.
        mirror_roughness: roughness () of f_c as a GGX lobe, or None for the mirror.
        refracting: whether directions bend at the coat (AxF: ``cc_no_refraction`` absent or 0).
        fresnel: ``"exact"`` or ``"schlick"`` with F0 = ((n-1)/(n+1))².
    """

    base: AbstractBRDF
    ior: Scalar = eqx.field(converter=as_parameter)
    normal: Direction = eqx.field(converter=as_parameter, default=NORMAL)
    color: RGB = eqx.field(converter=as_parameter, default=(1.0, 1.0, 1.0))
    mirror_roughness: Scalar | None = eqx.field(
        converter=lambda value: None if value is None else as_parameter(value), default=None
    )
    refracting: bool = eqx.field(static=True, default=True, kw_only=True)
    fresnel: CoatFresnel = eqx.field(static=True, default="exact", kw_only=True)

    def __check_init__(self):
        if self.fresnel not in ("exact", "schlick"):
            raise ValueError(f"ClearCoat fresnel={self.fresnel!r}: use 'exact' or 'schlick'")

    def reflectance(self, cosine: Angles) -> Angles:
        """Fresnel reflectance F of the coat at a cosine > 0 with its normal."""
        form = dielectric_reflectance if self.fresnel == "exact" else schlick_reflectance
        return form(floor_cosine(cosine), jnp.broadcast_to(self.ior, cosine.shape))

    def transmittance(self, cosine: Angles) -> Angles:
        """1 - F of :meth:`reflectance`, with all its digits at grazing angles."""
        form = dielectric_transmittance if self.fresnel == "exact" else schlick_transmittance
        return form(floor_cosine(cosine), jnp.broadcast_to(self.ior, cosine.shape))

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The layered value; 0 where a direction is below the coat's or the base's normal."""
        normal = normalize(self.normal)
        cos_i, cos_o = dot(wi, normal), dot(wo, normal)
        visible = (cos_i > 0) & (cos_o > 0)
        wi, wo = jnp.where(visible, wi, normal), jnp.where(visible, wo, normal)
        cos_i, cos_o = jnp.where(visible, cos_i, 1.0), jnp.where(visible, cos_o, 1.0)
        inside = (refract(wi, normal, self.ior), refract(wo, normal, self.ior)) if self.refracting else (wi, wo)
        transmitted = self.transmittance(cos_i) * self.transmittance(cos_o)
        value = transmitted * self.base.masked_value(*inside)
        if self.mirror_roughness is not None:
            value = value + self._mirror_value(wi, wo, self.mirror_roughness)
        return jnp.where(visible, value, jnp.zeros_like(value))

    def mirror(self, wo: Direction) -> tuple[Direction, RGB]:
        """The mirror direction of ``wo`` (above the coat's normal), and the share of its light that the coat reflects.

        The part of the coat that :meth:`evaluate` and :meth:`sample` leave out unless ``mirror_roughness`` is given:
        L_o gains weight · L_i(mirror direction).
        """
        normal = normalize(self.normal)
        return reflect(wo, normal), self.color * self.reflectance(dot(wo, normal))

    def _mirror_lobe(self, cos_d: Scalar, roughness: Scalar) -> GGX:
        """f_c as a GGX lobe in the frame of the coat's normal, its Fresnel factor taken at ``cos_d``."""
        return GGX(self.color * self.reflectance(cos_d), roughness, normalization="microfacet")

    def _mirror_value(self, wi: Direction, wo: Direction, roughness: Scalar) -> RGB:
        frame = tangent_frame(self.normal)
        wi, wo = to_local(frame, wi), to_local(frame, wo)
        return self._mirror_lobe(half_geometry(wi, wo).cos_d, roughness).masked_value(wi, wo)

    def _shares(self, wo: Direction, inside: Direction, cosine: Scalar) -> Float[Array, "2"]:
        """Shares of the base and of the mirror lobe in the draws."""
        mirror = self.reflectance(cosine) * jnp.mean(self.color)
        return shares(jnp.stack([self.transmittance(cosine) * self.base.weight(inside), mirror]))

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """A draw of the base below the coat, or of the mirror lobe."""
        normal, down = normalize(self.normal), jnp.asarray(DOWN, wo.dtype)
        visible = dot(wo, normal) > 0
        wo = jnp.where(visible, wo, normal)
        inside = refract(wo, normal, self.ior) if self.refracting else wo
        if self.mirror_roughness is None:
            wi = self._leave(self.base.masked_draw(inside, u), normal)
        else:
            frame = tangent_frame(self.normal)
            index, u = choose(u, self._shares(wo, inside, dot(wo, normal)))
            local = self._mirror_lobe(wo[2], self.mirror_roughness).masked_draw(to_local(frame, wo), u)
            lobe = jnp.where(local[2] > 0, to_world(frame, local), down)
            wi = jnp.where(index == 0, self._leave(self.base.masked_draw(inside, u), normal), lobe)
        return jnp.where(visible, wi, down)

    def _leave(self, inside: Direction, normal: Direction) -> Direction:
        """Refracted out of the coat; ``DOWN`` where that is impossible."""
        if not self.refracting:
            return jnp.where(dot(inside, normal) > 0, inside, jnp.asarray(DOWN, inside.dtype))
        cosine = dot(inside, normal)
        tangential = (inside - cosine * normal) * self.ior
        square = 1.0 - jnp.sum(tangential * tangential)
        leaves = (square > 0) & (cosine > 0) & (inside[2] > 0)
        return jnp.where(leaves, tangential + safe_sqrt(square) * normal, jnp.asarray(DOWN, inside.dtype))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Density of the draws: below the coat times d omega* / d omega = cos_i / (n² cos_i*), plus the mirror lobe."""
        normal = normalize(self.normal)
        visible = (dot(wi, normal) > 0) & (dot(wo, normal) > 0)
        wi, wo = jnp.where(visible, wi, normal), jnp.where(visible, wo, normal)
        inside_i, inside_o, squeeze = wi, wo, jnp.ones_like(wi[0])
        if self.refracting:
            inside_i, inside_o = refract(wi, normal, self.ior), refract(wo, normal, self.ior)
            squeeze = dot(wi, normal) / (self.ior * self.ior * floor_cosine(dot(inside_i, normal)))
        value = squeeze * self.base.masked_density(inside_i, inside_o)
        if self.mirror_roughness is not None:
            frame, share = tangent_frame(self.normal), self._shares(wo, inside_o, dot(wo, normal))
            lobe = self._mirror_lobe(wo[2], self.mirror_roughness)
            value = share[0] * value + share[1] * lobe.masked_density(to_local(frame, wi), to_local(frame, wo))
        return jnp.where(visible, value, jnp.zeros_like(value))

    def weight(self, wo: Direction) -> Scalar:
        """What the base sends through the coat, plus the mirror lobe."""
        normal = normalize(self.normal)
        visible = dot(wo, normal) > 0
        wo = jnp.where(visible, wo, normal)
        cosine = dot(wo, normal)
        inside = refract(wo, normal, self.ior) if self.refracting else wo
        weight = self.transmittance(cosine) * self.base.weight(inside)
        if self.mirror_roughness is not None:
            weight = weight + self.reflectance(cosine) * jnp.mean(self.color)
        return jnp.where(visible, weight, 0.0)
