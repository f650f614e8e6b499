"""The laws as graphs: Python's own functions called with symbols, for C to be made of them.

Everything here is a call into the package. What depends on parameters alone is taken out of all
functions and computed once per parameter set, into the constants c.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca

from jointfmu.contact.powerlaw import Power, Smooth, Spots, Term
from jointfmu.joints.model import Model
from jointfmu.mechanics.curve import closing
from jointfmu.quantity import Limit, Number, build

from .data import Split

Symbols = Sequence[Number]


@dataclass(frozen=True, slots=True)
class Function:
    """`y = name(x)` besides the constants; `doc` says what x and y are.

    looped : loops over many of them call it: it is inline, however long
    """

    name: str
    doc: str
    x: Sequence[ca.SX]
    y: Sequence[ca.SX]
    looped: bool = False


@dataclass(slots=True)
class Graph:
    """All functions of an FMU, and the parameters they depend on.

    theta     : symbols of the parameters, in the order of the variable list, then of those that are fixed
    constants : expressions of theta that the functions use; c is theta and then these
    """

    theta: dict[str, ca.SX]
    joint: Any
    limits: list[Limit]
    functions: list[Function] = field(default_factory=list)
    constants: list[ca.SX] = field(default_factory=list)
    symbols: list[ca.SX] = field(default_factory=list)

    def add(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, looped: bool = False) -> None:
        """Add a function."""
        self.functions.append(Function(name, doc, x, [ca.SX(value) for value in y], looped))

    def add_with_seed(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, fixed: int = 0) -> None:
        """Add a function and `name_seed`: its derivative along a seed for all x but the first `fixed`."""
        self.add(name, doc, x, y)
        self.add_seed(name, "x", x, y, fixed)

    def add_seed(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, fixed: int) -> None:
        """Add the derivative alone."""
        moving = ca.vertcat(*x[fixed:])
        seed = symbols("seed", len(x) - fixed)
        slope = ca.densify(ca.jtimes(ca.vertcat(*map(ca.SX, y)), moving, ca.vertcat(*seed)))
        self.add(
            f"{name}_seed",
            f"Derivative along a seed: {doc}, seed -> y of {name}",
            [*x, *seed],
            list(slope.nz),
        )

    def settle(self) -> None:
        """Take out what depends on parameters alone."""
        everything = ca.cse(ca.densify(ca.vertcat(*(value for f in self.functions for value in f.y))))
        theta = ca.vertcat(*self.theta.values())
        rest, self.symbols, self.constants = ca.extract_parametric(everything, theta)
        values, settled = iter(ca.densify(rest).nz), []
        for f in self.functions:
            settled.append(replace(f, y=[next(values) for _ in f.y]))
        self.functions = settled

    @property
    def c(self) -> ca.SX:
        """The constants' symbols."""
        return ca.vertcat(*self.theta.values(), *self.symbols)


def graph(model: Model, given: Split, functions: Callable[["Graph", Model], None], tabulated: bool) -> Graph:
    """All functions of an FMU, of the parameters that are exposed or data; the others have their value.

    functions : adds those of the joint
    tabulated : whether it has a curve, and so ends
    """
    before = ca.GlobalOptions.getNumpyMode()
    ca.GlobalOptions.setNumpyMode(1)
    try:
        theta = {name: ca.SX.sym(name) for name in (*given.exposed, *given.fixed)}
        joint = build(given.of, {**given.code, **theta})
        made = Graph(theta, joint, limits(joint))
        functions(made, model)
        if tabulated:
            _bounds(made, model)
        made.settle()
    finally:
        ca.GlobalOptions.setNumpyMode(before)
    return made


def symbols(name: str, count: int) -> list[ca.SX]:
    """So many symbols."""
    return [ca.SX.sym(f"{name}{i}") for i in range(count)]


def limits(joint: object) -> list[Limit]:
    """Intervals of parameters that other parameters decide."""
    own = joint.limits() if hasattr(joint, "limits") else []
    return [*own, *(joint.table_limits() if hasattr(joint, "table_limits") else [])]


