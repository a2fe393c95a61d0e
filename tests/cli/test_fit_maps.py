"""`axffit fit-maps`: exit codes, maps, and the material that it writes."""

import json

import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch
from axffit.fitting.texels.problem import TexelModel
from axffit.fitting.texels.synthetic import made, true_maps
from axffit.textures.files import exr
from tests.fitting.texels.stacks import write_image, write_stack

MODEL = TexelModel(normal=False)


@pytest.fixture(scope="module")
def texels():
    return made(MODEL, 12, images=16)


def test_maps_material_and_numbers_are_written_and_the_work_is_removed(tmp_path, capsys, texels):
    table, out = write_stack(tmp_path / "cloth 1", texels, (3, 4)), tmp_path / "maps"
    numbers = tmp_path / "numbers.json"
    options = ["--flat", "--noise", "0.01", "--floor", "1e-5", "--size-mm", "20", "--json", str(numbers)]
    assert dispatch(["fit-maps", str(table), "--out", str(out), *options]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[0] == "4 x 3 texels: 12 converged"
    assert shown[1].startswith("diffusecolor   median ")
    content = json.loads(numbers.read_text())
    assert (content["width"], content["height"], content["texels"]) == (4, 3, 12)
    assert not (out / "work").exists()
    material = axf.read(out / "cloth_1.axf").material("cloth_1")
    texture = material.textures["diffusecolor"]
    assert (texture.width_mm, texture.height_mm) == (20.0, 15.0)
    stored = exr.read(out / "diffusecolor.exr")
    np.testing.assert_array_equal(stored.number_format.decode(stored.levels[0]), texture.data)
    np.testing.assert_allclose(texture.data.reshape(12, 3).T, true_maps(MODEL, texels)["diffusecolor"], rtol=0.1)


def test_what_cannot_be_used_ends_in_2_and_leaves_no_maps(tmp_path, capsys, texels):
    table = write_stack(tmp_path / "stack", texels, (3, 4))
    write_image(tmp_path / "stack" / "image_07.exr", np.ones((2, 2, 3)))
    out = tmp_path / "maps"
    for options, said in (
        ([], "image_07.exr: is (2, 2, 3), the first image (3, 4, 3)"),
        (["--lobe", "phong"], "unknown lobe 'phong'"),
        (["--noise", "-1"], "noise of -1"),
        (["--size-mm", "0"], "size of 0 mm"),
    ):
        assert dispatch(["fit-maps", str(table), "--out", str(out), "--flat", *options]) == 2
        assert said in capsys.readouterr().err
    assert not list(out.glob("*.exr"))
    assert not list(out.glob("*.axf"))
