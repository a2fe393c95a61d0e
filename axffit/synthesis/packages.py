"""The named synthetic packages and the generator that writes them."""

import json
import os
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from .. import axf
from ..errors import InputError
from ..measured import mbsdf
from . import carpaint
from .carbon import brushed_carbon, carbon_twill
from .carpaint import metallic_paint, paint_model, relative_noise
from .fabrics import lace
from .leathers import leather, patent_leather, perforated_leather
from .metal import brushed_metal, hammered_copper, turned_brass
from .paints import pearlescent, ruby_metallic, silver_metallic, solid_yellow
from .variants import brushed_titanium, brushed_trim, carbon_trim, nappa_leather, seat_leather
from .wood import lacquered_walnut

Maker = Callable[[int], axf.AxfMaterial]
"""A material from the texels along each side of its maps."""

SIZES = (64, 512)
"""Sizes in texels that are made: 64 is committed, 512 is made when it is wanted."""

NOISE_LEVEL = 0.01
"""Relative standard deviation of the noise of the sampled paint."""

_NOISE_SEED = 20180608
_THETA_COUNT, _AZIMUTH_COUNT = 24, 48


@dataclass(frozen=True)
class Package:
    """One folder of synthetic files.

    Attributes:
        name: of the folder.
        description: what is in it, one line.
        write: writes its files into a folder, given the size in texels, and yields their paths.
    """

    name: str
    description: str
    write: Callable[[Path, int], Iterator[Path]]


def generate(folder: str | os.PathLike, *, size: int = 64, packages: Collection[str] | None = None) -> tuple[Path, ...]:
    """Write synthetic packages, the same bits for the same size every time.

    Args:
        folder: where to; each package gets a folder of its own below it.
        size: 64 or 512 texels along each side of the maps.
        packages: names of `PACKAGES`; None takes all.

    Returns:
        The files written.

    Raises:
        InputError: the size or a name is unknown.
    """
    if size not in SIZES:
        raise InputError(f"size {size}; allowed: {', '.join(map(str, SIZES))}")
    names = tuple(PACKAGES) if packages is None else tuple(packages)
    for name in names:
        if name not in PACKAGES:
            raise InputError(f"unknown package {name!r}; allowed: {', '.join(PACKAGES)}")
    written: list[Path] = []
    for name in names:
        target = Path(folder) / name
        target.mkdir(parents=True, exist_ok=True)
        written.extend(PACKAGES[name].write(target, size))
    return tuple(written)


def _folder(version: tuple[int, int, int], *makers: Maker) -> Callable[[Path, int], Iterator[Path]]:
    """A package of one file a material, each named as its material."""

    def write(folder: Path, size: int) -> Iterator[Path]:
        for make in makers:
            material = make(size)
            path = folder / f"{material.id}.axf"
            axf.write(path, axf.AxfFile((material,), version=version))
            yield path

    return write


def _one_file(version: tuple[int, int, int], *makers: Maker) -> Callable[[Path, int], Iterator[Path]]:
    """A package of one file that is named as the package and holds several materials."""

    def write(folder: Path, size: int) -> Iterator[Path]:
        path = folder / f"{folder.name}.axf"
        axf.write(path, axf.AxfFile(tuple(make(size) for make in makers), version=version))
        yield path

    return write


def _noisy_car_paint(folder: Path, _: int) -> Iterator[Path]:
    """Noisy samples of the metallic paint on the grid of an .mbsdf file, and the truth beside them."""
    with jax.enable_x64(new_val=True):
        model = paint_model(metallic_paint(SIZES[0]))
        wi, wo, _weights = mbsdf.grid_directions(_THETA_COUNT, _AZIMUTH_COUNT)
        values = np.asarray(model.evaluate(jnp.asarray(wi), jnp.asarray(wo)))
    noisy = relative_noise(values, NOISE_LEVEL, _NOISE_SEED)
    path = folder / "noisy_car_paint.mbsdf"
    mbsdf.write_table(path, noisy.reshape(_THETA_COUNT, _THETA_COUNT, _AZIMUTH_COUNT, 3))
    yield path
    truth = folder / "truth.json"
    truth.write_text(json.dumps(_truth(), indent=1) + "\n", encoding="utf-8")
    yield truth


def _truth() -> dict[str, object]:
    """What the noisy samples were made from."""
    return {
        "synthetic": "yes: made by axffit's seeded generator, not measured",
        "model": "carpaint+coat",
        "CT_diffuse": carpaint.DIFFUSE,
        "CT_coeffs": carpaint.COEFFICIENTS,
        "CT_F0s": carpaint.F0S,
        "CT_spreads": carpaint.SPREADS,
        "IOR": carpaint.IOR,
        "cc_no_refraction": 0,
        "coat_fresnel": "exact",
        "brdfcolors": "those of metallic_paint/metallic_paint.axf, texel centers at (k + 1/2) / 64",
        "noise": {"kind": "independent Gaussian, relative to the value", "level": NOISE_LEVEL, "seed": _NOISE_SEED},
    }


_1_0, _1_1, _1_2, _1_3, _1_4, _1_5 = ((1, minor, 0) for minor in range(6))

PACKAGES: Mapping[str, Package] = {
    package.name: package
    for package in (
        Package(
            "brushed_carbon",
            "anisotropic Ward SVBRDF: carbon-fiber weave with a brushed steel inlay under clear coat",
            # AxF 1.2 is the first to have both representations.
            _folder(_1_2, brushed_carbon),
        ),
        Package(
            "metallic_paint",
            "coated car paint: three lobes, color table, flakes with all mip levels",
            _folder(_1_2, metallic_paint),
        ),
        Package(
            "noisy_car_paint",
            "metallic_paint without its flakes, sampled with 1 % noise, and the true parameters",
            _noisy_car_paint,
        ),
        Package(
            "AxFSvbrdf_1_0_Dir",
            "AxF 1.0: Lambert and Ward without a Fresnel factor or a coat; leather, brushed aluminum",
            _folder(_1_0, leather, brushed_metal),
        ),
        Package(
            "AxFSvbrdf_1_1_Dir",
            "AxF 1.1: Fresnel factor and refracting coat; woven carbon, walnut, uncoated leather",
            _folder(_1_1, carbon_twill, lacquered_walnut, nappa_leather),
        ),
        Package(
            "AxFSvbrdfNoRefract_1_3_Dir",
            "AxF 1.3: a coat that does not refract; patent leather, engine-turned brass",
            _folder(_1_3, patent_leather, turned_brass),
        ),
        Package(
            "Volkswagen",
            "three SVBRDF (seat, trim, woven carbon) and a car paint in one file",
            _one_file(_1_2, seat_leather, brushed_trim, carbon_trim, ruby_metallic),
        ),
        Package(
            "AxFCarPaintRefract_1_2_Dir",
            "car paints under a refracting coat: silver metallic, solid yellow, pearlescent",
            _folder(_1_2, silver_metallic, solid_yellow, pearlescent),
        ),
        Package(
            "AxFSvbrdf_1_4",
            "AxF 1.4: opacity and height; lace, perforated leather",
            _folder(_1_4, lace, perforated_leather),
        ),
        Package(
            "AxFSvbrdf_1_5",
            "AxF 1.5: GGX, isotropic with a height and anisotropic; hammered copper, brushed titanium",
            _folder(_1_5, hammered_copper, brushed_titanium),
        ),
    )
}
"""Packages by name."""
