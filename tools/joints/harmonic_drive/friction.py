"""Friction of the drives in the catalogue: published, or scaled from drives with published friction.

No-load torques at the wave generator, for size D and ratio R:

    starting torque = a (D/20)^p 100/R,    running torque at 2000 rev/min and R = 100 = b (D/20)^3

a, p and b are fitted to the published torques by least squares over logarithms. Dry friction is proportional
to 1/R, like the radial deformation of the flexspline. This exponent is not fitted: only one drive with
published friction has a ratio below 100. The exponent 3 is the exponent of the friction moment of a rolling
bearing over its diameter (Palmgren). The difference of running and starting torque is viscous friction of the
grease, equal for all ratios. Both load-dependent losses are mean values of the published drives.

Intervals are Student's prediction intervals of the regressions: a single drive lies inside with probability
CONFIDENCE_LEVEL.
"""

import math
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.friction import REFERENCE_TEMPERATURE, friction_limits, viscous_torque
from jointfmu.quantity import Array

from ...common.options import format_option_flag
from ...inputs.catalogue import CatalogueEntry, SourcedNumber

CONFIDENCE_LEVEL = 0.95
"""Probability that a single drive lies inside its prediction interval [1]."""
REFERENCE_DRIVE_SIZE, REFERENCE_SPEED_RATIO = 20.0, 100.0
"""Reference size and reference ratio of the scaling laws [1]."""
RUNNING_TORQUE_SIZE_EXPONENT = 3.0
"""Exponent of the size in the scaling law of the running torque [1]."""


@dataclass(frozen=True, slots=True)
class PublishedFriction:
    """Published friction of a drive; None: not published.

    drive_size, speed_ratio : [1]
    starting_torque         : [N.m] at the wave generator
    running_torque          : [N.m] at the wave generator, at 2000 rev/min
    load_loss               : friction over transmitted torque [1], if the motor drives
    load_loss_back          : friction over transmitted torque [1], if the output drives
    """

    drive_size: float
    speed_ratio: float
    starting_torque: float
    running_torque: float | None
    load_loss: float | None
    load_loss_back: float | None


class ScaledNumber(NamedTuple):
    """Friction number from a scaling law, with the ends of its prediction interval, all in the same unit."""

    central_value: float
    prediction_interval_low: float
    prediction_interval_high: float


@dataclass(frozen=True, slots=True)
class ScaledFriction:
    """Friction of one drive, scaled from drives with published friction.

    starting_torque           : [N.m]
    viscous_torque            : [N.m] increase of the torque from start to 2000 rev/min
    load_loss, load_loss_back : [1]
    """

    starting_torque: ScaledNumber
    viscous_torque: ScaledNumber
    load_loss: ScaledNumber
    load_loss_back: ScaledNumber


@lru_cache(maxsize=512)  # most drives of the catalogue share size and ratio with others
def scale_friction(
    drive_size: float, speed_ratio: float, published_drives: tuple[PublishedFriction, ...]
) -> ScaledFriction:
    """Scale the friction of published drives (four or more) to a drive of a size [1] and a ratio [1]."""
    starting_logs = np.array(
        [
            (
                np.log(k.drive_size / REFERENCE_DRIVE_SIZE),
                np.log(k.starting_torque * k.speed_ratio / REFERENCE_SPEED_RATIO),
            )
            for k in published_drives
        ]
    )
    running_logs = [
        np.log(k.running_torque / (k.drive_size / REFERENCE_DRIVE_SIZE) ** RUNNING_TORQUE_SIZE_EXPONENT)
        for k in published_drives
        if k.running_torque is not None
    ]
    design = np.stack([np.ones(len(starting_logs)), starting_logs[:, 0]], axis=1)
    reference = _scale_torque(
        design, starting_logs[:, 1], np.array([1.0, np.log(drive_size / REFERENCE_DRIVE_SIZE)]), 1.0
    )
    ones = np.ones((len(running_logs), 1))
    running = _scale_torque(
        ones,
        np.array(running_logs),
        np.ones(1),
        (drive_size / REFERENCE_DRIVE_SIZE) ** RUNNING_TORQUE_SIZE_EXPONENT,
    )
    rise = (max(x - reference.central_value, 0.0) for x in running)
    starting = ScaledNumber(*(REFERENCE_SPEED_RATIO / speed_ratio * x for x in reference))
    losses = (
        _mean_published_loss([getattr(k, name) for k in published_drives])
        for name in ("load_loss", "load_loss_back")
    )
    return ScaledFriction(starting, ScaledNumber(*rise), *losses)


