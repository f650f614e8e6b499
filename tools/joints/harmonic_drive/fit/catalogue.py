"""Parameters of a drive from the torsional stiffness in a catalogue (K1, K2, K3, T1, T2).

Two laws. `catalogue` (`make_drive_with_catalogue_law_from_row`): three lines, taken from the row without a
fit; for comparison the law `hu2023` is fitted too. `hu2023` (`fit_contact_pair_law`): smooth law of the
contact pair of flexspline and flexible bearing. The fit meets the angle at T1, T2 and the rated torque, and
approximates the lines elsewhere up to max_torque. Its unknowns are those of a fit to a measured curve.
`torque_smoothing`, the torque below which the pressure does not yet grow, is T1, where the stiffness of the
catalogue starts to rise. It becomes a fourth unknown if three unknowns do not meet the angles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.prescribed_midline import (
    DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP,
    CatalogueDriveParameters,
)
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array

from ....inputs.catalogue import SourcedNumber
from ....inputs.fitting.least_squares import SOLUTION_WITHOUT_UNKNOWNS, FitSolution, solve_least_squares
from ....inputs.fitting.outcome import (
    DerivedFitValues,
    FitResult,
    build_fitted_file,
    make_fit_unknowns,
    make_predictor,
)
from ..catalogue import MAX_OVER_RATED_TORQUE, STIFFNESS_COLUMN_NAMES
from . import drive
from .drive import CatalogueRow, compute_stiffness, draw_stiffness_picture, draw_wind_up_picture

DEFAULT_FITTED_PARAMETERS = ("K_FTS0", "drive_scale", "zero_torque_pressure")
"""Parameters of the law `hu2023` that are fitted."""
EXTRA_FITTED_PARAMETER = "torque_smoothing"
"""Parameter that is fitted too if DEFAULT_FITTED_PARAMETERS alone do not meet the wind-up angles."""
MAX_RELATIVE_ANGLE_ERROR = 0.009
"""Largest relative error [1] of the angle at T1, T2 and the rated torque: 1 % with a margin."""
EXACT_ANGLE_STANDARD_DEVIATIONS = (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4)
"""Relative standard deviations [1] of the angle at T1, T2 and the rated torque. They are tried in turn until
the fitted angles are within MAX_RELATIVE_ANGLE_ERROR."""
OTHER_ANGLE_STANDARD_DEVIATION = 0.2
"""Relative standard deviation [1] of the angle at other torques: real drives have no corners."""


def fit(
    start_parameters: ParameterFile | None,
    fitted_names: Sequence[str] | None,
    rated_torque: float | None,
    source: str,
    ratio: float | None,
    law: str,
    **row: float,
) -> FitResult:
    """Make the parameters of a drive from a row of a catalogue.

    fitted_names : names to fit, with the law `hu2023` only; None: those of DEFAULT_FITTED_PARAMETERS
    rated_torque : [N.m]; None: the torque T2 of the row
    source       : where the row is published
    ratio        : speed ratio [1]; None: that of `start_parameters`
    law          : "catalogue" or "hu2023"
    row          : K1, K2, K3 [N.m/rad], T1, T2 [N.m]: stiffness up to T1, from T1 to T2 and above T2

    Raises ValueError for numbers outside their limits or a name that cannot be fitted, RuntimeError if no law
    `hu2023` has the wind-up angles of the row.
    """
    rated, kind = (row["T2"], "estimate") if rated_torque is None else (rated_torque, "catalogue")
    catalogue_row = CatalogueRow(**row, rated_torque=rated)
    printed = make_sourced_numbers(catalogue_row, kind, ratio, source)
    return (make_drive_with_catalogue_law_from_row if law == "catalogue" else fit_contact_pair_law)(
        catalogue_row, start_parameters, fitted_names, printed, source
    )


def make_sourced_numbers(
    catalogue_row: CatalogueRow,
    rated_torque_origin: str = "catalogue",
    speed_ratio: float | None = None,
    row_source: str = "catalogue",
) -> dict[str, SourcedNumber]:
    """Make the numbers of a catalogue row with their source: {parameter: number}.

    rated_torque_origin : origin of the rated torque: "catalogue" if it is published, else that of the
                          estimate T2
    speed_ratio         : speed ratio [1], added if it is known
    row_source          : where the row is published
    """
    origin = f"{row_source} ({catalogue_row})"
    rated = origin if rated_torque_origin == "catalogue" else "no rated torque given; T2 of the catalogue"
    numbers = {
        name: SourcedNumber(getattr(catalogue_row, name), "catalogue", origin)
        for name in STIFFNESS_COLUMN_NAMES
    }
    numbers["rated_torque"] = SourcedNumber(catalogue_row.rated_torque, rated_torque_origin, rated)
    return (
        numbers
        if speed_ratio is None
        else numbers | {"ratio": SourcedNumber(speed_ratio, "catalogue", origin)}
    )


def fit_contact_pair_law(
    catalogue_row: CatalogueRow,
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    sourced_numbers: Mapping[str, SourcedNumber] | None = None,
    row_source: str = "catalogue",
) -> FitResult:
    """Fit the smooth law of the contact pair to a row of a catalogue.

    fitted_names    : names to fit; None: DEFAULT_FITTED_PARAMETERS, and EXTRA_FITTED_PARAMETER if the others
                      do not suffice
    sourced_numbers : numbers of the row, from `make_sourced_numbers`; None: those of `catalogue_row`
    row_source      : where the row is published

    Raises ValueError for a name that cannot be fitted, RuntimeError if no law has the wind-up angles of the
    row.
    """
    sourced_numbers = sourced_numbers or make_sourced_numbers(catalogue_row)
    file = start_parameters or load_default("harmonic_drive")
    rated = sourced_numbers["rated_torque"]
    origin = sourced_numbers["T1"].value_source
    file = drive.change_rated_torque(
        file, catalogue_row.rated_torque, MAX_OVER_RATED_TORQUE, rated.value_origin, rated.value_source
    )
    if "ratio" in sourced_numbers:
        file = file.with_values({"ratio": sourced_numbers["ratio"].si_value}, "catalogue", origin)
    file = file.with_values({EXTRA_FITTED_PARAMETER: catalogue_row.T1}, "catalogue", f"T1 of {origin}")
    torque, max_torque = comparison_torques(catalogue_row, file.values.max_torque), file.values.max_torque
    choices = (
        [tuple(fitted_names)]
        if fitted_names
        else [DEFAULT_FITTED_PARAMETERS, (*DEFAULT_FITTED_PARAMETERS, EXTRA_FITTED_PARAMETER)]
    )
    file = drive.scale_stiffness(file, choices[0], torque, catalogue_row.wind_up(torque))
    solution, deviation = _fit_with_increasing_weight(catalogue_row, file, choices, torque)
    result = build_fitted_file(file, solution.values, "catalogue", origin, f"torque 0 to {max_torque:g} N.m")
    result = replace(result, name=f"fitted to {row_source}")
    errors = drive.compute_wind_up(result.values, torque) / catalogue_row.wind_up(torque) - 1.0
    worst = int(np.argmax(np.abs(errors)))
    text = f"at {torque[worst]:.3g} N.m, largest between {torque[0]:.3g} and {max_torque:g} N.m"
    facts = _angle_errors(catalogue_row, result.values, {})
    facts["angle_error_largest"] = float(errors[worst]), "1", text
    note = (
        f"standard deviations: the angle known to {100 * deviation:g} % at T1, T2 and rated torque, "
        f"{100 * OTHER_ANGLE_STANDARD_DEVIATION:g} % elsewhere"
    )
    pictures = (
        draw_wind_up_picture(catalogue_row, result.values, {}, torque),
        draw_stiffness_picture(catalogue_row, result.values, {}, max_torque),
    )
    return FitResult(
        result, solution, facts | _describe_max_torque(catalogue_row, max_torque), pictures, notes=[note]
    )


def comparison_torques(catalogue_row: CatalogueRow, max_torque: float) -> Array:
    """Torques [N.m] up to about `max_torque` at which a fit compares the law with the catalogue's wind-up."""
    ends = np.array([0.0, catalogue_row.T1, catalogue_row.T2, max(max_torque, 1.5 * catalogue_row.T2)])
    samples = [np.linspace(a, b, 7)[1:] for a, b in pairwise(ends)]
    return np.unique(np.concatenate([catalogue_row.torques_of_exact_angles, *samples]))


