"""Definition of the C code of a joint: generated functions, constants, shared C files."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import casadi as ca

from jointfmu.contact import interface
from jointfmu.joints.model import Model
from jointfmu.mechanics import curve
from jointfmu.mechanics.memory import HistoryLayout

from .c_text import number
from .graph import Graph

CURVE = ("tabulated_joint", "curve")
"""Shared C files of a joint with a tabulated curve."""
TABLES = (*CURVE, "spot_distribution")
"""Shared C files of a joint that also inverts its interface law."""
APPROACH = (*TABLES, "approach")
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

    def __or__(self, other: "Definitions") -> "Definitions":
        return Definitions(
            {**self.counts, **other.counts}, {**self.macros, **other.macros}, {**self.arrays, **other.arrays}
        )


def column(name: str, size: str, values: Any) -> Definitions:
    """Define a C array `name[size]` of double and its size."""
    return Definitions({size: len(values)}, {}, {f"{name}[{size}]": [number(x) for x in values]})


def quadrature(prefix: str, nodes: Any) -> Definitions:
    """Define quadrature nodes `PREFIX[N_PREFIX]` and weights `PREFIX_WEIGHTS[N_PREFIX]`."""
    abscissas = column(prefix, f"N_{prefix}", nodes[0])
    weights = column(f"{prefix}_WEIGHTS", f"N_{prefix}", nodes[1])
    return abscissas | weights


Named = Mapping[ModuleType, Sequence[str]]
"""{module: names of its constants}, which have the same names in C."""
NUMBERS: Named = {
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
COUNTS: Named = {curve: ("MAX_REFINEMENT",), interface: ("MAX_ITERATIONS",)}
"""Python constants that the C of every joint with tables needs: integers (NUMBER_NAMES: real numbers)."""


def named(numbers: Named, counts: Named) -> Definitions:
    """Definitions of constants of Python modules: real numbers and integers."""
    count_values, number_values = (
        {name: getattr(module, name) for module, names in names_by_module.items() for name in names}
        for names_by_module in (counts, numbers)
    )
    return Definitions(count_values, number_values)


@dataclass(frozen=True, slots=True)
class NativePart:
    """Definition of the C code of a joint.

    add_functions    : adds the functions that the C of the joint calls to a graph
    shared_files     : stems of files in `runtime/law/` that it needs, besides the files of every FMU
    make_definitions : (graph, model) -> constants of its C
    history_layout   : layout of the history variables, of the largest size; `HISTORY_NAME` in C is an index
    """

    functions: Callable[[Graph, Model], None]
    shared: Sequence[str]
    definitions: Callable[[Graph, Model], Definitions] = lambda graph, model: Definitions()
    memory: HistoryLayout = HistoryLayout({})

    @property
    def tabulated(self) -> bool:
        """Whether the joint has a tabulated curve."""
        return "tabulated_joint" in self.shared


def _equations(g: Graph, model: Model) -> None:
    """Add the outputs, and the event times if any, of a model with explicit equations."""
    names = ("time", *(v.name for v in model.inputs), *(v.name for v in model.outputs[: model.state_count]))
    v: dict[str, Any] = {name: ca.SX.sym(name) for name in names}
    outputs = model.evaluate(g.joint, v)
    doc = "time, inputs, states -> outputs"
    if model.find_event_times:
        g.add(
            "event_times",
            "-> times at which the course of the outputs has a corner",
            [],
            model.find_event_times(g.joint),
        )
    g.add_with_seed("outputs", doc, list(v.values()), [outputs[o.name] for o in model.outputs])


EQUATIONS = NativePart(_equations, ("equations",))
"""C definition of a model whose outputs are explicit functions of time, inputs and states."""


def shared_definitions(shared: Sequence[str]) -> Definitions:
    """Constants that the shared C files need."""
    if "tabulated_joint" not in shared:
        return Definitions()
    tables = named(NUMBERS, COUNTS) | Definitions({"CURVE_NODES": curve.MAX_NODES})
    if "approach" not in shared:
        return tables
    steps = {"APPROACH_STEPS": curve.MIN_STEPS_PER_LOG_AREA, "CLOSING_STEPS": curve.CLOSING_STEPS}
    ratio = {"CLOSING_RATIO": curve.CLOSING_RATIO}
    return tables | Definitions(steps, ratio) | quadrature("APPROACH_GAUSS", curve.GAUSS_RULE)
