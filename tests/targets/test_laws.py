"""The laws of every target: what is packed is valid, comes back within its format's bound, and packs again the same.

A new target is one line of `axffit.targets.TARGETS`, and inherits all of this.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from axffit.axf.validation import problems
from axffit.errors import InputError
from axffit.targets import TARGETS, target_named
from axffit.testing.strategies import car_paint_materials, svbrdf_materials
from axffit.textures import ROUNDINGS, format_named
from tests.targets.materials import MATERIALS, paint, ward, without

DRIFTS = {
    "unreal": "it rounds to half and then floors: what was unpacked is rounded and floored once more",
    "mdl": "a 32-bit angle is multiplied by 2 pi and divided again, each with a rounding",
}
"""Targets whose codes change when what was unpacked is packed again, and why; they still may not move far."""

FEW = settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.too_slow], phases=[Phase.generate])

every_target = pytest.mark.parametrize("target", TARGETS)
every_material = pytest.mark.parametrize("name", MATERIALS)
materials = st.one_of(svbrdf_materials(most=3), car_paint_materials(most=3))


def source_of(module, material, texture):
    """The levels that the target's texture was made from."""
    prepared = module.ENGINE.prepare(material).material
    if texture.axf_name == "thetaFI_sliceLUT":
        return (np.asarray(prepared.properties["thetaFI_sliceLUT"], np.float64).reshape(1, -1, 1),)
    return prepared.textures[texture.axf_name].levels


def check_bounds(module, material, rounding=None, formats=None):
    packed = module.pack(material, rounding=rounding, formats=formats)
    assert module.validate(packed) == ()
    for texture in packed.textures.values():
        assert module.texture_name(texture.axf_name, material.kind) == texture.name
        if texture.defaulted:
            continue
        form, reading = format_named(texture.format), module.reading(texture, packed.values)
        assert reading.formula == texture.transform
        for before, codes in zip(source_of(module, material, texture), texture.levels, strict=True):
            wanted = reading.forward(before)
            padded = np.zeros((*wanted.shape[:-1], form.channels))
            padded[..., : wanted.shape[-1]] = wanted
            lowest, highest = form.codecs[0].lowest, form.codecs[0].highest
            held = np.clip(padded, lowest, highest)
            if np.any(held != padded):
                assert texture.clamped > 0, f"{texture.name} is clamped and not counted"
            error = np.abs(form.decode(codes) - held)[..., : wanted.shape[-1]]
            assert np.all(error <= form.error_bound(held, texture.rounding)[..., : wanted.shape[-1]]), texture.name
    return packed


def check_stable(module, material):
    """From the second time on nothing moves, but where `DRIFTS` says so and then by little."""
    once = module.unpack(module.pack(material))
    assert list(problems(once)) == []
    first = module.pack(once)
    twice = module.unpack(first)
    second = module.pack(twice)
    assert set(first.textures) == set(second.textures)
    assert {name: pytest.approx(value, rel=1e-3) for name, value in first.values.items()} == dict(second.values)
    for key, texture in once.textures.items():
        for before, after in zip(texture.levels, twice.textures[key].levels, strict=True):
            if module.NAME not in DRIFTS:
                np.testing.assert_array_equal(after, before, err_msg=key)
            else:
                moved = after.astype(np.float64) - before
                if key == "anisrotation":
                    moved -= 2 * np.pi * np.rint(moved / (2 * np.pi))
                # A rounding to half or two, and two steps of 16 bits below the channel's scale.
                allowed = 2.0**-9 * np.abs(before) + 2 * max(float(np.abs(before).max()), 0.1) / 65535
                assert np.all(np.abs(moved) <= allowed), key
    if module.NAME not in DRIFTS:
        assert dict(first.values) == dict(second.values)


@every_target
@every_material
def test_bounds_hold(target, name):
    check_bounds(target_named(target), MATERIALS[name]())


@every_target
@every_material
@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_bounds_hold_under_every_rounding(target, name, rounding):
    packed = check_bounds(target_named(target), MATERIALS[name](), rounding=rounding)
    assert {texture.rounding for texture in packed.textures.values()} == {rounding}


CHOICES = [
    (target, row.axf_name, choice.format)
    for target, module in TARGETS.items()
    for row in module.ENGINE.tables.textures
    for choice in row.choices[max(row.choices)]
]


