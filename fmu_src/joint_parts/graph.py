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

from .data import ParameterSplit

Symbols = Sequence[Number]
"""Symbols or expressions of CasADi."""


@dataclass(frozen=True, slots=True)
class CFunction:
    """C function name(x, c) -> y: arguments x, constants c, results y; `doc` names x and y.

    argument_symbols, result_expressions : x, and y as expressions of x and c
    called_in_loops : whether the C calls it inside loops: then it is inlined whatever its length
    has_workspace   : whether y has room for N_WORKSPACE intermediate values behind the results: for functions
        so long that these values need too much stack
    leading_count   : number of leading results that the function can compute alone, see `format_function`;
        None: always all results
    """

    name: str
    doc: str
    argument_symbols: Sequence[ca.SX]
    result_expressions: Sequence[ca.SX]
    called_in_loops: bool = False
    has_workspace: bool = False
    leading_count: int | None = None


@dataclass(slots=True)
class FunctionGraph:
    """C functions of an FMU as expression graphs, and the parameters on which they depend.

    parameter_symbols : {name: symbol} of the parameters: FMU variables in their order, then data values
    joint             : parameter set of the joint, with symbols as values
    parameter_limits  : intervals of parameters that depend on other parameters
    constants         : expressions of the parameters, extracted from the functions
    constant_symbols  : symbols of these constants in the functions
    """

    parameter_symbols: dict[str, ca.SX]
    joint: Any
    parameter_limits: list[ParameterLimit]
    functions: list[CFunction] = field(default_factory=list)
    constants: list[ca.SX] = field(default_factory=list)
    constant_symbols: list[ca.SX] = field(default_factory=list)

    def add_function(
        self,
        function_name: str,
        doc: str,
        argument_symbols: Sequence[ca.SX],
        result_expressions: Symbols,
        called_in_loops: bool = False,
        has_workspace: bool = False,
        leading_count: int | None = None,
    ) -> None:
        """Add a C function to the graph."""
        results = [ca.SX(value) for value in result_expressions]
        self.functions.append(
            CFunction(
                function_name, doc, argument_symbols, results, called_in_loops, has_workspace, leading_count
            )
        )

    def add_function_with_derivative(
        self,
        function_name: str,
        doc: str,
        argument_symbols: Sequence[ca.SX],
        result_expressions: Symbols,
        constant_count: int = 0,
        leading_count: int | None = None,
    ) -> None:
        """Add a C function, and its directional derivative along a seed as `NAME_seed`.

        constant_count : number of leading arguments that are constant in the derivative
        leading_count  : number of leading results that both functions can compute alone; None: always all
        """
        self.add_function(
            function_name, doc, argument_symbols, result_expressions, leading_count=leading_count
        )
        self.add_derivative(
            function_name, "x", argument_symbols, result_expressions, constant_count, leading_count
        )

    def add_derivative(
        self,
        function_name: str,
        doc: str,
        argument_symbols: Sequence[ca.SX],
        result_expressions: Symbols,
        constant_count: int,
        leading_count: int | None = None,
    ) -> None:
        """Add the directional derivative of a C function along a seed, as `NAME_seed`.

        constant_count : number of leading arguments that are constant in the derivative
        leading_count  : number of leading results that it can compute alone; None: always all
        """
        variables = ca.vertcat(*argument_symbols[constant_count:])
        seed = make_symbols("seed", len(argument_symbols) - constant_count)
        slope = ca.densify(
            ca.jtimes(ca.vertcat(*map(ca.SX, result_expressions)), variables, ca.vertcat(*seed))
        )
        self.add_function(
            f"{function_name}_seed",
            f"Derivative along a seed: {doc}, seed -> y of {function_name}",
            [*argument_symbols, *seed],
            list(slope.nz),
            leading_count=leading_count,
        )

    def extract_constants(self) -> None:
        """Replace subexpressions that depend on parameters alone by constants, in all functions."""
        everything = ca.cse(
            ca.densify(ca.vertcat(*(value for f in self.functions for value in f.result_expressions)))
        )
        theta = ca.vertcat(*self.parameter_symbols.values())
        reduced, self.constant_symbols, self.constants = ca.extract_parametric(everything, theta)
        values, functions = iter(ca.densify(reduced).nz), []
        for f in self.functions:
            functions.append(replace(f, result_expressions=[next(values) for _ in f.result_expressions]))
        self.functions = functions

    @property
    def all_constants(self) -> ca.SX:
        """Symbols of all constants of the C functions: parameters, then the extracted expressions."""
        return ca.vertcat(*self.parameter_symbols.values(), *self.constant_symbols)