def _fit_with_increasing_weight(
    catalogue_row: CatalogueRow,
    parameter_file: ParameterFile,
    sets_of_unknowns: Sequence[Sequence[str]],
    comparison_torques: Array,
) -> tuple[FitSolution, float]:
    """Fit the contact pair with increasing weight of the angles at T1, T2 and rated torque, until they match.

    sets_of_unknowns : sets of unknowns to try in turn

    Returns the solution and its relative standard deviation [1] of these angles. Raises RuntimeError if no
    fit meets them.
    """
    exact, target = (
        np.isin(comparison_torques, catalogue_row.torques_of_exact_angles),
        catalogue_row.wind_up(comparison_torques),
    )
    angles = make_predictor(parameter_file, lambda joint: drive.compute_wind_up(joint, comparison_torques))
    limits = dict(drive.parameter_bounds(parameter_file)) | {"K_FTS0": (catalogue_row.K2, np.inf)}
    best = np.inf
    for names, deviation in product(sets_of_unknowns, EXACT_ANGLE_STANDARD_DEVIATIONS):
        scale = np.where(exact, deviation, OTHER_ANGLE_STANDARD_DEVIATION)
        solution = solve_least_squares(
            make_fit_unknowns(parameter_file, names, limits),
            lambda values, scale=scale: (angles(values) / target - 1.0) / scale,  # type: ignore[misc]
            residual_deviation=1.0,
            convergence_tolerance=1e-5,
        )
        worst = float(np.max(np.abs(solution.residuals * scale)[exact]))
        if worst <= MAX_RELATIVE_ANGLE_ERROR:
            return solution, deviation
        best = min(best, worst)
        parameter_file = parameter_file.with_values(
            {n: v for n, v in solution.values.items() if n not in solution.names_at_bound},
            "catalogue",
            "start",
        )
    raise RuntimeError(
        f"no law with {', '.join(sets_of_unknowns[-1])} free keeps the angle of {catalogue_row} at T1, T2 "
        f"and rated torque {catalogue_row.rated_torque:g} N.m within {100 * MAX_RELATIVE_ANGLE_ERROR:g} %: "
        f"the best misses it by {100 * best:.2g} %; use the law catalogue"
    )


