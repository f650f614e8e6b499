"""FMU instance (pythonfmu slave) of the flavour python; the physics is in the package jointfmu, not here."""

import ctypes
import json
import math
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, NoReturn, TypeVar
from uuid import NAMESPACE_URL, uuid5
from xml.etree.ElementTree import Element

import numpy as np
from jointfmu_fmu_src.xml_parts import (
    ListedVariable,
    format_start_value,
    list_variables,
    make_model_structure,
    make_unit_definitions,
    stop_time,
)
from pythonfmu import Boolean, DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Initial, Fmi2Status

from jointfmu.files.timestamp import get_build_time
from jointfmu.joints import KINDS, MODELS, register_joint
from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import History, Model, TabulatedJoint
from jointfmu.parameters import load_parameter_file
from jointfmu.quantity import build_parameter_set
from jointfmu.version import __version__

MethodReturnValue = TypeVar("MethodReturnValue")
MAX_INPUTS_IN_ERROR_MESSAGE = 4
"""Largest number of inputs that an error message lists [1]."""
LOST_START_VALUES_WARNING_KEY = -1
"""Key, in `warned_keys`, of the warning of inputs at 0 in place of their start values."""


class AcceptedStep(NamedTuple):
    """Last accepted load step of a joint with history: history before and after the step, final inputs."""

    history_before: list[float]
    history_after: list[float]
    end_inputs: dict[str, float]


def protect_reference_counts(
    slave_method: Callable[..., MethodReturnValue],
) -> Callable[..., MethodReturnValue]:
    """Decorate a method of an FMU instance, so that its exceptions do not crash the process.

    On every exception pythonfmu 0.7 releases one reference too many to the instance, its class and its log
    queue. After a few exceptions Python would delete these objects in use.
    """

    @wraps(slave_method)
    def call_with_protected_references(self: Any, *args: Any) -> MethodReturnValue:
        """Call the wrapped method; after an exception restore the references that pythonfmu wrongly releases.

        One reference is added to the instance, its class and its log queue, which Python would delete in use.
        """
        try:
            return slave_method(self, *args)
        except Exception:
            for released in (self, type(self), self.log_queue):
                ctypes.pythonapi.Py_IncRef(ctypes.py_object(released))
            raise

    return call_with_protected_references


