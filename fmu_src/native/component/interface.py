"""The interfaces of FMI-LS-WASM: the types and functions of its WIT, written in WIT's own notation.

Draft of the layered standard, github.com/modelica/fmi-ls-wasm, commit 77277f4: package `fmi:fmi3@3.0.0`.
Scheduled execution, which no FMU here has, is left out.
"""

from collections.abc import Mapping
from dataclasses import dataclass

PLATFORM = "wasm32-wasip2"
"""Folder of the component below `binaries`."""
STANDARD = "org.modelica.fmi-ls-wasm"
VERSION = "0.1.0"

Functions = Mapping[str, str]
"""{name: "parameter: type, ... -> result"}."""


def full(interface: str) -> str:
    """Name of an interface with its package."""
    return f"fmi:fmi3/{interface}@3.0.0"


TYPES = {
    "value-reference": "u32",
    "status": "enum<ok, warning, discard, error, fatal>",
    "interval-qualifier": "enum<interval-not-yet-known, interval-unchanged, interval-changed>",
    "dependency-kind": "enum<dependent, constant, fixed, tunable, discrete>",
    "fmu-state": "list<u8>",
    "interval-fraction": "record<counter: u64, resolution: u64>",
    "variable-dependency": "record<dependent-value-reference: value-reference, "
    "element-index-of-dependent: u32, independent-value-reference: value-reference, "
    "element-index-of-independent: u32, kind: dependency-kind>",
    "discrete-states-info": "record<new-discrete-states-needed: bool, terminate-simulation: bool, "
    "nominals-of-continuous-states-changed: bool, values-of-continuous-states-changed: bool, "
    "next-event-time-defined: bool, next-event-time: f64>",
}
"""Of the interface `types`."""
USED = (
    "value-reference",
    "status",
    "fmu-state",
    "interval-qualifier",
    "interval-fraction",
    "variable-dependency",
    "discrete-states-info",
)
"""Those that the interfaces of both kinds of instances have under the same name."""
LOG = {"log-message": "instance-name: string, status: status, category: string, message: string"}
"""What an FMU calls of the interface `callbacks`."""
COMMON = {"get-version": "-> string"}

_VALUES = {
    "float32": "f32",
    "float64": "f64",
    "int8": "s8",
    "int16": "s16",
    "int32": "s32",
    "int64": "s64",
    "uint8": "u8",
    "uint16": "u16",
    "uint32": "u32",
    "uint64": "u64",
    "boolean": "bool",
    "string": "string",
    "binary": "list<u8>",
    "clock": "bool",
}
_REFS = "value-references: list<value-reference>"
_DERIVATIVE = (
    "unknowns: list<value-reference>, knowns: list<value-reference>, seed: list<f64> "
    "-> result<list<f64>, status>"
)
_BOTH = {
    "set-debug-logging": "logging-on: bool, categories: list<string> -> status",
    "enter-initialization-mode": "tolerance: option<f64>, start-time: f64, stop-time: option<f64> -> status",
    "exit-initialization-mode": "-> status",
    "enter-event-mode": "-> status",
    "update-discrete-states": "-> result<discrete-states-info, status>",
    "terminate": "-> status",
    "reset": "-> status",
    "enter-configuration-mode": "-> status",
    "exit-configuration-mode": "-> status",
    **{f"get-{name}": f"{_REFS} -> result<list<{type_}>, status>" for name, type_ in _VALUES.items()},
    **{f"set-{name}": f"{_REFS}, values: list<{type_}> -> status" for name, type_ in _VALUES.items()},
    "get-number-of-variable-dependencies": "vr: value-reference -> result<u64, status>",
    "get-variable-dependencies": "dependent: value-reference -> result<list<variable-dependency>, status>",
    "get-fmu-state": "-> result<fmu-state, status>",
    "set-fmu-state": "state: fmu-state -> status",
    "get-directional-derivative": _DERIVATIVE,
    "get-adjoint-derivative": _DERIVATIVE,
    "get-interval-decimal": f"{_REFS} -> result<list<tuple<f64, interval-qualifier>>, status>",
    "get-interval-fraction": f"{_REFS} -> result<list<tuple<interval-fraction, interval-qualifier>>, status>",
    "get-shift-decimal": f"{_REFS} -> result<list<f64>, status>",
    "get-shift-fraction": f"{_REFS} -> result<list<interval-fraction>, status>",
    "set-interval-decimal": f"{_REFS}, intervals: list<f64> -> status",
    "set-interval-fraction": f"{_REFS}, intervals: list<interval-fraction> -> status",
    "set-shift-decimal": f"{_REFS}, shifts: list<f64> -> status",
    "set-shift-fraction": f"{_REFS}, shifts: list<interval-fraction> -> status",
    "evaluate-discrete-states": "-> status",
    "enter-step-mode": "-> status",
    "get-output-derivatives": "requests: list<tuple<value-reference, u32>> -> result<list<f64>, status>",
}
_START = "instance-name: string, instantiation-token: string, visible: bool, logging-on: bool"


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of instances, with an interface and a resource of its own.

    name    : of the interface
    types   : its own types
    factory : parameters of the static function `instantiate-NAME`
    methods : of the resource `NAME-instance`
    """

    name: str
    types: Mapping[str, str]
    factory: str
    methods: Functions

    @property
    def resource(self) -> str:
        """Name of the resource."""
        return f"{self.name}-instance"

    @property
    def functions(self) -> Functions:
        """All functions under the names that WIT gives them in binaries."""
        new = f"[static]{self.resource}.instantiate-{self.name}"
        self_ = f"self: borrow<{self.resource}>"
        return {new: f"{self.factory} -> option<own<{self.resource}>>"} | {
            f"[method]{self.resource}.{name}": f"{self_}{'' if text.startswith('->') else ','} {text}"
            for name, text in self.methods.items()
        }


KINDS = (
    Kind(
        "model-exchange",
        {"completed-step-result": "record<enter-event-mode: bool, terminate-simulation: bool>"},
        _START,
        _BOTH
        | {
            "enter-continuous-time-mode": "-> status",
            "set-time": "time: f64 -> status",
            "set-continuous-states": "continuous-states: list<f64> -> status",
            "get-continuous-state-derivatives": "-> result<list<f64>, status>",
            "get-event-indicators": "-> result<list<f64>, status>",
            "get-continuous-states": "-> result<list<f64>, status>",
            "get-nominals-of-continuous-states": "-> result<list<f64>, status>",
            "get-number-of-event-indicators": "-> result<u64, status>",
            "get-number-of-continuous-states": "-> result<u64, status>",
            "completed-integrator-step": "no-set-fmu-state-prior-to-current-point: bool "
            "-> result<completed-step-result, status>",
        },
    ),
    Kind(
        "co-simulation",
        {
            "do-step-result": "record<last-successful-time: f64, event-handling-needed: bool, "
            "terminate-simulation: bool, early-return: bool>"
        },
        f"{_START}, event-mode-used: bool, early-return-allowed: bool, "
        "required-intermediate-variables: list<value-reference>",
        _BOTH
        | {
            "set-input-derivatives": "requests: list<tuple<value-reference, u32>>, values: list<f64> "
            "-> status",
            "do-step": "current-communication-point: f64, communication-step-size: f64, "
            "no-set-fmu-state-prior-to-current-point: bool -> result<do-step-result, status>",
        },
    ),
)
