"""From published calibration points to the unpublished parameters, by scipy's least squares.

Each fit has as many points as unknowns, so every point is met exactly; the points' role says that
they were used. Validation points are never read here. `python -m jointfmu_tools.published.calibration JOINT`
prints the default parameter file with its calibrated values fitted anew.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, default, dump

from .computed import CalibrationFit, published
from .reference import Point, points


def calibrate(start: ParameterFile) -> ParameterFile:
    """The parameter set with its calibrated values fitted anew.

    Raises ValueError if the joint has no calibration points, RuntimeError if a point is not met.
    """
    kind = KINDS[start.joint]
    own = published(kind)
    if not own.calibration:
        some = [name for name in KINDS if published(KINDS[name]).calibration]
        raise ValueError(f"joint = {start.joint!r} has no calibration points; allowed are {', '.join(some)}")
    known = {p.id: p for paper in own.papers for p in points(paper) if p.role == "calibration"}
    for fit in own.calibration:
        start = _solve(start, fit, [known[name] for name in fit.points])
    return start


def _solve(start: ParameterFile, fit: CalibrationFit, chosen: Sequence[Point]) -> ParameterFile:
    names = list(fit.unknowns)
    source = "fitted to " + ", ".join(point.id for point in chosen)

    def at(logs: Any) -> ParameterFile:
        values = dict(zip(names, np.exp(logs).tolist(), strict=True))
        return start.with_values(values, "calibration", source)

    residuals = _residuals(at, published(KINDS[start.joint]).observables, chosen)
    first = np.log(list(fit.unknowns.values()))
    solution = least_squares(residuals, first, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=400)
    worst = float(np.max(np.abs(solution.fun)))
    if worst > 1e-8:
        raise RuntimeError(f"calibration of {', '.join(names)} misses a point by {worst:.2g}")
    return at(solution.x)


def _residuals(
    at: Callable[[object], ParameterFile],
    observables: Mapping[str, Callable[..., float | bool]],
    chosen: Sequence[Point],
) -> Callable[[object], list[float]]:
    def residuals(logs: object) -> list[float]:
        values = at(logs).values
        return [observables[p.quantity](values, **p.where) / p.value - 1.0 for p in chosen]

    return residuals


if __name__ == "__main__":
    print(dump(calibrate(default(sys.argv[1]))), end="")
