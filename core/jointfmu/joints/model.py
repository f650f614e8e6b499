"""Models that are exported as FMUs: inputs, outputs, evaluation, validity limits and default experiments.

The parameter set of the joint declares the parameters with their units, intervals and meanings.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..quantity import Interval, Number, flatten_fields

VariableValues = Mapping[str, float]
OutputValues = Mapping[str, Number]
History = NDArray[np.float64]


class LoadDisplacementTable(Protocol):
    """Load-displacement table of a joint, which ends at a largest displacement."""

    @property
    def end_point(self) -> tuple[float, float]:
        """Displacement and load at the last point of the table."""


class TabulatedJoint(Protocol):
    """Joint ready for evaluation: parameter values, and the load-displacement table computed from them.

    The functions of `Model` take it as their first argument. A joint that needs no table may use its
    parameter set itself; its model then has no validity limits.
    """

    @property
    def joint(self) -> object:
        """Parameter set of the joint, a frozen dataclass; C code is generated from it."""

    @property
    def curve(self) -> LoadDisplacementTable:
        """Table of the load as a function of the displacement, from which the outputs are interpolated."""


INPUT_MARGIN_OVER_NOMINAL = 1e-5
"""Margin below the minimum of an input over its nominal value [1]. Solvers form derivatives with steps of
1.5e-8 to 6e-6 of a value: the square root and the cubic root of the precision of doubles."""


@dataclass(frozen=True, slots=True)
class Variable:
    """Input or output of a model.

    nominal : typical size, in the unit
    minimum : smallest allowed value of an input
    start   : start value of an input that the parameter file does not state
    """

    name: str
    unit: str
    doc: str
    nominal: float = 1.0
    minimum: float = -math.inf
    start: float = 0.0

    @property
    def interval(self) -> Interval:
        """Interval of allowed values of an input: finite, and at least `minimum`."""
        return Interval.from_bounds(ge=self.minimum)

    @property
    def minimum_margin(self) -> float:
        """Tolerance, in the variable's unit, by which a solver's steps may set an input below `minimum`."""
        return INPUT_MARGIN_OVER_NOMINAL * self.nominal if math.isfinite(self.minimum) else 0.0

    def round_to_minimum(self, input_value: float) -> float:
        """Raise an input value to `minimum` if it is below by at most `minimum_margin`; else return it."""
        return (
            self.minimum if self.minimum - self.minimum_margin <= input_value < self.minimum else input_value
        )


@dataclass(frozen=True, slots=True)
class LoadRamp:
    """Load ramp of one input of a model, its default experiment: the input grows in steps.

    end_value, value_step : largest value and increment of the input for the default parameters
    step_duration    : [s] time between two steps
    parameter_values : {parameter: value} that replace default parameters during the ramp
    find_load_range  : function (tabulated joint, start values) -> onset and end value for the parameters of
        this joint; None: `onset_value` and `end_value` hold for all parameters
    onset_value      : value of the input at which the load starts to act
    """

    input_name: str
    end_value: float
    value_step: float
    step_duration: float = 1.0
    parameter_values: Mapping[str, float] = field(default_factory=dict)
    find_load_range: Callable[..., tuple[float, float]] | None = None
    onset_value: float = 0.0

    def sample_inputs(self, value_count: int) -> NDArray[np.float64]:
        """Values of the input: 0, then from the onset to the end of the ramp, dense near the onset."""
        points = (
            self.onset_value + (self.end_value - self.onset_value) * np.linspace(0.0, 1.0, value_count) ** 2
        )
        points[0] = 0.0
        return points


@dataclass(frozen=True, slots=True)
class LoadCycle:
    """Load cycle that shows hysteresis: the input oscillates about its start value, from the virgin state.

    variable_values : {parameter or input: value} for which the loop encloses an area
    find_output_scales : function (parameter set, {output: values over the cycle}) -> {output: scale} of
        outputs whose round-off is not relative to each value, but to this scale; or None
    """

    input_name: str
    input_amplitude: float
    variable_values: Mapping[str, float | bool]
    find_output_scales: Callable[[Any, Mapping[str, NDArray[np.float64]]], Mapping[str, float]] | None = None


@dataclass(frozen=True, slots=True)
class ValidityLimit:
    """Validity limit: interval of an input or output outside of which the FMU warns, such as its table's end.

    variable_name : name of the input or output
    find_interval : function (parameter set, (displacement, load) at the end of the table, inputs) -> lower
        and upper end of the interval; numbers or symbols
    doc           : text of the warning: what happens outside
    """

    variable_name: str
    find_interval: Callable[..., tuple[Number, Number]]
    doc: str


@dataclass(frozen=True, slots=True)
class Model:
    """Model of a joint, exported as one FMU.

    name     : name of the FMU
    joint    : kind of the joint, `joint = NAME` in parameter files
    parameter_class : class of the parameter set with the joint's default law
    tabulate : function, parameter set -> tabulated joint
    evaluate : function (tabulated joint, inputs) -> outputs; a model with history starts in the virgin state
    validity_limits : a warning for each variable that leaves its interval
    ramp     : default experiment
    dependencies : {output: inputs that it depends on}; outputs that are not listed depend on all inputs
    linear_factors : {output: {input: kind of the factor}} for outputs that are linear in an input: "constant"
        if the factor is a number, "parameters" if it is a function of the parameters alone
    fixed_parameters : parameters, or prefixes of their names, that the FMU does not expose
    state_count : number of continuous states, which are the first outputs: positions of bodies, then their
        speeds; then follow the accelerations. So the rate of output i is output i + number of bodies.
    evaluate_residuals : function (tabulated joint, inputs, states and accelerations) -> residuals of the
        equations of motion, whose derivative by the accelerations is symmetric; the C code then computes the
        derivatives of the accelerations from those of the residuals. None: from `evaluate`
    is_time_dependent : whether outputs change with time at constant inputs
    find_event_times : function, tabulated joint -> times [s] at which outputs have a kink, numbers or
        symbols; None: there are none
    initial_history : function, tabulated joint -> history variables (n) of the virgin state, all zero; None:
        the model has no history
    advance  : function (tabulated joint, inputs, history variables) -> outputs and new history variables
        after a straight path to the inputs; the history variables passed in are not modified
    load_cycle : load cycle that shows the hysteresis
    make_variant : function (model, parameter set) -> model with additional outputs for this parameter set;
        None: there are none, or the model has them already
    alias    : name that the user gave to the FMU; "": `name`

    Raises ValueError if only one of `initial_history` and `advance` is given, or a loop without them.
    """

    name: str
    joint: str
    doc: str
    parameter_class: type[Any]
    tabulate: Callable[..., TabulatedJoint]
    inputs: Sequence[Variable]
    outputs: Sequence[Variable]
    evaluate: Callable[..., OutputValues]
    validity_limits: Sequence[ValidityLimit]
    ramp: LoadRamp
    dependencies: Mapping[str, Sequence[str]]
    linear_factors: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    fixed_parameters: Sequence[str] = ()
    state_count: int = 0
    evaluate_residuals: Callable[..., Sequence[Number]] | None = None
    is_time_dependent: bool = False
    find_event_times: Callable[..., Sequence[Number]] | None = None
    initial_history: Callable[..., History] | None = None
    advance: Callable[..., tuple[OutputValues, History]] | None = None
    load_cycle: LoadCycle | None = None
    make_variant: "Callable[[Model, Any], Model] | None" = None
    alias: str = ""

    def __post_init__(self) -> None:
        if (self.initial_history is None) != (self.advance is None):
            raise ValueError(
                f"{self.name}: one of initial_history, advance is missing; state both or neither"
            )
        if self.load_cycle and self.advance is None:
            raise ValueError(f"{self.name}: a load cycle needs history, expected initial_history and advance")

    @property
    def title(self) -> str:
        """Displayed name: the alias, if there is one, else the name."""
        return self.alias or self.name

    def is_state_derivative(self, output_index: int) -> bool:
        """Whether the output with this index is the time derivative of a state."""
        bodies = self.state_count // 2
        return bodies <= output_index < self.state_count + bodies

    def parameter_fields(self) -> dict[str, Any]:
        """Dataclass fields of the parameters that the FMU exposes: {structured parameter name: field}."""
        return {
            name: item
            for name, item in flatten_fields(self.parameter_class)
            if "series" not in item.metadata
            and not any(name == h or name.startswith(f"{h}.") for h in self.fixed_parameters)
            and not isinstance(item.metadata.get("allowed", (0,))[0], str)
        }

    def with_parameters(self, joint_name: str, parameter_set: object) -> "Model":
        """Copy of the model for a parameter set, which may have another law and add outputs.

        joint_name : kind of joint of the parameter set

        Raises ValueError if the model is of another kind of joint.
        """
        if joint_name != self.joint:
            raise ValueError(
                f"{self.name}: the parameter file has joint = {joint_name!r}, expected joint = {self.joint!r}"
            )
        model = replace(self, parameter_class=type(parameter_set))
        if self.make_variant:
            model = replace(self.make_variant(model, parameter_set), make_variant=None)
        return model

    def with_load_range(self, tabulated_joint: TabulatedJoint, start_values: VariableValues) -> "Model":
        """Copy of the model with load ramp and cycle scaled to a joint's load range and start values.

        The load cycle is scaled if it has the same input as the ramp.
        """
        ramp, loop = self.ramp, self.load_cycle
        if ramp.find_load_range is None:
            return self
        onset, end = (float(x) for x in ramp.find_load_range(tabulated_joint, start_values))
        end = max(end, start_values[ramp.input_name])
        scale = end / ramp.end_value
        if loop and loop.input_name == ramp.input_name:
            loop = replace(loop, input_amplitude=scale * loop.input_amplitude)
        ramp = replace(ramp, onset_value=max(onset, 0.0), end_value=end, value_step=scale * ramp.value_step)
        return replace(self, ramp=ramp, load_cycle=loop)

    def find_warnings(
        self, tabulated_joint: TabulatedJoint, variable_values: VariableValues
    ) -> dict[int, str]:
        """Warnings {index of the validity limit: text} for variables outside their intervals."""
        units = {v.name: "" if v.unit == "1" else f" {v.unit}" for v in (*self.inputs, *self.outputs)}
        messages = {}
        for i, o in enumerate(self.validity_limits):
            value, unit = variable_values[o.variable_name], units[o.variable_name]
            low, high = (
                float(end)
                for end in o.find_interval(
                    tabulated_joint.joint, tabulated_joint.curve.end_point, variable_values
                )
            )
            inside = Interval.from_bounds(ge=low, le=high)
            if not inside.contains(value):
                messages[i] = f"{o.variable_name} = {value:.6g}{unit} is outside {inside}{unit}: {o.doc}"
        return messages

    def list_dependencies(self, output_name: str) -> Sequence[str]:
        """Names of the inputs and states on which an output depends."""
        return self.dependencies.get(output_name, [v.name for v in self.inputs])


EXTRAPOLATION_WARNING = "outside the tabulated law, the curve continues with its last tangent"
"""Text of the warning for a state beyond the end of the table."""
