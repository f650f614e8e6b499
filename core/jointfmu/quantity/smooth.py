"""Smooth step from 0 to 1, a polynomial of fifth degree, used in Python, C and Modelica."""

import numpy as np

from .interval import Number

SMOOTH_STEP_COEFFICIENTS = (10.0, -15.0, 6.0)
"""Coefficients of r^3, r^4 and r^5 [1] in the smooth step."""


def _clip_to_unit_interval(x: Number) -> Number:
    """Clip x to the interval from 0 to 1."""
    return np.minimum(np.maximum(x, 0.0), 1.0)


def smooth_step(x: Number) -> Number:
    """Smooth step: 0 at x <= 0, 1 at x >= 1, with continuous first and second derivative."""
    r, (a, b, c) = _clip_to_unit_interval(x), SMOOTH_STEP_COEFFICIENTS
    return r * r * r * (a + r * (c * r + b))


def smooth_step_slopes(x: Number) -> tuple[Number, Number]:
    """First and second derivative of the smooth step: 30 (r - r^2)^2 and 60 (r - r^2)(1 - 2 r).

    r: x, clipped to the interval from 0 to 1.
    """
    r, steepest = _clip_to_unit_interval(x), 3.0 * SMOOTH_STEP_COEFFICIENTS[0]
    rest = r * (1.0 - r)
    return steepest * rest**2, 2.0 * steepest * rest * (1.0 - 2.0 * r)


def smooth_step_integral(x: Number) -> Number:
    """Integral of `smooth_step` from 0 to x."""
    r, (a, b, c) = _clip_to_unit_interval(x), SMOOTH_STEP_COEFFICIENTS
    return r * r * r * r * (a / 4.0 + r * (c / 6.0 * r + b / 5.0)) + np.maximum(x - 1.0, 0.0)