def _bounds(g: Graph, model: Model) -> None:
    ends = [end for limit in g.limits for end in (limit.interval.low, limit.interval.high)]
    g.add("parameter_limits", "-> low, high of every limit that parameters set each other", [], ends)
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    end = symbols("end", 2)
    rows = [e for o in model.outside for e in o.interval(g.joint, (end[0], end[1]), v)]
    doc = "inputs, x and y at the end of the curve -> low, high of every warning"
    g.add("outside_limits", doc, [*v.values(), *end], rows)


@dataclass(frozen=True, slots=True)
class _Settled:
    """A regime that ended below u: its integral is a constant."""

    term: Smooth

    @property
    def lower(self) -> Number:
        return self.term.lower

    @property
    def upper(self) -> Number:
        return self.term.upper

    def spot(self, t: Number) -> float:
        return 0.0

    def integral(self, m: Number, u: Number) -> Number:
        return self.term.integral(m, self.term.upper)


def _regimes(spots: Spots) -> tuple[list[Number], list[Spots]]:
    """Log-areas where a costly term (Gauss-Legendre) begins or ends, and the law in between.

    Between two of them only the terms that are under way need their quadrature.
    """
    terms = [t for row in spots.terms.values() for t in row if isinstance(t, Smooth)]
    ends: list[Number] = []
    for t in terms:
        for end in (t.lower, t.upper):
            if not any(end is known for known in ends):
                ends.append(end)

    def place(end: Number) -> int:
        return next(i for i, known in enumerate(ends) if known is end)

    def at(term: Term, k: int) -> list[Term]:
        if not isinstance(term, Smooth):
            return [term]
        if place(term.upper) < k:
            return [_Settled(term)]
        return [term] if place(term.lower) < k else []

    nothing = Power(0.0, 1.0)
    return ends, [
        replace(
            spots,
            terms={
                n: tuple(new for t in row for new in at(t, k)) or (nothing,) for n, row in spots.terms.items()
            },
        )
        for k in range(len(ends) + 1)
    ]


def law_functions(g: Graph, law: Any, table: Sequence[str], state: Any) -> None:
    """The interface law: what the inversion, the tables and the outputs need of it."""
    spots, u = law.spots(), ca.SX.sym("u")
    switches, regimes = _regimes(spots)
    g.add("law_switches", "-> log-areas between which law_..._0, 1, ... are valid", [], switches)
    g.add("law_ends", "-> log-areas where a regime of the stiffness ends", [], spots.ends)
    head = [law.A_0, law.hardness, spots.reference, spots.m, spots.stiff_onset]
    g.add(
        "law_head",
        "-> A_0 [m2], hardness [Pa], reference area [m2], m, log-area of first stiffness",
        [],
        head,
    )
    for k, regime in enumerate(regimes):
        g.add(f"law_load_{k}", "log-area -> log of load, its slope", [u], regime.log_total("load", u))
        rows = [f(name, u) for name in ("load", *table) for f in (regime.total, regime.slope)]
        doc = f"log-area -> total and slope of load, {', '.join(table)}"
        g.add(f"law_table_{k}", doc, [u], rows)
        y = ca.vertcat(*map(ca.SX, state(regime, u)))
        slope = ca.jacobian(y, u)
        doc = "log-area -> state, its slopes, theirs, slope of the load's slope less m times it"
        rows = [y, slope, ca.jacobian(slope, u), _bend_of_load(regime, u)]
        g.add(f"law_state_{k}", doc, [u], ca.densify(ca.vertcat(*rows)).nz)


def _bend_of_load(spots: Spots, u: Number) -> Number:
    """F'' - m F': of the largest spot alone, without a sum over the others."""
    largest = sum(term.spot(u) for term in spots.terms["load"])
    return spots.m * spots.weight * ca.jacobian(largest, u)


def add_closing(g: Graph) -> None:
    """The closing of the contact, of joints with the curve of pressure over approach."""
    p, k, bend, z = symbols("x", 4)
    doc = "p, k, dk/dx at the end of the closing, z -> displacement from there, load, stiffness, its slope"
    g.add("closing", doc, [p, k, bend, z], closing(p, k, bend, z))