CONTACT_PAIR_LAW_TEXT = "law of the contact pair"
"""Name of the law of the contact pair in plots."""


def make_drive_with_catalogue_law(
    drive_name: str,
    sourced_numbers: Mapping[str, SourcedNumber],
    start_parameters: ParameterFile | None = None,
) -> ParameterFile:
    """Make the parameters of a drive with the law `catalogue`.

    sourced_numbers  : {parameter: number with source}; other parameters are those of `start_parameters`
    start_parameters : drive with any law; None: the default drive

    Raises ValueError for a number outside its limits.
    """
    file = start_parameters or load_default("harmonic_drive")
    kept = ["corner"] if isinstance(file.values, CatalogueDriveParameters) else []
    if not (kept or "corner" in sourced_numbers):
        text = "default choice: the angle at the corners of catalogue drives within 0.4 %"
        sourced_numbers = {
            **sourced_numbers,
            "corner": SourcedNumber(DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP, "user", text),
        }
    return drive.change_law(file, CatalogueDriveParameters, drive_name, sourced_numbers, kept)


def make_drive_with_catalogue_law_from_row(
    catalogue_row: CatalogueRow,
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    sourced_numbers: Mapping[str, SourcedNumber] | None = None,
    row_source: str = "catalogue",
) -> FitResult:
    """Make a drive whose curve without hysteresis is the three lines of a catalogue row; nothing is fitted.

    Arguments as for `fit_contact_pair_law`.

    Raises ValueError if `fitted_names` has a name, and for numbers outside their limits.
    """
    if fitted_names:
        raise ValueError("the law catalogue has nothing to fit; --free is allowed with --law hu2023")
    max_torque = MAX_OVER_RATED_TORQUE * catalogue_row.rated_torque
    largest = SourcedNumber(max_torque, "estimate", f"{MAX_OVER_RATED_TORQUE:g} times rated_torque")
    file = make_drive_with_catalogue_law(
        row_source,
        {**(sourced_numbers or make_sourced_numbers(catalogue_row)), "max_torque": largest},
        start_parameters,
    )
    pair, note = _fit_contact_pair_law_or_note(
        catalogue_row, start_parameters if start_parameters and start_parameters.law == "hu2023" else None
    )
    facts = _angle_errors(catalogue_row, file.values, {"max": max_torque}) | _describe_max_torque(
        catalogue_row, max_torque
    )
    also = {}
    if pair is not None:
        also = {CONTACT_PAIR_LAW_TEXT: pair}
        facts |= _describe_contact_pair_errors(catalogue_row, pair, max_torque)
    angle = draw_wind_up_picture(
        catalogue_row, file.values, also, comparison_torques(catalogue_row, max_torque)
    )
    return FitResult(
        file,
        SOLUTION_WITHOUT_UNKNOWNS,
        facts,
        (angle, draw_stiffness_picture(catalogue_row, file.values, also, max_torque)),
        notes=note,
    )