def build_graph(
    model: Model,
    parameter_split: ParameterSplit,
    add_functions: Callable[["FunctionGraph", Model], None],
    is_tabulated: bool,
) -> FunctionGraph:
    """Build the C functions of an FMU. FMU variables and data are symbols; other parameters are numbers.

    add_functions : function (graph, model) that adds the functions of the joint
    is_tabulated  : whether the joint has a tabulated curve: then functions of its validity limits are added
    """
    previous_mode = ca.GlobalOptions.getNumpyMode()
    ca.GlobalOptions.setNumpyMode(1)
    try:
        theta = {
            name: ca.SX.sym(name) for name in (*parameter_split.variable_names, *parameter_split.data_values)
        }
        joint = build_parameter_set(parameter_split.parameter_class, {**parameter_split.code_values, **theta})
        g = FunctionGraph(theta, joint, collect_parameter_limits(joint))
        add_functions(g, model)
        if is_tabulated:
            _add_limit_functions(g, model)
        g.extract_constants()
    finally:
        ca.GlobalOptions.setNumpyMode(previous_mode)
    return g


def make_symbols(symbol_prefix: str, symbol_count: int) -> list[ca.SX]:
    """Make numbered symbols: `PREFIX0`, `PREFIX1`, ..."""
    return [ca.SX.sym(f"{symbol_prefix}{i}") for i in range(symbol_count)]


def collect_parameter_limits(joint: object) -> list[ParameterLimit]:
    """Collect the limits of the parameters whose allowed interval depends on other parameters."""
    own = joint.find_parameter_limits() if hasattr(joint, "find_parameter_limits") else []
    table = joint.find_table_parameter_limits() if hasattr(joint, "find_table_parameter_limits") else []
    return [*own, *table]


def _add_limit_functions(function_graph: FunctionGraph, model: Model) -> None:
    """Add the functions of the parameter limits and of the limits beyond which warnings are logged."""
    ends = [
        end for limit in function_graph.parameter_limits for end in (limit.interval.low, limit.interval.high)
    ]
    function_graph.add_function(
        "parameter_limit_bounds",
        "-> lower, upper bound of each parameter that other parameters limit",
        [],
        ends,
    )
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    end = make_symbols("end", 2)
    rows = [
        e for o in model.validity_limits for e in o.find_interval(function_graph.joint, (end[0], end[1]), v)
    ]
    doc = "inputs, x and y at the end of the curve -> lower, upper bound of each validity limit"
    function_graph.add_function("validity_bounds", doc, [*v.values(), *end], rows)


@dataclass(frozen=True, slots=True)
class _CompletedTerm:
    """Load, stiffness or area of contact spots in a regime that ends below the largest spot.

    The integral over such a regime is a constant of the parameters.
    """

    term: SmoothTerm

    @property
    def lower_log_area(self) -> Number:
        return self.term.lower_log_area

    @property
    def upper_log_area(self) -> Number:
        return self.term.upper_log_area

    def evaluate_spot(self, log_area: Number) -> float:
        return 0.0

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        return self.term.integrate_over_spots(size_exponent, self.term.upper_log_area)


