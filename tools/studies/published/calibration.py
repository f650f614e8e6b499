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


def fit_calibrated_parameters(start_parameter_file: ParameterFile) -> ParameterFile:
    """Repeat the fit of a joint's calibrated parameters to published numbers.

    Raises ValueError if the joint has no calibrated parameters, RuntimeError if a number is not reproduced.
    """
    kind = KINDS[start_parameter_file.joint]
    own = load_published_numbers(kind)
    if not own.calibration_fits:
        some = [name for name in KINDS if load_published_numbers(KINDS[name]).calibration_fits]
        raise ValueError(
            f"joint = {start_parameter_file.joint!r} has no calibration points; allowed are {', '.join(some)}"
        )
    known = {p.id: p for paper in own.paper_names for p in read_points(paper) if p.role == "calibration"}
    for fit in own.calibration_fits:
        start_parameter_file = fit_unknowns(
            start_parameter_file, fit, [known[name] for name in fit.point_ids]
        )
    return start_parameter_file


def fit_unknowns(
    start_parameter_file: ParameterFile,
    calibration_fit: CalibrationFit,
    calibration_points: Sequence[PublishedPoint],
) -> ParameterFile:
    """Fit the parameters of one calibration fit to its published numbers.

    Raises RuntimeError if a published number is not reproduced.
    """
    names = list(calibration_fit.start_value_by_parameter)
    source = "fitted to " + ", ".join(point.id for point in calibration_points)

    def make_parameter_file(unknown_logarithms: Any) -> ParameterFile:
        """Make the parameter file with fitted values, from the logarithms of these values."""
        values = dict(zip(names, np.exp(unknown_logarithms).tolist(), strict=True))
        return start_parameter_file.with_values(values, "calibration", source)

    residuals = _make_residual_function(
        make_parameter_file,
        load_published_numbers(KINDS[start_parameter_file.joint]).observable_functions,
        calibration_points,
    )
    first = np.log(list(calibration_fit.start_value_by_parameter.values()))
    solution = least_squares(residuals, first, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=400)
    worst = float(np.max(np.abs(solution.fun)))
    if worst > 1e-8:
        raise RuntimeError(
            f"calibration of {', '.join(names)} misses a calibration point by a relative {worst:.2g}, "
            "allowed is 1e-8"
        )
    return make_parameter_file(solution.x)


def _make_residual_function(
    make_parameter_file: Callable[[object], ParameterFile],
    observable_functions: Mapping[str, Callable[..., float | bool]],
    calibration_points: Sequence[PublishedPoint],
) -> Callable[[object], list[float]]:
    """Make the function that a fit minimises: logarithms of the fitted parameters -> relative errors."""

    def residuals(unknown_logarithms: object) -> list[float]:
        """Relative errors [1] of the computed calibration points."""
        values = make_parameter_file(unknown_logarithms).values
        return [
            observable_functions[p.quantity](values, **p.where) / p.value - 1.0 for p in calibration_points
        ]

    return residuals


if __name__ == "__main__":
    print(format_parameter_file(fit_calibrated_parameters(load_default(sys.argv[1]))), end="")
