"""Calibration: fit of parameters that a paper does not state to its published numbers, by least squares.

Each fit has as many points as unknowns, so every point is met exactly. Only points with the role
"calibration" are used. `python -m jointfmu_tools.studies.published.calibration JOINT` prints the default
parameter file with its calibrated values fitted again.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default

from .computed import CalibrationFit, load_published_numbers
from .reference import PublishedPoint, read_points


def calibrate(start_file: ParameterFile) -> ParameterFile:
    """Fit the calibrated parameters of a joint to the published numbers again.

    Raises ValueError if the joint has no calibration points, RuntimeError if a point is not met.
    """
    kind = KINDS[start_file.joint]
    own = load_published_numbers(kind)
    if not own.calibration:
        some = [name for name in KINDS if load_published_numbers(KINDS[name]).calibration]
        raise ValueError(
            f"joint = {start_file.joint!r} has no calibration points; allowed are {', '.join(some)}"
        )
    known = {p.id: p for paper in own.papers for p in read_points(paper) if p.role == "calibration"}
    for fit in own.calibration:
        start_file = fit_unknowns(start_file, fit, [known[name] for name in fit.point_ids])
    return start_file


def fit_unknowns(
    start_file: ParameterFile, calibration_fit: CalibrationFit, calibration_points: Sequence[PublishedPoint]
) -> ParameterFile:
    """Fit the unknowns of one calibration fit to its points.

    Raises RuntimeError if a point is not met.
    """
    names = list(calibration_fit.unknowns)
    source = "fitted to " + ", ".join(point.id for point in calibration_points)

    def make_parameter_file(log_unknowns: Any) -> ParameterFile:
        """Make the parameter file with values of the unknowns, from their logarithms."""
        values = dict(zip(names, np.exp(log_unknowns).tolist(), strict=True))
        return start_file.with_values(values, "calibration", source)

    residuals = _residual_function(
        make_parameter_file,
        load_published_numbers(KINDS[start_file.joint]).observable_functions,
        calibration_points,
    )
    first = np.log(list(calibration_fit.unknowns.values()))
    solution = least_squares(residuals, first, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=400)
    worst = float(np.max(np.abs(solution.fun)))
    if worst > 1e-8:
        raise RuntimeError(
            f"calibration of {', '.join(names)} does not meet a calibration point: deviation {worst:.2g}"
        )
    return make_parameter_file(solution.x)


def _residual_function(
    make_parameter_file: Callable[[object], ParameterFile],
    observable_functions: Mapping[str, Callable[..., float | bool]],
    calibration_points: Sequence[PublishedPoint],
) -> Callable[[object], list[float]]:
    """Function of the logarithms of the unknowns: relative errors of the calibration points."""

    def residuals(log_unknowns: object) -> list[float]:
        """Relative errors of the calibration points."""
        values = make_parameter_file(log_unknowns).values
        return [
            observable_functions[p.quantity](values, **p.where) / p.value - 1.0 for p in calibration_points
        ]

    return residuals


if __name__ == "__main__":
    print(format_parameter_file(calibrate(load_default(sys.argv[1]))), end="")
