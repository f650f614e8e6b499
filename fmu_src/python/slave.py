"""pythonfmu slave of all FMUs of the flavour python; the physics is in the package, not here."""

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
    list_variables,
    model_structure,
    stop_time,
    text,
    unit_definitions,
)
from pythonfmu import Boolean, DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Initial, Fmi2Status

from jointfmu import __version__
from jointfmu.files.timestamp import build_time
from jointfmu.joints import KINDS, MODELS, register_joint
from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import History, Model, TabulatedJoint
from jointfmu.parameters import load_parameter_file
from jointfmu.quantity import build_parameter_set

T = TypeVar("T")


class AcceptedPath(NamedTuple):
    """Last accepted load step of a joint with history: history before and after it, inputs at its end."""

    before: list[float]
    after: list[float]
    inputs: dict[str, float]


def keep_references(method: Callable[..., T]) -> Callable[..., T]:
    """Decorate a method that may raise: protect its instance from a reference count error of pythonfmu 0.7.

    On every exception pythonfmu 0.7 releases one reference too many to the instance, its class and its log
    queue. After a few exceptions the process would crash.
    """

    @wraps(method)
    def guarded(self: Any, *args: Any) -> T:
        try:
            return method(self, *args)
        except Exception:
            for released in (self, type(self), self.log_queue):
                ctypes.pythonapi.Py_IncRef(ctypes.py_object(released))
            raise

    return guarded


