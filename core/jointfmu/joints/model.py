"""What a joint is exported as: inputs and outputs with unit and meaning, and what is computed.

Parameters are those of the joint's parameter set, whose units, intervals and meanings are declared there.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..quantity import Interval, Number, flat_fields

Values = Mapping[str, float]
Outputs = Mapping[str, Number]
Memory = NDArray[np.float64]


class Tabulated(Protocol):
    """A force law over a displacement, with an end."""

    @property
    def end(self) -> tuple[float, float]:
        """Displacement and load at the end of the table."""


class Spring(Protocol):
    """What a joint gives the builders: a parameter set, tabulated once.

    The functions of its `Model` take it, and C is generated of the parameter set. Of a joint of equations the
    parameter set itself may stand for it; then nothing is outside a table.
    """

    @property
    def joint(self) -> object:
        """The parameter set, a frozen dataclass of quantities."""

    @property
    def curve(self) -> Tabulated:
        """The curve that its outputs are read from."""


@dataclass(frozen=True, slots=True)
class Variable:
    """An input or output.

    start : of an input that no parameter file gives
    """

    name: str
    unit: str
    doc: str
    nominal: float = 1.0
    low: float = -math.inf
    start: float = 0.0

    @property
    def interval(self) -> Interval:
        """What an input may be: finite, and not below its least value."""
        return Interval.of(ge=self.low)


@dataclass(frozen=True, slots=True)
class Ramp:
    """Load ramp: the default experiment, one step per interval [s].

    end, step : of the main job's
    reach     : (spring, start values) -> begin and end that show what a parameter set does; None: as above
    begin     : where the load begins
    settings  : of parameters with which a course over time shows in experiments
    """

    input: str
    end: float
    step: float
    interval: float = 1.0
    settings: Mapping[str, float] = field(default_factory=dict)
    reach: Callable[..., tuple[float, float]] | None = None
    begin: float = 0.0

    def points(self, count: int) -> NDArray[np.float64]:
        """Inputs (count) from 0 to the end, dense where the load begins and curves bend."""
        points = self.begin + (self.end - self.begin) * np.linspace(0.0, 1.0, count) ** 2
        points[0] = 0.0
        return points


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop that shows a joint's memory: an input to and fro about its start value, from rest.

    settings : of parameters and inputs with which it has an area
    """

    input: str
    amplitude: float
    settings: Mapping[str, float | bool]


@dataclass(frozen=True, slots=True)
class Outside:
    """A way to leave the tables, worth a warning: a variable outside its interval.

    interval : (joint, (x, y) at the end of the curve, inputs) -> (low, high); numbers or symbols
    doc      : what happens there
    """

    variable: str
    interval: Callable[..., tuple[Number, Number]]
    doc: str


@dataclass(frozen=True, slots=True)
class Model:
    """One exported model of a joint, later an FMU.

    joint    : kind of the parameter file
    parameters : its parameter set with the joint's default law
    spring   : makes the tabulated joint of a parameter set
    evaluate : (spring, inputs) -> outputs; of a joint with memory from rest
    outside  : warnings about a state outside the tables
    dependencies : inputs that an output depends on, where not on all
    linear   : {output: {input: what the factor depends on}} where an output is linear in an input with a
        factor of parameters only ("parameters") or of none ("constant")
    hidden   : prefixes of parameters that no tool may change
    states   : continuous states, the first outputs: positions of bodies, then their speeds; after them the
        accelerations, so that the rate of each is the output as many places on as there are bodies
    moves    : outputs change with time, while inputs rest
    events   : (spring) -> times [s] at which their course has a corner, numbers or symbols; None: at none
    rest     : (spring) -> memory (n) of a joint that has not moved yet, all zero; None: it has no memory
    evolve   : (spring, inputs, memory) -> outputs and memory after the straight path to the inputs; the
        memory given stays as it is
    loop     : that shows its memory
    variant  : (model, parameter set) -> the model where a parameter set gives it further outputs
    alias    : the name that a user gave it; "" for its own
    """

    name: str
    joint: str
    doc: str
    parameters: type[object]
    spring: Callable[..., Spring]
    inputs: Sequence[Variable]
    outputs: Sequence[Variable]
    evaluate: Callable[..., Outputs]
    outside: Sequence[Outside]
    ramp: Ramp
    dependencies: Mapping[str, Sequence[str]]
    linear: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    hidden: Sequence[str] = ()
    states: int = 0
    moves: bool = False
    events: Callable[..., Sequence[Number]] | None = None
    rest: Callable[..., Memory] | None = None
    evolve: Callable[..., tuple[Outputs, Memory]] | None = None
    loop: Loop | None = None
    variant: "Callable[[Model, Any], Model] | None" = None
    alias: str = ""

    def __post_init__(self) -> None:
        if (self.rest is None) != (self.evolve is None):
            raise ValueError(f"{self.name}: one of rest, evolve is given, expected both or none")
        if self.loop and self.evolve is None:
            raise ValueError(f"{self.name}: a loop is given without a memory, expected one with evolve")

    @property
    def title(self) -> str:
        """What it is called where it is used."""
        return self.alias or self.name

    def rate(self, output: int) -> bool:
        """Whether an output is the rate of a state."""
        bodies = self.states // 2
        return bodies <= output < self.states + bodies

    def parameter_fields(self) -> dict[str, Any]:
        """Structured names and fields of the parameters that the FMU exposes."""
        return {
            name: item
            for name, item in flat_fields(self.parameters)
            if not any(name == h or name.startswith(f"{h}.") for h in self.hidden)
            and not isinstance(item.metadata.get("allowed", (0,))[0], str)
        }

    def of(self, joint: str, parameters: object) -> "Model":
        """The model with the parameters and outputs of a parameter file, whose interface law may be another.

        Raises ValueError if the file is of another joint than this FMU's.
        """
        if joint != self.joint:
            raise ValueError(f"{self.name}: the parameter file is of a {joint!r}, expected a {self.joint!r}")
        own = replace(self, parameters=type(parameters))
        return self.variant(own, parameters) if self.variant else own

    def loaded(self, spring: Spring, start: Values) -> "Model":
        """The model with its ramp, and a loop over the same input, as far as they reach with these."""
        ramp, loop = self.ramp, self.loop
        if ramp.reach is None:
            return self
        begin, end = (float(x) for x in ramp.reach(spring, start))
        end = max(end, start[ramp.input])
        stretch = end / ramp.end
        if loop and loop.input == ramp.input:
            loop = replace(loop, amplitude=stretch * loop.amplitude)
        ramp = replace(ramp, begin=max(begin, 0.0), end=end, step=stretch * ramp.step)
        return replace(self, ramp=ramp, loop=loop)

    def warnings(self, spring: Spring, values: Values) -> dict[int, str]:
        """Warnings about a state of inputs and outputs outside the tables, by number."""
        units = {v.name: "" if v.unit == "1" else f" {v.unit}" for v in (*self.inputs, *self.outputs)}
        messages = {}
        for i, o in enumerate(self.outside):
            value, unit = values[o.variable], units[o.variable]
            low, high = (float(end) for end in o.interval(spring.joint, spring.curve.end, values))
            inside = Interval.of(ge=low, le=high)
            if not inside.contains(value):
                messages[i] = f"{o.variable} = {value:.6g}{unit} is outside {inside}{unit}: {o.doc}"
        return messages

    def depends(self, output: str) -> Sequence[str]:
        """Inputs and states on which an output depends."""
        return self.dependencies.get(output, [v.name for v in self.inputs])


BEYOND = "beyond the tabulated law the last tangent is continued"
"""What happens outside a table."""
