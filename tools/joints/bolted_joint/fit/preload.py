"""Fit of the bolted joint to stiffness or resonance frequency as a function of the preload.

The joint is the spring of an oscillator with one degree of freedom; with elastic sides it includes members
and bolts. A structure in series is optional:

    1/K = 1/K_joint(preload) + 1/K_series,        f = sqrt(K/mass)/(2 pi).

K_joint is nearly a power of the preload P, `K_N ~ P^(D/(3-D))` for D below 1.5 and `~ P` above. So a curve
of two preloads or more determines two parameters: the exponent (D, below about 1.5) and the level, the factor
of the power. The level depends on G, on the moduli and weakly on H: G is fitted, the others keep their start
values. A_0 has no effect, because the law depends on loads, not on pressures. In the law `roughness` h sets
the level, in the law `table` table.factor; the exponent of both is fixed. One preload determines the level
alone. A resonance frequency determines only K/mass: without a stated mass the fit adjusts `mass` and keeps G,
h or table.factor.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.bolted_joint.bolts import LIFT_OFF_OVER_FULL_STIFFNESS
from jointfmu.joints.bolted_joint.law import AnyBoltedJoint, preload_pressure, working_preload
from jointfmu.joints.bolted_joint.variables import MODELS
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.mechanics.footprint.bolts import PressureSource, pressure_distribution
from jointfmu.mechanics.footprint.distribution import MergedDistribution
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array
from jointfmu.quantity.units import UnitSizes, conversion_factor, unit_sizes

from ....common import columns
from ....inputs.fitting.least_squares import (
    FitSolution,
    Unknown,
    parameter_covariance,
    select_start_values,
    solve_least_squares,
)
from ....inputs.fitting.measurement import COLUMN_SYNONYMS
from ....inputs.fitting.outcome import (
    RMS_HEIGHT_PARAMETER,
    DerivedFitValues,
    FitPlot,
    FitResult,
    build_fitted_file,
    find_undetermined_parameters,
    make_fit_unknowns,
    note_residual_correlation,
)
from ....run.engine import ParametricJoint

SERIES_STIFFNESS_NAME = "series_stiffness"
"""Unknown that is not a parameter of the joint: stiffness [N/m] of the structure in series."""
COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "preload": unit_sizes("N", "kN"),
    "stiffness": unit_sizes("N/m", "N/um", "kN/mm", "N/mm"),
    "frequency": unit_sizes("Hz", "kHz"),
}
"""Columns of a file of the fit, with their units."""
MAX_ROUGHNESS_OVER_START_VALUE = 10.0
"""Fitted roughness over that of the start file [1], above which it is no roughness: the range of a process
(ASME B46.1) is about a factor of 4 on each side of its mean."""
MIN_STATISTICAL_DEGREES_OF_FREEDOM = 2
"""Number of points in excess of the unknowns [1], from which the fit estimates the noise of a point."""
ASSUMED_RELATIVE_NOISE = {"stiffness": 0.05, "frequency": 0.005}
"""{quantity: relative standard deviation [1] of a point}, assumed if too few points are left for an
estimate."""
MAX_TREND_PROBABILITY = 0.01
"""Probability [1] that noise alone makes the trend of the residuals over the preload, below which the trend
is an error of the law."""
DEFAULT_FITTED_PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "zhao2018": ("surface.G", "surface.D"),
    "roughness": ("h",),
    "table": ("table.factor",),
}
"""{law: parameters to fit}: for the stiffness level, and for the exponent if the law has one."""
START_VALUES: Mapping[str, tuple[float, ...]] = {
    "surface.D": (1.25, 1.42, 1.6),
    "surface.G": tuple(1.21e-8 * np.logspace(-3.0, 3.0, 7)),
    "h": (1e-7, 1e-6, 1e-5),
    "table.factor": (0.1, 1.0, 10.0),
}
"""{parameter: further start values of the search}, in addition to the values of the start file."""


BOLTED_JOINT_FOR_FITS = ParametricJoint(MODELS[0])
"""Evaluations of the joint with elastic sides, at trial values of the fitted parameters."""


def compute_joint_stiffness(
    joint_parameters: AnyBoltedJoint, preload: Array, motion_direction: str = "normal"
) -> Array:
    """Stiffness (n) [N/m] of the tightened joint at preloads (n) [N], equal to the output of the FMU.

    motion_direction : "normal" (K_zz) or "tangential" (K_xx)
    """
    if joint_parameters.has_elastic_members:
        complete = BOLTED_JOINT_FOR_FITS.open_with_parameters(joint_parameters)
        columns = complete.evaluate_path({"preload": preload}, restart_at_each_point=True).variable_columns
        return columns["K_zz" if motion_direction == "normal" else "K_xx"]
    shape = merged_normalised_pressure(joint_parameters.pattern)
    p = preload_pressure(joint_parameters, shape, preload, 0.0)
    curve = tabulate_approach(joint_parameters)
    k, _ = stiffness_curve(joint_parameters, np.maximum(p, curve.closing_end_pressure))
    closing = p < curve.closing_end_pressure  # here the curve, not the law, defines the stiffness
    k[closing] = curve.derivatives(curve.inverse(p[closing]), 1)[1]
    normal = joint_parameters.A_0 * np.sum(shape.area_share * k, axis=-1)
    if motion_direction == "normal":
        pulling = np.where(
            working_preload(joint_parameters, preload) > 0.0, 1.0, LIFT_OFF_OVER_FULL_STIFFNESS
        )
        return np.asarray(normal + joint_parameters.n_bolts * joint_parameters.bolt_stiffness * pulling)
    return np.asarray(joint_parameters.shear_stiffness_ratio() * normal)


def describe_series_remedy(start_file: ParameterFile, is_series_known: bool) -> str:
    """What to do if bodies in series with the joint make the measured stiffness too small, as text.

    is_series_known : whether the series stiffness is stated or fitted
    """
    if is_series_known:
        return "check the series stiffness"
    members = "" if start_file.values.has_elastic_members else "start from a file with sides = elastic, or "
    return f"{members}state --series-stiffness, or fit it (--free ... {SERIES_STIFFNESS_NAME})"


def note_large_roughness(
    start_file: ParameterFile, solution: FitSolution, is_series_known: bool
) -> list[str]:
    """Note for the user if the fitted roughness is far above that of the start file; else an empty list.

    Then the compliance of bodies in series with the joint counts as roughness.

    is_series_known : whether the series stiffness is stated or fitted
    """
    fitted, start = (
        values.get(RMS_HEIGHT_PARAMETER, 0.0) for values in (solution.values, start_file.values_by_name)
    )
    if fitted <= MAX_ROUGHNESS_OVER_START_VALUE * start:
        return []
    return [
        f"{RMS_HEIGHT_PARAMETER} = {1e6 * fitted:.3g} um is {fitted / start:.3g} times that of the start "
        f"file, {1e6 * start:.3g} um: members or structure in series with the joint probably count as "
        f"roughness; {describe_series_remedy(start_file, is_series_known)}"
    ]


def make_embedding_fact(start_file: ParameterFile, preload: float | None = None) -> DerivedFitValues:
    """Fact of a fit: force that clamps the joint, if embedding reduces the preload; else empty.

    preload : of each bolt in the test [N]; None: several preloads, the fact is the embedding
    """
    embedding = float(start_file.values.embedding)
    if not embedding:
        return {}
    if preload is None:
        text = "subtracted from each preload: the force that clamps the joint in the fit"
        return {"embedding": (embedding, "N", text)}
    text = f"per bolt, of the fit: preload {preload:g} N minus embedding {embedding:.5g} N of the start file"
    return {"clamping_force": (float(working_preload(start_file.values, preload)), "N", text)}


@cache
def merged_normalised_pressure(pressure_source: PressureSource) -> MergedDistribution:
    """Contact pressure over mean pressure [1] without a moment, with nodes of equal pressure merged."""
    return pressure_distribution(pressure_source).merge_nodes(keeps_moment_pressure=False)


def fit(
    data_path: str | Path,
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    *,
    direction: str = "normal",
    modal_mass: float | None = None,
    series_stiffness: float | None = None,
) -> FitResult:
    """Fit a file with the columns preload (of each bolt) and stiffness or frequency (COLUMN_UNITS).

    Parameters
    ----------
    start_parameters : parameters of the joint to start from
    fitted_names     : names to fit; None: those of DEFAULT_FITTED_PARAMETERS. For frequencies without
                       `modal_mass`, `mass` replaces the stiffness level. For one preload: the level alone.
    direction        : direction of the motion, "normal" or "tangential"
    modal_mass       : [kg] mass that vibrates on the joint, for frequencies; replaces `mass`
    series_stiffness : [N/m] of the structure, in series; None: rigid, unless it is among the names

    Raises ValueError with a one-line message for a bad file, unit or value, or a name that cannot be fitted.
    Raises RuntimeError if the fit does not converge.
    """
    curve = _read_preload_curve(Path(data_path))
    if start_parameters is None:
        raise ValueError(
            "the joint to start from is missing; state its parameter file (--params), as jointfmu new "
            "writes it"
        )
    file = _set_modal_mass(start_parameters, curve, modal_mass, series_stiffness)
    is_mass_fitted = curve.quantity_name == "frequency" and modal_mass is None
    level, *exponent = DEFAULT_FITTED_PARAMETERS[file.law]
    if curve.different_preload_count == 1:
        exponent = []
    names = list(
        fitted_names if fitted_names is not None else (*exponent, "mass" if is_mass_fitted else level)
    )

    def predict_measured_values(parameter_values: Mapping[str, float]) -> Array:
        """Stiffness or frequency at the measured preloads, with values of the fitted parameters."""
        own = {name: value for name, value in parameter_values.items() if name != SERIES_STIFFNESS_NAME}
        joint = replace(file, origins={}, sources={}).with_values(own, "calibration", "fit").values
        return curve.predict_quantity(
            joint, parameter_values.get(SERIES_STIFFNESS_NAME, series_stiffness), direction
        )

    def logarithmic_error(parameter_values: Mapping[str, float]) -> Array:
        """Logarithm of predicted over measured values (n) [1]."""
        return np.log(predict_measured_values(parameter_values) / curve.measured_values)

    if curve.different_preload_count < len(names) <= 2:
        raise ValueError(
            f"{data_path}: has {curve.different_preload_count} different preloads, too few for "
            f"{' and '.join(names)}: at least {len(names)} are needed"
        )
    unknowns = _find_start_values(file, names, curve, logarithmic_error)
    solution, is_noise_assumed = _solve_fit(unknowns, logarithmic_error, curve)
    own = {name: value for name, value in solution.values.items() if name != SERIES_STIFFNESS_NAME}
    span = f"preload {curve.preloads[0]:g} to {curve.preloads[-1]:g} N, {direction} {curve.quantity_name}"
    result = build_fitted_file(
        file, own, "calibration", Path(data_path).name, span, find_undetermined_parameters(solution)
    )
    stiffness = solution.values.get(SERIES_STIFFNESS_NAME, series_stiffness)
    margin = 0.5 * curve.preloads[0] if curve.different_preload_count == 1 else 0.0
    grid = np.linspace(curve.preloads[0] - margin, curve.preloads[-1] + margin, 200)
    finer = replace(curve, preloads=grid, measured_values=np.ones_like(grid))
    unit, size = (
        ("Hz", 1.0) if curve.quantity_name == "frequency" else ("N/um", conversion_factor("N/m", "N/um"))
    )
    kN = COLUMN_UNITS["preload"]["kN"]
    picture = FitPlot(
        measured_x=curve.preloads / kN,
        measured_y=curve.measured_values * size,
        misfit=100.0 * np.expm1(-solution.residuals),
        law_curve=(grid / kN, finer.predict_quantity(result.values, stiffness, direction) * size),
        axis_labels=("preload of each bolt [kN]", f"{curve.quantity_name} [{unit}]", "data / law - 1 [%]"),
    )
    notes = [] if is_noise_assumed else note_residual_correlation(solution.residuals, "curve")
    if is_noise_assumed:
        notes.append(_describe_assumed_noise(curve, solution))
    is_series_known = series_stiffness is not None or SERIES_STIFFNESS_NAME in names
    notes += _note_wrong_exponent(curve, solution, describe_series_remedy(file, is_series_known))
    if curve.different_preload_count == 1 and DEFAULT_FITTED_PARAMETERS[file.law][1:]:
        notes.append(
            f"one preload does not determine the exponent: {DEFAULT_FITTED_PARAMETERS[file.law][1]} keeps "
            "its value; measure at a second preload to fit it"
        )
    if is_mass_fitted and "mass" in names and level not in names:
        notes.append(
            f"frequencies determine K/mass only: mass is fitted, and {level} keeps its value; state the "
            f"modal mass to fit {level}"
        )
    notes += note_large_roughness(file, solution, is_series_known)
    facts = make_embedding_fact(file) | _summarise_fit(curve, solution)
    return FitResult(result, solution, facts, [picture], notes=notes)


@dataclass(frozen=True, slots=True)
class PreloadCurve:
    """Measured stiffness or frequency as a function of the preload.

    quantity_name   : "stiffness" [N/m] or "frequency" [Hz]
    preloads        : (n) [N] of each bolt, ascending
    measured_values : (n) measured values
    """

    quantity_name: str
    preloads: Array
    measured_values: Array

    @property
    def preload_exponent(self) -> float:
        """Exponent [1] of the power of the preload with which the measured quantity grows.

        The curve must have at least two different preloads.
        """
        return float(np.polyfit(np.log(self.preloads), np.log(self.measured_values), 1)[0])

    def law_exponent(self, fit_residuals: Array) -> float:
        """Exponent [1] of the power of the preload with which the quantity grows by the fitted law.

        fit_residuals : (n) [1] logarithms of fitted over measured values
        """
        return self.preload_exponent + float(np.polyfit(np.log(self.preloads), fit_residuals, 1)[0])

    @property
    def different_preload_count(self) -> int:
        """Number of different preloads."""
        return int(np.unique(self.preloads).size)

    def predict_quantity(
        self, joint_parameters: AnyBoltedJoint, series_stiffness: float | None, motion_direction: str
    ) -> Array:
        """Predict stiffness or frequency (n) of a joint at the preloads."""
        K = compute_joint_stiffness(joint_parameters, self.preloads, motion_direction)
        K = K if series_stiffness is None else 1.0 / (1.0 / K + 1.0 / series_stiffness)
        return K if self.quantity_name == "stiffness" else np.sqrt(K / joint_parameters.mass) / (2.0 * np.pi)


def _read_preload_curve(data_path: Path) -> PreloadCurve:
    """Read and check a measured curve: stiffness or frequency over preload."""
    table = columns.read_columns(data_path, COLUMN_UNITS, 1, COLUMN_SYNONYMS)
    preload = table.require_column("preload", COLUMN_UNITS)
    quantities = [name for name in ("stiffness", "frequency") if name in table.values_by_name]
    if len(quantities) != 1:
        have = "both" if quantities else "neither"
        choice = {name: COLUMN_UNITS[name] for name in ("stiffness", "frequency")}
        raise ValueError(
            f"{data_path}: has {have} of stiffness and frequency, its columns are "
            f"{', '.join(columns.read_column_names(data_path))}; expected one of "
            f"{columns.format_expected_heading(choice)}: the frequency is that of one mode"
        )
    table.check_positive_columns(("preload", quantities[0]), COLUMN_UNITS)
    order = np.argsort(preload, kind="stable")
    preload, value = preload[order], table.values_by_name[quantities[0]][order]
    curve = PreloadCurve(quantities[0], preload, value)
    if curve.different_preload_count > 1 and curve.preload_exponent <= 0.0:
        raise ValueError(
            f"{data_path}: the {quantities[0]} falls with the preload, with the power "
            f"{curve.preload_exponent:.2g}; expected a rise: check the columns"
        )
    return curve


def _solve_fit(
    unknowns: Sequence[Unknown],
    logarithmic_error: Callable[[Mapping[str, float]], Array],
    preload_curve: PreloadCurve,
) -> tuple[FitSolution, bool]:
    """Solve the least-squares fit of stiffness or frequency over preload.

    The measurement noise is assumed if there are at most two unknowns and few points: it is then the value of
    ASSUMED_RELATIVE_NOISE, or the noise of the residuals if that is larger. Otherwise the noise follows from
    the residuals.
    """
    degrees_of_freedom = preload_curve.preloads.size - len(unknowns)
    if len(unknowns) > 2 or degrees_of_freedom >= MIN_STATISTICAL_DEGREES_OF_FREEDOM:
        return solve_least_squares(unknowns, logarithmic_error), False
    assumed_noise = ASSUMED_RELATIVE_NOISE[preload_curve.quantity_name]
    solution = solve_least_squares(unknowns, logarithmic_error, residual_deviation=assumed_noise)
    if degrees_of_freedom < 1:
        return solution, True
    noise = float(np.sqrt(solution.residuals @ solution.residuals / degrees_of_freedom))
    noise = max(noise, assumed_noise)
    return replace(solution, noise=noise, covariance=parameter_covariance(solution.jacobian, noise)), True


def _describe_assumed_noise(preload_curve: PreloadCurve, solution: FitSolution) -> str:
    """Describe the noise of a fit to few points, as a note for the user."""
    count, quantity = preload_curve.preloads.size, preload_curve.quantity_name
    points = "one point is" if count == 1 else f"{count} points are"
    assumed_noise = ASSUMED_RELATIVE_NOISE[quantity]
    source = (
        f"assume {100.0 * assumed_noise:g} % for each {quantity}"
        if solution.noise <= assumed_noise
        else f"assume the misfit of the fit, {100.0 * solution.noise:.2g} %"
    )
    return (
        f"{points} too few to find the scatter: the intervals, and the judgement of which values are "
        f"determined, {source}"
    )


def _note_wrong_exponent(preload_curve: PreloadCurve, solution: FitSolution, series_remedy: str) -> list[str]:
    """Note for the user if the quantity grows with another power of the preload than by the law; else empty.

    series_remedy : what to do if bodies in series with the joint are the reason
    """
    from scipy.stats import linregress  # slow to import, and most commands import this module

    if preload_curve.different_preload_count < 2:
        return []
    if preload_curve.preloads.size == 2:
        is_trend = solution.noise > ASSUMED_RELATIVE_NOISE[preload_curve.quantity_name]
    else:
        trend = linregress(np.log(preload_curve.preloads), solution.residuals)
        is_trend = bool(trend.pvalue < MAX_TREND_PROBABILITY)
    if not is_trend:
        return []
    measured, law = preload_curve.preload_exponent, preload_curve.law_exponent(solution.residuals)
    reason = (
        f"members or structure in series with the joint may be the reason; {series_remedy}"
        if law > measured
        else "the law cannot follow the data"
    )
    return [
        f"the {preload_curve.quantity_name} grows with the power {measured:.3g} of the preload, by the "
        f"fitted law with {law:.3g}: {reason}"
    ]


def _set_modal_mass(
    start_parameters: ParameterFile,
    preload_curve: PreloadCurve,
    modal_mass: float | None,
    series_stiffness: float | None,
) -> ParameterFile:
    """Set the parameter `mass` of the start parameters to the modal mass [kg] of the test, if it is stated.

    Raises ValueError for a mass or a series stiffness [N/m] that is not positive, and for a mass if the file
    has stiffnesses.
    """
    for name, value, unit in (
        ("modal mass", modal_mass, "kg"),
        ("series stiffness", series_stiffness, "N/m"),
    ):
        if value is not None and not 0.0 < value < np.inf:
            raise ValueError(f"{name} = {value:g} {unit} is outside (0, inf)")
    if modal_mass is None:
        return start_parameters
    if preload_curve.quantity_name == "stiffness":
        raise ValueError(
            f"modal mass = {modal_mass:g} kg is for frequencies, but the file has stiffnesses; leave it out"
        )
    return start_parameters.with_values(
        {"mass": modal_mass}, "user", "modal mass stated with the frequencies"
    )


def _find_start_values(
    parameter_file: ParameterFile,
    fitted_names: Sequence[str],
    preload_curve: PreloadCurve,
    logarithmic_error: Callable[[Mapping[str, float]], Array],
) -> Sequence[Unknown]:
    """Unknowns of the fit, each with the start value of smallest error out of several."""
    parameters = make_fit_unknowns(
        parameter_file,
        [name for name in fitted_names if name != SERIES_STIFFNESS_NAME],
        {},
        (SERIES_STIFFNESS_NAME,),
    )
    level = (
        preload_curve.measured_values[-1]
        if preload_curve.quantity_name == "stiffness"
        else (2.0 * np.pi * preload_curve.measured_values[-1]) ** 2 * parameter_file.values.mass
    )
    parameters += [Unknown(SERIES_STIFFNESS_NAME, "N/m", 3.0 * float(level), 0.0, np.inf)] * (
        SERIES_STIFFNESS_NAME in fitted_names
    )

    def evaluate_start_error(parameter_values: dict[str, float]) -> tuple[Mapping[str, float], float]:
        """Compute the sum of squares of ln(computed/measured frequency) for start values.

        If the mass is fitted, it is first scaled such that the mean of these logarithms is 0.
        """
        errors = logarithmic_error(parameter_values)
        if "mass" in parameter_values:
            parameter_values["mass"] *= float(np.exp(2.0 * np.mean(errors)))
            errors = errors - np.mean(errors)
        return parameter_values, float(errors @ errors)

    return select_start_values(parameters, START_VALUES, evaluate_start_error)


def _summarise_fit(preload_curve: PreloadCurve, fit_solution: FitSolution) -> DerivedFitValues:
    """Summarise the fit: largest error, noise, exponent of the preload."""
    power = {}
    if preload_curve.different_preload_count > 1:
        text = f"of the preload with which the {preload_curve.quantity_name} grows"
        power["power"] = (preload_curve.preload_exponent, "1", f"{text}, measured")
        power["power_law"] = (preload_curve.law_exponent(fit_solution.residuals), "1", "of the fitted law")
    return {
        "points": (float(preload_curve.preloads.size), "1", "points used"),
        **power,
        "noise": (fit_solution.noise, "1", "relative standard deviation of a point about the fitted law"),
        "largest_misfit": (float(np.max(np.abs(fit_solution.residuals))), "1", "relative"),
    }
