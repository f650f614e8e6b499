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
from ....inputs.fitting.least_squares import Solution, Unknown, covariance, select_start, solve
from ....inputs.fitting.outcome import (
    FitFacts,
    FitPlot,
    FitResult,
    correlation_note,
    fitted_parameters,
    make_unknowns,
)
from ....run.engine import VariableJoint

SERIES_STIFFNESS_NAME = "series_stiffness"
"""Unknown that is not a parameter of the joint: stiffness [N/m] of the structure in series."""
COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "preload": unit_sizes("N", "kN"),
    "stiffness": unit_sizes("N/m", "N/um", "kN/mm", "N/mm"),
    "frequency": unit_sizes("Hz", "kHz"),
}
"""Columns of a file of the fit, with their units."""
MIN_DEGREES_OF_FREEDOM = 2
"""Number of points in excess of the unknowns [1], from which the fit estimates the noise of a point."""
ASSUMED_NOISE = 0.05
"""Relative standard deviation [1] of a point, assumed if there are too few points to estimate it."""
FITTED_PARAMETERS: Mapping[str, tuple[str, ...]] = {
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


COMPLETE_JOINT_ENGINES = VariableJoint(MODELS[0])
"""Evaluations of the joint with elastic sides, at trial values of the fitted parameters."""


def joint_stiffness(joint: AnyBoltedJoint, preload: Array, direction: str = "normal") -> Array:
    """Stiffness (n) [N/m] of the tightened joint at preloads (n) [N], equal to the output of the FMU.

    direction : "normal" (K_zz) or "tangential" (K_xx)
    """
    if joint.has_elastic_members:
        complete = COMPLETE_JOINT_ENGINES.with_parameters(joint)
        columns = complete.follow({"preload": preload}, each_from_rest=True).columns
        return columns["K_zz" if direction == "normal" else "K_xx"]
    shape = merged_normalised_pressure(joint.pattern)
    p = preload_pressure(joint, shape, preload, 0.0)
    curve = tabulate_approach(joint)
    k, _ = stiffness_curve(joint, np.maximum(p, curve.closing_end_load))
    closing = p < curve.closing_end_load  # below this pressure the curve, not the law, defines the stiffness
    k[closing] = curve.derivatives(curve.inverse(p[closing]), 1)[1]
    normal = joint.A_0 * np.sum(shape.area_share * k, axis=-1)
    if direction == "normal":
        pulling = np.where(working_preload(joint, preload) > 0.0, 1.0, LIFT_OFF_OVER_FULL_STIFFNESS)
        return np.asarray(normal + joint.n_bolts * joint.bolt_stiffness * pulling)
    return np.asarray(joint.shear_stiffness_ratio() * normal)


@cache
def merged_normalised_pressure(pressure_source: PressureSource) -> MergedDistribution:
    """Normalised pressure distribution without a moment, with nodes of equal pressure merged."""
    return pressure_distribution(pressure_source).merge_nodes(keeps_moment_pressure=False)


def fit(
    path: str | Path,
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
    fitted_names     : names to fit; None: those of FITTED_PARAMETERS, with `mass` instead of the level for
                       frequencies without `modal_mass`; for one preload the level alone
    direction        : direction of the motion, "normal" or "tangential"
    modal_mass       : [kg] mass that vibrates on the joint, for frequencies; replaces `mass`
    series_stiffness : [N/m] of the structure, in series; None: rigid, unless it is among the names

    Raises ValueError with a one-line message for a bad file, unit or value, or a name that cannot be fitted.
    Raises RuntimeError if the fit does not converge.
    """
    curve = _read_curve(Path(path))
    if start_parameters is None:
        raise ValueError(
            "the joint to start from is missing; state its parameter file (--params), as jointfmu new "
            "writes it"
        )
    file = _set_modal_mass(start_parameters, curve, modal_mass, series_stiffness)
    is_mass_fitted = curve.quantity_name == "frequency" and modal_mass is None
    level, *exponent = FITTED_PARAMETERS[file.law]
    if curve.preload_count == 1:
        exponent = []
    names = list(
        fitted_names if fitted_names is not None else (*exponent, "mass" if is_mass_fitted else level)
    )

    def predict(parameter_values: Mapping[str, float]) -> Array:
        """Stiffness or frequency at the measured preloads, with values of the fitted parameters."""
        own = {name: value for name, value in parameter_values.items() if name != SERIES_STIFFNESS_NAME}
        joint = replace(file, origins={}, sources={}).with_values(own, "calibration", "fit").values
        return curve.predict(joint, parameter_values.get(SERIES_STIFFNESS_NAME, series_stiffness), direction)

    def logarithmic_error(parameter_values: Mapping[str, float]) -> Array:
        """Logarithm of predicted over measured values (n) [1]."""
        return np.log(predict(parameter_values) / curve.measured_values)

    if curve.preload_count < len(names) <= 2:
        raise ValueError(
            f"{path}: has {curve.preload_count} different preloads, too few for {' and '.join(names)}: at "
            f"least {len(names)} are needed"
        )
    unknowns = _find_start_values(file, names, curve, logarithmic_error)
    solution, is_noise_assumed = _solve(unknowns, logarithmic_error, curve)
    own = {name: value for name, value in solution.values.items() if name != SERIES_STIFFNESS_NAME}
    span = f"preload {curve.preload[0]:g} to {curve.preload[-1]:g} N, {direction} {curve.quantity_name}"
    result = fitted_parameters(file, own, "calibration", Path(path).name, span)
    stiffness = solution.values.get(SERIES_STIFFNESS_NAME, series_stiffness)
    margin = 0.5 * curve.preload[0] if curve.preload_count == 1 else 0.0
    grid = np.linspace(curve.preload[0] - margin, curve.preload[-1] + margin, 200)
    finer = replace(curve, preload=grid, measured_values=np.ones_like(grid))
    unit, size = (
        ("Hz", 1.0) if curve.quantity_name == "frequency" else ("N/um", conversion_factor("N/m", "N/um"))
    )
    kN = COLUMN_UNITS["preload"]["kN"]
    picture = FitPlot(
        measured_x=curve.preload / kN,
        measured_y=curve.measured_values * size,
        misfit=100.0 * np.expm1(-solution.residuals),
        law_curve=(grid / kN, finer.predict(result.values, stiffness, direction) * size),
        axis_labels=("preload of each bolt [kN]", f"{curve.quantity_name} [{unit}]", "data / law - 1 [%]"),
    )
    notes = [] if is_noise_assumed else correlation_note(solution.residuals, "curve")
    if is_noise_assumed:
        notes.append(
            f"the scatter of a point is not known from {curve.preload.size}: the intervals are those of "
            f"{solution.noise:.0%} for each point"
        )
    if curve.preload_count == 1 and FITTED_PARAMETERS[file.law][1:]:
        notes.append(
            f"one preload determines the level alone: {FITTED_PARAMETERS[file.law][1]}, which gives the "
            "exponent, is kept; measure at a second preload to fit it"
        )
    if is_mass_fitted and "mass" in names and level not in names:
        notes.append(
            f"frequencies without a stated mass give K/mass only: the level is in mass, {level} is kept; "
            f"state the modal mass to fit {level}"
        )
    return FitResult(result, solution, _fit_facts(curve, solution), [picture], notes=notes)


@dataclass(frozen=True, slots=True)
class PreloadCurve:
    """Measured stiffness or frequency as a function of the preload.

    quantity_name   : "stiffness" [N/m] or "frequency" [Hz]
    preload         : (n) [N] of each bolt, ascending
    measured_values : (n) measured values
    """

    quantity_name: str
    preload: Array
    measured_values: Array

    @property
    def power(self) -> float:
        """Exponent [1] of the power of the preload with which the measured quantity grows.

        The curve needs at least two different preloads.
        """
        return float(np.polyfit(np.log(self.preload), np.log(self.measured_values), 1)[0])

    @property
    def preload_count(self) -> int:
        """Number of different preloads."""
        return int(np.unique(self.preload).size)

    def predict(self, joint: AnyBoltedJoint, series_stiffness: float | None, direction: str) -> Array:
        """Predict the quantity (n) for a joint, with an optional stiffness [N/m] in series."""
        K = joint_stiffness(joint, self.preload, direction)
        K = K if series_stiffness is None else 1.0 / (1.0 / K + 1.0 / series_stiffness)
        return K if self.quantity_name == "stiffness" else np.sqrt(K / joint.mass) / (2.0 * np.pi)


def _read_curve(path: Path) -> PreloadCurve:
    """Read and check a measured curve: stiffness or frequency over preload."""
    table = columns.read_columns(path, COLUMN_UNITS, 1)
    preload = table.require_column("preload", COLUMN_UNITS)
    quantities = [name for name in ("stiffness", "frequency") if name in table.columns]
    if len(quantities) != 1:
        have = "both" if quantities else "neither"
        choice = {name: COLUMN_UNITS[name] for name in ("stiffness", "frequency")}
        raise ValueError(
            f"{path}: has {have} of stiffness and frequency; expected one: {columns.format_heading(choice)}"
        )
    table.check_positive(("preload", quantities[0]), COLUMN_UNITS)
    order = np.argsort(preload, kind="stable")
    preload, value = preload[order], table.columns[quantities[0]][order]
    curve = PreloadCurve(quantities[0], preload, value)
    if curve.preload_count > 1 and curve.power <= 0.0:
        raise ValueError(
            f"{path}: the {quantities[0]} does not rise with the preload (power {curve.power:.2g})"
        )
    return curve


def _solve(
    unknowns: Sequence[Unknown],
    logarithmic_error: Callable[[Mapping[str, float]], Array],
    preload_curve: PreloadCurve,
) -> tuple[Solution, bool]:
    """Solve the fit. Returns the solution, and whether the noise of a point is assumed.

    The noise is assumed if there are at most two unknowns and few points: it is then ASSUMED_NOISE, or the
    noise of the residuals if that is larger. Otherwise the noise follows from the residuals.
    """
    degrees_of_freedom = preload_curve.preload.size - len(unknowns)
    if len(unknowns) > 2 or degrees_of_freedom >= MIN_DEGREES_OF_FREEDOM:
        return solve(unknowns, logarithmic_error), False
    solution = solve(unknowns, logarithmic_error, noise=ASSUMED_NOISE)
    if degrees_of_freedom < 1:
        return solution, True
    noise = float(np.sqrt(solution.residuals @ solution.residuals / degrees_of_freedom))
    noise = max(noise, ASSUMED_NOISE)
    return replace(solution, noise=noise, covariance=covariance(solution.jacobian, noise)), True


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
            f"modal mass = {modal_mass:g} kg is stated, but the file has stiffnesses, no frequencies"
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
    parameters = make_unknowns(
        parameter_file, [name for name in fitted_names if name != SERIES_STIFFNESS_NAME], {}
    )
    level = (
        preload_curve.measured_values[-1]
        if preload_curve.quantity_name == "stiffness"
        else (2.0 * np.pi * preload_curve.measured_values[-1]) ** 2 * parameter_file.values.mass
    )
    parameters += [Unknown(SERIES_STIFFNESS_NAME, "N/m", 3.0 * float(level), 0.0, np.inf)] * (
        SERIES_STIFFNESS_NAME in fitted_names
    )

    def evaluate_start(parameter_values: dict[str, float]) -> tuple[Mapping[str, float], float]:
        """Scale the mass, if it is fitted, to the mean frequency. Returns values and squared error."""
        errors = logarithmic_error(parameter_values)
        if "mass" in parameter_values:
            parameter_values["mass"] *= float(np.exp(2.0 * np.mean(errors)))
            errors = errors - np.mean(errors)
        return parameter_values, float(errors @ errors)

    return select_start(parameters, START_VALUES, evaluate_start)


def _fit_facts(preload_curve: PreloadCurve, solution: Solution) -> FitFacts:
    """Facts about the fit: largest error, noise, exponent of the preload."""
    power = {}
    if preload_curve.preload_count > 1:
        text = f"of the preload with which the {preload_curve.quantity_name} grows"
        power["power"] = (preload_curve.power, "1", text)
    return {
        "points": (float(preload_curve.preload.size), "1", "points used"),
        **power,
        "noise": (solution.noise, "1", "relative standard deviation of a point about the fitted law"),
        "largest_misfit": (float(np.max(np.abs(solution.residuals))), "1", "relative"),
    }
