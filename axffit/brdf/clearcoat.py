"""A clear coat over any base (AxF >= 1.1; without refraction >= 1.3)."""

from typing import Literal

import equinox as eqx
import jax.numpy as jnp

from axffit._types import RGB, Angles, Direction, Scalar
from axffit.brdf.base import AbstractBRDF, as_parameter
from axffit.brdf.fresnel import dielectric_reflectance, schlick_reflectance
from axffit.brdf.geometry import half_geometry
from axffit.brdf.ggx import GGX
from axffit.frames import NORMAL, dot, refract, tangent_frame, to_local
from axffit.numerics import floor_cosine, normalize

CoatFresnel = Literal["exact", "schlick"]


class ClearCoat(AbstractBRDF):
    """A perfectly transparent, infinitely thin dielectric layer over ``base``.

        f(i, o) = f_c(i, o) + (1 - F(i)) f_b(i*, o*) (1 - F(o))

    F is taken at the cosine with the coat's ``normal``. With ``refracting``, i* and o* are the refracted directions and
    every angle of the base is taken after refraction, without a 1/n² radiance factor; otherwise i* = i, o* = o.
    Reflection inside the layer is not modelled: AxF's own fits put it into the base. f_c is a mirror, 0 for almost all
    pairs of directions; renderers take its weight from :meth:`reflectance`. With ``mirror_roughness`` it is a narrow
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

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The layered value; 0 where a direction is below the coat's or the base's normal."""
        normal = normalize(self.normal)
        cos_i, cos_o = dot(wi, normal), dot(wo, normal)
        visible = (cos_i > 0) & (cos_o > 0)
        wi, wo = jnp.where(visible, wi, normal), jnp.where(visible, wo, normal)
        cos_i, cos_o = jnp.where(visible, cos_i, 1.0), jnp.where(visible, cos_o, 1.0)
        inside = (refract(wi, normal, self.ior), refract(wo, normal, self.ior)) if self.refracting else (wi, wo)
        transmitted = (1.0 - self.reflectance(cos_i)) * (1.0 - self.reflectance(cos_o))
        value = transmitted * self.base.masked_value(*inside)
        if self.mirror_roughness is not None:
            value = value + self._mirror(wi, wo, self.mirror_roughness)
        return jnp.where(visible, value, jnp.zeros_like(value))

    def _mirror(self, wi: Direction, wo: Direction, roughness: Scalar) -> RGB:
        """f_c as a GGX lobe about the coat's normal."""
        frame = tangent_frame(self.normal)
        wi, wo = to_local(frame, wi), to_local(frame, wo)
        fresnel = self.reflectance(half_geometry(wi, wo).cos_d)
        return GGX(self.color * fresnel, roughness, normalization="microfacet").masked_value(wi, wo)
