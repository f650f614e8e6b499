"""Intervals of declarations, limits, samples, fits and model descriptions."""

import math
import sys
from itertools import product

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointfmu.quantity import Interval, ParameterLimit

NUMBERS = st.floats(-1e300, 1e300, allow_nan=False)
ENDS = st.one_of(NUMBERS, st.sampled_from([0.0, 1.0, math.inf, -math.inf]))
INTERVALS = st.builds(Interval, ENDS, ENDS, st.booleans(), st.booleans())


@pytest.mark.parametrize(
    ("ends", "text", "inside", "outside"),
    [
        ({}, "(-inf, inf)", [-1e308, 0.0, 1e308], []),
        ({"gt": 0.0}, "(0, inf)", [5e-324, 1e308], [0.0, -1.0]),
        ({"ge": 0.0}, "[0, inf)", [0.0, -0.0, 1e308], [-5e-324]),
        ({"lt": 1.0}, "(-inf, 1)", [-1e308, math.nextafter(1.0, 0.0)], [1.0]),
        ({"gt": 0.0, "le": 1.0}, "(0, 1]", [5e-324, 1.0], [0.0, math.nextafter(1.0, 2.0)]),
        ({"ge": -1.0, "lt": 2.5}, "[-1, 2.5)", [-1.0, 2.0], [2.5, -1.5]),
        ({"ge": 3.0, "le": 3.0}, "[3, 3]", [3.0], [2.0, 4.0]),
        ({"ge": -math.inf, "le": math.inf}, "(-inf, inf)", [0.0], []),
        ({"ge": 1, "le": 1234567.0}, "[1, 1.23457e+06]", [1, 1234567], [0, 1234568]),
    ],
)
def test_text_and_membership(ends, text, inside, outside):
    interval = Interval.from_bounds(**ends)
    assert str(interval) == text
    assert [interval.contains(x) for x in inside] == [True] * len(inside)
    outside = [*outside, math.nan, math.inf, -math.inf]
    assert [interval.contains(x) for x in outside] == [False] * len(outside)
    everything = np.array([*inside, *outside])
    np.testing.assert_array_equal(interval.contains(everything), [x in inside for x in everything])


@pytest.mark.parametrize(("ends", "names"), [({"gt": 0.0, "ge": 1.0}, "gt and ge = 0.0, 1.0"),
                                             ({"lt": 2.0, "le": 2.0}, "lt and le = 2.0, 2.0")])  # fmt: skip
def test_an_end_is_given_once(ends, names):
    with pytest.raises(ValueError, match=f"^{names} are the same end; state only one$"):
        Interval.from_bounds(**ends)


def test_ends_may_be_arrays():
    """Samples of a parameter, and samples of the interval that other parameters determine, in broadcast
    shapes."""
    interval = Interval.from_bounds(ge=np.array([0.0, 1.0, np.nan]), lt=2.0)
    np.testing.assert_array_equal(interval.contains(1.0), [True, True, False])
    np.testing.assert_array_equal(
        interval.contains(np.array([[0.5], [2.0]])), [[True, False, False], [False, False, False]]
    )


def test_symbols_pass():
    x = casadi.SX.sym("x")
    assert Interval.from_bounds(gt=0.0).contains(x) is True
    assert Interval.from_bounds(gt=x).contains(-1.0) is True
    assert Interval.from_bounds(le=x * x).contains(np.inf) is True


@given(INTERVALS, INTERVALS, st.one_of(ENDS, st.just(math.nan)))
def test_the_intersection_holds_what_both_hold(one, other, number):
    both = one.intersection(other)
    places = [number, one.low, one.high, other.low, other.high]
    for x in places:
        assert both.contains(x) == (one.contains(x) and other.contains(x))
    assert both == other.intersection(one)
    assert one.intersection(Interval()) == one


@given(INTERVALS)
def test_closed_bounds_are_the_outermost_numbers_inside(interval):
    low, high = interval.closed_bounds()
    for bound, end, is_open, side in (
        (low, interval.low, interval.low_open, -math.inf),
        (high, interval.high, interval.high_open, math.inf),
    ):
        if math.isinf(end) and end == side:
            assert bound == side  # there is no end
        elif not is_open or math.isinf(end):
            assert bound == end
        elif end == 0.0:
            assert bound == -math.copysign(sys.float_info.min, side)
        else:
            assert bound != end
            assert math.nextafter(bound, side) == end


@pytest.mark.parametrize("flags", list(product([False, True], repeat=2)))
def test_infinite_ends_are_open(flags):
    interval = Interval(-math.inf, np.float64(np.inf), *flags)
    assert (interval.low_open, interval.high_open) == (True, True)
    assert interval == Interval()


@pytest.mark.parametrize(
    ("low", "high", "empty"),
    [
        (math.nan, math.inf, True),
        (0.0, math.nan, True),
        (2.1e-4, 2.1e-4 * (1.0 + 1e-9), True),
        (0.0, -1.0, True),
        (-math.inf, math.inf, False),
        (0.0, 1e-300, False),
        (-math.inf, 1.0, False),
        (1.0, 1.001, False),
    ],
)
def test_an_interval_that_shows_no_number_is_empty(low, high, empty):
    limit = ParameterLimit("w", Interval(low, high), "why")
    assert Interval(low, high).is_empty == empty
    assert not Interval(0.0, 0.0, low_open=False, high_open=False).is_empty
    text = limit.find_problem(math.nan, "m")
    assert ("leave no value for it: why" in text) == empty
    assert ("is outside" in text) != empty
