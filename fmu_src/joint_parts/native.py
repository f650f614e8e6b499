"""Definition of the C code of a joint: generated functions, constants, shared C files."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import casadi as ca

from jointfmu.contact import interface
from jointfmu.joints.model import Model
from jointfmu.mechanics import curve
from jointfmu.mechanics.history_layout import HistoryLayout

from .c_text import format_number
from .graph import Graph

CURVE_FILES = ("tabulated_joint", "curve")
"""Shared C files of a joint with a tabulated curve."""
INVERSION_FILES = (*CURVE_FILES, "spot_distribution")
"""Shared C files of a joint that also inverts its interface law."""
APPROACH_FILES = (*INVERSION_FILES, "approach")
"""Shared C files of a joint that also has a curve of pressure against approach."""


@dataclass(frozen=True, slots=True)
class Definitions:
    """Constants of the C code.

    counts : {name: integer}, written as an enum
    macros : {name: number}, written as #define
    arrays : {declaration: rows} of arrays of double
    """

    counts: Mapping[str, int] = field(default_factory=dict)
    macros: Mapping[str, float] = field(default_factory=dict)
    arrays: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def __or__(self, addition: "Definitions") -> "Definitions":
        """Constants of both; ValueError if they give one name two values."""
        first, second = ({**each.counts, **each.macros, **each.arrays} for each in (self, addition))
        if clashes := [name for name in first.keys() & second if first[name] != second[name]]:
            raise ValueError(f"C constant {min(clashes)} has two values; expected one name for one constant")
        return Definitions(
            {**self.counts, **addition.counts},
            {**self.macros, **addition.macros},
            {**self.arrays, **addition.arrays},
        )


def define_array(array_name: str, size_name: str, values: Any) -> Definitions:
    """Define a C array of double, and its size as a constant."""
    return Definitions(
        {size_name: len(values)}, {}, {f"{array_name}[{size_name}]": [format_number(x) for x in values]}
    )


def define_quadrature(prefix: str, nodes_and_weights: Any) -> Definitions:
    """Define quadrature nodes `PREFIX[N_PREFIX]` and weights `PREFIX_WEIGHTS[N_PREFIX]`."""
    abscissas = define_array(prefix, f"N_{prefix}", nodes_and_weights[0])
    weights = define_array(f"{prefix}_WEIGHTS", f"N_{prefix}", nodes_and_weights[1])
    return abscissas | weights


ModuleConstants = Mapping[ModuleType, Sequence[str]]
"""{module: names of its constants}, which have the same names in C."""
NUMBER_NAMES: ModuleConstants = {
    curve: ("MAX_ERROR",),
    interface: (
        "MIN_LOG_AREA",
        "MAX_LOG_AREA",
        "MIN_LOAD_SLOPE",
        "MAX_LOAD_SLOPE",
        "NEWTON_TOLERANCE",
        "MIN_PRESSURE",
        "ONE_SIDED_OFFSET",
    ),
}
COUNT_NAMES: ModuleConstants = {curve: ("MAX_REFINEMENT",), interface: ("MAX_ITERATIONS",)}
"""Python constants that the C of every joint with tables needs: integers (NUMBER_NAMES: real numbers)."""


def define_constants(number_names: ModuleConstants, count_names: ModuleConstants) -> Definitions:
    """Definitions of constants of Python modules: real numbers and integers."""
    count_values, number_values = (
        {name: getattr(module, name) for module, names in names_by_module.items() for name in names}
        for names_by_module in (count_names, number_names)
    )
    return Definitions(count_values, number_values)


@dataclass(frozen=True, slots=True)
class NativeDefinition:
    """Definition of the C code of a joint.

    add_functions    : adds the functions that the C of the joint calls to a graph
    shared_files     : stems of files in `runtime/law/` that it needs, besides the files of every FMU
    make_definitions : (graph, model) -> constants of its C
    history_layout   : layout of the history variables, of the largest size; `HISTORY_NAME` in C is an index
    """

    add_functions: Callable[[Graph, Model], None]
    shared_files: Sequence[str]
    make_definitions: Callable[[Graph, Model], Definitions] = lambda graph, model: Definitions()
    history_layout: HistoryLayout = HistoryLayout({})

    @property
    def is_tabulated(self) -> bool:
        """Whether the joint has a tabulated curve."""
        return "tabulated_joint" in self.shared_files


def _add_equations(function_graph: Graph, model: Model) -> None:
    """Add the outputs, and the event times if any, of a model with explicit equations."""
    names = ("time", *(v.name for v in model.inputs), *(v.name for v in model.outputs[: model.state_count]))
    v: dict[str, Any] = {name: ca.SX.sym(name) for name in names}
    outputs = model.evaluate(function_graph.joint, v)
    doc = "time, inputs, states -> outputs"
    if model.find_event_times:
        function_graph.add_function(
            "event_times",
            "-> times at which the course of the outputs has a corner",
            [],
            model.find_event_times(function_graph.joint),
        )
    function_graph.add_with_derivative(
        "outputs", doc, list(v.values()), [outputs[o.name] for o in model.outputs]
    )


EQUATIONS_DEFINITION = NativeDefinition(_add_equations, ("equations",))
"""C definition of a model whose outputs are explicit functions of time, inputs and states."""


def shared_definitions(shared_files: Sequence[str]) -> Definitions:
    """Constants that the shared C files need."""
    if "tabulated_joint" not in shared_files:
        return Definitions()
    tables = define_constants(NUMBER_NAMES, COUNT_NAMES) | Definitions({"CURVE_NODES": curve.MAX_TABLE_NODES})
    if "approach" not in shared_files:
        return tables
    steps = {"APPROACH_STEPS": curve.MIN_STEPS_PER_LOG_AREA, "CLOSING_STEPS": curve.CLOSING_STEPS}
    ratio = {"CLOSING_AREA_RATIO": curve.CLOSING_AREA_RATIO}
    return tables | Definitions(steps, ratio) | define_quadrature("APPROACH_GAUSS", curve.GAUSS_RULE)