def _scale_torque(
    design_matrix: Array, torque_logarithms: Array, design_row: Array, torque_factor: float
) -> ScaledNumber:
    """Estimate a torque [N.m] with its interval by linear regression of its logarithm, times a factor.

    design_matrix     : (n, k) predictors of n drives with published torque, for k coefficients
    torque_logarithms : (n) logarithms of these torques
    design_row        : (k) predictors of the drive whose torque is estimated
    """
    value, half = _predict_with_interval(design_matrix, torque_logarithms, design_row)
    return ScaledNumber(*(torque_factor * float(np.exp(x)) for x in (value, value - half, value + half)))


def _mean_published_loss(published_losses: Sequence[float | None]) -> ScaledNumber:
    """Mean of published load-dependent losses [1], with an interval that is cut at zero."""
    published = np.array([value for value in published_losses if value is not None])
    value, half = _predict_with_interval(np.ones((published.size, 1)), published, np.ones(1))
    return ScaledNumber(value, max(value - half, 0.0), value + half)


def _predict_with_interval(
    design_matrix: Array, regression_values: Array, design_row: Array
) -> tuple[float, float]:
    """Predict a value by linear regression; value, and half width of its prediction interval.

    design_matrix, regression_values : (n, k) predictors and (n) values of n observations
    design_row                       : (k) predictors of the predicted value
    """
    from scipy.special import stdtrit

    law = np.linalg.lstsq(design_matrix, regression_values)[0]
    freedom = regression_values.size - law.size
    residuals = regression_values - design_matrix @ law
    deviation = np.sqrt(
        residuals
        @ residuals
        / freedom
        * (1.0 + design_row @ np.linalg.inv(design_matrix.T @ design_matrix) @ design_row)
    )
    return float(design_row @ law), float(stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE_LEVEL) * deviation)


CATALOGUE_MOTOR_SPEED = 2000.0 * math.pi / 30.0
"""Speed [rad/s] of the wave generator at which catalogues state running torque and efficiency: 2000
rev/min."""
FRICTION_COLUMNS = ("starting_torque", "running_torque", "back_driving_torque", "efficiency")
"""Columns of the catalogue that describe friction."""
_STATED_LIMIT_TOLERANCE = 1e-5
"""Relative tolerance [1] of limits, so that a user can type a limit as an error message shows it."""
_INTERVAL_DECIMALS = 12
"""Decimals to which ends of intervals in SI units are rounded, so that round-off does not hide a zero."""
PARAMETER_OF_COLUMN: Mapping[str, tuple[str, str]] = {
    "starting_torque": ("friction_coulomb", "starting torque"),
    "running_torque": ("friction_viscous", "rise from starting to running torque"),
    "back_driving_torque": ("load_loss_back", "back-driving torque"),
    "efficiency": ("load_loss", "efficiency at rated torque"),
}
"""{column: (parameter that follows from it, text for the source of the parameter)}."""


def compute_friction_parameters(
    sourced_numbers: Mapping[str, SourcedNumber], stated_number_names: Collection[str] = ()
) -> dict[str, SourcedNumber]:
    """Friction parameters of a drive from catalogue numbers: {parameter: number}.

    sourced_numbers     : ratio, rated_torque and FRICTION_COLUMNS, as far as they are known
    stated_number_names : stated numbers, of FRICTION_COLUMNS; contradictions of these numbers are errors

    friction_coulomb = starting torque
    friction_viscous = (running torque - starting torque)/CATALOGUE_MOTOR_SPEED
    load_loss        = 1/efficiency - 1 - running torque ratio/rated torque, at least 0
    load_loss_back   = 1 - ratio starting torque/back-driving torque, at least 0

    Without an efficiency, load_loss is load_loss_back. Without a starting torque the result is empty.

    Raises ValueError if a stated number would make a parameter negative.
    """
    if "starting_torque" not in sourced_numbers:
        return {}
    start, running = sourced_numbers["starting_torque"], sourced_numbers.get("running_torque")
    ratio, rated = abs(sourced_numbers["ratio"].si_value), sourced_numbers.get("rated_torque")
    _check_stated_numbers(sourced_numbers, stated_number_names)
    values: dict[str, tuple[Callable[[float], float], str]] = {"starting_torque": (lambda torque: torque, "")}
    if running is not None:
        text = f" over {CATALOGUE_MOTOR_SPEED:.4g} rad/s"
        values["running_torque"] = (lambda torque: (torque - start.si_value) / CATALOGUE_MOTOR_SPEED, text)
    if (output := sourced_numbers.get("efficiency")) is not None and rated is not None:
        idle = _no_load_torque_ratio(sourced_numbers)
        values["efficiency"] = (
            lambda part: 1.0 / part - 1.0 - idle,
            f" {output.si_value:.4g}, less the running torque",
        )
    if (back := sourced_numbers.get("back_driving_torque")) is not None:
        values["back_driving_torque"] = (
            lambda torque: 1.0 - ratio * start.si_value / torque,
            f" {back.si_value:.4g} N.m over ratio times starting torque",
        )
    parameters = {
        PARAMETER_OF_COLUMN[name][0]: _make_friction_parameter(name, sourced_numbers[name], *value)
        for name, value in values.items()
    }
    if "load_loss_back" in parameters and "load_loss" not in parameters:
        parameters["load_loss"] = parameters["load_loss_back"]
    return parameters


