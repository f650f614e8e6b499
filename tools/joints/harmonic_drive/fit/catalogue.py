"""Parameters of a drive from the torsional stiffness in a catalogue (K1, K2, K3, T1, T2).

Two laws. `catalogue` (`make_line_drive_from_row`): three lines, taken from the row without a fit; for
comparison the law `hu2023` is fitted too. `hu2023` (`fit_pair`): smooth law of the contact pair. The fit
meets the angle at T1, T2 and the rated torque, and approximates the lines elsewhere up to max_torque. Its
unknowns are those of a fit to a measured curve. `torque_smoothing`, the torque below which the pressure does
not yet grow, is T1, where the stiffness of the catalogue starts to rise. It becomes a fourth unknown if three
unknowns do not meet the angles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.prescribed_midline import DEFAULT_CORNER_RATIO, CatalogueDrive
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array

from ....inputs.catalogue import SourcedNumber
from ....inputs.fitting.least_squares import EMPTY_SOLUTION, Solution, solve
from ....inputs.fitting.outcome import Facts, FitResult, fitted_parameters, make_predictor, make_unknowns
from ..catalogue import STIFFNESS_NAMES
from . import drive
from .drive import CatalogueRow, angle_picture, stiffness, stiffness_picture

FITTED_PARAMETERS = ("K_FTS0", "drive_scale", "zero_torque_pressure")
"""Parameters of the law `hu2023` that are fitted."""
EXTRA_PARAMETER = "torque_smoothing"
"""Parameter that is fitted too if FITTED_PARAMETERS alone do not meet the wind-up angles."""
MAX_ANGLE_ERROR = 0.009
"""Largest relative error [1] of the angle at T1, T2 and the rated torque: 1 % with a margin."""
FITTED_ANGLE_DEVIATIONS = (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4)
"""Relative standard deviations [1] of the angle at T1, T2 and the rated torque. They are tried in turn until
the fitted angles are within MAX_ANGLE_ERROR."""
OTHER_ANGLE_DEVIATION = 0.2
"""Relative standard deviation [1] of the angle at other torques: real drives have no corners."""
MAX_TORQUE_RATIO = 4.0
"""max_torque over rated torque [1], about the repeated peak torque of catalogue drives."""


def fit(
    start: ParameterFile | None,
    fitted_names: Sequence[str] | None,
    rated_torque: float | None,
    source: str,
    ratio: float | None,
    law: str,
    **row: float,
) -> FitResult:
    """Make the parameters of a drive from a row of a catalogue.

    fitted_names : names to fit, with the law `hu2023` only; None: those of FITTED_PARAMETERS
    rated_torque : [N.m]; None: T2
    source       : where the row is published
    ratio        : speed ratio [1]; None: that of `start`
    law          : "catalogue" or "hu2023"
    row          : K1, K2, K3 [N.m/rad], T1, T2 [N.m]

    Raises ValueError for numbers outside their limits or a name that cannot be fitted, RuntimeError if no law
    `hu2023` meets the angles.
    """
    rated, kind = (row["T2"], "estimate") if rated_torque is None else (rated_torque, "catalogue")
    catalogue_row = CatalogueRow(**row, rated=rated)
    printed = source_numbers(catalogue_row, kind, ratio, source)
    return (make_line_drive_from_row if law == "catalogue" else fit_pair)(
        catalogue_row, start, fitted_names, printed, source
    )


def source_numbers(
    row: CatalogueRow, rated_origin: str = "catalogue", ratio: float | None = None, source: str = "catalogue"
) -> dict[str, SourcedNumber]:
    """Numbers of a catalogue row with their source: {parameter: number}; with the ratio, if it is known."""
    origin = f"{source} ({row})"
    rated = origin if rated_origin == "catalogue" else "no rated torque given; T2 of the catalogue"
    numbers = {name: SourcedNumber(getattr(row, name), "catalogue", origin) for name in STIFFNESS_NAMES}
    numbers["rated_torque"] = SourcedNumber(row.rated, rated_origin, rated)
    return numbers if ratio is None else numbers | {"ratio": SourcedNumber(ratio, "catalogue", origin)}


def fit_pair(
    row: CatalogueRow,
    start: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    numbers: Mapping[str, SourcedNumber] | None = None,
    source: str = "catalogue",
) -> FitResult:
    """Fit the smooth law of the contact pair to a row of a catalogue.

    fitted_names : names to fit; None: FITTED_PARAMETERS, and EXTRA_PARAMETER if the others do not suffice
    numbers      : of the row, from `source_numbers`; None: those of `row`
    source       : where the row is published

    Raises ValueError for a name that cannot be fitted, RuntimeError if no law meets the angles.
    """
    numbers = numbers or source_numbers(row)
    file = start or load_default("harmonic_drive")
    rated = numbers["rated_torque"]
    origin = numbers["T1"].source
    file = drive.resize_drive(file, row.rated, MAX_TORQUE_RATIO, rated.kind, rated.source)
    if "ratio" in numbers:
        file = file.with_values({"ratio": numbers["ratio"].value}, "catalogue", origin)
    file = file.with_values({EXTRA_PARAMETER: row.T1}, "catalogue", f"T1 of {origin}")
    torque, max_torque = comparison_torques(row, file.values.max_torque), file.values.max_torque
    choices = (
        [tuple(fitted_names)] if fitted_names else [FITTED_PARAMETERS, (*FITTED_PARAMETERS, EXTRA_PARAMETER)]
    )
    file = drive.scale_stiffness(file, choices[0], torque, row.wind_up(torque))
    solution, deviation = _solve_weighted(row, file, choices, torque)
    result = fitted_parameters(file, solution.values, "catalogue", origin, f"torque 0 to {max_torque:g} N.m")
    result = replace(result, name=f"fitted to {source}")
    errors = drive.wind_up(result.values, torque) / row.wind_up(torque) - 1.0
    worst = int(np.argmax(np.abs(errors)))
    text = f"at {torque[worst]:.3g} N.m, largest between {torque[0]:.3g} and {max_torque:g} N.m"
    facts = _angle_errors(row, result.values, {})
    facts["angle_error_largest"] = float(errors[worst]), "1", text
    note = (
        f"standard deviations: the angle known to {100 * deviation:g} % at T1, T2 and rated torque, "
        f"{100 * OTHER_ANGLE_DEVIATION:g} % elsewhere"
    )
    pictures = (
        angle_picture(row, result.values, {}, torque),
        stiffness_picture(row, result.values, {}, max_torque),
    )
    return FitResult(result, solution, facts | _max_torque_fact(row, max_torque), pictures, notes=[note])


def comparison_torques(row: CatalogueRow, max_torque: float) -> Array:
    """Torques [N.m] at which the smooth law is compared with the lines, up to about `max_torque`."""
    ends = np.array([0.0, row.T1, row.T2, max(max_torque, 1.5 * row.T2)])
    samples = [np.linspace(a, b, 7)[1:] for a, b in pairwise(ends)]
    return np.unique(np.concatenate([row.fitted_torques, *samples]))


def _solve_weighted(
    row: CatalogueRow, file: ParameterFile, unknown_sets: Sequence[Sequence[str]], torque: Array
) -> tuple[Solution, float]:
    """Fit with increasing weight at T1, T2 and the rated torque, until the angles there are met.

    unknown_sets : sets of unknowns to try in turn

    Returns the solution and its relative standard deviation [1] of these angles. Raises RuntimeError if no
    fit meets them.
    """
    exact, target = np.isin(torque, row.fitted_torques), row.wind_up(torque)
    angles = make_predictor(file, lambda joint: drive.wind_up(joint, torque))
    limits = dict(drive.parameter_bounds(file)) | {"K_FTS0": (row.K2, np.inf)}
    best = np.inf
    for names, deviation in product(unknown_sets, FITTED_ANGLE_DEVIATIONS):
        scale = np.where(exact, deviation, OTHER_ANGLE_DEVIATION)
        solution = solve(
            make_unknowns(file, names, limits),
            lambda values, scale=scale: (angles(values) / target - 1.0) / scale,  # type: ignore[misc]
            noise=1.0,
            tolerance=1e-5,
        )
        worst = float(np.max(np.abs(solution.residuals * scale)[exact]))
        if worst <= MAX_ANGLE_ERROR:
            return solution, deviation
        best = min(best, worst)
        file = file.with_values(
            {n: v for n, v in solution.values.items() if n not in solution.names_at_bound},
            "catalogue",
            "start",
        )
    raise RuntimeError(
        f"no law with {', '.join(unknown_sets[-1])} free keeps the angle of {row} at T1, T2 and rated torque "
        f"{row.rated:g} N.m within {100 * MAX_ANGLE_ERROR:g} %: the best misses it by {100 * best:.2g} %"
    )


PAIR_LAW_TEXT = "law of the contact pair"


def make_line_drive(
    name: str, numbers: Mapping[str, SourcedNumber], start: ParameterFile | None = None
) -> ParameterFile:
    """Make the parameters of a drive with the law `catalogue`.

    numbers : {parameter: number with source}; other parameters are those of `start`
    start   : drive with any law; None: the default drive

    Raises ValueError for a number outside its limits.
    """
    file = start or load_default("harmonic_drive")
    kept = ["corner"] if isinstance(file.values, CatalogueDrive) else []
    if not (kept or "corner" in numbers):
        text = "default choice: the angle at the corners of catalogue drives within 0.4 %"
        numbers = {**numbers, "corner": SourcedNumber(DEFAULT_CORNER_RATIO, "user", text)}
    return drive.change_law(file, CatalogueDrive, name, numbers, kept)


def make_line_drive_from_row(
    row: CatalogueRow,
    start: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    numbers: Mapping[str, SourcedNumber] | None = None,
    source: str = "catalogue",
) -> FitResult:
    """Make the drive with the three lines of a row. Arguments as for `fit_pair`, but no parameter is fitted.

    Raises ValueError if `fitted_names` has a name, and for numbers outside their limits.
    """
    if fitted_names:
        raise ValueError("the law catalogue has nothing to fit; --free is allowed with --law hu2023")
    max_torque = MAX_TORQUE_RATIO * row.rated
    largest = SourcedNumber(max_torque, "estimate", f"{MAX_TORQUE_RATIO:g} times rated_torque")
    file = make_line_drive(source, {**(numbers or source_numbers(row)), "max_torque": largest}, start)
    pair, note = _fit_pair_or_note(row, start if start and start.law == "hu2023" else None)
    facts = _angle_errors(row, file.values, {"max": max_torque}) | _max_torque_fact(row, max_torque)
    also = {}
    if pair is not None:
        also = {PAIR_LAW_TEXT: pair}
        facts |= _pair_facts(row, pair, max_torque)
    angle = angle_picture(row, file.values, also, comparison_torques(row, max_torque))
    return FitResult(
        file,
        EMPTY_SOLUTION,
        facts,
        (angle, stiffness_picture(row, file.values, also, max_torque)),
        notes=note,
    )


def _fit_pair_or_note(row: CatalogueRow, start: ParameterFile | None) -> tuple[Drive | None, list[str]]:
    """Law of the contact pair that meets the angles of the row; if there is none, None and a note."""
    try:
        drive: Drive = fit_pair(row, start).parameters.values
    except RuntimeError as error:
        return None, [f"the {PAIR_LAW_TEXT} cannot be told beside it: {error}"]
    return drive, []


def _angle_errors(row: CatalogueRow, fitted_drive: Drive, extra_torques: Mapping[str, float]) -> Facts:
    """Relative errors of the angle of a law at T1, T2, the rated torque, and extra torques [N.m]."""
    facts = {}
    for name, T in {"T1": row.T1, "T2": row.T2, "rated": row.rated, **extra_torques}.items():
        error = float(drive.wind_up(fitted_drive, np.array(T)) / row.wind_up(T)) - 1.0
        facts[f"angle_error_{name}"] = (error, "1", f"law over catalogue - 1 at {T:g} N.m")
    return facts


def _max_torque_fact(row: CatalogueRow, max_torque: float) -> Facts:
    text = f"{MAX_TORQUE_RATIO:g} times the rated torque {row.rated:g} N.m"
    return {"max_torque": (max_torque, "N.m", text)}


def _pair_facts(row: CatalogueRow, pair: Drive, max_torque: float) -> Facts:
    """Largest angle error, and stiffness errors, of the law of the contact pair compared with the lines."""
    torque = np.linspace(0.0, max_torque, 401)[1:]
    angle = drive.wind_up(pair, torque) / row.wind_up(torque) - 1.0
    i = int(np.argmax(np.abs(angle)))
    text = f"{PAIR_LAW_TEXT} over catalogue - 1"
    facts = {"pair_angle_error": (float(angle[i]), "1", f"{text} at {torque[i]:.3g} N.m, the largest")}
    for name, T in (("zero", 0.0), ("rated", row.rated), ("max", max_torque)):
        K, step = float(stiffness(pair, np.array(T))), float(row.stiffness(T))
        facts[f"pair_stiffness_{name}"] = (
            K / step - 1.0,
            "1",
            f"{text} at {T:g} N.m: {K:.5g} for {step:g} N.m/rad",
        )
    return facts
