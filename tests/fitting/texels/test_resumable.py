"""A stack of images becomes maps; a run killed at any moment goes on to the same bits; another run is refused."""

import json
import os
import signal
import subprocess
import sys
import time

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from axffit import axf
from axffit.errors import InputError
from axffit.fitting.texels import resumable
from axffit.fitting.texels.batch import Outcome
from axffit.fitting.texels.noise import Noise
from axffit.fitting.texels.problem import TexelModel
from axffit.fitting.texels.results import as_material, images, summary
from axffit.fitting.texels.resumable import fit_stack
from axffit.fitting.texels.stack import read_stack
from axffit.fitting.texels.synthetic import made, true_maps
from axffit.textures.files import exr
from tests.fitting.texels.stacks import write_image, write_stack

MODEL = TexelModel(normal=False)
NOISE = Noise(0.01, 1e-5, known=True)
SHAPE = (8, 12)
CHUNK, LANES = 16, 16


@pytest.fixture(scope="module")
def texels():
    return made(MODEL, SHAPE[0] * SHAPE[1], images=24)


@pytest.fixture(scope="module")
def table(tmp_path_factory, texels):
    return write_stack(tmp_path_factory.mktemp("stack"), texels, SHAPE)


def fitted(table, work, **changed):
    options = {"model": MODEL, "noise": NOISE, "chunk": CHUNK, "lanes": LANES} | changed
    return fit_stack(read_stack(table), work=work, **options)


@pytest.fixture(scope="module")
def whole(table, tmp_path_factory):
    return fitted(table, tmp_path_factory.mktemp("whole"))


def bits(maps):
    arrays = [*maps.values.values(), *maps.errors.values(), maps.chi_square, maps.outcome]
    return [array.tobytes() for array in arrays]


def test_the_maps_are_the_truth_within_their_errors(whole, texels):
    assert (whole.outcome == Outcome.CONVERGED).all()
    for name, truth in true_maps(MODEL, texels).items():
        off = (whole.values[name] - truth.T.reshape(*SHAPE, -1)) / whole.errors[name]
        assert np.abs(off).max() < 5.5, name
    assert np.median(whole.chi_square) == pytest.approx(1.0, abs=0.1)


class Killed(BaseException):
    """Nothing catches it."""


@pytest.mark.parametrize("moment", range(1, 9))
def test_a_run_cut_off_at_any_file_goes_on_to_the_same_bits(table, tmp_path, whole, monkeypatch, moment):
    """Between writing the n-th file and giving it its name: manifest, pixels, six chunks."""
    replace, calls = os.replace, []

    def cut(*paths):
        calls.append(paths)
        if len(calls) == moment:
            raise Killed
        replace(*paths)

    monkeypatch.setattr(resumable.os, "replace", cut)
    with pytest.raises(Killed):
        fitted(table, tmp_path)
    monkeypatch.undo()
    assert len(list(tmp_path.glob("chunk_*"))) == max(0, moment - 3)
    assert bits(fitted(table, tmp_path)) == bits(whole)


RUN = """
import sys
import jax
jax.config.update("jax_enable_x64", True)
from pathlib import Path
from tests.fitting.texels.test_resumable import fitted
fitted(Path(sys.argv[1]), Path(sys.argv[2]))
"""


@pytest.mark.slow
def test_a_process_killed_half_way_leaves_what_goes_on_to_the_same_bits(table, tmp_path, whole):
    run = subprocess.Popen([sys.executable, "-c", RUN, str(table), str(tmp_path)])
    try:
        while run.poll() is None and len(list(tmp_path.glob("chunk_*"))) < 2:
            time.sleep(0.002)
        run.send_signal(signal.SIGKILL)
    finally:
        run.wait()
    assert (tmp_path / "chunk_00001.npy").exists()
    assert bits(fitted(table, tmp_path)) == bits(whole)


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"model": TexelModel("ward", normal=False)}, "model"),
        ({"noise": Noise(0.02)}, "noise"),
        ({"chunk": 32}, "chunk"),
    ],
    ids=["model", "noise", "chunk"],
)
def test_a_folder_of_another_run_is_refused(table, tmp_path, changed, named):
    resumable._agree(
        tmp_path / "manifest.json", resumable._manifest(read_stack(table), MODEL, NOISE, (*SHAPE, 3), CHUNK, LANES)
    )
    with pytest.raises(InputError, match=f"holds a run with other {named}; give the same ones"):
        fitted(table, tmp_path, **changed)


def test_other_pixels_and_a_spoilt_manifest_are_refused(table, tmp_path, texels):
    work = tmp_path / "work"
    work.mkdir()
    other = write_stack(tmp_path / "stack", texels, SHAPE)
    resumable._agree(
        work / "manifest.json", resumable._manifest(read_stack(other), MODEL, NOISE, (*SHAPE, 3), CHUNK, LANES)
    )
    write_image(other.parent / "image_03.exr", np.ones((*SHAPE, 3)))
    with pytest.raises(InputError, match="holds a run with other inputs"):
        fitted(other, work)
    (work / "manifest.json").write_text("[]")
    with pytest.raises(InputError, match="is no manifest of a run"):
        fitted(other, work)


def test_too_few_images_and_images_of_two_sizes_are_refused(tmp_path, texels):
    table = write_stack(tmp_path / "stack", texels, SHAPE)
    lines = table.read_text().splitlines()
    table.write_text("\n".join(lines[:3]))
    with pytest.raises(InputError, match="2 images of 3 channels for 7 parameters"):
        fitted(table, tmp_path / "few")
    table.write_text("\n".join(lines))
    write_image(table.parent / "image_05.exr", np.ones((3, 4, 3)))
    with pytest.raises(InputError, match=r"image_05.exr: is \(3, 4, 3\), the first image \(8, 12, 3\)"):
        fitted(table, tmp_path / "sizes")
    assert not (tmp_path / "sizes" / "pixels.f32").exists()


def test_the_material_reflects_what_was_fitted(whole, texels, tmp_path):
    material = as_material(whole, MODEL, name="made", size_mm=(12.0, 8.0), metadata={"note": "synthetic"})
    axf.write(tmp_path / "made.axf", material)
    surface = axf.to_brdf(axf.read(tmp_path / "made.axf").material("made"))
    wi, wo = (jnp.asarray(side, jnp.float32) for side in (texels.wi, texels.wo))
    flat = eqx.filter_vmap(eqx.filter_vmap(lambda brdf: brdf.evaluate(wi, wo)))
    values = np.asarray(flat(surface)) * texels.wi[:, 2:]
    measured = np.asarray(texels.samples.values).transpose(2, 1, 0).reshape(values.shape)
    assert np.sqrt(np.mean((values / measured - 1) ** 2)) == pytest.approx(0.01 * np.sqrt(1 - 7 / 72), rel=0.03)


def test_images_hold_the_maps(whole, tmp_path):
    for name, write in images(whole).items():
        write(tmp_path / name)
    stored = exr.read(tmp_path / "diffusecolor_stderr.exr")
    np.testing.assert_array_equal(
        stored.number_format.decode(stored.levels[0]), whole.errors["diffusecolor"].astype(np.float32)
    )
    assert {path.name for path in tmp_path.iterdir()} == {
        *(f"{name}{end}.exr" for name in whole.values for end in ("", "_stderr")),
        "chi_square.exr",
        "outcome.exr",
    }
    content = json.loads(json.dumps(summary(whole)))
    assert content["outcomes"]["CONVERGED"] == content["texels"] == 96
    assert content["maps"]["specularlobe"]["determined_share"] == 1.0
