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
from .carbon import brushed_carbon
from .carpaint import metallic_paint, paint_model, relative_noise

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


def _material(make: Callable[[int], axf.AxfMaterial]) -> Callable[[Path, int], Iterator[Path]]:
    """A package that is one .axf file of one material."""

    def write(folder: Path, size: int) -> Iterator[Path]:
        path = folder / f"{folder.name}.axf"
        # A measured material of this kind would come from AxF 1.2 on, which has both representations.
        axf.write(path, axf.AxfFile((make(size),), version=(1, 2, 0)))
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


PACKAGES: Mapping[str, Package] = {
    package.name: package
    for package in (
        Package(
            "brushed_carbon",
            "anisotropic Ward SVBRDF: carbon-fiber weave with a brushed steel inlay under clear coat",
            _material(brushed_carbon),
        ),
        Package(
            "metallic_paint",
            "coated car paint: three lobes, color table, flakes with all mip levels",
            _material(metallic_paint),
        ),
        Package(
            "noisy_car_paint",
            "metallic_paint without its flakes, sampled with 1 % noise, and the true parameters",
            _noisy_car_paint,
        ),
    )
}
"""Packages by name."""
