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
from .graph import FunctionGraph

CURVE_FILES = ("tabulated_joint", "curve")
"""Shared C files of a joint with a tabulated curve."""
INVERSION_FILES = (*CURVE_FILES, "spot_distribution")
"""Shared C files of a joint that also inverts its interface law."""
APPROACH_FILES = (*INVERSION_FILES, "approach")
"""Shared C files of a joint that also has a curve of pressure against approach."""


@dataclass(frozen=True, slots=True)
class CDefinitions:
    """Constants of the C code: integers, real numbers, arrays.

    integer_constants : {name: integer}, written as an enum
    real_constants    : {name: number}, written as #define
    real_arrays       : {declaration: rows} of arrays of double
    """

    integer_constants: Mapping[str, int] = field(default_factory=dict)
    real_constants: Mapping[str, float] = field(default_factory=dict)
    real_arrays: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def __or__(self, other_definitions: "CDefinitions") -> "CDefinitions":
        """Constants of both; ValueError if they give one name two values."""
        first, second = (
            {**each.integer_constants, **each.real_constants, **each.real_arrays}
            for each in (self, other_definitions)
        )
        if clashes := [name for name in first.keys() & second if first[name] != second[name]]:
            raise ValueError(f"C constant {min(clashes)} has two values; expected one name for one constant")
        return CDefinitions(
            {**self.integer_constants, **other_definitions.integer_constants},
            {**self.real_constants, **other_definitions.real_constants},
            {**self.real_arrays, **other_definitions.real_arrays},
        )


def define_array(array_name: str, size_name: str, values: Any) -> CDefinitions:
    """Define a C array of double, and its size as a constant."""
    return CDefinitions(
        {size_name: len(values)}, {}, {f"{array_name}[{size_name}]": [format_number(x) for x in values]}
    )


def define_quadrature(prefix: str, nodes_and_weights: Any) -> CDefinitions:
    """Define quadrature nodes `PREFIX[N_PREFIX]` and weights `PREFIX_WEIGHTS[N_PREFIX]`."""
    abscissas = define_array(prefix, f"N_{prefix}", nodes_and_weights[0])
    weights = define_array(f"{prefix}_WEIGHTS", f"N_{prefix}", nodes_and_weights[1])
    return abscissas | weights


