"""Each obligation broken on purpose, and named."""

from dataclasses import replace

import numpy as np
import pytest

from axffit.targets import unity_2018
from axffit.targets.base import PackedMaterial
from tests.targets.materials import MATERIALS, paint, ward, without


def changed(material, drop=(), **values) -> PackedMaterial:
    packed = unity_2018.pack(material)
    textures = {name: t for name, t in packed.textures.items() if name not in drop}
    kept = {name: value for name, value in packed.values.items() if name not in drop}
    return replace(packed, textures=textures, values={**kept, **values})


def with_packed(packed, name, **fields) -> PackedMaterial:
    return replace(packed, textures={**packed.textures, name: replace(packed.textures[name], **fields)})


LOBE, NORMAL = "_SVBRDF_SpecularLobeMap", "_SVBRDF_NormalMap"
FLAKES, TABLE = "_CarPaint_BTFFlakesMap_sRGB", "_CarPaint_thetaFI_sliceLUTMap"
ROTATION, COAT = "_SVBRDF_AnisotropicRotationAngleMap", "_SVBRDF_ClearCoatNormalMap"
WARD, PAINT = unity_2018.pack(ward()), unity_2018.pack(paint())

BROKEN: dict[str, tuple[PackedMaterial, str, str]] = {
    "bit 0 with one lobe channel": (
        with_packed(WARD, LOBE, channels=1, format="R16F", levels=(np.zeros((4, 4, 1), np.uint16),)),
        "flags.bit0", LOBE,
    ),
    "bit 0 without a rotation map": (changed(ward(), [ROTATION]), "flags.bit0", ROTATION),
    "two lobe channels without bit 0": (changed(ward(), _flags=14), "flags.bit0", "_flags"),
    "bit 0 on a paint": (changed(paint(), _flags=7), "flags.bit0", "_flags"),
    "bit 1 without a coat normal": (changed(ward(), [COAT]), "flags.bit1", COAT),
    "coat textures without bit 1": (changed(ward(), _flags=13), "flags.bit1", "_flags"),
    "bit 2 without an IOR map": (
        changed(ward(), ["_SVBRDF_ClearCoatIORMap_sRGB"]), "flags.bit2", "_SVBRDF_ClearCoatIORMap_sRGB",
    ),
    "bit 2 on a paint without IOR": (
        changed(paint(), ["_SVBRDF_ClearCoatIORMap_sRGB", "_CarPaint_IOR"]),
        "flags.bit2", "_SVBRDF_ClearCoatIORMap_sRGB",
    ),
    "bit 3 without a height map": (changed(ward(), ["_SVBRDF_HeightMap"]), "flags.bit3", "_SVBRDF_HeightMap"),
    "a height map without bit 3": (changed(ward(), _flags=7), "flags.bit3", "_flags"),
    "a flag without a meaning": (changed(ward(), _flags=15 + 16), "flags", "_flags"),
    "a specular code without a meaning": (changed(ward(), _SVBRDF_BRDFType=12), "models", "_SVBRDF_BRDFType"),
    "a Fresnel code without a meaning": (changed(ward(), _SVBRDF_BRDFVariants=3), "models", "_SVBRDF_BRDFVariants"),
    "a missing texture": (changed(ward(), [NORMAL]), "texture.missing", NORMAL),
    "a texture of the other kind": (
        replace(WARD, textures={**WARD.textures, FLAKES: PAINT.textures[FLAKES]}), "texture.unknown", FLAKES,
    ),
    "a format the shader does not read": (with_packed(WARD, NORMAL, format="RG8_UNORM"), "texture.format", NORMAL),
    "a number of channels": (with_packed(WARD, NORMAL, channels=2), "texture.channels", NORMAL),
    "codes of another type": (
        with_packed(WARD, NORMAL, levels=(np.zeros((4, 4, 4), np.uint8),)), "texture.codes", NORMAL,
    ),
    "no level": (with_packed(WARD, NORMAL, levels=()), "texture.codes", NORMAL),
    "a scale of zero": (changed(paint(), _CarPaint_BRDFColorMap_Scale=0.0), "scale", "_CarPaint_BRDFColorMap_Scale"),
    "a scale beside a float format": (
        changed(paint(), _CarPaint_BTFFlakesMap_Scale=2.0), "scale", "_CarPaint_BTFFlakesMap_Scale",
    ),
    "a missing value": (changed(paint(), ["_CarPaint_CT_diffuse"]), "value.missing", "_CarPaint_CT_diffuse"),
    "a value of the other kind": (changed(ward(), _CarPaint_IOR=1.5), "value.unknown", "_CarPaint_IOR"),
    "a value that is NaN": (changed(paint(), _CarPaint_CT_diffuse=np.nan), "value.float", "_CarPaint_CT_diffuse"),
    "a word too long for float32": (changed(ward(), _flags=2**24), "value.uint", "_flags"),
    "three components": (changed(paint(), _CarPaint_CT_F0s=(0.1, 0.1, 0.1)), "value.float4", "_CarPaint_CT_F0s"),
    "no size": (changed(ward(), _materialSizeU_mm=0.0), "value.size", "_materialSizeU_mm"),
    "five lobes": (changed(paint(), _CarPaint_lobesCount=5), "lobes", "_CarPaint_lobesCount"),
    "wrong padding": (
        changed(paint(), _CarPaint_CT_spreads=(0.1, 0.2, 0.3, 0.0)), "lobes.padding", "_CarPaint_CT_spreads",
    ),
    "flakes without their table": (changed(paint(), [TABLE]), "slices", TABLE),
    "a table that is too short": (changed(paint(), _CarPaint_maxThetaI=7), "slices", TABLE),
    "a table that points nowhere": (
        with_packed(PAINT, TABLE, levels=(np.array([[[0], [5], [99]]], np.uint8),)), "slices", TABLE,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_obligation_is_named(name):
    packed, obligation, subject = BROKEN[name]
    problems = unity_2018.validate(packed)
    assert (obligation, subject) in {(problem.obligation, problem.subject) for problem in problems}
    assert all("\n" not in str(problem) and problem.subject in str(problem) for problem in problems)


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("missing", [(), ("diffusecolor", "brdfcolors", "clearcoatnormal", "height", "btfflakes")])
def test_what_pack_makes_breaks_nothing(name, missing):
    assert unity_2018.validate(unity_2018.pack(without(MATERIALS[name](), *missing))) == ()
