"""RGL files against Mitsuba's reader, which inverts the warp that ours samples, and laws of the warp."""

import numpy as np
import pytest

from axffit import measured
from axffit.errors import InputError
from axffit.measured import rgl, tensor_file, warp
from tests.measured.makers import rgl_fields

KINDS = {
    "isotropic, RGB": {"azimuths": 1, "wavelengths": 0},
    "isotropic, spectral": {"azimuths": 1, "wavelengths": 6},
    "anisotropic, RGB": {"azimuths": 5, "wavelengths": 0},
    "anisotropic, spectral": {"azimuths": 5, "wavelengths": 6},
}


def written(path, fields):
    tensor_file.write_fields(path, fields)
    return path


@pytest.mark.parametrize("kind", KINDS)
def test_a_made_file_is_what_mitsuba_reads(kind, tmp_path):
    mitsuba = pytest.importorskip("mitsuba", reason="needs the extra `mitsuba`")
    spectral = KINDS[kind]["wavelengths"] > 0
    mitsuba.set_variant("scalar_spectral" if spectral else "scalar_rgb")
    path = written(tmp_path / "made.bsdf", rgl_fields(**KINDS[kind]))
    samples = measured.read(path)
    theirs = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    context, surface = mitsuba.BSDFContext(), mitsuba.SurfaceInteraction3f()
    # In float32 a half vector at the pole is off by 1e-4 in sqrt(theta).
    half = samples.wi + samples.wo
    tilted = np.hypot(half[:, 0], half[:, 1]) > 1e-3 * half[:, 2]
    nodes = np.flatnonzero(samples.valid & tilted & (samples.wo[:, 2] > 0.02))
    compared = np.random.default_rng(1).choice(nodes, 400, replace=False)
    channels = [0, 2, 3, 5] if spectral else [0, 1, 2]
    if isinstance(samples.channels, measured.Wavelengths):
        surface.wavelengths = [float(samples.channels.nanometers[c]) for c in channels]
    found = []
    for wi, wo in zip(samples.wi[compared], samples.wo[compared], strict=True):
        surface.wi = mitsuba.Vector3f(*map(float, wi))
        found.append(np.array(theirs.eval(context, surface, mitsuba.Vector3f(*map(float, wo)))) / wo[2])
    np.testing.assert_allclose(np.array(found), samples.values[compared][:, channels], rtol=1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_samples_are_all_nodes_with_their_channels(kind, tmp_path):
    fields = rgl_fields(**KINDS[kind], size=8)
    samples = measured.read(written(tmp_path / "made.bsdf", fields))
    assert len(samples) == np.prod(fields["luminance"].shape)
    assert samples.values.shape[1] == (KINDS[kind]["wavelengths"] or 3)
    assert samples.provenance["description"] == "a made material"
    assert not samples.valid[samples.wo[:, 2] < rgl.LEAST_COSINE].any()


def test_weights_are_solid_angles(tmp_path):
    """The mean over half vectors of a smooth function equals the integral over the viewer's hemisphere."""
    fields = rgl_fields(size=96)
    samples = measured.read(written(tmp_path / "made.bsdf", fields))
    one = (np.abs(samples.wi[:, 2] - np.cos(fields["theta_i"][2])) < 1e-6) & samples.valid
    weights, cosine = samples.weights[one], samples.wo[one, 2]
    # Over the hemisphere the mean of cos theta is 1/2, of cos² theta 1/3.
    assert np.average(cosine, weights=weights) == pytest.approx(1 / 2, rel=0.01)
    assert np.average(cosine**2, weights=weights) == pytest.approx(1 / 3, rel=0.01)


def test_without_the_jacobian_the_color_is_the_product_itself(tmp_path):
    fields = rgl_fields(size=8) | {"jacobian": np.zeros(1, np.uint8)}
    samples = measured.read(written(tmp_path / "made.bsdf", fields))
    stored = fields["rgb"].reshape(6, 3, 64).transpose(0, 2, 1).reshape(-1, 3)
    seen = samples.valid
    np.testing.assert_allclose(samples.values[seen] * samples.wo[seen, 2:], stored[seen], rtol=1e-12)


def test_the_warp_draws_the_density_it_says():
    density = np.random.default_rng(3).uniform(0.1, 2.0, (5, 7))
    n = 400
    y, x = (a.ravel() for a in np.meshgrid(*[(np.arange(n) + 0.5) / n] * 2, indexing="ij"))
    u, v, found = warp.sample(density, x, y)
    np.testing.assert_allclose(found, warp.bilinear(density, u, v) / warp.bilinear(density, x, y).mean(), rtol=1e-4)
    # A uniform grid, warped: any function's mean is its integral against the density.
    expected = np.mean((x * y**2) * warp.bilinear(density, x, y)) / np.mean(warp.bilinear(density, x, y))
    assert np.mean(u * v**2) == pytest.approx(expected, rel=1e-4)


def test_a_constant_density_leaves_positions_where_they_are():
    x, y = np.array([0.0, 0.3, 1.0, 0.77]), np.array([0.0, 1.0, 0.5, 0.123])
    u, v, density = warp.sample(np.full((4, 3), 7.0), x, y)
    np.testing.assert_allclose([u, v, density], [x, y, np.ones(4)], atol=1e-14)


WRONG = {
    "holds no sigma": lambda f: f.pop("sigma"),
    "holds no wavelengths": lambda f: f.update(spectra=f.pop("rgb")),
    "luminance has shape": lambda f: f.update(luminance=f["luminance"][:, :-1]),
    "rgb has shape": lambda f: f.update(rgb=f["rgb"][:, :, :2]),
    "ndf has shape": lambda f: f.update(ndf=f["ndf"][None]),
    "theta_i does not rise": lambda f: f.update(theta_i=f["theta_i"][::-1].copy()),
    "theta_i reaches": lambda f: f.update(theta_i=np.degrees(f["theta_i"])),
    "not finite": lambda f: f.update(sigma=f["sigma"] * np.float32(np.nan)),
    "negative densities": lambda f: f.update(vndf=-f["vndf"]),
    "fewer than 2 x 2": lambda f: f.update(ndf=f["ndf"][:1]),
}


@pytest.mark.parametrize("message", WRONG)
def test_fields_that_disagree_are_refused(message, tmp_path):
    fields = rgl_fields(size=4)
    WRONG[message](fields)
    with pytest.raises(InputError, match=message):
        measured.read(written(tmp_path / "made.bsdf", fields))


def test_every_type_of_the_container_comes_back(tmp_path):
    fields = {text: np.arange(6, dtype=text).reshape(2, 3) for text in tensor_file.TYPES.values()}
    fields["scalar"] = np.array(2.5)
    back = tensor_file.read_fields(written(tmp_path / "a.bsdf", fields))
    assert list(back) == list(fields)
    for name, array in fields.items():
        assert back[name].dtype == array.dtype
        np.testing.assert_array_equal(back[name], array)
    with pytest.raises(ValueError, match="complex"):
        tensor_file.write_fields(tmp_path / "b.bsdf", {"a": np.zeros(2, complex)})
