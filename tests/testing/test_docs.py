"""docs/testing.md says what there is: its blocks run, its names are those of the code, and none is missing."""

import re
import shlex
import subprocess
import sys

import pytest

from axffit.targets import TARGETS
from axffit.testing import draws, energy, laws, packing, strategies
from axffit.testing.directions import GRAZING_COSINES, extreme_pairs, random_pairs
from axffit.testing.places import MOST_EXTREME
from tests.conftest import PROJECT
from tests.testing.materials import plain, written

TEXT = (PROJECT / "docs" / "testing.md").read_text(encoding="utf-8")
FLAT = " ".join(TEXT.split())
INSTALL, COMMANDS = re.findall(r"```sh\n(.*?)```", TEXT, flags=re.S)
OF_LAWS, OF_STRATEGIES = re.findall(r"```python\n(.*?)```", TEXT, flags=re.S)


def pytest_in(folder, *words):
    (folder / "pytest.ini").write_text("[pytest]\n")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-c", "pytest.ini", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    return done.returncode, done.stdout + done.stderr


def test_the_extra_to_install_exists():
    assert shlex.split(INSTALL)[-1] == "axffit[testing]"
    assert "\ntesting = [" in (PROJECT / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("line", COMMANDS.splitlines())
def test_every_command_of_the_page_runs(line, tmp_path):
    for name in ("paint", "steel"):
        material = plain()
        written(tmp_path / f"{name}.axf", type(material)(**{**vars(material), "id": name}))
    program, *words = shlex.split(line)
    assert program == "pytest"
    code, text = pytest_in(tmp_path, *words)
    assert code == 0, text


@pytest.mark.slow
def test_the_blocks_of_code_run(tmp_path):
    """One process for both: the laws below in a test of their own."""
    laws_alone = "\n".join(f"    {line}" for line in OF_LAWS.splitlines())
    (tmp_path / "test_page.py").write_text(f"{OF_STRATEGIES}\n\ndef test_laws():\n{laws_alone}\n", encoding="utf-8")
    code, text = pytest_in(tmp_path, "--hypothesis-seed=0", "test_page.py")
    assert code == 0, text
    assert "3 passed" in text


def test_options_laws_targets_and_strategies_are_all_there():
    plugin = (PROJECT / "axffit" / "testing" / "plugin.py").read_text(encoding="utf-8")
    options = re.findall(r'^ +"(--axf[a-z-]*)"', plugin, flags=re.M)
    assert re.findall(r"^\| `(--[a-z-]+)", TEXT, flags=re.M) == options
    assert re.findall(r"^\| `([a-z][a-z-]+)` \|", TEXT, flags=re.M) == list(laws.LAWS)
    for target in TARGETS:
        assert f"`{target}`" in TEXT
    table = TEXT.partition("| Of | Strategies |")[2]
    public = {n for n in vars(strategies) if not n.startswith("_") and callable(vars(strategies)[n])}
    assert set(re.findall(r"`([a-z_0-9]+)`", table)) == public


def test_numbers_are_those_of_the_code():
    assert f"({MOST_EXTREME} at most)" in FLAT
    assert f"{len(random_pairs()[0])} seeded pairs" in FLAT
    assert f"all {len(extreme_pairs()[0])} pairs" in FLAT
    (cosines,) = re.findall(r"cosines of (1e-300.*?) and 0\.5", FLAT)
    assert tuple(map(float, cosines.split(", "))) == GRAZING_COSINES
    assert f"{laws.LARGEST_DIFFERENTIATED:,} entries".replace(",", " ") in FLAT
    assert f"for {energy.MOST_VIEWERS} viewers; of a material in the mean" in FLAT
    assert f"| {energy.STANDARD_ERRORS:g} standard errors" in FLAT
    assert f"for {draws.MOST_VIEWERS} viewers" in FLAT
    assert (packing.OF_TEXEL, packing.OF_TEXTURE) == (2**-8, 2**-14)
    assert "2⁻⁸ of its texel's largest channel plus 2⁻¹⁴" in FLAT


def test_the_page_of_models_leads_here():
    assert "(../testing.md)" in (PROJECT / "docs" / "models" / "README.md").read_text(encoding="utf-8")
