"""Estimates as text, and their intervals."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vibroimpact import Estimate


@pytest.mark.parametrize(
    ("value", "std", "unit", "text"),
    [
        (5.51446, 0.00045, "Hz", "5.51446(45) Hz"),
        (0.5, 0.0996, "1", "0.50(10)"),
        (12345.0, 1200.0, "N", "12300(1200) N"),
        (10.04, 1.23, "s", "10.0(1.2) s"),
        (2.5e-7, 3.1e-9, "m", "2.500(31)e-7 m"),
        (3.0, None, "m", "3 m"),
        (math.nan, None, "m", "nan m"),
        (3.0, 0.0, "m", "3(0) m"),
        (0.0, 0.00123, "m", "0.0000(12) m"),
    ],
)
def test_two_digits_of_the_uncertainty_are_shown(value, std, unit, text):
    assert str(Estimate(value, std, unit)) == text


@given(st.floats(-1e9, 1e9), st.floats(1e-9, 1e9))
def test_the_shown_value_is_within_half_a_digit_of_the_uncertainty(value, std):
    shown = str(Estimate(value, std))
    head, _, power = shown.partition("e")
    number = float(head.split("(")[0]) * 10.0 ** int(power or 0)
    # The last shown digit is one of two of the uncertainty: half of it is 5 % of it at most.
    assert abs(number - value) <= 0.0501 * std + 1e-12 * abs(value)


def test_an_interval_is_that_of_a_normal_distribution():
    low, high = Estimate(10.0, 2.0).interval(0.95)
    assert (low, high) == (pytest.approx(10 - 2 * 1.959964, rel=1e-6), pytest.approx(10 + 2 * 1.959964, rel=1e-6))


def test_without_an_uncertainty_there_is_no_interval():
    with pytest.raises(ValueError, match="not known"):
        Estimate(10.0, None).interval()
    with pytest.raises(ValueError, match="between 0 and 1"):
        Estimate(10.0, 1.0).interval(95)
