"""docs/verify.md says what the verb does: its commands run, its names are those of the code, and none is missing."""

import re
import shlex
import shutil
import tomllib

import pytest

from axffit import axf
from axffit.cli import dispatch
from axffit.quantization import read_tolerances
from axffit.quantization.diagnosis import FACTOR, NAMES, NOISE
from axffit.quantization.hypotheses import SAMPLE_TEXELS
from axffit.quantization.tolerances import KINDS, LUT_CHECKS
from axffit.targets import TARGETS
from tests.conftest import PROJECT
from tests.targets.materials import paint, ward

pytestmark = pytest.mark.usefixtures("few_texels")

TEXT = (PROJECT / "docs" / "verify.md").read_text(encoding="utf-8")
(COMMANDS,) = re.findall(r"```sh\n(.*?)```", TEXT, flags=re.S)
(EXAMPLE,) = re.findall(r"```toml\n(.*?)```", TEXT, flags=re.S)


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with every file the page names."""
    monkeypatch.chdir(tmp_path)
    steel = ward(size=8)
    axf.write(tmp_path / "steel.axf", axf.AxfMaterial(**{**vars(steel), "id": "steel"}))
    axf.write(tmp_path / "paint.axf", paint(size=8))
    (tmp_path / "fabrics").mkdir()
    shutil.copy(tmp_path / "steel.axf", tmp_path / "fabrics" / "wool.axf")
    (tmp_path / "studio.toml").write_text(EXAMPLE, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_every_command_of_the_page_runs(place, capsys):
    outside = {"axffit verify paint.axf --target hdrp_10", "--read-by hdrp_10"}
    for line in COMMANDS.splitlines():
        program, *words = shlex.split(line)
        assert program == "axffit"
        code = dispatch(words)
        assert code == int(any(part in line for part in outside)), (line, capsys.readouterr())
    assert {path.name for path in place.iterdir()} >= {"verdicts.json", "verdicts.xml", "verdicts.html", "exported"}


def test_the_example_of_a_tolerance_file_is_read(place):
    limits = read_tolerances(place / "studio.toml")
    angle = limits.get("textures.normal.angle")
    assert angle is not None
    assert (angle.limit, angle.statistic) == (0.01, "p999")
    assert len(tomllib.loads(EXAMPLE)) == 3


def test_options_faults_engines_and_limits_are_all_there(capsys):
    assert dispatch(["verify", "--help"]) == 0
    options = set(re.findall(r"--[a-z-]+", capsys.readouterr().out.rsplit("Options", 1)[1])) - {"--help"}
    listed = {
        option for line in TEXT.splitlines() if line.startswith("| `") for option in re.findall(r"--[a-z-]+", line)
    }
    assert listed == options
    assert re.findall(r"^\| `([a-z_]+)` \|", TEXT, flags=re.M) == list(NAMES)
    assert f"at least {FACTOR:g} times" in TEXT
    assert f"after {NOISE:g} bits" in TEXT
    assert f"{SAMPLE_TEXELS:,} texels".replace(",", " ") in " ".join(TEXT.split())
    for name in (*TARGETS, *(f"lut.{check}" for check in LUT_CHECKS), *(f"brdf.{check}" for check in KINDS)):
        assert f"`{name}`" in TEXT
