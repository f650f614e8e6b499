"""CasADi expression graphs of the joint laws, from which C code is generated.

The package's own Python functions are called with CasADi symbols. Subexpressions of parameters alone are
extracted from all functions and computed once per parameter set: the constants c.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca

from jointfmu.contact.powerlaw import PowerTerm, RegimeTerm, SmoothTerm, SpotDistribution
from jointfmu.joints.model import Model
from jointfmu.mechanics.curve import closing_pressure
from jointfmu.quantity import Number, ParameterLimit, build_parameter_set

from .data import Split

Symbols = Sequence[Number]


@dataclass(frozen=True, slots=True)
class Function:
    """C function `y = name(x, c)`; c are the constants, `doc` names x and y.

    called_in_loops : whether the C calls it inside loops: then it is inlined whatever its length
    """

    name: str
    doc: str
    x: Sequence[ca.SX]
    y: Sequence[ca.SX]
    looped: bool = False


@dataclass(slots=True)
class Graph:
    """C functions of an FMU as expression graphs, and the parameters on which they depend.

    theta     : {name: symbol} of the parameters: FMU variables in their order, then data values
    joint     : parameter set of the joint, with symbols as values
    limits    : intervals of parameters that depend on other parameters
    constants : expressions of theta extracted from the functions
    symbols   : symbols of these constants in the functions
    """

    theta: dict[str, ca.SX]
    joint: Any
    limits: list[ParameterLimit]
    functions: list[Function] = field(default_factory=list)
    constants: list[ca.SX] = field(default_factory=list)
    symbols: list[ca.SX] = field(default_factory=list)

    def add(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, looped: bool = False) -> None:
        """Add a function."""
        self.functions.append(Function(name, doc, x, [ca.SX(value) for value in y], looped))

    def add_with_seed(
        self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, constant_count: int = 0
    ) -> None:
        """Add a function, and as `name_seed` its derivative along a seed.

        constant_count : number of first x that are constant in the derivative
        """
        self.add(name, doc, x, y)
        self.add_seed(name, "x", x, y, constant_count)

    def add_seed(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, constant_count: int) -> None:
        """Add the derivative of y along a seed as `name_seed`.

        constant_count : number of first x that are constant in the derivative
        """
        variables = ca.vertcat(*x[constant_count:])
        seed = symbols("seed", len(x) - constant_count)
        slope = ca.densify(ca.jtimes(ca.vertcat(*map(ca.SX, y)), variables, ca.vertcat(*seed)))
        self.add(
            f"{name}_seed",
            f"Derivative along a seed: {doc}, seed -> y of {name}",
            [*x, *seed],
            list(slope.nz),
        )

    def settle(self) -> None:
        """Replace subexpressions of parameters alone by constants in all functions."""
        everything = ca.cse(ca.densify(ca.vertcat(*(value for f in self.functions for value in f.y))))
        theta = ca.vertcat(*self.theta.values())
        reduced, self.symbols, self.constants = ca.extract_parametric(everything, theta)
        values, functions = iter(ca.densify(reduced).nz), []
        for f in self.functions:
            functions.append(replace(f, y=[next(values) for _ in f.y]))
        self.functions = functions

    @property
    def c(self) -> ca.SX:
        """Symbols of all constants of the C functions: theta, then the extracted expressions."""
        return ca.vertcat(*self.theta.values(), *self.symbols)


def graph(model: Model, split: Split, functions: Callable[["Graph", Model], None], tabulated: bool) -> Graph:
    """Build the C functions of an FMU. FMU variables and data are symbols; other parameters are numbers.

    add_functions : adds the functions of the joint
    is_tabulated  : whether the joint has a tabulated curve: then functions of its validity limits are added
    """
    previous_mode = ca.GlobalOptions.getNumpyMode()
    ca.GlobalOptions.setNumpyMode(1)
    try:
        theta = {name: ca.SX.sym(name) for name in (*split.exposed, *split.fixed)}
        joint = build_parameter_set(split.of, {**split.code, **theta})
        g = Graph(theta, joint, limits(joint))
        functions(g, model)
        if tabulated:
            _bounds(g, model)
        g.settle()
    finally:
        ca.GlobalOptions.setNumpyMode(previous_mode)
    return g


def symbols(name: str, count: int) -> list[ca.SX]:
    """Make `count` symbols `name0`, `name1`, ..."""
    return [ca.SX.sym(f"{name}{i}") for i in range(count)]


def limits(joint: object) -> list[ParameterLimit]:
    """Intervals of parameters that depend on other parameters."""
    own = joint.find_limits() if hasattr(joint, "find_limits") else []
    return [*own, *(joint.find_table_limits() if hasattr(joint, "find_table_limits") else [])]


def _bounds(g: Graph, model: Model) -> None:
    """Add the functions of the parameter limits and of the limits beyond which warnings are logged."""
    ends = [end for limit in g.limits for end in (limit.interval.low, limit.interval.high)]
    g.add(
        "parameter_limit_bounds",
        "-> lower, upper bound of each parameter that other parameters limit",
        [],
        ends,
    )
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    end = symbols("end", 2)
    rows = [e for o in model.validity_limits for e in o.interval(g.joint, (end[0], end[1]), v)]
    doc = "inputs, x and y at the end of the curve -> lower, upper bound of each validity limit"
    g.add("validity_bounds", doc, [*v.values(), *end], rows)


@dataclass(frozen=True, slots=True)
class _Settled:
    """Term of the contact law whose range ends below log-area u: its integral is a constant."""

    term: SmoothTerm

    @property
    def lower(self) -> Number:
        return self.term.lower

    @property
    def upper(self) -> Number:
        return self.term.upper

    def spot_value(self, t: Number) -> float:
        return 0.0

    def integral(self, m: Number, u: Number) -> Number:
        return self.term.integral(m, self.term.upper)


def _regimes(spots: SpotDistribution) -> tuple[list[Number], list[SpotDistribution]]:
    """Log-areas at which a term with Gauss-Legendre quadrature begins or ends, and the law between them.

    Between two of these log-areas only the active terms need their quadrature.
    """
    terms = [t for row in spots.terms.values() for t in row if isinstance(t, SmoothTerm)]
    ends: list[Number] = []
    for t in terms:
        for end in (t.lower, t.upper):
            if not any(end is known for known in ends):
                ends.append(end)

    def index(end: Number) -> int:
        return next(i for i, known in enumerate(ends) if known is end)

    def active_terms(term: RegimeTerm, k: int) -> list[RegimeTerm]:
        if not isinstance(term, SmoothTerm):
            return [term]
        if index(term.upper) < k:
            return [_Settled(term)]
        return [term] if index(term.lower) < k else []

    zero = PowerTerm(0.0, 1.0)
    return ends, [
        replace(
            spots,
            terms={
                name: tuple(active for term in row for active in active_terms(term, k)) or (zero,)
                for name, row in spots.terms.items()
            },
        )
        for k in range(len(ends) + 1)
    ]


def law_functions(g: Graph, law: Any, table: Sequence[str], state: Any) -> None:
    """Add the functions of an interface law that its inversion, its tables and the outputs need.

    table_names     : names of the sums over contact spots, besides the load, that are tabulated
    state_functions : (law in one range of log-areas, log-area) -> quantities, first and second derivatives
    """
    spots, u = law.spots(), ca.SX.sym("u")
    switches, regimes = _regimes(spots)
    g.add(
        "law_range_bounds", "-> log-areas that separate the ranges of law_..._0, law_..._1, ...", [], switches
    )
    g.add("law_regime_ends", "-> log-areas at which a regime of the stiffness ends", [], spots.regime_ends)
    head = [law.A_0, law.hardness, spots.reference, spots.m, spots.stiffness_onset]
    g.add(
        "law_distribution",
        "-> A_0 [m2], hardness [Pa], reference area [m2], exponent m, log-area of the stiffness onset",
        [],
        head,
    )
    for k, regime in enumerate(regimes):
        g.add(f"law_load_{k}", "log-area u -> ln F, d(ln F)/du", [u], regime.log_total("load", u))
        rows = [f(name, u) for name in ("load", *table) for f in (regime.total, regime.total_derivative)]
        doc = f"log-area u -> sums over spots, each with its derivative by u: load, {', '.join(table)}"
        g.add(f"law_totals_{k}", doc, [u], rows)
        y = ca.vertcat(*map(ca.SX, state(regime, u)))
        slope = ca.jacobian(y, u)
        doc = "log-area u -> law state, its first and second derivatives by u, F'' - m F' of the load F"
        rows = [y, slope, ca.jacobian(slope, u), _bend_of_load(regime, u)]
        g.add(f"law_state_{k}", doc, [u], ca.densify(ca.vertcat(*rows)).nz)


def _bend_of_load(spots: SpotDistribution, u: Number) -> Number:
    """F'' - m F' of the load F(u), u log-area: follows from the largest spot, without a sum over spots."""
    largest = sum(term.spot_value(u) for term in spots.terms["load"])
    return spots.m * spots.weight * ca.jacobian(largest, u)


def add_closing(g: Graph) -> None:
    """Add the function of contact closing, for joints with a curve of pressure against approach."""
    p, k, bend, z = symbols("x", 4)
    doc = "p, k, dk/dx at the end of the closing, z -> displacement from there, p, k, dk/dx at z"
    g.add("closing_pressure", doc, [p, k, bend, z], closing_pressure(p, k, bend, z))
