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
from jointfmu.joints.harmonic_drive.given import CORNER, CatalogueDrive
from jointfmu.parameters import ParameterFile, default
from jointfmu.quantity import Array

from ....catalogue import Printed
from ....fitting.least_squares import NOTHING, Solution, solve
from ....fitting.outcome import Facts, FitResult, fitted, model, unknowns
from ..catalogue import LINES
from . import drive
from .drive import Row, angle_picture, stiffness, stiffness_picture

FREE = ("K_FTS0", "drive_scale", "zero_torque_pressure")
"""Parameters of the law `hu2023` that are fitted."""
FURTHER = "torque_smoothing"
"""Parameter that is fitted too if the others alone do not meet the angles."""
AIMED = 0.009
"""Largest relative error [1] of the angle at T1, T2 and the rated torque: 1 % with a margin."""
TIGHT = (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4)
"""Relative standard deviations [1] of the angle at these torques, tried in turn until the angles are met."""
LOOSE = 0.2
"""Relative standard deviation [1] of the angle at other torques: real drives have no corners."""
MAX_OVER_RATED = 4.0
"""max_torque over rated torque [1], about the repeated peak torque of catalogue drives."""


def fit(
    start: ParameterFile | None,
    free: Sequence[str] | None,
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
    catalogue_row = Row(**row, rated=rated)
    printed = stated_numbers(catalogue_row, kind, ratio, source)
    return (fit_lines if law == "catalogue" else fit_pair)(catalogue_row, start, free, printed, source)


def stated_numbers(
    row: Row, rated_kind: str = "catalogue", ratio: float | None = None, source: str = "catalogue"
) -> dict[str, Printed]:
    """Numbers of a catalogue row with their source: {parameter: number}; with the ratio, if it is known."""
    origin = f"{source} ({row})"
    rated = origin if rated_kind == "catalogue" else "no rated torque given; T2 of the catalogue"
    numbers = {name: Printed(getattr(row, name), "catalogue", origin) for name in LINES}
    numbers["rated_torque"] = Printed(row.rated, rated_kind, rated)
    return numbers if ratio is None else numbers | {"ratio": Printed(ratio, "catalogue", origin)}


def fit_pair(
    row: Row,
    start: ParameterFile | None = None,
    free: Sequence[str] | None = None,
    printed: Mapping[str, Printed] | None = None,
    source: str = "catalogue",
) -> FitResult:
    """Fit the smooth law of the contact pair to a row of a catalogue.

    fitted_names : names to fit; None: FITTED_PARAMETERS, and EXTRA_PARAMETER if the others do not suffice
    numbers      : of the row, from `source_numbers`; None: those of `row`
    source       : where the row is published

    Raises ValueError for a name that cannot be fitted, RuntimeError if no law meets the angles.
    """
    printed = printed or stated_numbers(row)
    file, rated, origin = start or default("harmonic_drive"), printed["rated_torque"], printed["T1"].source
    file = drive.resized(file, row.rated, MAX_OVER_RATED, rated.kind, rated.source)
    if "ratio" in printed:
        file = file.with_values({"ratio": printed["ratio"].value}, "catalogue", origin)
    file = file.with_values({FURTHER: row.T1}, "catalogue", f"T1 of {origin}")
    torque, max_torque = torques(row, file.values.max_torque), file.values.max_torque
    choices = [tuple(free)] if free else [FREE, (*FREE, FURTHER)]
    file = drive.scaled(file, choices[0], torque, row.angle(torque))
    solution, deviation = _solved(row, file, choices, torque)
    result = fitted(file, solution.values, "catalogue", origin, f"torque 0 to {max_torque:g} N.m")
    result = replace(result, name=f"fitted to {source}")
    errors = drive.windup(result.values, torque) / row.angle(torque) - 1.0
    worst = int(np.argmax(np.abs(errors)))
    text = f"at {torque[worst]:.3g} N.m, largest between {torque[0]:.3g} and {max_torque:g} N.m"
    facts = _angle_errors(row, result.values, {})
    facts["angle_error_largest"] = float(errors[worst]), "1", text
    note = (
        f"standard deviations: the angle known to {100 * deviation:g} % at T1, T2 and rated torque, "
        f"{100 * LOOSE:g} % elsewhere"
    )
    pictures = (
        angle_picture(row, result.values, {}, torque),
        stiffness_picture(row, result.values, {}, max_torque),
    )
    return FitResult(result, solution, facts | _most(row, max_torque), pictures, notes=[note])


def torques(row: Row, most: float) -> Array:
    """Torques [N.m] at which the smooth law is compared with the lines, up to about `max_torque`."""
    ends = np.array([0.0, row.T1, row.T2, max(most, 1.5 * row.T2)])
    samples = [np.linspace(a, b, 7)[1:] for a, b in pairwise(ends)]
    return np.unique(np.concatenate([row.kept, *samples]))


def _solved(
    row: Row, file: ParameterFile, choices: Sequence[Sequence[str]], torque: Array
) -> tuple[Solution, float]:
    """Fit with increasing weight at T1, T2 and the rated torque, until the angles there are met.

    choices : sets of unknowns to try in turn

    Returns the solution and its relative standard deviation [1] of these angles. Raises RuntimeError if no
    fit meets them.
    """
    exact, target = np.isin(torque, row.kept), row.angle(torque)
    angles = model(file, lambda joint: drive.windup(joint, torque))
    limits = dict(drive.bounds(file)) | {"K_FTS0": (row.K2, np.inf)}
    best = np.inf
    for names, deviation in product(choices, TIGHT):
        scale = np.where(exact, deviation, LOOSE)
        solution = solve(
            unknowns(file, names, limits),
            lambda values, scale=scale: (angles(values) / target - 1.0) / scale,  # type: ignore[misc]
            noise=1.0,
            tolerance=1e-5,
        )
        worst = float(np.max(np.abs(solution.residuals * scale)[exact]))
        if worst <= AIMED:
            return solution, deviation
        best = min(best, worst)
        file = file.with_values(
            {n: v for n, v in solution.values.items() if n not in solution.at_bound}, "catalogue", "start"
        )
    raise RuntimeError(
        f"no law with {', '.join(choices[-1])} free keeps the angle of {row} at T1, T2 and rated torque "
        f"{row.rated:g} N.m within {100 * AIMED:g} %: the best misses it by {100 * best:.2g} %"
    )


PAIR = "law of the contact pair"


def made(name: str, printed: Mapping[str, Printed], start: ParameterFile | None = None) -> ParameterFile:
    """Make the parameters of a drive with the law `catalogue`.

    numbers : {parameter: number with source}; other parameters are those of `start`
    start   : drive with any law; None: the default drive

    Raises ValueError for a number outside its limits.
    """
    file = start or default("harmonic_drive")
    kept = ["corner"] if isinstance(file.values, CatalogueDrive) else []
    if not (kept or "corner" in printed):
        text = "default choice: the angle at the corners of catalogue drives within 0.4 %"
        printed = {**printed, "corner": Printed(CORNER, "user", text)}
    return drive.with_law(file, CatalogueDrive, name, printed, kept)


def fit_lines(
    row: Row,
    start: ParameterFile | None = None,
    free: Sequence[str] | None = None,
    printed: Mapping[str, Printed] | None = None,
    source: str = "catalogue",
) -> FitResult:
    """Make the drive with the three lines of a row. Arguments as for `fit_pair`, but no parameter is fitted.

    Raises ValueError if `fitted_names` has a name, and for numbers outside their limits.
    """
    if free:
        raise ValueError("the law catalogue has nothing to fit; --free is allowed with --law hu2023")
    max_torque = MAX_OVER_RATED * row.rated
    largest = Printed(max_torque, "estimate", f"{MAX_OVER_RATED:g} times rated_torque")
    file = made(source, {**(printed or stated_numbers(row)), "max_torque": largest}, start)
    pair, note = _pair(row, start if start and start.law == "hu2023" else None)
    facts = _angle_errors(row, file.values, {"max": max_torque}) | _most(row, max_torque)
    also = {}
    if pair is not None:
        also = {PAIR: pair}
        facts |= _pair_facts(row, pair, max_torque)
    angle = angle_picture(row, file.values, also, torques(row, max_torque))
    return FitResult(
        file, NOTHING, facts, (angle, stiffness_picture(row, file.values, also, max_torque)), notes=note
    )


def _pair(row: Row, start: ParameterFile | None) -> tuple[Drive | None, list[str]]:
    """Law of the contact pair that meets the angles of the row; if there is none, None and a note."""
    try:
        drive: Drive = fit_pair(row, start).parameters.values
    except RuntimeError as error:
        return None, [f"the {PAIR} cannot be told beside it: {error}"]
    return drive, []


def _angle_errors(row: Row, law: Drive, more: Mapping[str, float]) -> Facts:
    """Relative errors of the angle of a law at T1, T2, the rated torque, and extra torques [N.m]."""
    facts = {}
    for name, T in {"T1": row.T1, "T2": row.T2, "rated": row.rated, **more}.items():
        error = float(drive.windup(law, np.array(T)) / row.angle(T)) - 1.0
        facts[f"angle_error_{name}"] = (error, "1", f"law over catalogue - 1 at {T:g} N.m")
    return facts


def _most(row: Row, most: float) -> Facts:
    text = f"{MAX_OVER_RATED:g} times the rated torque {row.rated:g} N.m"
    return {"max_torque": (most, "N.m", text)}


def _pair_facts(row: Row, pair: Drive, most: float) -> Facts:
    """Largest angle error, and stiffness errors, of the law of the contact pair compared with the lines."""
    torque = np.linspace(0.0, most, 401)[1:]
    angle = drive.windup(pair, torque) / row.angle(torque) - 1.0
    i = int(np.argmax(np.abs(angle)))
    text = f"{PAIR} over catalogue - 1"
    facts = {"pair_angle_error": (float(angle[i]), "1", f"{text} at {torque[i]:.3g} N.m, the largest")}
    for name, T in (("zero", 0.0), ("rated", row.rated), ("max", most)):
        K, step = float(stiffness(pair, np.array(T))), float(row.stiffness(T))
        facts[f"pair_stiffness_{name}"] = (
            K / step - 1.0,
            "1",
            f"{text} at {T:g} N.m: {K:.5g} for {step:g} N.m/rad",
        )
    return facts
