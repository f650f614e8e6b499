"""From published calibration points to the unpublished parameters, by scipy's least squares.

Each fit has as many points as unknowns, so every point is met exactly; the points' role says that
they were used. Validation points are never read here. `python -m jointfmu.calibration JOINT` prints
the default parameter file with its calibrated values fitted anew.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from .observables import OBSERVABLES
from .parameters import ParameterFile, default, dump
from .reference import Point, points


@dataclass(frozen=True, slots=True)
class Fit:
    """Unknowns with starting values and the calibration points that fix them.

    All unknowns are fitted in logarithms, so they stay positive.
    """

    unknowns: Mapping[str, float]
    points: Sequence[str]


FITS: dict[str, tuple[str, tuple[Fit, ...]]] = {
    "harmonic_drive": (
        "hu2023",
        (
            Fit(
                {
                    "zero_torque_pressure": 45e6,
                    "rated_pressure": 101e6,
                    "pair_scale": 1.5e-4,
                    "deformation_loss": 2e16,
                    "radial_deformation": 0.196e-3,
                    "eccentricity_loss": 4e11,
                },
                (
                    "K_TS.max.1",
                    "K_TS.max.5",
                    "p_max.5",
                    "K_TS.min.1",
                    "K_TS.nominal.5",
                    "K_TS.eccentricity.3",
                ),
            ),
            Fit(
                {"drive_scale": 4.0, "K_FTS0": 2e4},
                ("K_WTS.theory.0.5", "K_WTS.measured.5"),
            ),
        ),
    ),
    "bolted_joint": (
        "zhao2018",
        (
            Fit(
                {"pattern.decay_length": 0.01, "pattern.decay_exponent": 1.0},
                ("p_max.9kN", "p_between.9kN"),
            ),
        ),
    ),
}


def calibrate(start: ParameterFile) -> ParameterFile:
    """The parameter set with its calibrated values fitted anew.

    Raises ValueError if the joint has no calibration points, RuntimeError if a point is not met.
    """
    if start.joint not in FITS:
        raise ValueError(f"joint = {start.joint!r} has no calibration points; allowed are {', '.join(FITS)}")
    paper, fits = FITS[start.joint]
    published = {point.id: point for point in points(paper) if point.role == "calibration"}
    for fit in fits:
        start = _solve(start, fit, [published[name] for name in fit.points])
    return start


def _solve(start: ParameterFile, fit: Fit, chosen: Sequence[Point]) -> ParameterFile:
    names = list(fit.unknowns)
    source = "fitted to " + ", ".join(point.id for point in chosen)

    def at(logs: Any) -> ParameterFile:
        values = dict(zip(names, np.exp(logs).tolist(), strict=True))
        return start.with_values(values, "calibration", source)

    residuals = _residuals(at, chosen)
    first = np.log(list(fit.unknowns.values()))
    solution = least_squares(residuals, first, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=400)
    worst = float(np.max(np.abs(solution.fun)))
    if worst > 1e-8:
        raise RuntimeError(f"calibration of {', '.join(names)} misses a point by {worst:.2g}")
    return at(solution.x)


def _residuals(at: Callable[[Any], ParameterFile], chosen: Sequence[Point]) -> Callable[[Any], list[float]]:
    def residuals(logs: Any) -> list[float]:
        values = at(logs).values
        return [OBSERVABLES[p.quantity](values, **p.where) / p.value - 1.0 for p in chosen]

    return residuals


if __name__ == "__main__":
    print(dump(calibrate(default(sys.argv[1]))), end="")