def _fit_contact_pair_law_or_note(
    catalogue_row: CatalogueRow, start_parameters: ParameterFile | None
) -> tuple[DriveParameters | None, list[str]]:
    """Fit the contact-pair law to a catalogue row; None and a note if no fit has its wind-up angles."""
    try:
        drive: DriveParameters = fit_contact_pair_law(catalogue_row, start_parameters).parameters.values
    except RuntimeError as error:
        return None, [
            f"the {CONTACT_PAIR_LAW_TEXT} cannot be compared with the lines of the catalogue: {error}"
        ]
    return drive, []


def _angle_errors(
    catalogue_row: CatalogueRow, fitted_drive: DriveParameters, extra_torques: Mapping[str, float]
) -> DerivedFitValues:
    """Relative errors [1] of a fitted law's wind-up at T1, T2, rated torque and extra torques [N.m]."""
    facts = {}
    for name, T in {
        "T1": catalogue_row.T1,
        "T2": catalogue_row.T2,
        "rated": catalogue_row.rated_torque,
        **extra_torques,
    }.items():
        error = float(drive.compute_wind_up(fitted_drive, np.array(T)) / catalogue_row.wind_up(T)) - 1.0
        facts[f"angle_error_{name}"] = (error, "1", f"law over catalogue - 1 at {T:g} N.m")
    return facts


def _describe_max_torque(catalogue_row: CatalogueRow, max_torque: float) -> DerivedFitValues:
    """Describe the largest torque of the fitted law, max_torque, for the user."""
    text = f"{MAX_OVER_RATED_TORQUE:g} times the rated torque {catalogue_row.rated_torque:g} N.m"
    return {"max_torque": (max_torque, "N.m", text)}


def _describe_contact_pair_errors(
    catalogue_row: CatalogueRow, contact_pair_drive: DriveParameters, max_torque: float
) -> DerivedFitValues:
    """Largest errors of angle and stiffness of the contact-pair law, compared with the catalogue lines."""
    torque = np.linspace(0.0, max_torque, 401)[1:]
    angle = drive.compute_wind_up(contact_pair_drive, torque) / catalogue_row.wind_up(torque) - 1.0
    i = int(np.argmax(np.abs(angle)))
    text = f"{CONTACT_PAIR_LAW_TEXT} over catalogue - 1"
    facts = {"pair_angle_error": (float(angle[i]), "1", f"{text} at {torque[i]:.3g} N.m, the largest")}
    for name, T in (("zero", 0.0), ("rated", catalogue_row.rated_torque), ("max", max_torque)):
        K, step = float(compute_stiffness(contact_pair_drive, np.array(T))), float(catalogue_row.stiffness(T))
        facts[f"pair_stiffness_{name}"] = (
            K / step - 1.0,
            "1",
            f"{text} at {T:g} N.m: {K:.5g} for {step:g} N.m/rad",
        )
    return facts
