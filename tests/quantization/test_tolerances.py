"""Tolerance files: the package's own is complete and reasoned; a user's changes part of it; mistakes are named."""

import math
from dataclasses import replace
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.errors import InputError
from axffit.quantization import default_tolerances, read_tolerances
from axffit.quantization.maps import map_errors
from axffit.quantization.measures import MEASURES
from axffit.quantization.statistics import STATISTICS
from axffit.quantization.tolerances import KINDS, LUT_CHECKS, Tolerance, known_names
from axffit.targets import TARGETS, target_named
from tests.targets.materials import paint, ward, with_texture


def written(tmp_path, text):
    path = tmp_path / "limits.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_default_has_a_reason_and_every_texture_a_limit():
    entries = default_tolerances().entries
    assert all(len(entry.reason) > 20 for entry in entries.values())
    for axf_name in MEASURES:
        assert any(name.startswith(f"textures.{axf_name}.") for name in entries)
    assert {f"lut.{c}" for c in LUT_CHECKS} | {f"brdf.{c}" for c in KINDS} <= set(entries)
    assert set(entries) <= set(known_names())


def test_every_target_whose_formats_differ_has_a_section_with_reasons():
    default = default_tolerances()
    assert set(default.targets) == set(TARGETS) - {"unity_2018"}
    for entries in default.targets.values():
        own = {name: entry for name, entry in entries.items() if entry != default.entries.get(name)}
        assert own
        assert all(len(entry.reason) > 15 for entry in own.values())
        assert set(default.entries) <= set(entries) <= set(known_names())


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("make", [ward, paint])
def test_a_target_s_own_formats_are_within_its_limits(make, target):
    """But for what its importer changes before it quantizes, and colors above 1 that fixed point cannot hold."""
    material = make(size=32)
    dimmed = {key: 0.3 * material.textures[key].data for key in ("specularcolor", "diffusecolor") if make is ward}
    for key, values in dimmed.items():
        material = with_texture(material, key, values)
    module = target_named(target)
    packed = module.pack(material)
    limits = default_tolerances().for_target(target)
    changed = {"unreal": {"specularlobe"}}.get(target, set())
    judged = 0
    for packed_texture in packed.textures.values():
        key = packed_texture.axf_name
        if key not in material.textures or key in changed:
            continue
        original = replace(material.textures[key], levels=material.textures[key].levels[: len(packed_texture.levels)])
        for found in map_errors(original, packed_texture, module.reading(packed_texture, packed.values)).statistics:
            limit = limits.get(f"textures.{key}.{found.measure}")
            if limit is not None:
                assert limit.allows(found.value(limit.statistic)), (key, found)
                judged += limit.limit < math.inf
    assert judged >= (12 if make is ward else 3)


@pytest.mark.parametrize(("target", "name", "format"), [
    ("hdrp_10", "anisrotation.axis_angle", 180 * 2.0**-12),
    ("hdrp_10", "opacity.absolute", 2.0**-12),
    ("png16", "opacity.absolute", 2.0**-17),
    ("png16", "fresnel.absolute", 2.2 * 2.0**-17),
    ("png16", "diffusecolor.relative", 2.2 * 2.0**-17 / 2.0 ** (-14 / 2.2)),
    ("png16", "brdfcolors.relative", 2.2 * 2.0**-17 / (2.0**-14 / 10) ** (1 / 2.2)),
    ("unreal", "normal.angle", math.degrees(math.asin(3**0.5 / 2048))),
    ("unity_2018", "normal.angle", math.degrees(math.asin(3**0.5 / 65535))),
    ("unity_2018", "opacity.absolute", 1 / 510),
    ("unity_2018", "diffusecolor.relative", 2.0**-11),
])  # fmt: skip
def test_limits_are_the_bounds_of_formats_rounded_up(target, name, format):
    limit = default_tolerances().for_target(target).entries[f"textures.{name}"].limit
    assert format < limit < 1.35 * format


def test_a_user_file_changes_only_what_it_names(tmp_path):
    path = written(
        tmp_path, '[textures.normal.angle]\nlimit = 0.5\nstatistic = "p95"\n\n[lut.truncated]\nlimit = inf\n'
    )
    changed, default = read_tolerances(path), default_tolerances()
    assert changed.entries["textures.normal.angle"] == Tolerance(0.5, "p95", "")
    assert changed.entries["lut.truncated"].limit == math.inf
    same = set(default.entries) - {"textures.normal.angle", "lut.truncated"}
    assert all(changed.entries[name] == default.entries[name] for name in same)
    assert str(path) in changed.source