ModuleConstants = Mapping[ModuleType, Sequence[str]]
"""{module: names of its constants}, which have the same names in C."""
REAL_CONSTANT_NAMES: ModuleConstants = {
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
"""Real constants of Python modules that the C of every joint with tables has under the same names."""
INTEGER_CONSTANT_NAMES: ModuleConstants = {curve: ("MAX_STEP_COUNT_FACTOR",), interface: ("MAX_ITERATIONS",)}
"""Integer constants of Python modules that the C of every joint with tables has under the same names."""


def define_constants(
    real_constant_names: ModuleConstants, integer_constant_names: ModuleConstants
) -> CDefinitions:
    """Define C constants for constants of Python modules, {module: names}: real numbers and integers."""
    count_values, number_values = (
        {name: getattr(module, name) for module, names in names_by_module.items() for name in names}
        for names_by_module in (integer_constant_names, real_constant_names)
    )
    return CDefinitions(count_values, number_values)


@dataclass(frozen=True, slots=True)
class NativeDefinition:
    """Definition of the C code of a joint.

    add_functions     : adds the functions that the C of the joint calls to a graph
    shared_file_stems : stems of files in `runtime/law/` that it needs, besides the files of every FMU
    make_definitions  : (graph, model) -> constants of its C
    history_layout    : layout of the history variables, of the largest size; `HISTORY_NAME` in C is an index
    """

    add_functions: Callable[[FunctionGraph, Model], None]
    shared_file_stems: Sequence[str]
    make_definitions: Callable[[FunctionGraph, Model], CDefinitions] = lambda graph, model: CDefinitions()
    history_layout: HistoryLayout = HistoryLayout({})

    @property
    def is_tabulated(self) -> bool:
        """Whether the joint evaluates a tabulated curve of load over displacement."""
        return "tabulated_joint" in self.shared_file_stems


def _add_equations(function_graph: FunctionGraph, model: Model) -> None:
    """Add the outputs, and the event times if any, of a model with explicit equations to a graph."""
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
    results = [outputs[o.name] for o in model.outputs]
    leading_count = model.state_count * 3 // 2 or len(results)
    if not model.evaluate_residuals:
        function_graph.add_function_with_derivative(
            "outputs", doc, list(v.values()), results, leading_count=leading_count
        )
        return
    function_graph.add_function(
        "outputs", doc, list(v.values()), results, has_workspace=True, leading_count=leading_count
    )
    _add_jacobian(function_graph, model, v, results, model.evaluate_residuals)


def _add_jacobian(
    function_graph: FunctionGraph,
    model: Model,
    symbol_by_name: Mapping[str, ca.SX],
    output_expressions: Sequence[Any],
    evaluate_residuals: Callable[..., Sequence[Any]],
) -> None:
    """Add two C functions for the Jacobian of the outputs with respect to inputs and states.

    `outputs_jacobian` computes factors of the Jacobian, `outputs_jacobian_product` the product with a seed.
    The derivatives of the accelerations follow from derivatives of the residuals (implicit functions).
    """
    count, names = model.state_count, [v.name for v in model.outputs]
    accelerations = {name: ca.SX.sym(name) for name in names[count : count * 3 // 2]}
    residuals = ca.vertcat(*evaluate_residuals(function_graph.joint, {**symbol_by_name, **accelerations}))
    others = ca.vertcat(*map(ca.SX, [*output_expressions[:count], *output_expressions[count * 3 // 2 :]]))
    knowns = ca.vertcat(*[*symbol_by_name.values()][1:])
    pivots, triangle, order = ca.ldl(ca.jacobian(residuals, ca.vertcat(*accelerations.values())))
    factors = [pivots, triangle, ca.jacobian(residuals, knowns), ca.jacobian(others, knowns)]
    symbols: list[Any] = [ca.SX.sym(f"factor{k}_", factor.sparsity()) for k, factor in enumerate(factors)]
    seed: Any = ca.SX.sym("seed", knowns.numel())
    rates = ca.ldl_solve(-ca.mtimes(symbols[2], seed), symbols[0], symbols[1], order)
    other_rates = ca.mtimes(symbols[3], seed)
    doc = "time, inputs, states, accelerations -> factors of the derivatives of the outputs"
    arguments = [*symbol_by_name.values(), *accelerations.values()]
    function_graph.add_function(
        "outputs_jacobian",
        doc,
        arguments,
        [x for factor in factors for x in factor.nz],
        has_workspace=True,
    )
    function_graph.add_function(
        "outputs_jacobian_product",
        "these factors, seed of inputs and states -> rates of the outputs",
        [x for symbol in (*symbols, seed) for x in symbol.nz],
        [*ca.vertsplit(other_rates[:count]), *ca.vertsplit(rates), *ca.vertsplit(other_rates[count:])],
        has_workspace=True,
        leading_count=count * 3 // 2,
    )


def _define_jacobian_size(function_graph: FunctionGraph, model: Model) -> CDefinitions:
    """Define the C constant with the number of factors that the C function `outputs_jacobian` computes."""
    sizes = [len(f.result_expressions) for f in function_graph.functions if f.name == "outputs_jacobian"]
    return CDefinitions({"N_JACOBIAN": sizes[0]} if sizes else {})


EXPLICIT_EQUATIONS_DEFINITION = NativeDefinition(_add_equations, ("equations",), _define_jacobian_size)
"""Definition of the C code of a model whose outputs are explicit functions of time, inputs and states."""


def shared_definitions(shared_file_stems: Sequence[str]) -> CDefinitions:
    """Constants that shared C files of `runtime/law/` with given stems need."""
    if "tabulated_joint" not in shared_file_stems:
        return CDefinitions()
    tables = define_constants(REAL_CONSTANT_NAMES, INTEGER_CONSTANT_NAMES) | CDefinitions(
        {"CURVE_NODES": curve.MAX_TABLE_NODES}
    )
    if "approach" not in shared_file_stems:
        return tables
    steps = {"APPROACH_STEPS": curve.MIN_STEPS_PER_LOG_AREA, "CLOSING_STEPS": curve.CLOSING_STEPS}
    steps["MIN_STEP_FACTOR_BETWEEN_KINKS"] = curve.MIN_STEP_FACTOR_BETWEEN_KINKS
    ratio = {"CLOSING_END_OVER_PLASTIC_SPOT_AREA": curve.CLOSING_END_OVER_PLASTIC_SPOT_AREA}
    return tables | CDefinitions(steps, ratio) | define_quadrature("APPROACH_GAUSS", curve.GAUSS_RULE)
