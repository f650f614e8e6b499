"""Smooth step: its ends, and its derivatives and integral against differences."""

import numpy as np

from jointfmu.quantity import smooth_step, smooth_step_integral, smooth_step_slopes

X, H = np.linspace(-0.5, 1.5, 201), 1e-5
ROUND_OFF = 1e-15


def test_ends_and_middle() -> None:
    x = np.array([-1.0, 0.0, 0.5, 1.0, 2.0])
    slope, bend = smooth_step_slopes(x)
    np.testing.assert_allclose(smooth_step(x), [0.0, 0.0, 0.5, 1.0, 1.0], atol=ROUND_OFF)
    np.testing.assert_allclose(slope, [0.0, 0.0, 1.875, 0.0, 0.0], atol=ROUND_OFF)
    np.testing.assert_allclose(bend, np.zeros(5), atol=ROUND_OFF)


def test_slopes_and_integral_are_those_of_the_step() -> None:
    """Central differences have the error h^2/6 times the third derivative, 60 for the step and 360 for its
    derivative.

    Round-off is some 1e-16/h.
    """
    slope, bend = smooth_step_slopes(X)

    def difference(of: object) -> np.ndarray:
        return (of(X + H) - of(X - H)) / (2.0 * H)

    np.testing.assert_allclose(difference(smooth_step_integral), smooth_step(X), atol=H**2 + 1e-15 / H)
    np.testing.assert_allclose(difference(smooth_step), slope, atol=10.0 * H**2 + 1e-15 / H)
    away = (np.abs(X) > H) & (np.abs(X - 1.0) > H)  # the third derivative jumps there
    found = difference(lambda x: smooth_step_slopes(x)[0])
    np.testing.assert_allclose(found[away], bend[away], atol=60.0 * H**2 + 1e-14 / H)
