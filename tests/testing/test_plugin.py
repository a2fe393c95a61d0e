"""The plugin as a user's shell runs it. It is named with -p, so that no installed entry point is needed."""

import subprocess
import sys
from pathlib import Path

import pytest

DATA = Path(__file__).resolve().parents[2] / "data_synthetic"
CARBON = str(DATA / "brushed_carbon" / "brushed_carbon.axf")
USAGE_ERROR = 4


def run(folder, *options):
    """pytest in a folder of its own, which has no settings: the suite's are not the user's."""
    (folder / "pytest.ini").write_text("[pytest]\n")
    plugin = ["-p", "no:axffit", "-p", "axffit.testing.plugin", "-p", "no:cacheprovider", "-c", "pytest.ini"]
    command = [sys.executable, "-m", "pytest", "-q", "-rs", *plugin, "--pyargs", "axffit.testing", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout + done.stderr


def test_without_a_file_nothing_is_checked_and_that_is_said(tmp_path):
    code, text = run(tmp_path)
    assert code == 0
    assert "1 skipped" in text
    assert "name an .axf file with --axf FILE" in text


REFUSED = {
    "no such file": (["--axf", "nothing.axf"], "nothing.axf: no such file"),
    "no such material": (["--axf", CARBON, "--axf-material", "nobody"], "no material 'nobody'; there are: "),
    "no such target": (["--axf", CARBON, "--axf-target", "nobody"], "unknown target 'nobody'; allowed: unity_2018"),
    "fewer than no texels": (["--axf", CARBON, "--axf-texels", "-1"], "--axf-texels -1: give 0 or more"),
    "a material of no file": (["--axf-material", "a"], "--axf-material needs a file"),
    "a target for no file": (["--axf-target", "mdl"], "--axf-target needs a file"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_a_usage_error(name, tmp_path):
    options, message = REFUSED[name]
    code, text = run(tmp_path, *options)
    assert code == USAGE_ERROR
    assert message in text
    assert "Traceback" not in text


def test_a_broken_law_is_named_with_its_directions_and_texel(tmp_path):
    """The synthetic carbon holds negative colors, as real files do."""
    code, text = run(
        tmp_path, "--axf", CARBON, "--axf-texels", "0", "-k", "negativity or unity", "--axf-target", "unity_2018"
    )
    assert code == 1
    assert "1 failed, 3 passed" in text
    assert text.count("brushed_carbon: non-negativity: f = (-") == 1
    for part in ("1/sr is negative at wi = (", "), wo = (", "smallest channel 0 of diffusecolor"):
        assert part in text
