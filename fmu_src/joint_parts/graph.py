"""CasADi expression graphs of the joint laws, from which C code is generated.

The package's own Python functions are called with CasADi symbols. Subexpressions of parameters alone are
extracted from all functions and computed once per parameter set: the constants c.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca

from jointfmu.contact.powerlaw import PowerTerm, RegimeTerm, SmoothFunctionTerm, SpotDistribution
from jointfmu.joints.model import Model
from jointfmu.mechanics.curve import closing_pressure
from jointfmu.quantity import Number, ParameterLimit, build_parameter_set

from .data import ParameterSplit

CasadiExpressions = Sequence[Number]
"""Symbols or expressions of CasADi."""


@dataclass(frozen=True, slots=True)
class CFunction:
    """Generated C function of arguments x and constants c with results y.

    signature_comment    : comment that names x and y
    argument_symbols     : symbols of x
    result_expressions   : y as expressions of x and c
    is_called_in_loops   : whether the C code calls the function in loops: then it is inlined at any length
    has_workspace        : whether the array y has space for N_WORKSPACE intermediate values behind the
        results: for functions so long that these values need too much stack
    leading_result_count : number of leading results that the function can compute alone; None: always all
    """

    function_name: str
    signature_comment: str
    argument_symbols: Sequence[ca.SX]
    result_expressions: Sequence[ca.SX]
    is_called_in_loops: bool = False
    has_workspace: bool = False
    leading_result_count: int | None = None


@dataclass(slots=True)
class CFunctionSet:
    """C functions of an FMU as CasADi expressions, and the parameters on which they depend.

    parameter_symbols      : {name: symbol} of the parameters: FMU variables in their order, then numbers in
        data.c
    symbolic_parameter_set : parameter set of the joint, with CasADi symbols as values
    parameter_limits       : allowed intervals of parameters that depend on other parameters
    c_functions            : functions in the order in which they were added
    constant_expressions   : subexpressions of the functions that depend on parameters alone
    constant_symbols       : symbols that replace these subexpressions in the functions
    """

    parameter_symbols: dict[str, ca.SX]
    symbolic_parameter_set: Any
    parameter_limits: list[ParameterLimit]
    c_functions: list[CFunction] = field(default_factory=list)
    constant_expressions: list[ca.SX] = field(default_factory=list)
    constant_symbols: list[ca.SX] = field(default_factory=list)

    def add_function(
        self,
        function_name: str,
        signature_comment: str,
        argument_symbols: Sequence[ca.SX],
        result_expressions: CasadiExpressions,
        is_called_in_loops: bool = False,
        has_workspace: bool = False,
        leading_result_count: int | None = None,
    ) -> None:
        """Add a C function; parameters as the fields of `CFunction`."""
        results = [ca.SX(value) for value in result_expressions]
        self.c_functions.append(
            CFunction(
                function_name,
                signature_comment,
                argument_symbols,
                results,
                is_called_in_loops,
                has_workspace,
                leading_result_count,
            )
        )

    def add_function_with_derivative(
        self,
        function_name: str,
        signature_comment: str,
        argument_symbols: Sequence[ca.SX],
        result_expressions: CasadiExpressions,
        constant_argument_count: int = 0,
        leading_result_count: int | None = None,
    ) -> None:
        """Add a C function, and its directional derivative as C function `NAME_seed`.

        constant_argument_count : number of leading arguments that are constant in the derivative
        leading_result_count    : number of leading results that both functions can compute alone; None:
            always all
        """
        self.add_function(
            function_name,
            signature_comment,
            argument_symbols,
            result_expressions,
            leading_result_count=leading_result_count,
        )
        self.add_derivative(
            function_name,
            "x",
            argument_symbols,
            result_expressions,
            constant_argument_count,
            leading_result_count,
        )

    def add_derivative(
        self,
        function_name: str,
        signature_comment: str,
        argument_symbols: Sequence[ca.SX],
        result_expressions: CasadiExpressions,
        constant_argument_count: int,
        leading_result_count: int | None = None,
    ) -> None:
        """Add the directional derivative of a C function as C function `NAME_seed`.

        Its arguments are the arguments of the function and the direction (seed).

        constant_argument_count : number of leading arguments that are constant in the derivative
        leading_result_count    : number of leading results that can be computed alone; None: always all
        """
        variables = ca.vertcat(*argument_symbols[constant_argument_count:])
        seed = make_casadi_symbols("seed", len(argument_symbols) - constant_argument_count)
        slope = ca.densify(
            ca.jtimes(ca.vertcat(*map(ca.SX, result_expressions)), variables, ca.vertcat(*seed))
        )
        self.add_function(
            f"{function_name}_seed",
            f"Derivative along a seed: {signature_comment}, seed -> y of {function_name}",
            [*argument_symbols, *seed],
            list(slope.nz),
            leading_result_count=leading_result_count,
        )

    def extract_constants(self) -> None:
        """Replace subexpressions of all functions that depend on parameters alone by symbols of constants."""
        everything = ca.cse(
            ca.densify(ca.vertcat(*(value for f in self.c_functions for value in f.result_expressions)))
        )
        theta = ca.vertcat(*self.parameter_symbols.values())
        reduced, self.constant_symbols, self.constant_expressions = ca.extract_parametric(everything, theta)
        values, functions = iter(ca.densify(reduced).nz), []
        for f in self.c_functions:
            functions.append(replace(f, result_expressions=[next(values) for _ in f.result_expressions]))
        self.c_functions = functions

    @property
    def all_constant_symbols(self) -> ca.SX:
        """Symbols of all constants of the C functions: parameters, then the extracted expressions."""
        return ca.vertcat(*self.parameter_symbols.values(), *self.constant_symbols)


def build_c_function_set(
    fmu_model: Model,
    parameter_split: ParameterSplit,
    add_joint_functions: Callable[["CFunctionSet", Model], None],
    is_tabulated: bool,
) -> CFunctionSet:
    """Build the C functions of an FMU as CasADi expressions.

    FMU variables and numbers in data.c are symbols; all other parameters are numbers.

    add_joint_functions : function (C functions, model) that adds the functions of the joint
    is_tabulated        : whether the joint has a tabulated curve: then functions of its parameter limits and
        validity limits are added
    """
    previous_mode = ca.GlobalOptions.getNumpyMode()
    ca.GlobalOptions.setNumpyMode(1)
    try:
        theta = {
            name: ca.SX.sym(name)
            for name in (*parameter_split.variable_names, *parameter_split.data_struct_values)
        }
        joint = build_parameter_set(
            parameter_split.parameter_class, {**parameter_split.code_generation_values, **theta}
        )
        g = CFunctionSet(theta, joint, collect_parameter_limits(joint))
        add_joint_functions(g, fmu_model)
        if is_tabulated:
            _add_limit_functions(g, fmu_model)
        g.extract_constants()
    finally:
        ca.GlobalOptions.setNumpyMode(previous_mode)
    return g


def make_casadi_symbols(symbol_prefix: str, symbol_count: int) -> list[ca.SX]:
    """Make numbered CasADi symbols: `PREFIX0`, `PREFIX1`, ..."""
    return [ca.SX.sym(f"{symbol_prefix}{i}") for i in range(symbol_count)]


def collect_parameter_limits(parameter_set: object) -> list[ParameterLimit]:
    """Collect the limits of parameters of a joint whose allowed interval depends on other parameters."""
    own = parameter_set.find_parameter_limits() if hasattr(parameter_set, "find_parameter_limits") else []
    table = (
        parameter_set.find_table_parameter_limits()
        if hasattr(parameter_set, "find_table_parameter_limits")
        else []
    )
    return [*own, *table]


def _add_limit_functions(c_function_set: CFunctionSet, fmu_model: Model) -> None:
    """Add the C functions of the parameters' allowed intervals, and of the limits of validity (warnings)."""
    ends = [
        end for limit in c_function_set.parameter_limits for end in (limit.interval.low, limit.interval.high)
    ]
    c_function_set.add_function(
        "parameter_limit_bounds",
        "-> lower, upper bound of each parameter that other parameters limit",
        [],
        ends,
    )
    v = {i.name: ca.SX.sym(i.name) for i in fmu_model.inputs}
    end = make_casadi_symbols("end", 2)
    rows = [
        e
        for o in fmu_model.validity_limits
        for e in o.find_interval(c_function_set.symbolic_parameter_set, (end[0], end[1]), v)
    ]
    doc = "inputs, x and y at the end of the curve -> lower, upper bound of each validity limit"
    c_function_set.add_function("validity_bounds", doc, [*v.values(), *end], rows)


