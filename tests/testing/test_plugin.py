"""The plugin as a user's shell runs it, through its entry point."""

import subprocess
import sys

import pytest

from axffit.targets import TARGETS
from tests.conftest import PROJECT
from tests.testing.materials import DATA, constant, overexposed, plain, written

USAGE_ERROR = 4


def pytest_in(folder, *options, timeout=120):
    command = [sys.executable, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=timeout, check=False)
    return done.returncode, done.stdout + done.stderr


def run(folder, *options, timeout=120):
    """The laws, in a folder of its own, which has no settings: the suite's are not the user's."""
    (folder / "pytest.ini").write_text("[pytest]\n")
    return pytest_in(folder, "-c", "pytest.ini", "--pyargs", "axffit.testing", *options, timeout=timeout)


def test_without_a_file_nothing_is_checked_and_that_is_said(tmp_path):
    code, text = run(tmp_path)
    assert code == 0
    assert "1 skipped" in text
    assert text.count("no law was checked: name an .axf file with --axf FILE") == 2


REFUSED = {
    "no such file": (["--axf", "nothing.axf"], "nothing.axf: no such file"),
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


def test_a_broken_law_fails_and_says_where(tmp_path):
    """Only the laws that need few compilations are run here."""
    file = written(tmp_path / "bright.axf", overexposed())
    code, text = run(tmp_path, "--axf", file, "-k", "passivity or negati or unity", "--axf-target", "unity_2018")
    assert code == 1
    assert "1 failed, 5 passed" in text
    assert text.count("plain: passivity: albedo 1.") == 1
    assert " is above 1" in text


@pytest.mark.slow
def test_negative_colors_fail_on_request(tmp_path):
    file = written(tmp_path / "dark.axf", plain(diffusecolor=constant(-1.5, 0.5, 0.5)))
    code, text = run(tmp_path, "--axf", file, "-k", "negative-colors", "--axf-strict")
    assert code == 1
    assert "plain: negative-colors: 1 of 3 values of diffusecolor, down to -1.5" in text


def test_run_time_type_checks_of_axffit_and_the_plugin_go_together(tmp_path):
    """jaxtyping refuses to instrument a package that is imported; the plugin's own modules do not count."""
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    (tmp_path / "test_it.py").write_text(
        "import pytest, jaxtyping, numpy as np\n"
        "from axffit.frames import dot\n"
        "def test_it():\n"
        "    with pytest.raises(jaxtyping.TypeCheckError):\n"
        "        dot('a', 'b')\n"
    )
    code, text = pytest_in(tmp_path, "-c", "pytest.ini", "--jaxtyping-packages=axffit,beartype.beartype", "test_it.py")
    assert code == 0, text


def test_it_runs_inside_a_clone(tmp_path):
    """There the suite's settings apply: type checks, warnings as errors, another import mode."""
    file = written(tmp_path / "plain.axf", plain(diffusecolor=constant(-1.5, 0.5, 0.5)))
    code, text = pytest_in(PROJECT, "--pyargs", "axffit.testing", "--axf", file, "-k", "horizon or negative-colors")
    assert code == 0, text
    assert "2 passed" in text
    assert "plain: negative colors, read as 0: 1 of 3 values of diffusecolor, down to -1.5" in text


@pytest.mark.slow
def test_every_bundled_material_passes(tmp_path):
    """One run for all, as materials of one kind share their compilations."""
    files = [option for path in sorted(DATA.glob("*/*.axf")) for option in ("--axf", str(path))]
    targets = [option for name in TARGETS for option in ("--axf-target", name)]
    code, text = run(tmp_path, *files, *targets, "--axf-texels", "4", timeout=600)
    assert code == 0, text
    assert "failed" not in text
