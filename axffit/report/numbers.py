"""Numbers as people read them: significant digits, powers of ten, uncertainties.

Text, not HTML: superscripts and the minus sign are Unicode, so that the same text serves tables, captions and plots.
"""

import math

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MISSING = "–"


def significant(value: float | None, digits: int = 3) -> str:
    """``value`` with ``digits`` significant digits; powers of ten below 10⁻³ and from 10⁵ up; "–" for None.

    >>> significant(0.012345), significant(4.88e-4), significant(1200.0), significant(0.0)
    ('0.0123', '4.88×10⁻⁴', '1200', '0')
    """
    if value is None:
        return MISSING
    if math.isnan(value):
        return "not a number"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0:
        return "0"
    mantissa, exponent = f"{abs(value):.{digits - 1}e}".split("e")
    power = int(exponent)
    sign = "−" if value < 0 else ""
    if power < -3 or power >= 5:
        return f"{sign}{mantissa}×10{str(power).translate(_SUPERSCRIPT)}"
    return sign + f"{abs(float(f'{mantissa}e{power}')):.{max(digits - 1 - power, 0)}f}"


def number(value: float | None, digits: int = 3) -> str:
    """:func:`significant` without trailing zeros, for limits and counts that are exact: 5×10⁻⁴, 0.25, 0."""
    text = significant(value, digits)
    head, times, tail = text.partition("×")
    if "." in head:
        head = head.rstrip("0").rstrip(".")
    return head + times + tail


def with_uncertainty(value: float, standard_error: float | None) -> str:
    """``value ± standard error``: the error with two significant digits, the value to the same decimal place.

    >>> with_uncertainty(0.10512, 0.00042), with_uncertainty(4.6, None)
    ('0.10512 ± 0.00042', '4.60')
    """
    if standard_error is None or not math.isfinite(standard_error) or standard_error <= 0:
        return significant(value)
    return aligned([value, standard_error], standard_error).replace(";", " ±")


def aligned(values: list[float], resolution: float) -> str:
    """Values, separated by "; ", to the decimal place where ``resolution`` > 0 has its second significant digit.

    A common power of ten stands behind parentheses where the largest value asks for one.

    >>> aligned([0.1042, 0.10596], 0.00042), aligned([1.2e-6, 3.4e-8], 3.4e-8)
    ('0.10420; 0.10596', '(1.200; 0.034)×10⁻⁶')
    """
    decimals = 1 - int(f"{resolution:.1e}".split("e")[1])
    largest = max(abs(x) for x in [*values, resolution])
    power = math.floor(math.log10(largest))
    power = power if power < -3 or power >= 5 else 0
    places = max(decimals + power, 0)
    texts = [f"{x / 10.0**power:.{places}f}".replace("-", "−") for x in values]
    joined = "; ".join(texts)
    return joined if power == 0 else f"({joined})×10{str(power).translate(_SUPERSCRIPT)}"


def percent(value: float | None, digits: int = 3) -> str:
    """A ratio as a percentage: 0.0123 -> "1.23 %"."""
    return MISSING if value is None else f"{significant(100 * value, digits)}\u00a0%"


def count(value: int) -> str:
    """A count with thin spaces between thousands: 60 632."""
    return f"{value:,}".replace(",", "\u202f")