def _no_load_torque_ratio(sourced_numbers: Mapping[str, SourcedNumber]) -> float:
    """Running torque over rated torque at the motor [1]; starting torque if no running torque is known."""
    torque = sourced_numbers.get("running_torque", sourced_numbers["starting_torque"]).si_value
    return torque * abs(sourced_numbers["ratio"].si_value) / sourced_numbers["rated_torque"].si_value


def _check_stated_numbers(
    sourced_numbers: Mapping[str, SourcedNumber], stated_number_names: Collection[str]
) -> None:
    """Check the friction numbers that the user states for a drive.

    Raises ValueError if a number would make a friction parameter negative.
    """
    start, ratio = sourced_numbers["starting_torque"].si_value, abs(sourced_numbers["ratio"].si_value)
    ends = {
        "running_torque": (start, "the starting torque"),
        "back_driving_torque": (ratio * start, "ratio times starting torque"),
    }
    for name, (lowest, bound_text) in ends.items():
        if (
            name in stated_number_names
            and sourced_numbers[name].si_value < (1.0 - _STATED_LIMIT_TOLERANCE) * lowest
        ):
            value = f"{format_option_flag(name)} = {sourced_numbers[name].si_value:g} N.m"
            raise ValueError(f"{value} is outside [{lowest:.6g}, inf) N.m: it is at least {bound_text}")
    if "back_driving_torque" in stated_number_names and "rated_torque" in sourced_numbers:
        back, rated = (sourced_numbers[name].si_value for name in ("back_driving_torque", "rated_torque"))
        if back > rated:
            raise ValueError(
                f"--back-driving-torque = {back:g} N.m is above the rated torque, {rated:g} N.m; check the "
                f"unit, as in {back:g}mN.m"
            )
    if "efficiency" in stated_number_names and "rated_torque" in sourced_numbers:
        highest, stated_value = (
            1.0 / (1.0 + _no_load_torque_ratio(sourced_numbers)),
            sourced_numbers["efficiency"].si_value,
        )
        if stated_value > (1.0 + _STATED_LIMIT_TOLERANCE) * highest:
            raise ValueError(
                f"--efficiency = {stated_value:g} is outside (0, {highest:.6g}]: the torque without load "
                "takes the rest"
            )


def _make_friction_parameter(
    friction_column: str,
    catalogue_number: SourcedNumber,
    convert_to_parameter: Callable[[float], float],
    source_text: str,
) -> SourcedNumber:
    """Make the friction parameter from a catalogue number, with source and interval.

    convert_to_parameter : catalogue number -> value of the parameter
    """
    kind = (
        "derived"
        if source_text and catalogue_number.value_origin != "estimate"
        else catalogue_number.value_origin
    )
    source, interval = (
        f"{catalogue_number.value_source}; {PARAMETER_OF_COLUMN[friction_column][1]}{source_text}",
        None,
    )
    if catalogue_number.estimate_interval is not None:
        low, high = sorted(
            max(round(convert_to_parameter(end), _INTERVAL_DECIMALS), 0.0)
            for end in catalogue_number.estimate_interval
        )
        interval = low, high
        source += f"; {describe_interval(interval)}"
    return SourcedNumber(
        max(convert_to_parameter(catalogue_number.si_value), 0.0), kind, source, estimate_interval=interval
    )


def describe_interval(confidence_interval: tuple[float, float]) -> str:
    """Format an interval as text, for the entry `source` of a parameter."""
    return (
        f"{100.0 * CONFIDENCE_LEVEL:g} % interval {confidence_interval[0]:.4g} to "
        f"{confidence_interval[1]:.4g}"
    )


