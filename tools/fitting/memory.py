"""What the fits of joints with memory share: model of a measurement, search, facts, notes, pictures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal

from ..plots import shown
from .branches import Loops, ordered
from .hysteresis import Free, HysteresisLaw, Oscillator, Response
from .least_squares import Exchange, Residuals, Solution, Unknown, best_start, solve
from .measurement import Measurement
from .outcome import Facts, Picture, systematic

DAMPING = "damping_ratio"
"""Unknown that is no parameter of the joint: the damping ratio of the structure beside it [1]."""
MOST_DAMPING = 0.3
DAMPING_UNKNOWN = Unknown(DAMPING, "1", 1e-3, 1e-9, MOST_DAMPING)
ROUGH, TOLERANCE = 1e-3, 1e-6
"""Relative change of cost or parameters at which the first and the second fit end [1]."""
ROUGH_NOISE = 0.01
"""Noise of the first fit over the size of the data [1]; it holds the search back only."""
QUIET = 1e-9
"""Least noise over the largest [1]: data without any are made by a program."""

Law = Callable[[Mapping[str, float]], HysteresisLaw]


@dataclass(frozen=True, slots=True)
class MeasurementModel:
    """A measurement's model: the law over the unknowns, and what vibrates.

    law     : {name: value} of the unknowns -> law of the loop
    inertia : mass or inertia on the joint, None with loops
    damping : damping ratio of the structure beside the joint [1], if it is not an unknown
    """

    law: Law
    inertia: float | None
    damping: float

    def of(self, values: Mapping[str, float]) -> HysteresisLaw:
        return self.law({name: value for name, value in values.items() if name != DAMPING})

    def residuals(self, data: Loops | Free | Response, values: Mapping[str, float], scale: Array) -> Array:
        law = self.of(values)
        if isinstance(data, Loops):
            return data.residuals(law, scale)
        return data.residuals(self.oscillator(law, values), scale)

    def oscillator(self, law: HysteresisLaw, values: Mapping[str, float]) -> Oscillator:
        assert self.inertia is not None
        return Oscillator(law, self.inertia, values.get(DAMPING, self.damping))


def model(
    measurement: Measurement, law: Law, setting: str, inertia: float | None, damping: float
) -> MeasurementModel:
    """The model of a measurement; `setting` is the option of the inertia.

    Raises ValueError if what vibrates is stated with loops, is missing otherwise, or is out of its range.
    """
    what = setting.replace("_", " ")
    if measurement.kind == "loops":
        if inertia is not None:
            raise ValueError(f"{measurement.path}: has loops, nothing vibrates; allowed is no {what}")
    elif inertia is None:
        raise Refusal(f"{measurement.path}: has a vibration ({measurement.kind}); state the {what}", setting)
    elif not 0.0 < inertia < np.inf:
        raise ValueError(f"{what} = {inertia:g} is outside (0, inf)")
    if not 0.0 <= damping < MOST_DAMPING:
        raise ValueError(f"damping ratio = {damping:g} is outside [0, {MOST_DAMPING:g})")
    return MeasurementModel(law, inertia, damping)


def search(
    measurement: Measurement,
    unknowns: Sequence[Unknown],
    model: MeasurementModel,
    starts: Mapping[str, Sequence[float]],
    level: Exchange | None = None,
    moved: bool = False,
    corrected: Callable[[Mapping[str, float]], Measurement] | None = None,
) -> tuple[Solution, Array, Measurement]:
    """The best values; each group of data is weighted by its own noise, which a first fit finds.

    starts : {name: values beside the start's} at which the search may begin
    level  : the stiffness at rest and the unknown that carries it, which begins where the data have it
    moved  : whether the search moves that stiffness instead of the unknown
    corrected : values that the first fit found -> the measurement as the law would have it

    Returns the solution, the noise (n) of the data, and the measurement that it was fitted to.

    Raises ValueError and RuntimeError as `solve`; ValueError if the law allows none of the starts.
    """
    data = measurement.data

    def residuals(scale: Array) -> Residuals:
        return lambda values: model.residuals(data, values, scale)

    def exchanged(of: Residuals) -> Residuals:
        if exchange is None:
            return of
        swap, near = exchange, own[exchange.name].start
        return lambda values: of(swap.values(values, near))

    rough = data.scale
    seen = None if level is None else measurement.rest_stiffness(model.inertia)

    def tried(values: dict[str, float]) -> tuple[Mapping[str, float], float]:
        """At the stiffness that the data have, whatever else the point has."""
        if level is not None and seen is not None:
            rest = {name: value for name, value in values.items() if name != level.name}
            values |= level.values(rest | {level.label: seen}, values[level.name])
        if any(not u.low < values[u.name] < u.high for u in unknowns):
            return values, np.inf
        return values, float(np.sum(residuals(rough)(values) ** 2))

    own = {u.name: u for u in best_start(unknowns, starts, tried)}
    exchange = level if moved else None
    found = [exchange.unknown(own) if exchange and u.name == exchange.name else u for u in own.values()]
    first = solve(found, exchanged(residuals(rough)), noise=ROUGH_NOISE, tolerance=ROUGH)
    rest = first.residuals
    if corrected is not None:
        measurement = corrected(first.values)
        data = measurement.data
        rest = residuals(rough)(first.values)
    square = np.bincount(data.groups, rest[: rough.size] ** 2) / np.bincount(data.groups)
    scale = rough * np.sqrt(np.maximum(square, QUIET**2 * np.max(square)))[data.groups]
    found = [replace(u, start=_inside(u, first.values[u.name])) for u in found]
    solution = solve(found, exchanged(residuals(scale)), nuisances=data.nuisances, tolerance=TOLERANCE)
    return (exchange.back(solution, own) if exchange else solution), scale, measurement


def _inside(unknown: Unknown, value: float) -> float:
    """A value kept off the bounds."""
    low = max(unknown.low * (1.0 + 1e-6), 1e-300)
    return float(min(max(value, low), unknown.high * (1.0 - 1e-6)))


def facts(measurement: Measurement, solution: Solution, law: HysteresisLaw, scale: Array) -> Facts:
    """What was read off the data beside the parameters; `scale` (n), the noise of the data."""
    data, (_, unit) = measurement.data, measurement.heads.unit
    found = {
        "points": (float(data.scale.size), "1", "data points used"),
        "amplitude": (measurement.amplitude, unit, f"largest {measurement.heads.motion}"),
    }
    if isinstance(data, Loops) and law.elastic:
        found["offset"] = (data.rest(law, scale), unit, f"{measurement.heads.motion} at rest, taken off")
    if isinstance(data, Loops) and data.areas:
        area, size = max(data.areas, key=lambda loop: loop[1])
        found["loop_area"] = (area, "J", "measured, of the widest loop")
        found["loop_area_law"] = (float(law.area(np.array([0.5 * size]))[0]), "J", "of the fitted law there")
    _, loss = law.equivalent(np.array([measurement.amplitude]))
    found["loss_factor"] = (float(loss[0]), "1", "of the fitted law at the largest amplitude")
    found["noise"] = (solution.noise, "1", "of a residual over what its group has")
    return found


def notes(measurement: Measurement, solution: Solution) -> list[str]:
    """Whether the law misses the data systematically."""
    if measurement.kind == "response":
        return []
    rest = solution.residuals[: measurement.data.groups.size]
    same = np.diff(measurement.data.groups) == 0
    return systematic(rest, "data", same)


_LINE = 120


def pictures(
    measurement: Measurement, model: MeasurementModel, values: Mapping[str, float], scale: Array
) -> Sequence[Picture]:
    """Loops, or amplitudes over the frequency; or frequency and, beside it, damping over the amplitude."""
    law = model.of(values)
    match measurement.data:
        case Loops() as loops:
            return [_loops(measurement, loops, law, scale)]
        case Response() as response:
            return [_response(measurement, response, model.oscillator(law, values))]
        case Free() as free:
            return _free(measurement, free, model.oscillator(law, values))


def _loops(measurement: Measurement, loops: Loops, law: HysteresisLaw, scale: Array) -> Picture:
    (force_unit, by), (motion_unit, size) = (
        shown(unit, values)
        for unit, values in zip(measurement.heads.unit, (loops.force, loops.motion), strict=True)
    )
    lines = []
    law = law.about(loops.rest(law, scale))
    forces, starts, misfit = loops.fitted(law, scale)
    for k, (force, start) in enumerate(zip(forces, starts, strict=True)):
        motion = np.linspace(start, loops.motion[loops.branch == k][-1], _LINE)
        branch = force + law.change(motion, np.full(_LINE, start))
        lines.append(np.append(np.stack([motion, branch]), [[np.nan], [np.nan]], axis=1))
    line = np.concatenate(lines, axis=1)
    names = measurement.heads
    return Picture(
        x=size * loops.motion,
        y=by * loops.force,
        misfit=by * misfit,
        line=(size * line[0], by * line[1]),
        labels=(
            f"{names.motion} [{motion_unit}]",
            f"{names.force} [{force_unit}]",
            f"data - law [{force_unit}]",
        ),
    )


def _response(measurement: Measurement, data: Response, oscillator: Oscillator) -> Picture:
    unit, size = shown(measurement.heads.unit[1], data.amplitude)
    lines = []
    for force in np.unique(data.force):
        inside = data.force == force
        f = np.linspace(data.frequency[inside].min(), data.frequency[inside].max(), 4 * _LINE)
        near = np.interp(f, *ordered(data.frequency[inside], data.amplitude[inside]))
        amplitude = oscillator.response(f, np.full_like(f, force), near)
        lines.append(np.append(np.stack([f, amplitude]), [[np.nan], [np.nan]], axis=1))
    line = np.concatenate(lines, axis=1)
    return Picture(
        x=data.frequency,
        y=size * data.amplitude,
        misfit=100.0 * np.expm1(data.misfit(oscillator)),
        line=(line[0], size * line[1]),
        labels=("frequency [Hz]", f"{measurement.heads.motion} [{unit}]", "data / law - 1 [%]"),
    )


def _free(measurement: Measurement, data: Free, oscillator: Oscillator) -> tuple[Picture, Picture]:
    unit, size = shown(measurement.heads.unit[1], data.points.amplitude)
    a = data.points.amplitude
    grid = np.linspace(a.min(), a.max(), _LINE)
    lines, (frequency, damping) = oscillator.free(grid), np.split(data.misfit(oscillator), 2)
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
