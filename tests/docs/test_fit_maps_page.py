"""docs/fit-maps.md names the options, columns and files that there are."""

import re

from axffit.cli import dispatch
from axffit.fitting.texels import batch, resumable, stack, starts
from axffit.fitting.texels.batch import Outcome
from axffit.fitting.texels.maps import layout
from axffit.fitting.texels.problem import TexelModel
from tests.conftest import PROJECT

PAGE = (PROJECT / "docs" / "fit-maps.md").read_text(encoding="utf-8")


def test_options_exist(capsys):
    dispatch(["fit-maps", "--help"])
    shown = capsys.readouterr().out
    options = set(re.findall(r"--[a-z][a-z-]+", PAGE))
    assert {"--out", "--noise", "--flat", "--work"} <= options
    assert not [option for option in options if option not in shown]


def test_columns_and_files_are_all_there():
    for name in (*stack._VECTORS, *stack._ANGLES, "irradiance"):
        assert name in PAGE
    for name in layout(TexelModel(anisotropic=True, fresnel=True), 3):
        assert f"`{name}.exr`" in PAGE


def test_numbers_are_those_of_the_code():
    assert len(Outcome) == 4
    assert f"blocks of {batch.LANES} texels" in PAGE
    assert f"after {batch.ROUNDS[0]} steps goes on with the others like it, and after {batch.ROUNDS[1]} more" in PAGE
    assert f"Chunks of {resumable.CHUNK} texels" in PAGE
    assert len(starts.ROUGHNESSES) == 7
