"""Numbers as people read them."""

import math

import pytest

from axffit.report.numbers import aligned, count, number, percent, significant, with_uncertainty


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.012345, "0.0123"),
        (0.00099996, "0.00100"),
        (0.0009994, "9.99×10⁻⁴"),
        (4.88e-4, "4.88×10⁻⁴"),
        (1200.0, "1200"),
        (99999.0, "1.00×10⁵"),
        (-2.5, "−2.50"),
        (0.0, "0"),
        (-0.0, "0"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
        (math.nan, "not a number"),
        (None, "–"),
    ],
)
def test_significant(value, expected):
    assert significant(value) == expected


@pytest.mark.parametrize(
    ("value", "expected"), [(5e-4, "5×10⁻⁴"), (0.25, "0.25"), (0.0, "0"), (100.0, "100"), (1200.0, "1200"), (2.0, "2")]
)
def test_number_drops_zeros_of_the_fraction_only(value, expected):
    assert number(value) == expected


@pytest.mark.parametrize(
    ("value", "error", "expected"),
    [
        (0.10512, 0.00042, "0.10512 ± 0.00042"),
        (1.8287, 0.0264, "1.829 ± 0.026"),
        (123.4, 5.6, "123.4 ± 5.6"),
        (123.4, 56.0, "123 ± 56"),
        (1.2e-6, 3.4e-8, "(1.200 ± 0.034)×10⁻⁶"),
        (-0.5, 0.1, "−0.50 ± 0.10"),
        (0.0, 0.01, "0.000 ± 0.010"),
        (4.6, None, "4.60"),
        (4.6, math.inf, "4.60"),
    ],
)
def test_uncertainty_decides_the_last_digit(value, error, expected):
    assert with_uncertainty(value, error) == expected


def test_aligned_values_share_the_last_place():
    assert aligned([0.1042, 0.10596], 0.00042) == "0.10420; 0.10596"


def test_percent_and_count():
    assert percent(0.01234) == "1.23\u00a0%"
    assert percent(None) == "–"
    assert count(60632) == "60\u202f632"