@dataclass(frozen=True, slots=True)
class _CompletedRegimeTerm:
    """Contribution of a deformation regime (elastic, plastic) whose spots are all below the largest spot.

    A spot is the contact area of one asperity. The integral of load, stiffness or area over all spots of
    such a regime does not depend on the largest spot: it is a constant of the parameters.
    """

    smooth_term: SmoothFunctionTerm

    @property
    def lower_log_area(self) -> Number:
        return self.smooth_term.lower_log_area

    @property
    def upper_log_area(self) -> Number:
        return self.smooth_term.upper_log_area

    def evaluate_spot(self, log_area: Number) -> float:
        return 0.0

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        return self.smooth_term.integrate_over_spots(size_exponent, self.smooth_term.upper_log_area)


def _split_spot_regimes(spot_distribution: SpotDistribution) -> tuple[list[Number], list[SpotDistribution]]:
    """Divide the range of spot sizes (log-areas) at the ends of the regimes of deformation, for quadrature.

    Returns the log-areas at which an integral by quadrature begins or ends, and for each range between them
    a spot distribution with only the terms that contribute if the largest spot is in this range.
    """
    terms = [
        t for row in spot_distribution.regime_terms.values() for t in row if isinstance(t, SmoothFunctionTerm)
    ]
    ends: list[Number] = []
    for t in terms:
        for end in (t.lower_log_area, t.upper_log_area):
            if not any(end is known for known in ends):
                ends.append(end)

    def find_regime_end_index(regime_end_log_area: Number) -> int:
        """Index of the end of a regime, a log-area [1], in the list of all ends."""
        return next(i for i, known in enumerate(ends) if known is regime_end_log_area)

    def select_active_terms(regime_term: RegimeTerm, range_index: int) -> list[RegimeTerm]:
        """Terms by which a regime contributes if the largest spot is in a range: none, constant, variable."""
        if not isinstance(regime_term, SmoothFunctionTerm):
            return [regime_term]
        if find_regime_end_index(regime_term.upper_log_area) < range_index:
            return [_CompletedRegimeTerm(regime_term)]
        return [regime_term] if find_regime_end_index(regime_term.lower_log_area) < range_index else []

    zero = PowerTerm(0.0, 1.0)
    return ends, [
        replace(
            spot_distribution,
            regime_terms={
                name: tuple(active for term in row for active in select_active_terms(term, k)) or (zero,)
                for name, row in spot_distribution.regime_terms.items()
            },
        )
        for k in range(len(ends) + 1)
    ]


