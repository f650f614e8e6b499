"""Stable steps that joints output, against the eigenvalues of a body and a joint in co-simulation."""

import numpy as np
import pytest

from jointfmu.mechanics.stable_steps import MAX_STABLE_STEP, largest_stable_steps, mobility


def largest(zeta, late):
    """Largest step [1] at omega = 1 with all eigenvalues of the step inside the unit circle."""

    def moved(x, v, rate, one_ago, two_ago):
        force = 2.0 * one_ago - two_ago if late else -x - 2.0 * zeta * v
        speed = v + 0.5 * h * (force - rate)  # the mend of the step before
        return [x + h * (speed + 0.5 * h * force), speed + h * force, force, -x - 2.0 * zeta * v, one_ago]

    low, high = 1e-4, 4.0
    for _ in range(40):
        h = 0.5 * (low + high)
        step = np.array([moved(*state) for state in np.eye(5)]).T
        stable = np.abs(np.linalg.eigvals(step)).max() < 1.0 + 1e-9  # a root stands at 1
        low, high = (h, high) if stable else (low, h)
    return low


@pytest.mark.parametrize("zeta", [0.005, 0.02, 0.1, 0.3, 1.0, 4.0])
def test_stable_steps_are_those_of_the_eigenvalues(zeta):
    K, J = 4e6, 0.25  # omega = 4000 rad/s
    at_once, late = largest_stable_steps(K, 2.0 * zeta * np.sqrt(K * J), mobility(J))
    assert 4e3 * at_once == pytest.approx(largest(zeta, False), rel=1e-6)
    assert 4e3 * late == pytest.approx(largest(zeta, True), rel=0.05)


def test_what_is_held_or_open_takes_any_step():
    assert largest_stable_steps(1e6, 10.0, mobility(0.0)) == (MAX_STABLE_STEP, MAX_STABLE_STEP)
    at_once, late = largest_stable_steps(np.array([0.0, -1.0]), np.zeros(2), mobility(1.0))
    np.testing.assert_array_equal(at_once, MAX_STABLE_STEP)
    np.testing.assert_array_equal(late, 0.0)
