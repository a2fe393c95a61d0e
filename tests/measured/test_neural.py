import jax.numpy as jnp
import numpy as np
import pytest

from axffit import measured
from axffit.errors import InputError
from axffit.measured import neural


def write(path, names, weights, **more):
    np.savez(path, names=np.asarray(names), weights=np.asarray(weights), **more)
    return path


@pytest.fixture
def weights():
    return np.random.default_rng(2).normal(0.0, 0.4, (2, 675)).astype(np.float32)


@pytest.fixture
def path(tmp_path, weights):
    return write(tmp_path / "two.npz", ["first", "second"], weights)


def network(w, wi, wo):
    """The encoding written down once more, in NumPy and step by step."""
    h = wi + wo
    h = h / np.linalg.norm(h)
    theta_h, theta_d = np.arccos(h[2]), np.arccos(np.clip(h @ wi, -1, 1))
    phi_h = np.arctan2(h[1], h[0])
    c, s = np.cos(-phi_h), np.sin(-phi_h)
    turned = np.array([c * wi[0] - s * wi[1], s * wi[0] + c * wi[1], wi[2]])
    c, s = np.cos(-theta_h), np.sin(-theta_h)
    d = np.array([c * turned[0] + s * turned[2], turned[1], -s * turned[0] + c * turned[2]])
    phi_d = np.arctan2(d[1], d[0]) % np.pi
    x = np.array(
        [np.sin(theta_h), 0.0, np.cos(theta_h)]
        + [np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)]
    )
    a = np.maximum(x @ w[:126].reshape(6, 21) + w[126:147], 0)
    a = np.maximum(a @ w[147:588].reshape(21, 21) + w[588:609], 0)
    return np.maximum(np.exp(a @ w[609:672].reshape(21, 3) + w[672:675]) - 1.0, 0.0)


def test_the_network_is_the_documented_one(path, weights):
    rng = np.random.default_rng(3)
    v = rng.normal(size=(2, 20, 3))
    v[..., 2] = np.abs(v[..., 2])
    wi, wo = v / np.linalg.norm(v, axis=-1, keepdims=True)
    brdf = measured.interpolant(path, "second")
    expected = [network(weights[1].astype(float), *pair) for pair in zip(wi, wo, strict=True)]
    np.testing.assert_allclose(
        np.asarray(brdf.evaluate(jnp.asarray(wi), jnp.asarray(wo))), expected, rtol=1e-6, atol=1e-9
    )


def test_reading_samples_the_reference_grid_by_default(path):
    measurements = measured.read(path, "first")
    grid = measured.reference_grid()
    np.testing.assert_array_equal(measurements.wi, grid.wi)
    np.testing.assert_allclose(measurements.weights, grid.weights)
    assert measurements.values.shape == (len(grid.wi), 3)
    assert measurements.name == "first"
    coarse = neural.read(path, "first", grid=measured.reference_grid(6, 5, 4))
    assert len(coarse) == len(measured.reference_grid(6, 5, 4).wi)


def test_a_file_of_one_material_needs_no_name(tmp_path, weights):
    path = write(tmp_path / "one.npz", ["only"], weights[:1])
    assert neural.read(path, grid=measured.reference_grid(4, 4, 4)).name == "only"


@pytest.mark.parametrize(("material", "message"), [(None, "several materials"), ("third", "no material 'third'")])
def test_the_choice_of_material_is_checked_and_the_choices_named(path, material, message):
    with pytest.raises(InputError, match=message) as caught:
        measured.read(path, material)
    assert "first, second" in str(caught.value)


@pytest.mark.parametrize("kind", ["truncated", "no weights", "674 weights", "objects", "infinite", "integers"])
def test_damaged_files_are_refused_in_one_line(tmp_path, path, weights, kind):
    if kind == "truncated":
        path.write_bytes(path.read_bytes()[:2000])
    elif kind == "no weights":
        np.savez(path, names=np.array(["a"]))
    elif kind == "674 weights":
        write(path, ["a", "b"], weights[:, 1:])
    elif kind == "objects":
        np.savez(path, names=np.array([{"a": 1}, None], dtype=object), weights=weights)
    elif kind == "infinite":
        write(path, ["a", "b"], np.where(weights == weights[0, 0], np.inf, weights))
    else:
        write(path, ["a", "b"], weights.astype(np.int32))
    with pytest.raises(InputError) as caught:
        measured.read(path, "a")
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_spectralon_like_paper_has_a_plausible_albedo(reference_data):
    path = reference_data("nbrdf_measured", "rgl_isotropic_nbrdf_weights.npz")
    white = measured.read(path, "paper_white_rgb")
    cosine = white.wi[:, 2]
    # Both hemispheres weigh equally: the mean of f i_z o_z over pairs of directions is albedo / (4 pi).
    albedo = 4 * np.pi * np.sum(white.weights[:, None] * white.values * (cosine * white.wo[:, 2])[:, None], axis=0)
    assert np.all((albedo > 0.5) & (albedo < 1.1))
