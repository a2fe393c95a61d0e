"""What samples are said to be worth, on samples that are known."""

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit import measured
from axffit.brdf import GGX, Lambert
from axffit.errors import InputError
from axffit.hemisphere import directional_albedo
from axffit.measured import Measurements, RGBChannels, Wavelengths, color, mbsdf
from axffit.measured.angles import direction
from axffit.measured.description import describe, schema
from tests.measured.makers import MAKERS


def on_grid(brdf, theta_count=45, azimuth_count=90):
    wi, wo, weights = mbsdf.grid_directions(theta_count, azimuth_count)
    values = np.asarray(brdf.evaluate(jnp.asarray(wi), jnp.asarray(wo)))
    return Measurements(wi, wo, values, np.ones(len(wi), bool), weights, name="made")


def test_a_diffuser_is_reciprocal_and_returns_its_albedo():
    found = describe(on_grid(Lambert(jnp.array([0.2, 0.5, 1.0]))))
    jsonschema.validate(found, schema())
    assert found["reciprocity"]["pairs"] > 80_000
    assert found["reciprocity"]["violation"] == 0
    for row in found["furnace"]:
        np.testing.assert_allclose(row["albedo"], [0.2, 0.5, 1.0], rtol=1e-5)
    assert found["values"]["negative"] == 0
    assert found["isotropic"]
    assert found["angles"]["light"] == {"least_degrees": 1.0, "largest_degrees": 89.0, "distinct": 45}


def test_the_albedo_of_a_lobe_is_its_integral_with_and_without_stated_solid_angles():
    brdf = GGX(jnp.ones(3), jnp.array([0.4, 0.4]))
    theta = np.radians(30.0)
    wo_theta = np.radians(np.arange(1.0, 90.0, 2.0))
    polar, phi = (x.ravel() for x in np.meshgrid(wo_theta, np.radians(np.arange(0, 360, 4.0)), indexing="ij"))
    wi, wo = np.broadcast_to(direction(theta, 0.3), (len(polar), 3)), direction(polar, phi + 0.3)
    values = np.asarray(brdf.evaluate(jnp.asarray(wi), jnp.asarray(wo)))
    exact = float(directional_albedo(brdf, jnp.asarray(wi[0]))[0])
    for weights in (np.sin(polar), np.ones(len(polar))):
        samples = Measurements(wi, wo, values, np.ones(len(polar), bool), weights)
        (row,) = describe(samples)["furnace"]
        assert row["incidence_degrees"] == [30, 30]
        assert row["albedo"][0] == pytest.approx(exact, rel=0.005)


def test_a_violation_of_reciprocity_is_measured():
    samples = on_grid(Lambert(jnp.full(3, 0.5)), 8, 8)
    # f times the light's cosine is not reciprocal: RMS difference over RMS, summed by hand over all pairs.
    changed = Measurements(
        samples.wi, samples.wo, samples.values * samples.wi[:, 2:], samples.valid, samples.weights, name="tilted"
    )
    cosine = np.cos((np.arange(8) + 0.5) * np.pi / 16)
    a, b = (x[np.triu_indices(8, 1)] for x in np.meshgrid(cosine, cosine))
    expected = np.sqrt(np.mean((a - b) ** 2) / np.mean(0.5 * (a**2 + b**2)))
    assert describe(changed)["reciprocity"]["violation"] == pytest.approx(expected, rel=1e-5)
    assert describe(changed)["reciprocity"]["pairs"] == 8 * 7 // 2 * 8


def test_samples_without_pairs_or_enough_directions_are_not_judged():
    wi, wo = direction(np.full(3, 0.5), np.zeros(3)), direction(np.array([0.1, 0.2, 0.3]), np.zeros(3))
    samples = Measurements(wi, wo, np.array([[-0.1], [0.2], [0.3]]), np.ones(3, bool), np.ones(3))
    found = describe(
        Measurements(wi, wo, samples.values, samples.valid, np.ones(3), channels=Wavelengths(np.array([532.0])))
    )
    jsonschema.validate(found, schema())
    assert found["reciprocity"] == {"pairs": 0, "violation": None, "largest": None}
    assert found["furnace"] == []
    assert found["values"]["negative_share"] == pytest.approx(1 / 3, rel=1e-5)
    assert found["channels"] == {"kind": "wavelengths", "nanometers": [532.0]}