def compute_rated_efficiency(
    drive_parameters: DriveParameters, lubricant_temperature: float = REFERENCE_TEMPERATURE
) -> float:
    """Efficiency [1] of a drive at rated torque and CATALOGUE_MOTOR_SPEED, without hysteresis.

    lubricant_temperature : [K] of the lubricant
    """
    transmitted = drive_parameters.rated_torque / abs(drive_parameters.ratio)
    load = -math.copysign(drive_parameters.rated_torque, drive_parameters.ratio)
    friction_torque = friction_limits(drive_parameters, CATALOGUE_MOTOR_SPEED, load, lubricant_temperature)[
        0
    ] + viscous_torque(drive_parameters, CATALOGUE_MOTOR_SPEED, lubricant_temperature)
    return float(transmitted / (transmitted + friction_torque))


def collect_published_friction(
    catalogue_entries: Iterable[CatalogueEntry],
) -> dict[str, tuple[PublishedFriction, str]]:
    """Collect the friction {drive: (friction, maker)} of all drives with a published starting torque."""
    found = {}
    for item in catalogue_entries:
        printed = {
            name: number for name, number in item.known_numbers.items() if number.value_origin == "catalogue"
        }
        if "starting_torque" in printed:
            maker = printed["starting_torque"].value_source.partition(": ")[2].partition(",")[0]
            found[item.joint_name] = (
                _published_friction(item.joint_name, item.known_numbers["ratio"].si_value, printed),
                maker,
            )
    return found


def _published_friction(
    drive_name: str, speed_ratio: float, sourced_numbers: Mapping[str, SourcedNumber]
) -> PublishedFriction:
    """Published friction of one drive; losses follow from published efficiency and back-driving torque."""
    losses = compute_friction_parameters(
        {"ratio": SourcedNumber(speed_ratio, "catalogue", ""), **sourced_numbers}
    )
    running = sourced_numbers.get("running_torque")
    return PublishedFriction(
        parse_drive_size(drive_name),
        speed_ratio,
        sourced_numbers["starting_torque"].si_value,
        running.si_value if running else None,
        losses["load_loss"].si_value if "efficiency" in sourced_numbers else None,
        losses["load_loss_back"].si_value if "back_driving_torque" in sourced_numbers else None,
    )


def parse_drive_size(drive_name: str) -> float:
    """Size [1] in the name SERIES-SIZE-RATIO of a drive; a letter after the size, as in 14A, is ignored."""
    match = re.search(r"-(\d+)[A-Z]?-\d+$", drive_name)
    assert match, drive_name
    return float(match[1])


def add_friction_estimates(
    catalogue_entry: CatalogueEntry, published_drives: Mapping[str, tuple[PublishedFriction, str]]
) -> CatalogueEntry:
    """Add estimates of the friction numbers that are not published for a drive.

    published_drives : {drive: (its published friction, its maker)}

    Without a rated torque there is no estimate of the efficiency.
    """
    numbers, ratio = dict(catalogue_entry.known_numbers), catalogue_entry.known_numbers["ratio"].si_value
    published = tuple(each for each, _ in published_drives.values())
    law = scale_friction(parse_drive_size(catalogue_entry.joint_name), ratio, published)
    makers: dict[str, list[str]] = {}
    for name, (_, maker) in published_drives.items():
        makers.setdefault(maker, []).append(name)
    text = " and ".join(f"{maker} ({', '.join(names)})" for maker, names in makers.items())
    text += ", scaled by size and ratio"

    def add_column_estimate(friction_column: str, estimated_value: float, *interval_ends: float) -> None:
        """Add an estimated number to the catalogue entry of a drive.

        A column for which the catalogue has a value is left unchanged.
        """
        interval = min(interval_ends), max(interval_ends)
        numbers.setdefault(
            friction_column, SourcedNumber(estimated_value, "estimate", text, estimate_interval=interval)
        )

    add_column_estimate("starting_torque", *law.starting_torque)
    start = numbers["starting_torque"].si_value
    add_column_estimate("running_torque", *(start + x for x in law.viscous_torque))
    add_column_estimate("back_driving_torque", *(ratio * start / (1.0 - x) for x in law.load_loss_back))
    if rated := numbers.get("rated_torque"):
        idle = 1.0 + numbers["running_torque"].si_value * ratio / rated.si_value
        add_column_estimate("efficiency", *(1.0 / (idle + x) for x in law.load_loss))
    return CatalogueEntry(catalogue_entry.joint_name, numbers)
