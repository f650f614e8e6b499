"""How a joint becomes C: its functions, the numbers that its C takes, the C it shares."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import casadi as ca

from jointfmu.contact import interface
from jointfmu.joints.model import Model
from jointfmu.mechanics import curve
from jointfmu.mechanics.memory import Layout

from .c_text import number
from .graph import Graph

CURVE = ("tabulated", "curve")
"""Shared C of every joint that has a curve."""
TABLES = (*CURVE, "spots")
"""The same of a joint that inverts its interface law."""
APPROACH = (*TABLES, "approach")
"""The same with the curve of pressure over approach."""


@dataclass(frozen=True, slots=True)
class Definitions:
    """Constants of C.

    counts : {name: whole number}, as an enum
    macros : {name: number}
    arrays : {declaration: rows}, of double
    """

    counts: Mapping[str, int] = field(default_factory=dict)
    macros: Mapping[str, float] = field(default_factory=dict)
    arrays: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def __or__(self, other: "Definitions") -> "Definitions":
        return Definitions(
            {**self.counts, **other.counts}, {**self.macros, **other.macros}, {**self.arrays, **other.arrays}
        )


def column(name: str, size: str, values: Any) -> Definitions:
    """An array `name[size]`."""
    return Definitions({size: len(values)}, {}, {f"{name}[{size}]": [number(x) for x in values]})


def quadrature(prefix: str, nodes: Any) -> Definitions:
    """Nodes `PREFIX[N_PREFIX]` and weights `PREFIX_WEIGHTS[N_PREFIX]` of a quadrature."""
    places = column(prefix, f"N_{prefix}", nodes[0])
    weights = column(f"{prefix}_WEIGHTS", f"N_{prefix}", nodes[1])
    return places | weights


Named = Mapping[ModuleType, Sequence[str]]
"""{module: names} of numbers of the package that C has under the same name."""
NUMBERS: Named = {
    curve: ("MAX_ERROR",),
    interface: ("LEAST", "MOST", "FLATTEST", "STEEPEST", "CLOSE", "NOTHING", "SIDE"),
}
COUNTS: Named = {curve: ("FINEST",), interface: ("MOST_STEPS",)}
"""Of every joint with tables: real numbers, and whole ones."""


def named(numbers: Named, counts: Named) -> Definitions:
    """Numbers of the package, as they are now."""
    counted, real = (
        {name: getattr(module, name) for module, names in given.items() for name in names}
        for given in (counts, numbers)
    )
    return Definitions(counted, real)


@dataclass(frozen=True, slots=True)
class NativePart:
    """How a joint becomes C.

    functions   : adds the functions that its C calls to a graph
    shared      : files of `runtime/law/` that it uses, beside those of every FMU
    definitions : its constants
    memory      : what it remembers, with room for the most that parameters can ask for; `AT_NAME` in C
    """

    functions: Callable[[Graph, Model], None]
    shared: Sequence[str]
    definitions: Callable[[Graph, Model], Definitions] = lambda graph, model: Definitions()
    memory: Layout = Layout({})

    @property
    def tabulated(self) -> bool:
        """Whether the joint has a curve."""
        return "tabulated" in self.shared


def _equations(g: Graph, model: Model) -> None:
    names = ("time", *(v.name for v in model.inputs), *(v.name for v in model.outputs[: model.states]))
    v: dict[str, Any] = {name: ca.SX.sym(name) for name in names}
    outputs = model.evaluate(g.joint, v)
    doc = "time, inputs, states -> outputs"
    if model.events:
        g.add("events", "-> times at which the course of the outputs has a corner", [], model.events(g.joint))
    g.add_with_seed("outputs", doc, list(v.values()), [outputs[o.name] for o in model.outputs])


EQUATIONS = NativePart(_equations, ("equations",))
"""Of a model whose outputs are closed functions of time, inputs and states."""


def shared_definitions(shared: Sequence[str]) -> Definitions:
    """Constants of the shared C."""
    if "tabulated" not in shared:
        return Definitions()
    tables = named(NUMBERS, COUNTS) | Definitions({"CURVE_NODES": curve.MOST_NODES})
    if "approach" not in shared:
        return tables
    steps = {"APPROACH_STEPS": curve.STEPS, "CLOSING_STEPS": curve.CLOSING_STEPS}
    ratio = {"CLOSING_RATIO": curve.CLOSING_RATIO}
    return tables | Definitions(steps, ratio) | quadrature("APPROACH_GAUSS", curve.GAUSS)
