"""Small pictures, and few texels on request: drawing and measuring well are tested beside report and quantization."""

import sys

import pytest

from axffit.quantization.material_bounds import MaterialBounds
from axffit.report import pictures

SPHERE_SIZE = 24


@pytest.fixture(autouse=True)
def small_spheres(monkeypatch):
    """Pictures of few pixels, whoever asks for them."""
    spheres, material_pictures = pictures.spheres, pictures.material_pictures
    monkeypatch.setattr(pictures, "spheres", lambda brdf, *, size: spheres(brdf, size=min(size, SPHERE_SIZE)))
    monkeypatch.setattr(
        pictures,
        "material_pictures",
        lambda before, after, *, size: material_pictures(before, after, size=min(size, SPHERE_SIZE)),
    )


@pytest.fixture
def few_texels(monkeypatch):
    """The reflectance at four texels and without a bound: for tests of what lies around it."""
    module = sys.modules["axffit.quantization.verify"]
    monkeypatch.setattr(module, "material_bounds", lambda *_: MaterialBounds((), 0, "left out by a test"))
    texels = module.TEXELS
    for kind in texels:
        monkeypatch.setitem(texels, kind, 4)