@pytest.mark.parametrize(("target", "axf_name", "format"), CHOICES)
def test_bounds_hold_in_every_format(target, axf_name, format):
    module = target_named(target)
    kind = next(row.kinds for row in module.ENGINE.tables.textures if row.axf_name == axf_name)
    material = next(make() for make in (ward, paint) if make().kind in kind)
    packed = check_bounds(module, material, formats={axf_name: format})
    made = next((t for t in packed.textures.values() if t.axf_name == axf_name), None)
    assert made is None or made.format == format or made.channels < 2


@every_target
@every_material
def test_packing_again_changes_nothing(target, name):
    check_stable(target_named(target), MATERIALS[name]())


@every_target
@FEW
@given(material=materials)
def test_any_material(target, material):
    module = target_named(target)
    packed = check_bounds(module, material)
    assert (packed.target, packed.id, packed.name, packed.kind) == (target, material.id, material.name, material.kind)
    check_stable(module, material)


@every_target
@every_material
def test_what_is_missing_is_valid_too(target, name):
    module, material = target_named(target), MATERIALS[name]()
    for key in material.textures:
        assert module.validate(module.pack(without(material, key))) == (), key


@every_target
@every_material
def test_what_a_material_has_is_packed_or_noted(target, name):
    module, material = target_named(target), MATERIALS[name]()
    packed = module.pack(material)
    kept = {texture.axf_name for texture in packed.textures.values() if not texture.defaulted}
    for key in set(material.textures) - kept:
        assert any(key in note or {"anisrotation": "anisotropy"}.get(key, key) in note for note in packed.notes), key


@every_target
@every_material
def test_the_models_and_properties_come_back(target, name):
    module, material = target_named(target), MATERIALS[name]()
    back = module.unpack(module.pack(material))
    fields = ("id", "name", "kind", "diffuse_model", "specular_model", "specular_variant", "fresnel_variant")
    assert [getattr(back, f) for f in fields] == [getattr(module.ENGINE.prepare(material).material, f) for f in fields]
    assert back.has_clear_coat == material.has_clear_coat


@every_target
def test_defaults_can_be_left_out(target):
    module, material = target_named(target), without(ward(), "diffusecolor")
    assert "diffusecolor" not in module.unpack(module.pack(material), defaults=False).textures


@every_target
def test_each_default_lies_in_the_range_of_axf(target):
    module = target_named(target)
    for row in module.ENGINE.tables.textures:
        values = module.default_values(row.name)
        assert values.shape == (max(row.choices),)
        assert np.all(np.isfinite(values))


@every_target
def test_a_texture_or_format_the_target_does_not_know_is_refused(target):
    module = target_named(target)
    texture = next(iter(module.pack(ward()).textures.values()))
    with pytest.raises(InputError, match=f"{target} has no texture '_BumpMap'"):
        module.reading(replace(texture, name="_BumpMap"), {})
    with pytest.raises(InputError, match=f"{target} has no texture '_BumpMap'"):
        module.default_values("_BumpMap")
    with pytest.raises(InputError, match=f"{target}: .* cannot be BC6H; allowed: "):
        module.pack(ward(), formats={"diffusecolor": "BC6H"})
    with pytest.raises(InputError, match=f"{target}: a format is given for 'bump'"):
        module.pack(ward(), formats={"bump": "R8_UNORM"})
    with pytest.raises(InputError, match="unknown rounding 'up'"):
        module.pack(ward(), rounding="up")


@every_target
def test_values_have_rows_and_types(target):
    module = target_named(target)
    for make in MATERIALS.values():
        material = make()
        rows = {row.name: row for row in module.ENGINE.tables.values if material.kind in row.kinds}
        packed = module.pack(material)
        assert set(packed.values) == set(rows)
        assert set(module.values_of(material)) == set(rows)
        for name, value in packed.values.items():
            assert np.shape(value) == (() if rows[name].type.length == 1 else (rows[name].type.length,))


def test_an_unknown_target_is_refused():
    with pytest.raises(InputError, match="unknown target 'godot'; allowed: unity_2018, hdrp_10, png16, unreal, mdl"):
        target_named("godot")