def test_a_statistic_can_be_changed_alone(tmp_path):
    path = written(tmp_path, '[textures.normal.angle]\nstatistic = "mean"\n')
    default = default_tolerances().entries["textures.normal.angle"]
    assert read_tolerances(path).entries["textures.normal.angle"] == Tolerance(default.limit, "mean", default.reason)


def test_an_absolute_limit_can_be_added(tmp_path):
    path = written(tmp_path, "schema_version = 1\n[textures.diffusecolor.absolute]\nlimit = 0.1\n")
    assert read_tolerances(path).entries["textures.diffusecolor.absolute"].limit == 0.1


def test_a_user_s_section_stands_above_its_general_entries_and_those_above_the_package(tmp_path):
    text = """
    [textures.normal.angle]
    limit = 0.3
    [textures.opacity]
    absolute.statistic = "p95"
    [targets.hdrp_10.textures.normal.angle]
    limit = 0.5
    [targets.unity_2018.lut.rounded]
    limit = 2
    """
    tolerances, default = read_tolerances(written(tmp_path, text)), default_tolerances()
    limits = {name: tolerances.for_target(name).entries for name in TARGETS}
    assert limits["hdrp_10"]["textures.normal.angle"].limit == 0.5
    assert limits["unreal"]["textures.normal.angle"] == limits["mdl"]["textures.normal.angle"] == Tolerance(0.3)
    # What the user leaves out of an entry is the package's for the target.
    opacity = default.targets["png16"]["textures.opacity.absolute"]
    assert limits["png16"]["textures.opacity.absolute"] == replace(opacity, statistic="p95")
    assert [limits[name]["lut.rounded"].limit for name in ("unity_2018", "mdl")] == [2, 0]
    assert tolerances.entries["lut.rounded"].limit == 0
    assert tolerances.for_target("hdrp_10").source == tolerances.source


def test_a_level_takes_from_its_map_what_it_leaves_out_wherever_it_stands(tmp_path):
    text = """
    [textures.btfflakes.relative.level.2]
    limit = 0.5
    [textures.btfflakes.relative.level.0]
    statistic = "p95"
    [textures.btfflakes.relative]
    statistic = "mean"
    [targets.png16.textures.btfflakes.delta_e_2000.level.1]
    limit = 1
    """
    tolerances = read_tolerances(written(tmp_path, text))
    name, default = "textures.btfflakes.relative", default_tolerances().entries["textures.btfflakes.relative"]
    assert tolerances.entries[f"{name}.level.2"] == Tolerance(0.5, "mean", "")
    assert tolerances.entries[f"{name}.level.0"] == replace(default, statistic="p95")
    assert tolerances.levels_apart("btfflakes") == {"relative": {0, 2}}
    assert tolerances.for_target("png16").levels_apart("btfflakes") == {"relative": {0, 2}, "delta_e_2000": {1}}
    assert tolerances.for_target("png16").entries["textures.btfflakes.delta_e_2000.level.1"].limit == 1
    assert tolerances.levels_apart("normal") == {}


@cache
def measured(target):
    """Numbers of every measure of a paint, levels 1 and 2 apart and together, by the name of their limit."""
    module, material = target_named(target), paint()
    packed = module.pack(material)
    numbers = {}
    for packed_texture in packed.textures.values():
        key = packed_texture.axf_name
        if key in material.textures and len(packed_texture.levels) == len(material.textures[key].levels):
            reading, apart = module.reading(packed_texture, packed.values), {"relative": {1, 2}}
            for found in map_errors(material.textures[key], packed_texture, reading, apart).statistics:
                level = "" if found.level is None else f".level.{found.level}"
                numbers[f"textures.{key}.{found.measure}{level}"] = found
    return numbers


NAMES = [
    "textures.btfflakes.relative",
    "textures.btfflakes.relative.level.1",
    "textures.brdfcolors.delta_e_2000",
    "textures.clearcoatnormal.angle",
    "textures.clearcoatnormal.filtered_angle",
]
LIMITS = st.dictionaries(
    st.tuples(st.sampled_from(["", "targets.hdrp_10.", "targets.png16."]), st.sampled_from(NAMES)),
    st.tuples(st.floats(0, 0.1), st.sampled_from(STATISTICS)),
)


