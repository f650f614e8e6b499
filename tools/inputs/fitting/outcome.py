"""Result of a fit: parameter file, identifiability of the parameters, warnings, plots.

The singular values of the Jacobian (in the logarithms) over the noise are the reciprocal standard deviations
of independent combinations `prod name^exponent`. A parameter or combination counts as determined
if its standard deviation does not exceed its limit. The limit is MAX_PARAMETER_DEVIATION, or a tenth of the
interval of the parameter if that is smaller (both in logarithms).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.contact.roughness import MAX_ROUGHNESS_HEIGHT
from jointfmu.files.timestamp import get_build_time
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Interval, flatten_fields

from ...common import plots
from ...common.names import find_similar_names
from .least_squares import FitSolution, Unknown

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MAX_PARAMETER_DEVIATION = 0.2
"""Standard deviation of the logarithm of a parameter [1], up to which it counts as determined: about 20 %."""
MAX_DEVIATION_OVER_INTERVAL = 0.1
"""Standard deviation over the length of the parameter's interval, both in logarithms [1], up to which a
parameter counts as determined."""
MIN_OVER_MAX_EXPONENT = 0.01
"""Exponent over the largest exponent of a combination [1], below which the parameter is not named in it,
unless its uncertainty alone would exceed that of the combination."""
MIN_OVER_MAX_SINGULAR_VALUE = 1e-5
"""Singular value over the largest [1], below which it counts as zero: accuracy of the finite differences."""


@dataclass(frozen=True, slots=True)
class ParameterCombination:
    """Product of powers of fitted parameters, statistically independent of the other combinations.

    exponents          : {name: exponent}, the largest is 1; the base is the parameter, for a parameter of any
                         sign exp(parameter/scale)
    relative_deviation : relative standard deviation [1]; infinite if the data contain no information about it
    is_determined      : whether the standard deviation is within the limit
    parameter_scales   : {name: scale with its unit} of the parameters of any sign
    """

    exponents: Mapping[str, float]
    relative_deviation: float
    is_determined: bool
    parameter_scales: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """Text of the combination, as in `E^1 nu^-0.5`."""
        factors = {
            name: f"exp({name}/{self.parameter_scales[name]})" if name in self.parameter_scales else name
            for name in self.exponents
        }
        return " ".join(
            factors[name] if power == 1.0 else f"{factors[name]}^{power:.2g}"
            for name, power in self.exponents.items()
        )


def max_deviation_of_determined_parameter(unknown: Unknown) -> float:
    """Limit [1] of the standard deviation of ln(parameter), up to which a parameter counts as determined."""
    if unknown.parameter_scale or unknown.lower_bound <= 0.0 or not np.isfinite(unknown.upper_bound):
        return MAX_PARAMETER_DEVIATION
    return min(
        MAX_PARAMETER_DEVIATION,
        MAX_DEVIATION_OVER_INTERVAL * float(np.log(unknown.upper_bound / unknown.lower_bound)),
    )


def find_parameter_combinations(solution: FitSolution) -> list[ParameterCombination]:
    """Statistically independent combinations of the parameters of a solution, best determined first."""
    limits = np.array([max_deviation_of_determined_parameter(u) for u in solution.unknowns])
    deviations = np.array([*solution.relative_deviations.values()])
    _, s, rows = np.linalg.svd(solution.jacobian * limits, full_matrices=False)
    independent = []
    for value, row in zip(s, rows, strict=True):
        powers = row / limits  # ln of the combination is row . (ln x / limits)
        largest = powers[np.argmax(np.abs(row))]
        has_no_effect = value <= MIN_OVER_MAX_SINGULAR_VALUE * s[0]
        deviation = np.inf if has_no_effect else solution.noise / value
        share = np.abs(row) / np.max(np.abs(row))
        significant = (share >= MIN_OVER_MAX_EXPONENT) | (
            (share >= MIN_OVER_MAX_SINGULAR_VALUE) & (np.abs(powers) * deviations >= deviation)
        )
        exponents = {
            u.parameter_name: float(p / largest)
            for u, p, is_named in zip(solution.unknowns, powers, significant, strict=True)
            if is_named
        }
        independent.append(
            ParameterCombination(
                exponents,
                float(deviation / abs(largest)),
                bool(deviation <= 1.0),
                {
                    u.parameter_name: f"{u.parameter_scale:.3g} {u.si_unit}"
                    for u in solution.unknowns
                    if u.parameter_scale
                },
            )
        )
    return independent


def find_undetermined_parameters(solution: FitSolution) -> list[str]:
    """Names of the parameters that the data do not determine, or that are on a bound."""
    without_effect = {
        name
        for c in find_parameter_combinations(solution)
        if not np.isfinite(c.relative_deviation)
        for name in c.exponents
    }
    return [
        u.parameter_name
        for u in solution.unknowns
        if solution.relative_deviations[u.parameter_name] > max_deviation_of_determined_parameter(u)
        or u.parameter_name in solution.names_at_bound
        or u.parameter_name in without_effect
    ]


MAX_RESIDUAL_CORRELATION = 0.5
"""Correlation of neighbouring residuals [1], above which the misfit is systematic and not noise."""

MAX_MEASURED_OVER_FITTED_LOOP_AREA = 2.0
"""Measured over fitted area of the widest loop [1], or the inverse, above which a fit is rejected."""

RMS_HEIGHT_PARAMETER = "h"
"""Name of the parameter rms roughness height [m], in laws that have it."""

MAX_LAW_OVER_CONSTANT_RESIDUAL = 0.95
"""Residual of the law over residual of a constant, for held-out data [1], above which a fit is rejected."""


@dataclass(frozen=True, slots=True)
class FitPlot:
    """Contents of a plot: data, fitted curve and misfit over one abscissa, in the units of the axis labels.

    measured_x, measured_y : data (n)
    misfit                 : data minus law (n)
    law_curve              : x (m) and y (m) of the fitted law
    axis_labels            : axis labels of x, y and misfit
    highlighted_points     : mask (n) of the points to be highlighted
    other_laws             : {name: (x, y)} of the curves of other laws, for comparison
    """

    measured_x: Array
    measured_y: Array
    misfit: Array
    law_curve: tuple[Array, Array]
    axis_labels: tuple[str, str, str]
    highlighted_points: NDArray[np.bool_] | None = None
    other_laws: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)


DerivedFitValues = dict[str, tuple[float, str, str]]
"""Results {name: (value, unit, meaning)} that are no parameters."""
_REMEDY_TEXT = "fit other parameters, or add data"
"""What to do if the data do not determine the fitted parameters."""


@dataclass(frozen=True, slots=True)
class FitResult:
    """Result of a fit: fitted parameter file, solution, derived values, plots, notes.

    facts                      : {name: (value, unit, meaning)} of further values that the fit computes
    fit_plots                  : plots, drawn side by side
    notes                      : messages for the user, one line each
    confidence_intervals       : {name: ends of the 95 % confidence interval}, if they are known
    procedure_rejection_reason : reason of the fit procedure to reject the fit, as text; None: no reason
    """

    parameters: ParameterFile
    solution: FitSolution
    facts: DerivedFitValues
    fit_plots: Sequence[FitPlot]
    notes: Sequence[str] = ()
    confidence_intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    procedure_rejection_reason: str | None = None

    def list_fitted_parameters(self) -> list[dict[str, Any]]:
        """Rows of the table of fitted parameters: value, start value, unit, deviation, whether determined."""
        undetermined, deviations = (
            find_undetermined_parameters(self.solution),
            self.solution.relative_deviations,
        )
        return [
            {
                "name": u.parameter_name,
                "value": self.solution.values[u.parameter_name],
                "start": u.start_value,
                "unit": u.si_unit,
                "relative_deviation": _finite_or_none(deviations[u.parameter_name]),
                "determined": u.parameter_name not in undetermined,
                **(
                    {"interval": [*map(_finite_or_none, self.confidence_intervals[u.parameter_name])]}
                    if u.parameter_name in self.confidence_intervals
                    else {}
                ),
            }
            for u in self.solution.unknowns
        ]

    def rejection_reason(self) -> str | None:
        """Reason to reject the fit, as text; None if the fit is accepted."""
        names = [u.parameter_name for u in self.solution.unknowns]
        if self.procedure_rejection_reason:
            return self.procedure_rejection_reason
        if at_bound := self.solution.names_at_bound:
            interval = "their intervals" if at_bound[1:] else "its interval"
            return f"{', '.join(at_bound)} ended on a bound of {interval}; {_REMEDY_TEXT}"
        if (height := self.solution.values.get(RMS_HEIGHT_PARAMETER, 0.0)) > MAX_ROUGHNESS_HEIGHT:
            return (
                f"{RMS_HEIGHT_PARAMETER} = {1e6 * height:.3g} um is outside (0, "
                f"{1e6 * MAX_ROUGHNESS_HEIGHT:g}] "
                "um: too large for a roughness; check the units, and state the stiffness in series with the "
                "joint (--series-stiffness)"
            )
        count = len(find_undetermined_parameters(self.solution))
        if (
            names
            and count == len(names)
            and not any(c.is_determined for c in find_parameter_combinations(self.solution))
        ):
            if count == 1:
                return f"the data do not determine {names[0]}; {_REMEDY_TEXT}"
            return f"the data determine none of {', '.join(names)}, nor a combination of them; {_REMEDY_TEXT}"
        if "loop_area_law" in self.facts:
            measured, law = self.facts["loop_area"][0], self.facts["loop_area_law"][0]
            if (
                not measured / MAX_MEASURED_OVER_FITTED_LOOP_AREA
                <= law
                <= measured * MAX_MEASURED_OVER_FITTED_LOOP_AREA
            ):
                return (
                    f"the area of the widest loop is {measured:.3g} J measured, {law:.3g} J by the fitted "
                    f"law; allowed is a factor of {MAX_MEASURED_OVER_FITTED_LOOP_AREA:g}"
                )
        if "held_out" in self.facts:
            law, constant = self.facts["held_out"][0], self.facts["held_out_constant"][0]
            if law > MAX_LAW_OVER_CONSTANT_RESIDUAL * constant:
                return (
                    f"in the held-out part of the log, the error of the fit is {law:.3g} N.m, that of a "
                    f"constant friction torque {constant:.3g} N.m; allowed is "
                    f"{MAX_LAW_OVER_CONSTANT_RESIDUAL:g} times the error of the constant"
                )
        return None

    def warnings(self) -> list[str]:
        """Warnings, one line each: undetermined parameters, parameters on bounds, model limits, notes."""
        lines = []
        if names := find_undetermined_parameters(self.solution):
            lines.append(f"the data do not determine {', '.join(names)}: other values fit as well")
            ranked = find_parameter_combinations(self.solution)
            for combination in ranked:
                if combination.is_determined:
                    lines.append(
                        f"the combination {combination} is determined within "
                        f"{format_relative_deviation(combination.relative_deviation)}"
                    )
                elif len(combination.exponents) > 1:
                    lines.append(
                        f"the combination {combination} is not determined: "
                        f"{format_relative_deviation(combination.relative_deviation)}"
                    )
        lines += [f"{name} ended on a bound of its interval" for name in self.solution.names_at_bound]
        if self.solution.refusal_message:
            lines.append(f"the fit ended at values that the model rejects: {self.solution.refusal_message}")
        return lines + list(self.notes)

    def to_json(self) -> dict[str, Any]:
        """Result of the fit as one JSON object."""
        return {
            "joint": self.parameters.joint,
            "unknowns": self.list_fitted_parameters(),
            "correlation": [[_finite_or_none(x) for x in row] for row in self.solution.correlation.tolist()],
            "combinations": [
                {
                    "exponents": dict(combination.exponents),
                    "relative_deviation": _finite_or_none(combination.relative_deviation),
                    "determined": combination.is_determined,
                }
                for combination in find_parameter_combinations(self.solution)
            ],
            "facts": {
                name: {"value": _finite_or_none(v), "unit": unit} for name, (v, unit, _) in self.facts.items()
            },
            "warnings": self.warnings(),
            "parameters": dict(self.parameters.values_by_name),
        }


def note_residual_correlation(
    residuals: Array, quantity_name: str, neighbour_mask: NDArray[np.bool_] | slice = slice(None)
) -> list[str]:
    """Note for the user if neighbouring residuals are correlated: the law misses the data systematically.

    residuals      : (n), in the order of the measurement
    quantity_name  : name of the data in the note
    neighbour_mask : mask (n - 1) of the pairs of consecutive residuals that count as neighbours

    Returns a list of one line, or an empty list.
    """
    correlation = (
        float(np.sum((residuals[1:] * residuals[:-1])[neighbour_mask]) / np.sum(residuals**2))
        if np.any(residuals)
        else 0.0
    )
    if correlation <= MAX_RESIDUAL_CORRELATION:
        return []
    return [
        f"neighbouring residuals are correlated ({correlation:.2f}): the law deviates systematically from "
        f"the {quantity_name}, and the standard deviations are too small"
    ]


def format_relative_deviation(relative_deviation: float) -> str:
    """Format a relative standard deviation [1]: in percent, as a factor, or as "orders of magnitude"."""
    if relative_deviation < 1.0:
        return f"{100.0 * relative_deviation:.2g} %"
    return (
        f"a factor of {np.exp(relative_deviation):.2g}" if relative_deviation < 5.0 else "orders of magnitude"
    )


def _finite_or_none(number: float) -> float | None:
    """Finite value as it is; None (JSON null) for infinity and NaN."""
    return float(number) if np.isfinite(number) else None


def make_fit_unknowns(
    start_file: ParameterFile,
    fitted_names: Sequence[str],
    bounds_by_name: Mapping[str, tuple[float, float]],
    other_names: Sequence[str] = (),
) -> list[Unknown]:
    """Make the unknowns of a fit: named parameters, with values of `start_file` and declared intervals.

    bounds_by_name : {name: (low, high)} that narrow the declared intervals
    other_names    : unknowns that are no parameters of the joint, which the user may name too

    Raises ValueError for a name that the joint lacks, that is not a number, or that is given twice.
    """
    values, result = start_file.values_by_name, []
    declared = {n: f for n, f in flatten_fields(type(start_file.values)) if isinstance(values.get(n), float)}
    for name in fitted_names:
        if name not in declared:
            raise ValueError(_describe_unknown_name(name, start_file, [*declared, *other_names]))
        if fitted_names.count(name) > 1:
            raise ValueError(f"{name!r} is given twice; state it once")
        meta = declared[name].metadata
        interval = meta["interval"].intersection(Interval(*bounds_by_name.get(name, ())))
        result.append(Unknown(name, meta["unit"], float(values[name]), interval.low, interval.high))
    return result


def _describe_unknown_name(unknown_name: str, start_file: ParameterFile, allowed_names: Sequence[str]) -> str:
    """Describe a name that cannot be fitted, as error message: law that has it, or the nearest name."""
    laws = KINDS[start_file.joint].laws
    other = [law for law, cls in laws.items() if unknown_name in dict(flatten_fields(cls))]
    if other and start_file.law not in other:
        return (
            f"{unknown_name!r} is a parameter of the law {' and '.join(other)}, but {start_file.name} has "
            f"the law {start_file.law}; allowed are {', '.join(allowed_names)}"
        )
    similar = find_similar_names(unknown_name, allowed_names, 1)
    hint = f" (did you mean {similar[0]}?)" if similar else ""
    return f"{unknown_name!r} is not a parameter to fit{hint}; allowed are {', '.join(allowed_names)}"


def make_predictor(
    start_file: ParameterFile, predict_values: Callable[[Any], Array]
) -> Callable[[Mapping[str, float]], Array]:
    """Make the function {name: value} of the unknowns -> predictions; other parameters as in `start_file`.

    predict_values : function of the parameter set
    """
    return lambda values: predict_values(start_file.with_values(values, "calibration", "fit").values)


def build_fitted_file(
    start_file: ParameterFile,
    parameter_values: Mapping[str, float],
    value_origin: str,
    data_file_name: str,
    measured_range_text: str,
    undetermined_names: Sequence[str] = (),
) -> ParameterFile:
    """Copy of a parameter file with fitted values; their source states data, range and date.

    data_file_name, measured_range_text : data file and range of the data, as text
    value_origin               : kind of the source
    undetermined_names         : parameters that the data do not determine: their kind is "estimate"

    The date is today, or SOURCE_DATE_EPOCH if that environment variable is set (reproducible files).

    Raises ValueError if SOURCE_DATE_EPOCH is not a number of seconds.
    """
    today = get_build_time().date().isoformat()
    source = f"fitted to {data_file_name}, {today}, {measured_range_text}"
    undetermined = {name: parameter_values[name] for name in undetermined_names if name in parameter_values}
    file = start_file.with_values(parameter_values, value_origin, source).with_values(
        undetermined, "estimate", f"{source}; not determined: other values fit as well"
    )
    return replace(file, name=f"fitted to {data_file_name}")


def fit_figure_size(fit_result: FitResult) -> tuple[float, float]:
    """Width and height [inch] of the figure of a fit."""
    return 3.6 * (1 + len(fit_result.fit_plots)), 5.6


def draw_fit_plots(figure: "Figure", fit_result: FitResult) -> None:
    """Draw the plots of a fit side by side: data and law above, misfit below."""
    pictures = fit_result.fit_plots
    all_axes = figure.subplots(2, len(pictures), sharex="col", height_ratios=(2.4, 1.0), squeeze=False)
    for (above, below), picture in zip(all_axes.T, pictures, strict=True):
        x, y = picture.measured_x, picture.measured_y
        above.plot(*picture.law_curve, color=plots.BLUE, label="fitted law")
        for (name, line), color in zip(picture.other_laws.items(), (plots.GREEN, plots.GREY), strict=False):
            above.plot(*line, "--", color=color, lw=1.0, label=name)
        above.plot(x, y, ".", color=plots.RED, ms=4, label="data")
        below.axhline(0.0, color=plots.BLUE, lw=1.0)
        below.plot(x, picture.misfit, ".", color=plots.RED, ms=4)
        if picture.highlighted_points is not None:
            for axes, values in ((above, y), (below, picture.misfit)):
                axes.plot(
                    x[picture.highlighted_points],
                    values[picture.highlighted_points],
                    "o",
                    color=plots.RED,
                    ms=7,
                )
        above.set_ylabel(picture.axis_labels[1])
        below.set_xlabel(picture.axis_labels[0])
        below.set_ylabel(picture.axis_labels[2])
        above.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
