"""Tolerance files: the package's own is complete and reasoned; a user's changes part of it; mistakes are named."""

import math

import pytest

from axffit.errors import InputError
from axffit.quantization import default_tolerances, read_tolerances
from axffit.quantization.measures import MEASURES
from axffit.quantization.tolerances import BRDF_CHECKS, LUT_CHECKS, Tolerance, known_names


def written(tmp_path, text):
    path = tmp_path / "limits.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_default_has_a_reason_and_every_texture_a_limit():
    entries = default_tolerances().entries
    assert all(len(entry.reason) > 20 for entry in entries.values())
    for axf_name in MEASURES:
        assert any(name.startswith(f"textures.{axf_name}.") for name in entries)
    assert {f"lut.{c}" for c in LUT_CHECKS} | {f"brdf.{c}" for c in BRDF_CHECKS} <= set(entries)
    assert set(entries) <= set(known_names())


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
