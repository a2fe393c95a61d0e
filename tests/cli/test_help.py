"""Help is there at once, and says what a customer needs."""

import subprocess
import sys

import pytest

from axffit.cli import compare, demo, diff, dispatch, export, fit, fit_maps, import_, inspect, measured, verify

VERBS = {
    "inspect": inspect,
    "measured": measured,
    "diff": diff,
    "export": export,
    "import": import_,
    "verify": verify,
    "compare": compare,
    "fit": fit,
    "fit-maps": fit_maps,
    "demo": demo,
}
HEAVY = {"jax", "jaxlib", "optimistix", "equinox", "matplotlib", "h5py", "colour", "OpenEXR", "scipy", "numpy"}
SHOW_HEAVY = f"""
import sys
from axffit.cli import main
try:
    main(sys.argv[1:])
except SystemExit as end:
    print(end.code, sorted({HEAVY} & set(sys.modules)), file=sys.stderr)
"""


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], *([verb, "--help"] for verb in VERBS)], ids=" ".join)
def test_help_loads_no_heavy_module(arguments):
    shown = subprocess.run([sys.executable, "-c", SHOW_HEAVY, *arguments], capture_output=True, text=True, check=True)
    assert shown.stderr == "0 []\n"
    assert "axffit" in shown.stdout


@pytest.mark.parametrize("verb", VERBS)
def test_help_tells_purpose_exit_codes_and_an_example(verb, capsys):
    assert dispatch([verb, "--help"]) == 0
    shown = capsys.readouterr().out
    assert "Exit codes" in shown
    assert f"axffit {verb} " in shown.split("Example", 1)[1]
    assert VERBS[verb].HELP.split("\n", 1)[0] in shown


def test_help_of_all_names_each_verb(capsys):
    assert dispatch(["--help"]) == 0
    shown = capsys.readouterr().out
    assert not [verb for verb in VERBS if f" {verb} " not in shown]


def test_an_unknown_option_is_unusable_input(capsys):
    assert dispatch(["verify", "--colour"]) == 2
    assert "--colour" in capsys.readouterr().err


def test_examples_use_options_that_exist(capsys):
    for verb, module in VERBS.items():
        dispatch([verb, "--help"])
        options = capsys.readouterr().out.rsplit("Options", 1)[1]
        for line in module.HELP.splitlines():
            if line.startswith("  axffit "):
                for word in line.split():
                    assert not word.startswith("--") or word in options, line
