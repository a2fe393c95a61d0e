"""What the specular lobes share: f = s F · density, roughness along two axes, the normalization constant."""

from typing import Literal

import jax.numpy as jnp
from jaxtyping import Array, Float

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.fresnel import AbstractFresnel
from axffit.brdf.geometry import HalfGeometry

Normalization = Literal["sdk", "microfacet"]
"""``"sdk"``: Cook-Torrance and GGX as the AxF SDK documents them, without the microfacet 1/4 (directional albedo
tends to 4); ``"microfacet"``: with it. Converting changes the specular color by 4 and nothing else."""

PerAxis = Float[Array, ""] | Float[Array, "2"]
"""Shape (): isotropic; (2,): along the lobe's x and y axes."""


def lobe_value(specular_color: RGB, fresnel: AbstractFresnel, half: HalfGeometry, density: Scalar) -> RGB:
    """Value of a lobe, s F(<h,o>) · density: every lobe is a color, a Fresnel factor and a scalar shape (1/sr)."""
    return specular_color * (density * fresnel.factor(half.cos_d, half.one_minus_cos_d))


def alpha_xy(roughness: PerAxis) -> tuple[Scalar, Scalar]:
    """PerAxis along x and along y."""
    return (roughness, roughness) if roughness.ndim == 0 else (roughness[0], roughness[1])


def normalization_factor(normalization: Normalization) -> float:
    """1 for ``"sdk"``, 1/4 for ``"microfacet"``."""
    return {"sdk": 1.0, "microfacet": 0.25}[normalization]


def check_normalization(normalization: str) -> None:
    """Raise ``ValueError`` unless ``normalization`` is known."""
    if normalization not in ("sdk", "microfacet"):
        raise ValueError(f"normalization={normalization!r}: use 'sdk' (as AxF documents its lobes) or 'microfacet'")


def lobe_weight(specular_color: RGB, fresnel: AbstractFresnel, wo: Direction) -> Scalar:
    """Mean over the channels of s F at the mirror direction, where <h, o> = o_z."""
    return jnp.mean(specular_color * fresnel.factor(wo[2], 1.0 - wo[2]))
