"""Selection of nodes of a table: segments as long as allowed, with fixed nodes, and few evaluations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from jointfmu_tools.exchange.thinning import decimate_table


@given(reach=st.lists(st.integers(1, 40), min_size=2, max_size=60), extra=st.sets(st.integers(1, 59)))
def test_every_segment_is_as_long_as_fits(reach, extra):
    """Node i reaches `reach[i]` further, and never beyond a stop."""
    last = len(reach) - 1
    stops = {i for i in extra if i < last} | {last}
    nodes = decimate_table(stops, lambda i, j: j - i <= reach[i]).tolist()
    expected = [0]
    while expected[-1] < last:
        i = expected[-1]
        expected.append(min(i + reach[i], min(s for s in stops if s > i)))
    assert nodes == expected


def test_neighbours_join_whatever_is_said():
    np.testing.assert_array_equal(decimate_table({4}, lambda i, j: False), range(5))


@pytest.mark.parametrize("size", [10, 1000, 100_000])
def test_questions_grow_with_the_logarithm(size):
    asked = []
    nodes = decimate_table({size}, lambda i, j: not asked.append((i, j)))
    assert nodes.tolist() == [0, size]
    assert all(j - i > 1 for i, j in asked)
    # doubling finds the end, halving back closes in on it: two for each power of two
    assert len(asked) <= 2 * np.log2(size) + 2