@given(limits=LIMITS, factor=st.floats(1, 1e3), target=st.sampled_from(["unity_2018", "hdrp_10", "png16"]))
def test_wider_files_allow_no_less(limits, factor, target, tmp_path_factory):
    folder = tmp_path_factory.getbasetemp()

    def judged(by):
        text = "".join(
            f'[{where}{name}]\nlimit = {limit * by!r}\nstatistic = "{statistic}"\n'
            for (where, name), (limit, statistic) in limits.items()
        )
        entries = read_tolerances(written(folder, text)).for_target(target).entries
        return {
            name: entries[name].allows(found.value(entries[name].statistic))
            for name, found in measured(target).items()
            if name in entries
        }

    narrow, wide = judged(1.0), judged(factor)
    assert narrow.keys() == wide.keys()
    assert all(wide[name] >= narrow[name] for name in narrow)
    assert len(narrow) >= 3


ANGLE, RATIO, ROUNDED = "[textures.normal.angle]\n", "[brdf.log_ratio]\n", "[lut.rounded]\n"
WRONG = {
    "unknown texture": ("[textures.bump.angle]\n", r"unknown entry \[textures.bump\]; allowed: textures.diff"),
    "unknown measure": (
        "[textures.normal.mm]\n",
        r"entry \[textures.normal.mm\]; allowed: textures.normal.angle",
    ),
    "unknown level": ("[image.flip]\n", r"unknown entry \[image\]; allowed: textures.<AxF name>.<measure>, lut.trunc"),
    "unknown key": (ANGLE + "limits = 1\n", "unknown key 'limits'; allowed: limit, statistic, reason"),
    "statistic of a single number": (RATIO + 'statistic = "mean"\n', "unknown key 'statistic'; allowed: limit, reason"),
    "unknown statistic": (ANGLE + 'statistic = "p99"\n', "statistic = 'p99'; allowed: mean, p95, p999"),
    "negative limit": (ROUNDED + "limit = -1\n", "limit = -1; give a number of 0 or more"),
    "limit that is NaN": (ROUNDED + "limit = nan\n", "limit = nan; give a number"),
    "limit that is text": (ROUNDED + 'limit = "0"\n', "limit = '0'; give a number"),
    "limit that is true": (ROUNDED + "limit = true\n", "limit = True; give a number"),
    "reason that is no text": (ROUNDED + "reason = 3\n", "reason = 3; give text"),
    "value outside a table": ("[lut]\nrounded = 3\n", r"lut.rounded = 3 is not in a table; write \[lut.rounded\]"),
    "another version": ("schema_version = 2\n", "schema_version is 2; this axffit reads 1"),
    "no TOML": ("[textures\n", "is no TOML"),
    "unknown target": (
        "[targets.unity_6]\n",
        r"unknown target \[targets.unity_6\]; allowed: unity_2018, hdrp_10, png16",
    ),
    "targets that are no table": ("targets = 3\n", r"targets = 3 is not a table; write \[targets.<target>.<entry>\]"),
    "a target that is no table": ("[targets]\nmdl = 3\n", r"\[targets.mdl\]: 3 is not a table of entries"),
    "unknown entry of a target": (
        "[targets.mdl.textures.normal.mm]\n",
        r"\[targets.mdl\]: unknown entry \[textures.normal.mm\]; allowed: textures.normal.angle",
    ),
    "wrong limit of a target": (
        "[targets.mdl.lut.rounded]\nlimit = -1\n",
        r"\[targets.mdl\]: \[lut.rounded\]: limit = -1",
    ),
    "level that is no number": ("[textures.normal.angle.level.one]\n", "level.one.: give the number of a mip level"),
    "level that is written otherwise": ("[textures.normal.angle.level.01]\n", "level.01.: give the number"),
    "level that is no table": ("[textures.normal.angle]\nlevel = 2\n", "level = 2 is not a table"),
    "level without a table": ("[textures.normal.angle.level]\n2 = 0.1\n", "level.2 = 0.1 is not in a table"),
    "unknown key of a level": (
        "[textures.normal.angle.level.2]\nmax = 1\n",
        "level.2.: unknown key 'max'; allowed: limit",
    ),
    "level of a single number": (RATIO + "level.1.limit = 2\n", "unknown key 'level'; allowed: limit, reason"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_mistake_is_named_with_the_file(name, tmp_path):
    text, message = WRONG[name]
    path = written(tmp_path, text)
    with pytest.raises(InputError, match=message) as caught:
        read_tolerances(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_tolerances(tmp_path / "none.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="is not text"):
        read_tolerances(tmp_path / "binary.toml")


def test_what_a_limit_allows():
    assert Tolerance(1.0).allows(1.0)
    assert not Tolerance(1.0).allows(1.0000001)
    assert not Tolerance(1.0).allows(math.inf)
    assert Tolerance(math.inf).allows(math.inf)
    assert not Tolerance(1.0).allows(math.nan)
