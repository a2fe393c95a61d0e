"""The same kinds of material in other colors, as the packages need them; each takes the texels along a side."""

from ..axf import AxfMaterial
from .carbon import carbon_twill
from .leathers import leather
from .material import SEED
from .metal import brushed_metal


def nappa_leather(size: int = 64) -> AxfMaterial:
    """Fine navy leather with a Fresnel factor, without a coat."""
    return leather(
        size,
        SEED + 1,
        id="nappa_leather",
        name="Navy nappa leather",
        color=(0.018, 0.040, 0.105),
        depth_mm=0.05,
        fresnel=True,
    )


def seat_leather(size: int = 64) -> AxfMaterial:
    """Stone-gray leather of a seat."""
    return leather(
        size,
        SEED + 2,
        id="seat_leather",
        name="Stone-gray seat leather",
        color=(0.155, 0.138, 0.118),
        depth_mm=0.06,
        fresnel=True,
    )


def brushed_trim(size: int = 64) -> AxfMaterial:
    """Dark brushed trim, its color in the Fresnel factor."""
    return brushed_metal(
        size,
        SEED + 3,
        id="brushed_trim",
        name="Dark brushed trim",
        color=(0.36, 0.36, 0.38),
        roughness=(0.09, 0.30),
        fresnel=True,
    )


def carbon_trim(size: int = 64) -> AxfMaterial:
    """The woven carbon with other fibers."""
    return carbon_twill(size, SEED + 4, id="carbon_trim")


def brushed_titanium(size: int = 64) -> AxfMaterial:
    """Brushed titanium with an anisotropic GGX lobe."""
    return brushed_metal(
        size,
        SEED + 5,
        id="brushed_titanium",
        name="Brushed titanium",
        color=(0.54, 0.50, 0.45),
        roughness=(0.08, 0.26),
        specular_model="GGX",
        fresnel=True,
    )
