"""What a material is made of, as far as a bound must know it: its models by class, and a car paint's values."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...brdf import AbstractBRDF, AbstractFresnel, NoFresnel

Coat = Literal["refracting", "straight"]
"""A clear coat whose directions bend at it, or do not (AxF's ``cc_no_refraction``)."""


class NoBound(ValueError):
    """No bound is proved for this form or class; the message says what is not covered."""


@dataclass(frozen=True, eq=False)
class Paint:
    """A car paint's base in one channel (`brdf.CarPaint` without flakes).

    Attributes:
        diffuse: AxF ``CT_diffuse``.
        coefficients: AxF ``CT_coeffs`` (K,).
        f0: AxF ``CT_F0s`` (K,).
        spreads: AxF ``CT_spreads`` (K,).
        colors: the channel of the color table before (H, W), >= 0, texel centers as in `brdf.ColorTable`.
        colors_after: the same after quantization (H, W).
        channels: all channels of the table before (H, W, C): views are compared with the brightest.
    """

    diffuse: float
    coefficients: tuple[float, ...]
    f0: tuple[float, ...]
    spreads: tuple[float, ...]
    colors: np.ndarray
    colors_after: np.ndarray
    channels: np.ndarray


@dataclass(frozen=True)
class Form:
    """The models of a material; the numbers are in the `TexelClass`.

    An SVBRDF is ``coat(diffuse + specular)``, a car paint ``coat(paint)``; what is None is absent.

    Attributes:
        diffuse: `Lambert`, or `OrenNayar1994` as AxF's materials use it (facets of pi/4 with interreflection).
        specular: a lobe of `axffit.brdf`.
        fresnel: the lobe's Fresnel factor.
        coat: the clear coat, exact dielectric Fresnel, mirror reflection left out.
        paint: the base of a car paint, in place of diffuse and specular.

    Raises:
        ValueError: neither or both of an SVBRDF's base and a car paint's are given.
    """

    diffuse: type[AbstractBRDF] | None = None
    specular: type[AbstractBRDF] | None = None
    fresnel: type[AbstractFresnel] = NoFresnel
    coat: Coat | None = None
    paint: Paint | None = None

    def __post_init__(self):
        has_base = self.diffuse is not None or self.specular is not None
        if has_base == (self.paint is not None):
            raise ValueError("a form reflects by diffuse and specular models or by a paint: give one of the two")