def test_nothing_valid_is_described_all_the_same():
    samples = on_grid(Lambert(jnp.ones(3)), 3, 3)
    none = Measurements(samples.wi, samples.wo, samples.values, np.zeros(len(samples), bool), samples.weights)
    found = describe(none)
    jsonschema.validate(found, schema())
    assert found["valid"] == 0
    with pytest.raises(InputError, match="none of 27 samples"):
        measured.resampled(none)


@pytest.mark.parametrize(
    "name",
    # A file of UTIA has one size, 288 lights by 288 views.
    [pytest.param(x, marks=[pytest.mark.slow] if x == "paint.bin" else []) for x in MAKERS if x != "paint.binary"],
)
def test_every_format_is_described_and_shown(name, tmp_path):
    MAKERS[name](tmp_path / name)
    found = describe(measured.read(tmp_path / name))
    jsonschema.validate(found, schema())
    # The light of UTIA and the anisotropic directions of ASTM and plain CSV turn.
    assert found["isotropic"] == (name not in ("paint.bin", "paint.astm", "plain.csv"))
    brdf = measured.interpolant(tmp_path / name)
    value = brdf.evaluate(jnp.array([0.6, 0.0, 0.8]), jnp.array([0.0, 0.0, 1.0]))
    assert np.isfinite(np.asarray(value)).all()


def test_resampled_samples_are_close_to_what_was_sampled():
    brdf = GGX(jnp.ones(3), jnp.array([0.3, 0.3]))
    shown = measured.resampled(on_grid(brdf, 30, 45))
    wi, wo = (
        jnp.asarray(direction(0.5, 0.7)),
        jnp.asarray(direction(np.array([0.2, 0.6, 1.0]), np.array([3.5, 1.0, 0.7]))),
    )
    np.testing.assert_allclose(shown.evaluate(wi, wo), brdf.evaluate(wi, wo), rtol=0.2)
    np.testing.assert_allclose(shown.evaluate(wo, wi), shown.evaluate(wi, wo), rtol=1e-6)


def test_spectra_become_rgb_and_say_how():
    pytest.importorskip("colour")
    wi = np.broadcast_to(direction(0.5, 0.0), (2, 3))
    nanometers = np.arange(400.0, 701.0, 10.0)
    values = np.stack([np.full(31, 1 / np.pi), np.where(nanometers > 600, 0.3, 0.01)])
    spectral = Measurements(
        wi, wi, values, np.ones(2, bool), np.ones(2), 0.01 * np.ones((2, 31)), Wavelengths(nanometers), {"a": "b"}
    )
    rgb = measured.to_rgb(spectral)
    np.testing.assert_allclose(rgb.values[0], 1 / np.pi, rtol=1e-9)
    assert rgb.values[1, 0] > 5 * rgb.values[1, 2]
    assert rgb.channels == RGBChannels("srgb", "E")
    assert color.CONVERSION in rgb.provenance["color"]
    assert rgb.sigma is not None
    assert ((rgb.sigma > 0.001) & (rgb.sigma < 0.01)).all()
    assert measured.to_rgb(rgb) is rgb
    single = Measurements(wi, wi, values[:, :1], np.ones(2, bool), np.ones(2), channels=Wavelengths(np.array([532.0])))
    np.testing.assert_array_equal(measured.to_rgb(single).values, np.repeat(values[:, :1], 3, axis=1))
    wrong = Measurements(
        wi, wi, values[:, :2], np.ones(2, bool), np.ones(2), channels=Wavelengths(np.array([5.0, 4.0]))
    )
    with pytest.raises(InputError, match="rising"):
        measured.to_rgb(wrong)
