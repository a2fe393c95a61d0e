import numpy as np
import pytest

from axffit.measured import Measurements, Wavelengths

UP = np.array([[0.0, 0.0, 1.0]])


def make(n=4, **changes):
    fields = {
        "wi": np.repeat(UP, n, 0),
        "wo": np.repeat(UP, n, 0),
        "values": np.ones((n, 3)),
        "valid": np.ones(n, bool),
        "weights": np.arange(1.0, n + 1),
    }
    return Measurements(**(fields | changes))


def test_weights_are_scaled_to_sum_to_one_and_keep_their_ratios():
    measurements = make()
    np.testing.assert_allclose(measurements.weights, [0.1, 0.2, 0.3, 0.4])
    np.testing.assert_allclose(measurements.select(np.array([0, 3])).weights, [0.2, 0.8])


def test_samples_without_a_number_or_below_the_horizon_are_invalid():
    values = np.ones((4, 3))
    values[1, 2] = np.nan
    wo = np.repeat(UP, 4, 0)
    wo[2] = [0.0, 0.6, -0.8]
    sigma = np.ones((4, 3))
    sigma[3] = 0.0
    assert make(values=values, wo=wo, sigma=sigma).valid.tolist() == [True, False, False, False]


def test_negative_values_of_valid_samples_are_counted():
    values = np.ones((4, 3))
    values[0, :2] = -1.0
    values[1] = -1.0
    assert make(values=values, valid=np.array([True, False, True, True])).negative_count == 2


@pytest.mark.parametrize(
    "changes",
    [
        {"wi": np.repeat(UP, 3, 0)},
        {"wo": 2.0 * np.repeat(UP, 4, 0)},
        {"values": np.ones(4)},
        {"sigma": np.ones((4, 1))},
        {"weights": -np.ones(4)},
        {"weights": np.zeros(4)},
        {"channels": Wavelengths(np.array([400.0, 500.0]))},
    ],
    ids=["count", "unit length", "channels missing", "sigma", "negative weights", "zero weights", "wavelengths"],
)
def test_fields_that_do_not_fit_each_other_are_refused(changes):
    with pytest.raises(ValueError, match=r"expected|unit length|one standard|weights|wavelengths"):
        make(**changes)
