"""Friction of drives that print none: scaled from those that do, by size and ratio, with the scatter of that.

Without load, at the wave generator of a drive of size D and ratio R,

    starting torque = a (D/20)^p 100/R,    running torque at 2000 rev/min and R = 100 = b (D/20)^3

a, p and b by least squares in logarithms over what is printed. Dry friction goes with 1/R, as the radial
deformation of the flexspline does that every turn of the wave generator makes; of the printed drives one
alone has a ratio below 100, so that this power is not fitted. The cube is that of a rolling bearing's moment
over its diameter (Palmgren). What the running torque has beyond the starting torque is the grease's, alike
for all ratios. Both losses with load are the mean of those that are printed.

Intervals are to hold LEVEL of all single drives: Student's prediction intervals of the regressions.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEVEL = 0.95
SIZE, RATIO = 20.0, 100.0
"""To which the law refers [1]."""
POWER = 3.0
"""Of the running torque over the size [1]."""


@dataclass(frozen=True, slots=True)
class PrintedFriction:
    """What is printed of a drive: torques [N.m], losses over the torque transmitted [1]; None: it is not."""

    size: float
    ratio: float
    starting: float
    running: float | None
    load_loss: float | None
    load_loss_back: float | None


@dataclass(frozen=True, slots=True)
class Scaled:
    """A scaled number and its interval, in the unit of the number."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ScaledFriction:
    """Of one drive: starting torque and what a speed of 2000 rev/min adds [N.m], losses [1]."""

    starting: Scaled
    rise: Scaled
    load_loss: Scaled
    load_loss_back: Scaled


def scaled(size: float, ratio: float, drives: Collection[PrintedFriction]) -> ScaledFriction:
    """The friction of a drive of a size and ratio [1] from those that are known, four or more."""
    dry = np.array([(np.log(k.size / SIZE), np.log(k.starting * k.ratio / RATIO)) for k in drives])
    wet = [np.log(k.running / (k.size / SIZE) ** POWER) for k in drives if k.running is not None]
    line = np.stack([np.ones(len(dry)), dry[:, 0]], axis=1)
    usual = _torque(line, dry[:, 1], np.array([1.0, np.log(size / SIZE)]), 1.0)
    running = _torque(np.ones((len(wet), 1)), np.array(wet), np.ones(1), (size / SIZE) ** POWER)
    rise = (max(x - usual.value, 0.0) for x in (running.value, running.low, running.high))
    part = RATIO / ratio
    starting = Scaled(usual.value * part, usual.low * part, usual.high * part)
    losses = (_mean([getattr(k, name) for k in drives]) for name in ("load_loss", "load_loss_back"))
    return ScaledFriction(starting, Scaled(*rise), *losses)


def _torque(design: Array, logarithms: Array, at: Array, factor: float) -> Scaled:
    """A torque [N.m] by a law of its logarithm, times a factor."""
    value, half = _predicted(design, logarithms, at)
    return Scaled(*(factor * float(np.exp(x)) for x in (value, value - half, value + half)))


def _mean(values: Sequence[float | None]) -> Scaled:
    """The mean of what is known; the interval has nothing below zero."""
    found = np.array([value for value in values if value is not None])
    value, half = _predicted(np.ones((found.size, 1)), found, np.ones(1))
    return Scaled(value, max(value - half, 0.0), value + half)


def _predicted(design: Array, values: Array, at: Array) -> tuple[float, float]:
    """A linear law (k) through values (n) at a place, and half of the interval of a single value there."""
    from scipy.special import (
        stdtrit,  # slow to import, and commands need names of drives without their friction
    )

    law = np.linalg.lstsq(design, values)[0]
    free = values.size - law.size
    rest = values - design @ law
    spread = np.sqrt(rest @ rest / free * (1.0 + at @ np.linalg.inv(design.T @ design) @ at))
    return float(at @ law), float(stdtrit(free, 0.5 + 0.5 * LEVEL) * spread)
