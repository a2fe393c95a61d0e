"""Unit vectors: the documented means and maxima, and proven bounds against the largest angle a search finds."""

import numpy as np
import pytest

from axffit.textures import ROUNDINGS
from axffit.textures.floats import HALF
from axffit.textures.unit_vectors import UNIT_VECTORS, Components, Octahedral, RebuiltZ, Stored
from axffit.textures.unorm import Snorm, Unorm
from axffit.textures.worst_angle import angle_errors, angles_between, largest_angle, random_vectors

every_encoding = pytest.mark.parametrize("name", UNIT_VECTORS)
every_rounding = pytest.mark.parametrize("rounding", ROUNDINGS)

REFERENCE = {
    ("RGB UNORM16", "nearest_even"): (0.000660, 0.00149),
    ("RGB UNORM16", "floor"): (0.001319, 0.00299),
    ("RGB UNORM16", "device"): (0.000692, 0.00180),
    ("RGB half of n", "nearest_even"): (0.00606, 0.0228),
    ("RGB half of n", "toward_zero"): (0.00635, 0.0253),
    ("RGB half of 0.5 (n + 1)", "nearest_even"): (0.0177, 0.0475),
    ("RGB UNORM8", "nearest_even"): (0.1696, 0.385),
    ("RG UNORM8 + z", "nearest_even"): (0.468, 5.82),
    ("octahedral UNORM8", "nearest_even"): (0.337, 0.944),
}
"""Mean and largest angle in degrees of a million random normals of the hemisphere, as documented."""

MILLION = random_vectors(1_000_000, seed=11)


@pytest.mark.parametrize(("name", "rounding"), REFERENCE)
def test_documented_means_and_maxima_come_out(name, rounding):
    encoding = UNIT_VECTORS[name]
    mean, largest = REFERENCE[name, rounding]
    errors = np.degrees(angle_errors(encoding, MILLION, rounding))
    assert errors.mean() == pytest.approx(mean, rel=0.01)
    assert 0.97 * largest <= errors.max() <= np.degrees(encoding.angle_bound(rounding))


@every_rounding
@every_encoding
def test_the_bound_holds_and_is_close_to_the_largest_angle_found(name, rounding):
    encoding = UNIT_VECTORS[name]
    found, bound = largest_angle(encoding, rounding), encoding.angle_bound(rounding)
    drawn = angle_errors(encoding, MILLION[:50_000], rounding).max()
    assert max(found, drawn) <= bound
    assert bound <= (1.05 if encoding.stored.codec.bits <= 8 else 1.2) * found


@every_rounding
@every_encoding
def test_the_search_finds_at_least_what_draws_find(name, rounding):
    encoding = UNIT_VECTORS[name]
    assert angle_errors(encoding, MILLION[-50_000:], rounding).max() <= largest_angle(encoding, rounding)


@pytest.mark.parametrize(
    ("encoding", "rounding", "degrees"),
    [
        ("RGB UNORM16", "nearest_even", 0.0015143),
        ("RGB UNORM16", "floor", 0.0030286),
        ("RGB UNORM16", "device", 0.0018172),
        ("RGB UNORM8", "nearest_even", 0.3892),
        ("RGB half of n", "nearest_even", 0.0280),
    ],
)
def test_bounds_are_the_documented_ones(encoding, rounding, degrees):
    assert np.degrees(UNIT_VECTORS[encoding].angle_bound(rounding)) == pytest.approx(degrees, rel=1e-3)


@pytest.mark.parametrize(("bits", "degrees"), [(8, 0.3178), (16, 0.00124)])
def test_the_flat_normal_is_not_representable_in_unorm(bits, degrees):
    flat = np.array([[0.0, 0.0, 1.0]])
    assert np.degrees(angle_errors(UNIT_VECTORS[f"RGB UNORM{bits}"], flat)) == pytest.approx(degrees, rel=3e-3)
    assert angle_errors(UNIT_VECTORS[f"RGB SNORM{bits}"], flat) == 0.0


@every_encoding
def test_vectors_come_back_as_unit_vectors_from_every_kind_of_code(name):
    encoding = UNIT_VECTORS[name]
    codes = encoding.encode(MILLION[:1000])
    assert codes.shape == (1000, encoding.channels)
    assert np.linalg.norm(encoding.decode(codes), axis=-1) == pytest.approx(1.0, abs=1e-14)
    assert np.linalg.norm(encoding.decode(np.zeros_like(codes)), axis=-1) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("stored", [Stored(Unorm(16), offset=True), Stored(Snorm(16)), Stored(HALF)])
def test_whole_sphere_where_the_encoding_has_it(stored):
    vectors = MILLION[:20_000] * np.array([1.0, 1.0, -1.0])
    for encoding in (Components(stored), Octahedral(stored)):
        assert angle_errors(encoding, vectors).max() < 2e-3


def test_exact_components_are_the_vector_again():
    vectors = MILLION[:1000]
    for encoding in (make(Stored(HALF)) for make in (Components, RebuiltZ, Octahedral)):
        again = encoding.direction(encoding.components(vectors))
        assert angles_between(vectors, again).max() < 1e-7


def test_a_point_outside_the_disc_lies_on_the_horizon():
    encoding = UNIT_VECTORS["RG SNORM8 + z"]
    np.testing.assert_allclose(encoding.direction(np.array([0.8, 0.8])), [np.sqrt(0.5), np.sqrt(0.5), 0.0])
