"""AxF materials: any that a file may hold, and those that can be evaluated."""

import string
from typing import Any

import numpy as np
from hypothesis import strategies as st

from axffit.axf import AxfFile, AxfMaterial, MaterialKind
from axffit.axf.names import DIFFUSE_MODELS, FRESNEL_VARIANTS, SPECULAR_MODELS, SPECULAR_VARIANTS, TEXTURES
from axffit.testing.strategies.textures import textures
from axffit.testing.strategies.values import Draw, built, composite

_NAMES = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=12)
_IDS = _NAMES | st.sampled_from([".", "..", "a/b", "100%", "../x"])

_ISOTROPIC = ("Blinn1977", "VRay", "Lewis1993")
"""Variants that take one exponent only, as Phong does."""

_LARGEST_LOGARITHM = 17.0
"""Of an exponent: 2^17 is a little above 1e5."""


def _floats(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(float(np.float32(low)), high, width=32)


def _lobes(*, least: int) -> st.SearchStrategy[dict[str, list[float]]]:
    ranges = {"CT_coeffs": (0, 100), "CT_F0s": (0, 1), "CT_spreads": (1.1e-4, 10)}
    lobes = st.lists(st.tuples(*(_floats(*ends) for ends in ranges.values())), min_size=least, max_size=4)
    return lobes.map(lambda rows: {name: [row[k] for row in rows] for k, name in enumerate(ranges) if rows})


def _make(arguments: dict[str, Any]) -> AxfMaterial:
    return built(lambda: AxfMaterial(**arguments))


@composite
def _any_properties(draw: Draw) -> dict[str, Any]:
    found: dict[str, Any] = draw(_lobes(least=0))
    optional = {
        "CT_diffuse": _floats(0, 1),
        "IOR": _floats(1e-3, 10),
        "num_thetaF": st.integers(1, 64),
        "num_thetaI": st.integers(1, 64),
        "cc_no_refraction": st.integers(-(2**31), 2**31 - 1),
        "thetaFI_sliceLUT": st.lists(st.integers(1, 255), min_size=1, max_size=20).map(sorted),
    }
    for name, strategy in optional.items():
        value = draw(st.none() | strategy)
        if value is not None:
            found[name] = value
    return found


def axf_materials(*, id: str | None = None) -> st.SearchStrategy[AxfMaterial]:
    """Any material a valid file may hold, whether it makes sense or not: textures, properties, names of all sorts."""

    @composite
    def material(draw: Draw) -> AxfMaterial:
        keys = draw(st.sets(st.sampled_from(sorted(set(TEXTURES) - {"btfflakes"}))))
        found = {key: draw(textures(key=key)) for key in sorted(keys)}
        values = draw(_any_properties())
        if "thetaFI_sliceLUT" not in values and draw(st.booleans()):
            found["btfflakes"] = draw(textures(key="btfflakes"))
        return _make(
            {
                "id": draw(_IDS) if id is None else id,
                "name": draw(_NAMES),
                "kind": draw(st.sampled_from(MaterialKind)),
                "diffuse_model": draw(st.sampled_from(sorted(DIFFUSE_MODELS))),
                "specular_model": draw(st.sampled_from(sorted(SPECULAR_MODELS))),
                "specular_variant": draw(st.none() | st.sampled_from(sorted(SPECULAR_VARIANTS))),
                "fresnel_variant": draw(st.none() | st.sampled_from(FRESNEL_VARIANTS)),
                "anisotropic": draw(st.booleans()),
                "textures": found,
                "properties": values,
                "metadata": draw(st.dictionaries(_NAMES, st.text(string.printable, max_size=20), max_size=3)),
            }
        )

    return material()


@composite
def axf_files(draw: Draw) -> AxfFile:
    """Files of one to three materials, of any version."""
    ids = draw(st.lists(_IDS, min_size=1, max_size=3, unique=True))
    version = draw(st.tuples(*[st.integers(0, 2**32 - 1)] * 3))
    materials = tuple(draw(axf_materials(id=identifier)) for identifier in ids)
    return built(lambda: AxfFile(materials, version=version))


def _coat_textures() -> dict[str, st.SearchStrategy]:
    return {
        "clearcoatcolor": textures(key="clearcoatcolor", elements=(0.0, 1.0), size_mm=(1.0, 100.0)),
        "clearcoatnormal": textures(key="clearcoatnormal", elements=(-0.5, 0.5), size_mm=(1.0, 100.0)),
        "clearcoatior": textures(key="clearcoatior", elements=(1.0, 3.0), size_mm=(1.0, 100.0)),
    }


def svbrdf_materials(
    *, most: int = 4, coated: bool | None = None, anisotropic: bool | None = None
) -> st.SearchStrategy[AxfMaterial]:
    """SVBRDF materials that can be evaluated: every model and variant, maps of different sizes, with and without coat.

    Args:
        most: largest side of a map in texels.
        coated: whether there is a coat; None draws both.
        anisotropic: whether the lobe map has two channels; None draws both. Some models are isotropic only.
    """
    variants = sorted(v for v in SPECULAR_VARIANTS if not (anisotropic and v in _ISOTROPIC))
    lobes = [(SPECULAR_VARIANTS[v], v) for v in variants]
    lobes += [(model, None) for model in ("CookTorrance", "GGX", *(() if anisotropic else ("Phong",)))]

    def map_of(key: str, *elements: float, channels: int | None = None) -> st.SearchStrategy:
        return textures(key=key, most=most, channels=channels, elements=(elements[0], elements[1]), size_mm=(1.0, 99.0))

    @composite
    def material(draw: Draw) -> AxfMaterial:
        model, variant = draw(st.sampled_from(lobes))
        can_turn = model != "Phong" and variant not in _ISOTROPIC
        turned = can_turn and (draw(st.booleans()) if anisotropic is None else anisotropic)
        largest = _LARGEST_LOGARITHM if model in ("BlinnPhong", "Phong") else 1.0
        maps = {
            "diffusecolor": map_of("diffusecolor", 0.0, 1.0),
            "normal": map_of("normal", -0.5, 0.5),
            "specularcolor": map_of("specularcolor", 0.0, 10.0),
            "specularlobe": map_of("specularlobe", 0.0, largest, channels=2 if turned else 1),
        }
        optional = {"opacity": map_of("opacity", 0.0, 1.0), "height": map_of("height", -1.0, 1.0)}
        if turned:
            optional["anisrotation"] = map_of("anisrotation", -3.0, 3.0)
        fresnel = draw(st.none() | st.sampled_from(FRESNEL_VARIANTS))
        if fresnel is not None:
            maps["fresnel"] = map_of("fresnel", 0.0, 1.0)
        if draw(st.booleans()) if coated is None else coated:
            maps |= _coat_textures()
        properties = {"cc_no_refraction": draw(st.integers(0, 1))}
        return _make(
            {
                "id": "svbrdf",
                "name": "SVBRDF",
                "kind": MaterialKind.SVBRDF,
                "diffuse_model": draw(st.sampled_from(sorted(DIFFUSE_MODELS))),
                "specular_model": model,
                "specular_variant": variant,
                "fresnel_variant": fresnel,
                "anisotropic": turned,
                "textures": draw(st.fixed_dictionaries(maps, optional=optional)),
                "properties": properties,
            }
        )

    return material()


def car_paint_materials(*, most: int = 4, flakes: bool | None = None) -> st.SearchStrategy[AxfMaterial]:
    """Car paints that can be evaluated: 1 to 4 lobes, a color table, flakes whose slice table fits them, a coat.

    Args:
        most: largest side of a map in texels.
        flakes: whether there are flakes; None draws both.
    """

    @composite
    def material(draw: Draw) -> AxfMaterial:
        values: dict[str, Any] = draw(_lobes(least=1))
        values |= {"CT_diffuse": draw(_floats(0, 1)), "IOR": draw(st.sampled_from([1.0, 1.5]) | _floats(1, 3))}
        values["cc_no_refraction"] = draw(st.integers(0, 1))
        found = {"brdfcolors": draw(textures(key="brdfcolors", most=most, elements=(0.0, 3.0)))}
        if draw(st.booleans()) if flakes is None else flakes:
            counts = draw(st.lists(st.integers(1, 3), min_size=1, max_size=4))
            values |= {
                "num_thetaF": draw(st.integers(1, 12)),
                "num_thetaI": len(counts),
                "max_thetaI": len(counts),
                "thetaFI_sliceLUT": [0, *np.cumsum(counts).tolist(), 0],
            }
            size = (1.0, 99.0)
            found["btfflakes"] = draw(
                textures(key="btfflakes", most=most, depth=sum(counts), elements=(0.0, 2.0), size_mm=size)
            )
        found |= draw(st.just({}) | st.fixed_dictionaries(_coat_textures()))
        return _make(
            {
                "id": "paint",
                "name": "Paint",
                "kind": MaterialKind.CAR_PAINT,
                "specular_model": "CookTorrance",
                "textures": found,
                "properties": values,
            }
        )

    return material()
