"""Pictures of the fits of joints with memory: data, fitted law, residuals."""

from collections.abc import Mapping

import numpy as np

from ..plots import shown
from .branches import Loops
from .hysteresis import HysteresisLaw
from .least_squares import Array
from .measurement import Measurement
from .memory import MeasurementModel
from .oscillator import Free, Oscillator, Response
from .outcome import Picture

_LINE = 120


def pictures(
    measurement: Measurement, model: MeasurementModel, values: Mapping[str, float], scale: Array
) -> tuple[Picture, Picture | None]:
    """Loops, or amplitudes over the frequency; or frequency and, beside it, damping over the amplitude."""
    law = model.of(values)
    match measurement.data:
        case Loops() as loops:
            return _loops(measurement, loops, law, scale), None
        case Response() as response:
            return _response(measurement, response, model.oscillator(law, values)), None
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
        near = np.interp(f, *_ordered(data.frequency[inside], data.amplitude[inside]))
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


def _ordered(x: Array, y: Array) -> tuple[Array, Array]:
    order = np.argsort(x, kind="stable")
    return x[order], y[order]


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