def add_law_functions(
    c_function_set: CFunctionSet,
    interface_law: Any,
    tabulated_sum_names: Sequence[str],
    evaluate_law_state: Any,
) -> None:
    """Add the C functions of an interface law: load and other sums over all contact spots, derivatives.

    tabulated_sum_names : names of the sums over contact spots, besides the load, that are tabulated
    evaluate_law_state  : (spot distribution in one range of log-areas, log-area u of the largest spot) ->
        quantities of the law, of which the C code also computes dy/du and d2y/du2
    """
    spots, u = interface_law.spot_distribution(), ca.SX.sym("u")
    switches, regimes = _split_spot_regimes(spots)
    c_function_set.add_function(
        "law_range_bounds", "-> log-areas that separate the ranges of law_..._0, law_..._1, ...", [], switches
    )
    c_function_set.add_function(
        "law_regime_ends",
        "-> log-areas at which a regime of the stiffness ends",
        [],
        spots.regime_end_log_areas,
    )
    head = [interface_law.A_0, interface_law.max_pressure, spots.reference_area, spots.size_exponent]
    head += [spots.stiffness_onset_log_area, spots.first_kink_log_area]
    c_function_set.add_function(
        "law_distribution",
        "-> A_0 [m2], largest pressure [Pa], reference area [m2], exponent m, log-areas of stiffness onset "
        "and first kink",
        [],
        head,
    )
    for k, regime in enumerate(regimes):
        c_function_set.add_function(
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
        c_function_set.add_function(f"law_totals_{k}", doc, [u], rows)
        y = ca.vertcat(*map(ca.SX, evaluate_law_state(regime, u)))
        slope = ca.jacobian(y, u)
        doc = "log-area u -> law state, its first and second derivatives by u, F'' - m F' of the load F"
        rows = [y, slope, ca.jacobian(slope, u), _load_curvature_minus_slope_term(regime, u)]
        c_function_set.add_function(f"law_state_{k}", doc, [u], ca.densify(ca.vertcat(*rows)).nz)


def _load_curvature_minus_slope_term(spot_distribution: SpotDistribution, largest_log_area: Number) -> Number:
    """F'' - m F' of the load F(u): u is the log-area of the largest spot, m the exponent of the spot sizes.

    Primes are derivatives by u. The result depends on the load of the largest spot alone.
    """
    largest = sum(term.evaluate_spot(largest_log_area) for term in spot_distribution.regime_terms["load"])
    return (
        spot_distribution.size_exponent
        * spot_distribution.size_prefactor
        * ca.jacobian(largest, largest_log_area)
    )


def add_closing_pressure_function(c_function_set: CFunctionSet) -> None:
    """Add the C function of the pressure between first contact and the first point of the tabulated curve."""
    p, k, bend, z = make_casadi_symbols("x", 4)
    doc = "p, k, dk/dx at the end of the closing, z -> displacement from there, p, k, dk/dx at z"
    c_function_set.add_function("closing_pressure", doc, [p, k, bend, z], closing_pressure(p, k, bend, z))
