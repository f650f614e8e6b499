"""Layout of history variables: Python and C use the same positions."""

import numpy as np

from jointfmu.mechanics.history_layout import HistoryLayout

LAYOUT = HistoryLayout({"state": (), "force": (2, 3)}) | HistoryLayout({"loss": ()})


def test_parts_are_found_again() -> None:
    parts = {"state": [1.0, 2.0], "force": np.arange(12.0).reshape(2, 2, 3), "loss": 7.0}
    memory = LAYOUT.join(parts, 2)
    assert memory.shape == (2, LAYOUT.value_count)
    for name, part in LAYOUT.split(memory).items():
        np.testing.assert_array_equal(part, np.broadcast_to(parts[name], part.shape))


def test_places_are_those_of_the_first_numbers() -> None:
    counted = np.arange(float(LAYOUT.value_count))
    assert LAYOUT.first_value_indices == {name: part.flat[0] for name, part in LAYOUT.split(counted).items()}


def test_rest_is_zero() -> None:
    assert not np.any(LAYOUT.virgin_history())
    assert LAYOUT.virgin_history().shape == (8,)
