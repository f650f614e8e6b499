"""Load histories of a joint for its report: load ramp and load cycles, computed in Python without an FMU."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jointfmu_fmu_src.native.page import evaluated

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..ramps.loops import HysteresisLoops, Swing, conjugate, of
from ..ramps.ramp import RampResult

_POINTS = 101
"""Number of points of the load ramp."""
_SWING = Swing(points=80)
"""Load cycle: points per cycle, shape, number of cycles."""
PARTS = (0.25, 0.5, 1.0)
"""Amplitudes of the load cycles over the largest amplitude [1]."""
_FAR, _SURE = 10, 12
"""Doublings of the load in the search for the end of the law, and bisections to locate it."""
_SETTLED = 0.95
"""Force over the force at gross slip [1] above which the joint counts as slipping."""


class Course:
    """Load ramp and load cycles of a joint. All other inputs have the start values of the file.

    file, spring : parameter file, tabulated curves of the joint
    model        : model of the FMU, with ramp and load cycle for this file
    start_values : {input: start value}
    limit        : (value of the ramped input, warning) at the end of the law's range; None if there is no end
                   near the ramp
    """

    def __init__(self, model: Model, file: ParameterFile) -> None:
        self.file, self.spring = file, model.spring(file.values)
        self.rest = {v.name: file.start(v.name) for v in model.inputs}
        self.model = model.of(file.joint, file.values).loaded(self.spring, self.rest)
        self.limit = _limit(self.model, self.spring, self.rest)

    def ramp(self) -> dict[str, Array]:
        """Compute inputs and outputs (n) along the load ramp; points are dense where curves bend."""
        ramp = self.model.ramp
        points = [{**self.rest, ramp.input: float(x)} for x in ramp.points(_POINTS)]
        rows = [point | evaluated(self.model, self.spring, point) for point in points]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    @property
    def about(self) -> dict[str, float]:
        """Inputs during the load cycles: start values, or the settings of the model if these are zero."""
        assert self.model.loop
        settings = self.model.loop.settings
        return {name: value or float(settings.get(name, 0.0)) for name, value in self.rest.items()}

    def loops(self) -> HysteresisLoops:
        """Compute hysteresis loops of increasing amplitude, each from rest, of a joint with friction."""
        loop, driven = self.model.loop, {v.name: v.unit for v in self.model.inputs}
        assert loop
        outputs = {v.name: v.unit for v in self.model.outputs}
        output = conjugate(driven, outputs, loop.input, None, self.model.name)
        swing = Swing(about=self.about[loop.input], points=_SWING.points)
        largest = self._amplitude(output)
        results = [self._driven(loop.input, swing.along(a * largest), driven | outputs) for a in PARTS]
        return of(results, loop.input, output, swing)

    def _amplitude(self, output: str) -> float:
        """Largest amplitude of the load cycles.

        It is the amplitude of the model, or, if that is less, twice the displacement at gross slip.
        """
        loop = self.model.loop
        assert loop
        largest = loop.amplitude

        def reached(amplitude: float) -> float:
            points = self.about[loop.input] + np.array([0.0, amplitude])
            return float(np.ptp(self._driven(loop.input, points, {}).columns[output]))

        end = reached(largest)
        if _SETTLED * reached(2.0 * largest) > end:
            return largest
        low, high = 0.0, largest
        for _ in range(_SURE):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if reached(middle) > _SETTLED * end else (middle, high)
        return min(largest, float(f"{2.0 * high:.2g}"))

    def _driven(self, name: str, points: Array, units: dict[str, str]) -> RampResult:
        """Compute the outputs along a path of one input, from rest."""
        evolve, rest = self.model.evolve, self.model.rest
        assert evolve
        assert rest
        memory, rows = rest(self.spring), []
        for x in points:
            outputs, memory = evolve(self.spring, {**self.about, name: float(x)}, memory)
            rows.append({name: float(x)} | {output: float(value) for output, value in outputs.items()})
        return RampResult({key: np.array([row[key] for row in rows]) for key in rows[0]}, units, ())


def _limit(model: Model, spring: Any, rest: Mapping[str, float]) -> tuple[float, str] | None:
    """Find the end of the law: smallest ramped input with a warning that is absent at zero, and the warning.

    None if no such warning appears up to 2^10 times the end of the ramp.
    """

    def said(x: float) -> dict[int, str]:
        inputs = {**rest, model.ramp.input: x}
        return model.warnings(spring, inputs | evaluated(model, spring, inputs))

    before = said(0.0)

    def beyond(x: float) -> list[str]:
        return [text for number, text in said(x).items() if number not in before]

    low, high = 0.0, 2.0**-_FAR * model.ramp.end
    while not beyond(high):
        low, high = high, 2.0 * high
        if high > 2.0**_FAR * model.ramp.end:
            return None
    for _ in range(_SURE):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return high, beyond(high)[0]