def _split_regimes(spot_distribution: SpotDistribution) -> tuple[list[Number], list[SpotDistribution]]:
    """Divide the regimes of the contact spots into ranges of log-area, for quadrature.

    Returns the ends of the ranges (log-areas at which an integral by quadrature begins or ends), and a spot
    distribution for each range, with only the terms that are active in it.
    """
    terms = [t for row in spot_distribution.regime_terms.values() for t in row if isinstance(t, SmoothTerm)]
    ends: list[Number] = []
    for t in terms:
        for end in (t.lower_log_area, t.upper_log_area):
            if not any(end is known for known in ends):
                ends.append(end)

    def find_bound_index(bound_log_area: Number) -> int:
        """Index of a log-area among the sorted ends of the regimes."""
        return next(i for i, known in enumerate(ends) if known is bound_log_area)

    def split_term(term: RegimeTerm, regime_index: int) -> list[RegimeTerm]:
        """Reduce a term of the whole law to the terms that are active in one range of log-areas."""
        if not isinstance(term, SmoothTerm):
            return [term]
        if find_bound_index(term.upper_log_area) < regime_index:
            return [_CompletedTerm(term)]
        return [term] if find_bound_index(term.lower_log_area) < regime_index else []

    zero = PowerTerm(0.0, 1.0)
    return ends, [
        replace(
            spot_distribution,
            regime_terms={
                name: tuple(active for term in row for active in split_term(term, k)) or (zero,)
                for name, row in spot_distribution.regime_terms.items()
            },
        )
        for k in range(len(ends) + 1)
    ]


def add_law_functions(
    function_graph: FunctionGraph, law: Any, tabulated_sum_names: Sequence[str], evaluate_law_state: Any
) -> None:
    """Add the functions of an interface law that its inversion, its tables and the outputs need.

    tabulated_sum_names : names of the sums over contact spots, besides the load, that are tabulated
    evaluate_law_state  : (law in one range of log-areas, log-area) -> quantities, first and second
                          derivatives
    """
    spots, u = law.spot_distribution(), ca.SX.sym("u")
    switches, regimes = _split_regimes(spots)
    function_graph.add_function(
        "law_range_bounds", "-> log-areas that separate the ranges of law_..._0, law_..._1, ...", [], switches
    )
    function_graph.add_function(
        "law_regime_ends",
        "-> log-areas at which a regime of the stiffness ends",
        [],
        spots.regime_end_log_areas,
    )
    head = [law.A_0, law.max_pressure, spots.reference_area, spots.size_exponent]
    head += [spots.stiffness_onset_log_area, spots.first_kink]
    function_graph.add_function(
        "law_distribution",
        "-> A_0 [m2], largest pressure [Pa], reference area [m2], exponent m, log-areas of stiffness onset "
        "and first kink",
        [],
        head,
    )
    for k, regime in enumerate(regimes):
        function_graph.add_function(
            f"law_load_{k}", "log-area u -> ln F, d(ln F)/du", [u], regime.log_sum_over_spots("load", u)
        )
        rows = [
            f(name, u)
            for name in ("load", *tabulated_sum_names)
            for f in (regime.sum_over_spots, regime.sum_over_spots_derivative)
        ]
        doc = (
            "log-area u -> sums over spots, each with its derivative by u: load, "
            f"{', '.join(tabulated_sum_names)}"
        )
        function_graph.add_function(f"law_totals_{k}", doc, [u], rows)
        y = ca.vertcat(*map(ca.SX, evaluate_law_state(regime, u)))
        slope = ca.jacobian(y, u)
        doc = "log-area u -> law state, its first and second derivatives by u, F'' - m F' of the load F"
        rows = [y, slope, ca.jacobian(slope, u), _load_curvature(regime, u)]
        function_graph.add_function(f"law_state_{k}", doc, [u], ca.densify(ca.vertcat(*rows)).nz)


def _load_curvature(spot_distribution: SpotDistribution, largest_log_area: Number) -> Number:
    """Second derivative of the load less m times the first, F'' - m F', with respect to the log-area u.

    This value follows from the largest spot alone, without a sum over spots.
    """
    largest = sum(term.evaluate_spot(largest_log_area) for term in spot_distribution.regime_terms["load"])
    return (
        spot_distribution.size_exponent
        * spot_distribution.size_prefactor
        * ca.jacobian(largest, largest_log_area)
    )


def add_closing_function(function_graph: FunctionGraph) -> None:
    """Add the C function of the closing of a contact, for joints with a curve of pressure over approach."""
    p, k, bend, z = make_symbols("x", 4)
    doc = "p, k, dk/dx at the end of the closing, z -> displacement from there, p, k, dk/dx at z"
    function_graph.add_function("closing_pressure", doc, [p, k, bend, z], closing_pressure(p, k, bend, z))