class JointSlave(Fmi2Slave):  # type: ignore[misc]
    """FMU instance of the flavour python: variables, checks, log messages and state of a joint.

    The complete state is `values` (parameters and inputs), `initialized`, `warned_keys` and `accepted_step`.
    Everything else is computed from this state on demand.
    """

    joint_kind: ClassVar[JointKind]
    model_name: ClassVar[str]
    content_digest: ClassVar[str]
    """Digest of all code and parameters inside the FMU; the GUID follows from it."""
    parameter_variability: ClassVar[str]
    """Variability of all parameters, one of `xml_parts.PARAMETER_VARIABILITIES`."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        if self.joint_kind.name not in KINDS:  # a joint of another package
            register_joint(self.joint_kind)
        file = load_parameter_file(Path(self.resources) / "parameters.toml", self.joint_kind.name)
        self.model: Model = MODELS[self.model_name].with_parameters(file.joint, file.values)
        self.modelName = type(self).__name__
        self.description = self.model.doc
        self.version, self.license, self.author = __version__, "MIT", "jointfmu"
        self.guid = uuid5(NAMESPACE_URL, f"jointfmu/{self.modelName}/{self.content_digest}")
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=stop_time(self.model), step_size=1.0
        )
        self.start = dict(file.values_by_name)
        self.listed_variables = list_variables(self.model, file)
        self.fields = self.model.parameter_fields()
        self.input_starts = {v.name: file.start_value(v.name) for v in self.model.inputs}
        self.values: dict[str, Any] = {**self.start, **self.input_starts}
        self.initialized = False
        self.start_time = 0.0
        self.warned_keys: set[int] = set()
        self.accepted_step: AcceptedStep | None = None
        self._spring: TabulatedJoint | None = None
        self._outputs: dict[str, float] | None = None
        self._memory: History | None = None
        for item in self.listed_variables:
            self.register_variable(self._make_variable(item), nested=False)

    def _make_variable(self, listed_variable: ListedVariable) -> object:
        """Make the object of pythonfmu for a variable of the model description."""
        name = listed_variable.variable_name
        output = listed_variable.causality == "output"
        parameter = listed_variable.causality == "parameter"
        initial = Fmi2Initial.calculated if output else Fmi2Initial.exact
        return (Boolean if listed_variable.is_boolean else Real)(
            name,
            causality=Fmi2Causality[listed_variable.causality],
            variability=Fmi2Variability[self.parameter_variability if parameter else "continuous"],
            description=listed_variable.variable_description,
            getter=(lambda: self.get_output(name)) if output else (lambda: self.values[name]),
            setter=None if output else (lambda value: self.set_variable(name, value)),
            **({"initial": initial} if output or parameter else {}),
        )

    def set_variable(self, variable_name: str, variable_value: object) -> None:
        """Set a parameter or an input of the FMU; the value is checked at the next evaluation."""
        if variable_name in self.fields:
            if self.initialized and self.parameter_variability == "fixed":
                self.log_error_and_raise(
                    f"{variable_name} is a fixed parameter: it can be set only until initialization ends"
                )
            if self.accepted_step is not None:  # the next load step starts at the accepted inputs
                self.accepted_step = AcceptedStep(
                    self.accepted_step.history_after, self.accepted_step.history_after, {}
                )
            self._spring = None
        self.values[variable_name] = variable_value
        self._outputs = None

    def get_output(self, output_name: str) -> float:
        """Value of an output at the current inputs, evaluated if it is not up to date."""
        if self._outputs is None:
            self._outputs = self.evaluate()
        return self._outputs[output_name]

    def evaluate(self) -> dict[str, float]:
        """Evaluate all outputs at the current inputs.

        Raises ValueError if an input is outside its interval, or an output is not finite.
        """
        for v in self.model.inputs:
            self.values[v.name] = v.round_to_minimum(self.values[v.name])
        inputs = self.get_inputs()
        for v in self.model.inputs:
            if not v.interval.contains(inputs[v.name]):
                unit = "" if v.unit == "1" else f" {v.unit}"
                self.log_error_and_raise(
                    f"{v.name} = {inputs[v.name]:g}{unit} is outside {v.interval}: {v.doc}"
                )
        try:
            with np.errstate(all="ignore"):
                results, self._memory = self.evaluate_with_history(inputs)
        except (ValueError, RuntimeError, OverflowError) as error:
            self.log_error_and_raise(str(error))
        outputs = {name: float(value) for name, value in results.items()}
        if not_finite := [name for name, value in outputs.items() if not math.isfinite(value)]:
            largest = sorted(filter(inputs.get, inputs), key=lambda name: -abs(inputs[name]))
            listed = {*largest[:MAX_INPUTS_IN_ERROR_MESSAGE]}
            inputs_text = ", ".join(f"{name} = {inputs[name]:g}" for name in inputs if name in listed)
            if more := len(largest) - len(listed):
                inputs_text += f" and {more} more"
            self.log_error_and_raise(
                f"{inputs_text}: the inputs are too large, the output {not_finite[0]} is not finite"
            )
        self.log_warnings(inputs, outputs)
        return outputs

    def log_warnings(self, input_values: Mapping[str, float], output_values: Mapping[str, float]) -> None:
        """Log a warning for each validity limit that inputs or outputs exceed, each limit once.

        If the host has set inputs to 0 in place of their start values, one warning about these inputs
        replaces the warnings that these zeros cause.
        """
        joint, variables = self.get_tabulated_joint(), {**input_values, **output_values}
        found = self.model.find_warnings(joint, variables)
        lost = self.find_lost_start_values()
        kept = self.model.find_warnings(joint, variables | lost) if found and lost else found
        if found.keys() - kept.keys() - self.warned_keys:
            self.warn_of_lost_start_values()
        for key, message in found.items():
            if key not in self.warned_keys and key in kept:
                self.log(message, Fmi2Status.warning, "logStatusWarning")
        self.warned_keys |= found.keys()

    def find_lost_start_values(self) -> dict[str, float]:
        """{input: start value} of inputs that the host has set to 0, although their start value is not 0."""
        return {
            name: start for name, start in self.input_starts.items() if start and self.values[name] == 0.0
        }

    def warn_of_lost_start_values(self) -> None:
        """Log one warning if the host has set inputs to 0 whose start values are not 0."""
        lost = self.find_lost_start_values()
        if not lost or LOST_START_VALUES_WARNING_KEY in self.warned_keys:
            return
        self.warned_keys.add(LOST_START_VALUES_WARNING_KEY)
        units = {v.name: "" if v.unit == "1" else f" {v.unit}" for v in self.model.inputs}
        listed = ", ".join(
            f"{name} = 0{units[name]} in place of its start value = {start:.6g}{units[name]}"
            for name, start in lost.items()
        )
        text = f"{listed}: some tools set all inputs to 0; connect the input, or set its value"
        self.log(text, Fmi2Status.warning, "logStatusWarning")

    def get_inputs(self) -> dict[str, float]:
        """{input: current value} of the FMU instance."""
        return {v.name: self.values[v.name] for v in self.model.inputs}

    def find_start_history(self, input_values: dict[str, float]) -> History:
        """History variables of the joint at the start of the load step that ends at given inputs.

        If the given inputs equal the inputs of the last accepted step, this step is repeated from its start.
        """
        if self.accepted_step is None:
            assert self.model.initial_history is not None
            return self.model.initial_history(self.get_tabulated_joint())
        return np.array(
            self.accepted_step.history_before
            if input_values == self.accepted_step.end_inputs
            else self.accepted_step.history_after
        )

    def evaluate_with_history(
        self, input_values: dict[str, float]
    ) -> tuple[Mapping[str, Any], History | None]:
        """Return the outputs at given inputs, and the new history variables (None: the joint has none)."""
        if self.model.advance is None:
            return self.model.evaluate(self.get_tabulated_joint(), input_values), None
        return self.model.advance(
            self.get_tabulated_joint(), input_values, self.find_start_history(input_values)
        )

    def accept_load_step(self) -> None:
        """Evaluate the outputs, and accept the load step that ends at the current inputs."""
        self.get_output(self.model.outputs[0].name)
        inputs = self.get_inputs()
        if self._memory is not None and (
            self.accepted_step is None or inputs != self.accepted_step.end_inputs
        ):
            self.accepted_step = AcceptedStep(
                self.find_start_history(inputs).tolist(), self._memory.tolist(), inputs
            )

    def get_tabulated_joint(self) -> TabulatedJoint:
        """Joint with tabulated curve for the current parameters, computed if they have changed."""
        if self._spring is None:
            parameters = {name: self.values[name] for name in self.start}
            self._spring = self.model.tabulate(build_parameter_set(self.model.parameter_class, parameters))
        return self._spring

    def log_error_and_raise(self, error_message: str) -> NoReturn:
        """Log an error and raise it, so that the FMI call fails."""
        self.log(error_message, Fmi2Status.error, "logStatusError")
        raise ValueError(error_message)

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Store the start time of the simulation, at which the first step begins."""
        self.start_time = start_time

    @protect_reference_counts
    def exit_initialization_mode(self) -> None:
        """End the initialization: check the parameters, tabulate the joint, evaluate the outputs."""
        self.accept_load_step()
        self.warn_of_lost_start_values()
        self.initialized = True

    @protect_reference_counts
    def do_step(self, current_time: float, step_size: float) -> bool:
        """Evaluate the outputs at the current inputs and accept the load step; raises for invalid inputs."""
        self.accept_load_step()
        if current_time <= self.start_time:
            self.warn_of_lost_start_values()  # set to 0 between initialization and the first step
        return True

    get_real, set_real = (
        protect_reference_counts(Fmi2Slave.get_real),
        protect_reference_counts(Fmi2Slave.set_real),
    )
    get_integer = protect_reference_counts(Fmi2Slave.get_integer)
    set_integer = protect_reference_counts(Fmi2Slave.set_integer)
    get_boolean = protect_reference_counts(Fmi2Slave.get_boolean)
    set_boolean = protect_reference_counts(Fmi2Slave.set_boolean)
    get_string = protect_reference_counts(Fmi2Slave.get_string)
    set_string = protect_reference_counts(Fmi2Slave.set_string)

    def _get_fmu_state(self) -> dict[str, object]:
        """Complete state of the FMU instance, as a dictionary."""
        state = {
            "values": dict(self.values),
            "initialized": self.initialized,
            "warned": sorted(self.warned_keys),
        }
        return state | ({"way": self.accepted_step} if self.model.initial_history else {})

    @protect_reference_counts
    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        """Set the complete state of the FMU instance. Raises ValueError if the state is of another FMU."""
        if state.keys() != self._get_fmu_state().keys() or state["values"].keys() != self.values.keys():
            self.log_error_and_raise(
                f"the FMU state was not made by {self.modelName}; expected one that this FMU returned"
            )
        changed = any(self.values[name] != state["values"][name] for name in self.start)
        self.values, self.initialized = dict(state["values"]), state["initialized"]
        self.warned_keys = set(state["warned"])
        self.accepted_step = AcceptedStep(*state["way"]) if state.get("way") else None
        self._outputs = None
        if changed:
            self._spring = None

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, object]:
        """Decode an FMU state; unreadable bytes give an empty state, which `_set_fmu_state` refuses."""
        try:
            values = json.loads(state.decode("utf-8"))
        except ValueError:
            return {}
        return values if isinstance(values, dict) else {}

    def to_xml(self, model_options: Any = None) -> Element:
        """Make the model description, with parts that pythonfmu omits: units, bounds, initial unknowns."""
        root: Element = super().to_xml(dict(model_options or {}))
        root.set("generationDateAndTime", get_build_time().strftime("%Y-%m-%dT%H:%M:%SZ"))
        root.set("generationTool", f"jointfmu {__version__}")
        root.insert(1, make_unit_definitions(self.listed_variables))
        for item, node in zip(self.listed_variables, root.iter("ScalarVariable"), strict=True):
            if item.xml_attributes:
                node[0].attrib.update(item.xml_attributes)
                if item.start_value is not None:
                    node[0].set("start", format_start_value(item.start_value))
        structure = root.find("ModelStructure")
        assert structure is not None
        structure[:] = make_model_structure(self.model, self.parameter_variability)
        return root