class JointSlave(Fmi2Slave):  # type: ignore[misc]
    """FMU instance: variables, checks, log messages and state around the model of the package.

    The complete state is `values` (parameters and inputs), `initialized`, `warned_keys` and `accepted_step`.
    Everything else is computed from it on demand.
    """

    kind: ClassVar[JointKind]
    fmu: ClassVar[str]
    content: ClassVar[str]
    """Digest of all code and parameters inside the FMU; the GUID follows from it."""
    variability: ClassVar[str]
    """Variability of all parameters, one of `xml_parts.VARIABILITIES`."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        if self.kind.name not in KINDS:  # a joint of another package
            register_joint(self.kind)
        file = load_parameter_file(Path(self.resources) / "parameters.toml", self.kind.name)
        self.model: Model = MODELS[self.fmu].with_parameters(file.joint, file.values)
        self.modelName = type(self).__name__
        self.description = self.model.doc
        self.version, self.license, self.author = __version__, "MIT", "jointfmu"
        self.guid = uuid5(NAMESPACE_URL, f"jointfmu/{self.modelName}/{self.content}")
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=stop_time(self.model), step_size=1.0
        )
        self.start = dict(file.values_by_name)
        self.listed = list_variables(self.model, file)
        self.fields = self.model.parameter_fields()
        self.values: dict[str, Any] = {
            **self.start,
            **{v.name: file.start_value(v.name) for v in self.model.inputs},
        }
        self.initialized = False
        self.warned: set[int] = set()
        self.way: AcceptedPath | None = None
        self._spring: TabulatedJoint | None = None
        self._outputs: dict[str, float] | None = None
        self._memory: History | None = None
        for item in self.listed:
            self.register_variable(self._variable(item), nested=False)

    def _variable(self, item: ListedVariable) -> object:
        """pythonfmu variable of a listed variable."""
        name, output, parameter = item.name, item.causality == "output", item.causality == "parameter"
        initial = Fmi2Initial.calculated if output else Fmi2Initial.exact
        return (Boolean if item.boolean else Real)(
            name,
            causality=Fmi2Causality[item.causality],
            variability=Fmi2Variability[self.variability if parameter else "continuous"],
            description=item.doc,
            getter=(lambda: self.output(name)) if output else (lambda: self.values[name]),
            setter=None if output else (lambda value: self.set(name, value)),
            **({"initial": initial} if output or parameter else {}),
        )

    def set(self, name: str, value: object) -> None:
        """Set a parameter or an input; its value is checked at the next evaluation."""
        if name in self.fields:
            if self.initialized and self.variability == "fixed":
                self.refuse(f"{name} is a fixed parameter: it can be set until initialization ends")
            if self.way is not None:  # the next load step starts at the accepted inputs
                self.way = AcceptedPath(self.way.after, self.way.after, {})
            self._spring = None
        self.values[name] = value
        self._outputs = None

    def output(self, name: str) -> float:
        """Value of an output at the current inputs."""
        if self._outputs is None:
            self._outputs = self.evaluate()
        return self._outputs[name]

    def evaluate(self) -> dict[str, float]:
        """Evaluate all outputs at the current inputs; fails if an input is not finite or out of range."""
        inputs = self.inputs()
        for v in self.model.inputs:
            if not v.interval.contains(inputs[v.name]):
                unit = "" if v.unit == "1" else f" {v.unit}"
                self.refuse(f"{v.name} = {inputs[v.name]:g}{unit} is outside {v.interval}: {v.doc}")
        try:
            with np.errstate(all="ignore"):
                results, self._memory = self.at(inputs)
        except (ValueError, RuntimeError, OverflowError) as error:
            self.refuse(str(error))
        outputs = {name: float(value) for name, value in results.items()}
        if not_finite := [name for name, value in outputs.items() if not math.isfinite(value)]:
            inputs_text = ", ".join(f"{name} = {value:g}" for name, value in inputs.items() if value)
            self.refuse(f"{inputs_text}: too large, {not_finite[0]} is not finite")
        for key, message in self.model.find_warnings(self.spring(), {**inputs, **outputs}).items():
            if key not in self.warned:
                self.warned.add(key)
                self.log(message, Fmi2Status.warning, "logStatusWarning")
        return outputs

    def inputs(self) -> dict[str, float]:
        """{input: current value}."""
        return {v.name: self.values[v.name] for v in self.model.inputs}

    def memory(self, inputs: dict[str, float]) -> History:
        """History variables at the start of the load step to given inputs.

        If these are the accepted inputs, the accepted load step is repeated from its start.
        """
        if self.way is None:
            assert self.model.initial_history is not None
            return self.model.initial_history(self.spring())
        return np.array(self.way.before if inputs == self.way.inputs else self.way.after)

    def at(self, inputs: dict[str, float]) -> tuple[Mapping[str, Any], History | None]:
        """Outputs at given inputs, and the history variables there (None: the joint has none)."""
        if self.model.advance is None:
            return self.model.evaluate(self.spring(), inputs), None
        return self.model.advance(self.spring(), inputs, self.memory(inputs))

    def accept(self) -> None:
        """Evaluate the outputs, and accept the load step to the current inputs."""
        self.output(self.model.outputs[0].name)
        inputs = self.inputs()
        if self._memory is not None and (self.way is None or inputs != self.way.inputs):
            self.way = AcceptedPath(self.memory(inputs).tolist(), self._memory.tolist(), inputs)

    def spring(self) -> TabulatedJoint:
        """Tabulated joint for the current parameters."""
        if self._spring is None:
            parameters = {name: self.values[name] for name in self.start}
            self._spring = self.model.tabulate(build_parameter_set(self.model.parameters, parameters))
        return self._spring

    def refuse(self, message: str) -> NoReturn:
        """Log an error and raise it, so that the FMI call fails."""
        self.log(message, Fmi2Status.error, "logStatusError")
        raise ValueError(message)

    @keep_references
    def exit_initialization_mode(self) -> None:
        """End initialization: check the parameters, tabulate the joint, evaluate the outputs."""
        self.accept()
        self.initialized = True

    @keep_references
    def do_step(self, current_time: float, step_size: float) -> bool:
        """Evaluate the outputs at the current inputs and accept the load step; fails for invalid inputs."""
        self.accept()
        return True

    get_real, set_real = keep_references(Fmi2Slave.get_real), keep_references(Fmi2Slave.set_real)
    get_integer, set_integer = keep_references(Fmi2Slave.get_integer), keep_references(Fmi2Slave.set_integer)
    get_boolean, set_boolean = keep_references(Fmi2Slave.get_boolean), keep_references(Fmi2Slave.set_boolean)
    get_string, set_string = keep_references(Fmi2Slave.get_string), keep_references(Fmi2Slave.set_string)

    def _get_fmu_state(self) -> dict[str, object]:
        state = {"values": dict(self.values), "initialized": self.initialized, "warned": sorted(self.warned)}
        return state | ({"way": self.way} if self.model.initial_history else {})

    @keep_references
    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        if state.keys() != self._get_fmu_state().keys() or state["values"].keys() != self.values.keys():
            self.refuse(f"the FMU state is none of {self.modelName}; expected one that this FMU gave")
        changed = any(self.values[name] != state["values"][name] for name in self.start)
        self.values, self.initialized = dict(state["values"]), state["initialized"]
        self.warned = set(state["warned"])
        self.way = AcceptedPath(*state["way"]) if state.get("way") else None
        self._outputs = None
        if changed:
            self._spring = None

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, object]:
        """Decode an FMU state; unreadable bytes give an empty state, which is refused when it is set."""
        try:
            values = json.loads(state.decode("utf-8"))
        except ValueError:
            return {}
        return values if isinstance(values, dict) else {}

    def to_xml(self, model_options: Any = None) -> Element:
        """Model description with the parts that pythonfmu omits: units, bounds, initial unknowns."""
        root: Element = super().to_xml(dict(model_options or {}))
        root.set("generationDateAndTime", build_time().strftime("%Y-%m-%dT%H:%M:%SZ"))
        root.set("generationTool", f"jointfmu {__version__}")
        root.insert(1, unit_definitions(self.listed))
        for item, node in zip(self.listed, root.iter("ScalarVariable"), strict=True):
            if item.attributes:
                node[0].attrib.update(item.attributes)
                if item.start is not None:
                    node[0].set("start", text(item.start))
        structure = root.find("ModelStructure")
        assert structure is not None
        structure[:] = model_structure(self.model, self.variability)
        return root
