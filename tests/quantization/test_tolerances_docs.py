"""docs/tolerances.md says what a tolerance file may hold: its blocks are read, its names are those of the code."""

import re
import shlex
from pathlib import Path

import pytest

from axffit import axf
from axffit.cli import verify
from axffit.errors import InputError
from axffit.quantization import default_tolerances, read_tolerances
from axffit.quantization.filtered import FILTERED_MEASURES
from axffit.quantization.maps import COSTLY_TEXELS
from axffit.quantization.measures import MEASURES
from axffit.quantization.statistics import STATISTICS
from axffit.quantization.tolerances import SCHEMA_VERSION, known_names
from axffit.targets import TARGETS
from tests.conftest import PROJECT
from tests.targets.materials import ward

TEXT = (PROJECT / "docs" / "tolerances.md").read_text(encoding="utf-8")
FLAT = " ".join(TEXT.split())
(COMMAND,) = re.findall(r"```sh\n(.*?)```", TEXT, flags=re.S)
STUDIO, LEVELS, TARGETED = re.findall(r"```toml\n(.*?)```", TEXT, flags=re.S)


@pytest.fixture
def read(tmp_path):
    """Reads a block as a file."""

    def of(block):
        (tmp_path / "block.toml").write_text(block, encoding="utf-8")
        return read_tolerances(tmp_path / "block.toml")

    return of


def test_the_command_is_one(tmp_path, monkeypatch):
    """What the verb does with it is the matter of tests/cli."""
    monkeypatch.chdir(tmp_path)
    axf.write(tmp_path / "steel.axf", ward(size=8))
    (tmp_path / "studio.toml").write_text(STUDIO, encoding="utf-8")
    program, verb, file, option, limits = shlex.split(COMMAND)
    assert (program, verb, option) == ("axffit", "verify", "--tolerance")
    # Everything is read before the first material is judged, which is not asked for.
    verify.run([Path(file)], tolerance=Path(limits))
    (tmp_path / "studio.toml").write_text(STUDIO.replace("limit", "limits"), encoding="utf-8")
    with pytest.raises(InputError, match="unknown key 'limits'"):
        verify.run([Path(file)], tolerance=Path(limits))


def test_the_first_block(read):
    entries = read(STUDIO).entries
    normal = entries["textures.normal.angle"]
    assert (normal.limit, normal.statistic, normal.reason) == (0.01, "p999", "half-float normals, seen from 1 m")
    assert entries["textures.height.absolute"].limit == float("inf")
    assert (entries["lut.truncated"].limit, entries["brdf.log_ratio"].limit) == (0, 0.05)


def test_the_block_of_levels(read):
    tolerances = read(LEVELS)
    assert tolerances.levels_apart("btfflakes") == {"relative": {3}}
    level = tolerances.entries["textures.btfflakes.relative.level.3"]
    assert (level.limit, level.statistic, level.reason) == (0.01, "p999", "seen from 10 m on only")


def test_the_block_of_targets(read):
    tolerances = read(TARGETED)
    limits = {name: tolerances.for_target(name).entries["textures.normal.angle"].limit for name in TARGETS}
    assert limits == {"unity_2018": 0.05, "hdrp_10": 0.2, "png16": 0.05, "unreal": 0.05, "mdl": 0.05}
    assert tolerances.for_target("png16").entries["brdf.log_ratio"].limit == 0.1
    assert tolerances.for_target("mdl").entries["brdf.log_ratio"] == default_tolerances().entries["brdf.log_ratio"]


def test_every_name_is_there_and_no_other():
    rows = re.findall(r"^\| `([a-z]+)` \| (`[a-z_0-9`, ]+) \|(.*?)\|$", TEXT, flags=re.M)
    named = {name: [re.findall(r"`(\w+)`", cell) for cell in cells] for name, *cells in rows}
    assert list(named) == list(MEASURES)
    for name, (texels, between) in named.items():
        assert texels == [measure.name for measure in MEASURES[name]]
        assert between == list(FILTERED_MEASURES.get(name, ()))
    explained = set(re.findall(r"`(\w+)`", TEXT.partition("| Measure | Is |")[2].partition("\n\n")[0]))
    used = {measure for cells in named.values() for cell in cells for measure in cell}
    assert used <= explained
    checks = re.findall(r"^\| `((?:lut|brdf)\.\w+)` \|", TEXT, flags=re.M)
    assert checks == [name for name in known_names() if not name.startswith("textures.")]


def test_keys_and_numbers_are_those_of_the_code():
    keys = TEXT.partition("## Keys")[2].partition("## Measures")[0]
    for key in ("schema_version", "limit", "statistic", "reason"):
        assert f"| `{key}` |" in keys
    assert f"| `schema_version` | {SCHEMA_VERSION} |" in keys
    assert re.findall(r'`"(\w+)"`', keys) == list(STATISTICS)
    assert f"an even part of more than {COSTLY_TEXELS:,}".replace(",", " ") in FLAT
    own = re.findall(r"`(\w+)`", TEXT.partition("entries are those of `unity_2018`;")[2].partition("have sections")[0])
    assert own == [target for target in TARGETS if target in default_tolerances().targets]
