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
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default

from .computed import CalibrationFit, published_numbers
from .reference import Point, read_points


def calibrate(start: ParameterFile) -> ParameterFile:
    """The parameter set with its calibrated values fitted anew.

    Raises ValueError if the joint has no calibration points, RuntimeError if a point is not met.
    """
    kind = KINDS[start.joint]
    own = published_numbers(kind)
    if not own.calibration:
        some = [name for name in KINDS if published_numbers(KINDS[name]).calibration]
        raise ValueError(f"joint = {start.joint!r} has no calibration points; allowed are {', '.join(some)}")
    known = {p.id: p for paper in own.papers for p in read_points(paper) if p.role == "calibration"}
    for fit in own.calibration:
        start = _solve(start, fit, [known[name] for name in fit.points])
    return start


def _solve(start: ParameterFile, fit: CalibrationFit, calibration_points: Sequence[Point]) -> ParameterFile:
    names = list(fit.unknowns)
    source = "fitted to " + ", ".join(point.id for point in calibration_points)

    def at(logs: Any) -> ParameterFile:
        values = dict(zip(names, np.exp(logs).tolist(), strict=True))
        return start.with_values(values, "calibration", source)

    residuals = _residuals(at, published_numbers(KINDS[start.joint]).observables, calibration_points)
    first = np.log(list(fit.unknowns.values()))
    solution = least_squares(residuals, first, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=400)
    worst = float(np.max(np.abs(solution.fun)))
    if worst > 1e-8:
        raise RuntimeError(
            f"calibration of {', '.join(names)} does not meet a calibration point: deviation {worst:.2g}"
        )
    return at(solution.x)


def _residuals(
    parameters_at: Callable[[object], ParameterFile],
    observables: Mapping[str, Callable[..., float | bool]],
    calibration_points: Sequence[Point],
) -> Callable[[object], list[float]]:
    def residuals(logs: object) -> list[float]:
        values = parameters_at(logs).values
        return [observables[p.quantity](values, **p.where) / p.value - 1.0 for p in calibration_points]

    return residuals


if __name__ == "__main__":
    print(format_parameter_file(calibrate(load_default(sys.argv[1]))), end="")
