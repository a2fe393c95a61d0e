"""`axffit verify --suggest`: the table, the JSON, and what it refuses; docs/suggest.md."""

import json
import re

import jsonschema
import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch
from axffit.quantization.document import schema
from tests.conftest import PROJECT
from tests.targets.materials import ward, with_texture

pytestmark = pytest.mark.usefixtures("few_texels")

TOLERANCE = """
[textures.diffusecolor.relative]
limit = 1.0
[textures.diffusecolor.delta_e_2000]
limit = 10.0
"""


@pytest.fixture
def steel(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # Not darker than .04: 8 bits change the log of the darkest texel of `ward` by .0301, more than is tolerated.
    diffuse = np.maximum(ward(size=8).textures["diffusecolor"].data, np.float32(0.04))
    axf.write(tmp_path / "steel.axf", with_texture(ward(size=8), "diffusecolor", diffuse))
    (tmp_path / "studio.toml").write_text(TOLERANCE, encoding="utf-8")
    return "steel.axf"


def test_the_cheapest_formats_are_shown_and_written(steel, capsys):
    command = [
        "verify",
        steel,
        "--suggest",
        "--tolerance",
        "studio.toml",
        "--json",
        "verdicts.json",
        "--html",
        "a.html",
    ]
    assert dispatch([*command, "--no-pictures"]) == 0
    shown = capsys.readouterr().out
    with open("verdicts.json", encoding="utf-8") as file:
        content = json.load(file)
    jsonschema.validate(content, schema())
    suggestion = content["materials"][0]["suggestion"]
    assert re.search(r"^diffusecolor +RGBA16F +RGBA8_UNORM_SRGB +512 +256", shown, flags=re.M)
    assert suggestion["summary"] in shown
    assert suggestion["megabytes_before"] - suggestion["megabytes_after"] == pytest.approx(256e-6)
    # The outcome of the advised formats stays the last line, and what is shown without the option stays out.
    assert shown.splitlines()[-1] == content["summary"]


def test_without_the_option_nothing_is_suggested(steel, capsys):
    assert dispatch(["verify", steel, "--json", "verdicts.json"]) == 0
    assert "cheapest" not in capsys.readouterr().out
    with open("verdicts.json", encoding="utf-8") as file:
        assert "suggestion" not in json.load(file)["materials"][0]


@pytest.mark.parametrize("option", [("--packed-for", "hdrp_10"), ("--read-by", "hdrp_10"), ("--packed", "folder")])
def test_two_engines_or_foreign_textures_are_refused(steel, capsys, option):
    assert dispatch(["verify", steel, "--suggest", *option]) == 2
    assert f"leave {option[0]} out" in capsys.readouterr().err


def test_every_command_of_the_page_runs(steel, capsys):
    page = (PROJECT / "docs" / "suggest.md").read_text(encoding="utf-8")
    (commands,) = re.findall(r"```sh\n(.*?)```", page, flags=re.S)
    for line in commands.splitlines():
        assert dispatch(line.split()[1:]) in (0, 1), line
        assert "MB as advised" in capsys.readouterr().out
