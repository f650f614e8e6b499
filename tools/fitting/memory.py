"""Fit of hysteresis laws to measurements: model, search, derived facts, notes and plots.

The fits of all joints with hysteresis use this module.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ..plots import choose_unit
from .branches import Loops, sort_points
from .hysteresis import ForcedResponse, FreeVibration, HysteresisLaw, Oscillator
from .least_squares import Exchange, Residuals, Solution, Unknown, select_start, solve
from .measurement import Measurement
from .outcome import Facts, Picture, correlation_note

DAMPING = "damping_ratio"
"""Name of an unknown that is not a parameter of the joint: the damping ratio of the structure [1]."""
MAX_DAMPING = 0.3
"""Upper limit of the damping ratio of the structure [1]."""
DAMPING_UNKNOWN = Unknown(DAMPING, "1", 1e-3, 1e-9, MAX_DAMPING)
FIRST_TOLERANCE, TOLERANCE = 1e-3, 1e-6
"""Relative change of cost or parameters at which the first and the second fit end [1]."""
FIRST_NOISE = 0.01
"""Noise assumed in the first fit, over the size of the data [1]; it only sets the regularisation."""
MIN_NOISE_RATIO = 1e-9
"""Lower limit of the noise of a group, over the largest noise of all groups [1]; for data without noise."""

Law = Callable[[Mapping[str, float]], HysteresisLaw]


@dataclass(frozen=True, slots=True)
class MeasurementModel:
    """Model of a measurement: hysteresis law as a function of the unknowns, and the vibrating inertia.

    make_law      : function {name: value} of the unknowns -> hysteresis law
    inertia       : mass [kg] or moment of inertia [kg.m2] on the joint; None for loops
    damping_ratio : damping ratio of the structure [1], if it is not an unknown
    """

    law: Law
    inertia: float | None
    damping: float

    def hysteresis_law(self, values: Mapping[str, float]) -> HysteresisLaw:
        """Hysteresis law at values of the unknowns."""
        return self.law({name: value for name, value in values.items() if name != DAMPING})

    def residuals(
        self, data: Loops | FreeVibration | ForcedResponse, values: Mapping[str, float], scale: Array
    ) -> Array:
        """Residuals of the data at values of the unknowns.

        residual_scale : standard deviations (n) of the data, by which the residuals are divided
        """
        law = self.hysteresis_law(values)
        if isinstance(data, Loops):
            return data.residuals(law, scale)
        return data.residuals(self.oscillator(law, values), scale)

    def oscillator(self, law: HysteresisLaw, values: Mapping[str, float]) -> Oscillator:
        """Oscillator with a hysteresis law; its damping ratio is taken from `values` if it is an unknown."""
        assert self.inertia is not None
        return Oscillator(law, self.inertia, values.get(DAMPING, self.damping))


def build_model(
    measurement: Measurement, law: Law, inertia_option: str, inertia: float | None, damping: float
) -> MeasurementModel:
    """Build the model of a measurement; check inertia and damping ratio.

    inertia_option : name of the option for the inertia, used in error messages

    Raises ValueError if the inertia is stated for loops, is missing for a vibration, or if inertia or damping
    ratio are out of range.
    """
    name = inertia_option.replace("_", " ")
    if measurement.kind == "loops":
        if inertia is not None:
            raise ValueError(f"{measurement.path}: has loops, so {name} has no effect; leave it out")
    elif inertia is None:
        raise InputRefusal(
            f"{measurement.path}: has a vibration ({measurement.kind}); state the {name}", inertia_option
        )
    elif not 0.0 < inertia < np.inf:
        raise ValueError(f"{name} = {inertia:g} is outside (0, inf)")
    if not 0.0 <= damping < MAX_DAMPING:
        raise ValueError(f"damping ratio = {damping:g} is outside [0, {MAX_DAMPING:g})")
    return MeasurementModel(law, inertia, damping)


def fit_measurement(
    measurement: Measurement,
    unknowns: Sequence[Unknown],
    model: MeasurementModel,
    starts: Mapping[str, Sequence[float]],
    level: Exchange | None = None,
    exchanges_level: bool = False,
    correct_measurement: Callable[[Mapping[str, float]], Measurement] | None = None,
) -> tuple[Solution, Array, Measurement]:
    """Fit the unknowns twice: the first fit estimates the noise of each group of data, the second uses it.

    alternative_starts  : {name: alternative start values} of the search
    level_exchange      : stiffness at rest, and the unknown that is adjusted at each start to the measured
                          stiffness
    is_level_exchanged  : whether the stiffness at rest replaces that unknown during the search
                          (`UnknownExchange`)
    correct_measurement : function: values of the first fit -> corrected measurement, used in the second fit

    Returns the solution, the noise (n) of the data, and the measurement of the second fit.

    Raises ValueError and RuntimeError as `solve`; ValueError if the law allows none of the starts.
    """
    data = measurement.data

    def residuals(scale: Array) -> Residuals:
        return lambda values: model.residuals(data, values, scale)

    def apply_exchange(function: Residuals) -> Residuals:
        if exchange is None:
            return function
        current, start = exchange, original[exchange.name].start
        return lambda values: function(current.restore_unknowns(values, start))

    first_scale = data.scale
    measured_stiffness = None if level is None else measurement.rest_stiffness(model.inertia)

    def evaluate_start(values: dict[str, float]) -> tuple[Mapping[str, float], float]:
        """Values of a starting point and their cost; the level is adjusted to the measured stiffness."""
        if level is not None and measured_stiffness is not None:
            others = {name: value for name, value in values.items() if name != level.name}
            values |= level.restore_unknowns(others | {level.label: measured_stiffness}, values[level.name])
        if any(not u.low < values[u.name] < u.high for u in unknowns):
            return values, np.inf
        return values, float(np.sum(residuals(first_scale)(values) ** 2))

    original = {u.name: u for u in select_start(unknowns, starts, evaluate_start)}
    exchange = level if exchanges_level else None
    free = [
        exchange.unknown(original) if exchange and u.name == exchange.name else u for u in original.values()
    ]
    first = solve(free, apply_exchange(residuals(first_scale)), noise=FIRST_NOISE, tolerance=FIRST_TOLERANCE)
    first_residuals = first.residuals
    if correct_measurement is not None:
        measurement = correct_measurement(first.values)
        data = measurement.data
        first_residuals = residuals(first_scale)(first.values)
    square = np.bincount(data.noise_groups, first_residuals[: first_scale.size] ** 2) / np.bincount(
        data.noise_groups
    )
    scale = first_scale * np.sqrt(np.maximum(square, MIN_NOISE_RATIO**2 * np.max(square)))[data.noise_groups]
    free = [replace(u, start=_clip_to_bounds(u, first.values[u.name])) for u in free]
    solution = solve(
        free, apply_exchange(residuals(scale)), nuisance_count=data.nuisance_count, tolerance=TOLERANCE
    )
    return (exchange.restore_solution(solution, original) if exchange else solution), scale, measurement


def _clip_to_bounds(unknown: Unknown, value: float) -> float:
    """Clip a value to slightly inside of the bounds of an unknown."""
    low = max(unknown.low * (1.0 + 1e-6), 1e-300)
    return float(min(max(value, low), unknown.high * (1.0 - 1e-6)))


def facts(measurement: Measurement, solution: Solution, law: HysteresisLaw, scale: Array) -> Facts:
    """Results of a fit besides its parameters: points, amplitude, offset, loop area, loss factor, noise.

    residual_scale : noise (n) of the data
    """
    data, (_, unit) = measurement.data, measurement.heads.si_units
    result = {
        "points": (float(data.scale.size), "1", "data points used"),
        "amplitude": (measurement.amplitude, unit, f"largest {measurement.heads.motion}"),
    }
    if isinstance(data, Loops) and law.elastic:
        result["offset"] = (
            data.rest_position(law, scale),
            unit,
            f"{measurement.heads.motion} at rest, taken off",
        )
    if isinstance(data, Loops) and data.areas:
        area, size = max(data.areas, key=lambda loop: loop[1])
        result["loop_area"] = (area, "J", "measured, of the widest loop")
        result["loop_area_law"] = (
            float(law.loop_area(np.array([0.5 * size]))[0]),
            "J",
            "of the fitted law there",
        )
    _, loss = law.equivalent_spring(np.array([measurement.amplitude]))
    result["loss_factor"] = (float(loss[0]), "1", "of the fitted law at the largest amplitude")
    result["noise"] = (
        solution.noise,
        "1",
        "standard deviation of a residual, relative to the size of its group",
    )
    return result


def notes(measurement: Measurement, solution: Solution) -> list[str]:
    """Notes for the user if the residuals show that the law misses the data systematically; else empty."""
    if measurement.kind == "response":
        return []
    residuals = solution.residuals[: measurement.data.noise_groups.size]
    same_group = np.diff(measurement.data.noise_groups) == 0
    return correlation_note(residuals, "data", same_group)


_CURVE_POINTS = 120
"""Number of points of a plotted curve of the law."""


def pictures(
    measurement: Measurement, model: MeasurementModel, values: Mapping[str, float], scale: Array
) -> Sequence[Picture]:
    """Plots of data and fitted law, by the kind of the measurement.

    Loops: force over motion. Forced vibration: amplitude over frequency. Free vibration: frequency over
    amplitude, and damping ratio over amplitude.
    """
    law = model.hysteresis_law(values)
    match measurement.data:
        case Loops() as loops:
            return [_loops_picture(measurement, loops, law, scale)]
        case ForcedResponse() as response:
            return [_response_picture(measurement, response, model.oscillator(law, values))]
        case FreeVibration() as free:
            return _decay_pictures(measurement, free, model.oscillator(law, values))


def _loops_picture(measurement: Measurement, loops: Loops, law: HysteresisLaw, scale: Array) -> Picture:
    """Plot of measured loops: force over motion."""
    (force_unit, force_scale), (motion_unit, motion_scale) = (
        choose_unit(unit, values)
        for unit, values in zip(measurement.heads.si_units, (loops.force, loops.motion), strict=True)
    )
    lines = []
    law = law.shift_rest(loops.rest_position(law, scale))
    forces, starts, misfit = loops.fit_turning_points(law, scale)
    for k, (force, start) in enumerate(zip(forces, starts, strict=True)):
        motion = np.linspace(
            start, loops.motion[loops.branch == k][-1], _CURVE_POINTS
        )  # NaN separates the branches
        branch = force + law.force_change(motion, np.full(_CURVE_POINTS, start))
        lines.append(np.append(np.stack([motion, branch]), [[np.nan], [np.nan]], axis=1))
    line = np.concatenate(lines, axis=1)
    names = measurement.heads
    return Picture(
        x=motion_scale * loops.motion,
        y=force_scale * loops.force,
        misfit=force_scale * misfit,
        line=(motion_scale * line[0], force_scale * line[1]),
        labels=(
            f"{names.motion} [{motion_unit}]",
            f"{names.force} [{force_unit}]",
            f"data - law [{force_unit}]",
        ),
    )


def _response_picture(measurement: Measurement, data: ForcedResponse, oscillator: Oscillator) -> Picture:
    """Plot of a forced vibration: amplitude over frequency, one curve for each force amplitude."""
    unit, size = choose_unit(measurement.heads.si_units[1], data.amplitude)
    lines = []
    for force in np.unique(data.force):
        inside = data.force == force
        f = np.linspace(data.frequency[inside].min(), data.frequency[inside].max(), 4 * _CURVE_POINTS)
        measured = np.interp(f, *sort_points(data.frequency[inside], data.amplitude[inside]))
        amplitude = oscillator.response_amplitude(f, np.full_like(f, force), measured)
        lines.append(np.append(np.stack([f, amplitude]), [[np.nan], [np.nan]], axis=1))
    line = np.concatenate(lines, axis=1)
    return Picture(
        x=data.frequency,
        y=size * data.amplitude,
        misfit=100.0 * np.expm1(data.misfit(oscillator)),
        line=(line[0], size * line[1]),
        labels=("frequency [Hz]", f"{measurement.heads.motion} [{unit}]", "data / law - 1 [%]"),
    )


def _decay_pictures(
    measurement: Measurement, data: FreeVibration, oscillator: Oscillator
) -> tuple[Picture, Picture]:
    """Plots of a free vibration: frequency and damping ratio over amplitude."""
    unit, size = choose_unit(measurement.heads.si_units[1], data.points.amplitude)
    a = data.points.amplitude
    grid = np.linspace(a.min(), a.max(), _CURVE_POINTS)
    lines, (frequency, damping) = oscillator.free_vibration(grid), np.split(data.misfit(oscillator), 2)
    x = f"amplitude of the {measurement.heads.motion} [{unit}]"
    return (
        Picture(
            x=size * a,
            y=data.points.frequency,
            misfit=100.0 * frequency,
            line=(size * grid, lines[0]),
            labels=(x, "frequency [Hz]", "data / law - 1 [%]"),
        ),
        Picture(
            x=size * a,
            y=100.0 * data.points.damping,
            misfit=100.0 * damping,
            line=(size * grid, 100.0 * lines[1]),
            labels=(x, "damping ratio [%]", "data - law [%]"),
        ),
    )
