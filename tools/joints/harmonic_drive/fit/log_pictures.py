"""Pictures of a fit to a robot's log: friction and residuals over speed, time and temperature."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Protocol

import numpy as np

from jointfmu.quantity.units import KELVIN_AT_ZERO

from ....fitting.least_squares import Array
from ....fitting.outcome import Picture
from .log_samples import Samples

MILLI = 1e3
_FRICTION, _MISFIT = "friction at the motor [mN m]", "log - law [mN m]"
_UNLOADED, _WARMTH = "friction without load [mN m]", "temperature [degrees C]"


class FrictionLaw(Protocol):
    """A fit: friction and torque at samples, friction without load at speeds and a temperature."""

    def torque(self, samples: Samples) -> tuple[Array, Array]: ...

    def unloaded(self, dq: Array, temperature: float) -> Array: ...


def pictures(samples: Samples, law: FrictionLaw) -> Iterator[Picture]:
    """Over the speed of the joint, the time, the temperature, as far as the log has them."""
    braked, torque = law.torque(samples)
    misfit = samples.torque - torque
    measured = braked + misfit
    yield _over_speed(samples, law, misfit)
    if samples.dynamic.any():
        rows = np.flatnonzero(samples.dynamic)
        time = samples.time[rows]
        yield _picture(time, measured[rows], misfit[rows], (time, braked[rows]), "time [s]")
    if (known := np.flatnonzero(np.isfinite(samples.temperature))).size:
        warmth = samples.temperature[known] - KELVIN_AT_ZERO
        ends = np.array([warmth.min(), warmth.max()])
        over, rest = measured[known] / braked[known], MILLI * misfit[known]
        yield Picture(warmth, over, rest, (ends, np.ones(2)), (_WARMTH, "friction, log over law", _MISFIT))


def _over_speed(samples: Samples, law: FrictionLaw, misfit: Array) -> Picture:
    """Without load, at the median of the temperatures; held-out rows of a table are marked."""
    fastest = float(np.max(np.abs(samples.dq)))
    speed = np.linspace(-fastest, fastest, 400)
    known = samples.temperature[np.isfinite(samples.temperature)]
    usual = float(np.median(known)) if known.size else np.nan
    y, line = law.unloaded(samples.dq, usual) + misfit, (speed, law.unloaded(speed, usual))
    picture = _picture(samples.dq, y, misfit, line, "speed of the joint [rad/s]")
    marks = None if samples.dynamic.any() else samples.later
    return replace(picture, labels=(picture.labels[0], _UNLOADED, _MISFIT), marks=marks)


def _picture(x: Array, y: Array, misfit: Array, line: tuple[Array, Array], label: str) -> Picture:
    """Torques in mN m; a line through many samples in their order."""
    return Picture(x, MILLI * y, MILLI * misfit, (line[0], MILLI * line[1]), (label, _FRICTION, _MISFIT))
