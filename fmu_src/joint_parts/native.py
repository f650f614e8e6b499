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

from .c_text import format_double_literal
from .graph import CFunctionSet

CURVE_FILE_STEMS = ("tabulated_joint", "curve")
"""Shared C files of a joint with a tabulated curve."""
LAW_INVERSION_FILE_STEMS = (*CURVE_FILE_STEMS, "spot_distribution")
"""Shared C files of a joint that also inverts its interface law."""
APPROACH_CURVE_FILE_STEMS = (*LAW_INVERSION_FILE_STEMS, "approach")
"""Shared C files of a joint that also has a curve of pressure against approach."""


@dataclass(frozen=True, slots=True)
class CConstants:
    """Constants of the generated C code: integers, real numbers, arrays.

    integer_constants : {name: integer}, written as an enum
    real_constants    : {name: number}, written as #define
    real_arrays       : {declaration "NAME[SIZE]": rows as C text} of arrays of double
    """

    integer_constants: Mapping[str, int] = field(default_factory=dict)
    real_constants: Mapping[str, float] = field(default_factory=dict)
    real_arrays: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def __or__(self, other_definitions: "CConstants") -> "CConstants":
        """Union of two sets of C constants. Raises ValueError if one name has two values."""
        first, second = (
            {**each.integer_constants, **each.real_constants, **each.real_arrays}
            for each in (self, other_definitions)
        )
        if clashes := [name for name in first.keys() & second if first[name] != second[name]]:
            raise ValueError(f"C constant {min(clashes)} has two values; expected one name for one constant")
        return CConstants(
            {**self.integer_constants, **other_definitions.integer_constants},
            {**self.real_constants, **other_definitions.real_constants},
            {**self.real_arrays, **other_definitions.real_arrays},
        )


def define_c_array(array_name: str, size_name: str, array_values: Any) -> CConstants:
    """Define a C array of double, and its size as a constant."""
    return CConstants(
        {size_name: len(array_values)},
        {},
        {f"{array_name}[{size_name}]": [format_double_literal(x) for x in array_values]},
    )


def define_c_quadrature(array_name: str, nodes_and_weights: Any) -> CConstants:
    """Define C arrays of quadrature nodes `NAME[N_NAME]` and weights `NAME_WEIGHTS[N_NAME]`."""
    abscissas = define_c_array(array_name, f"N_{array_name}", nodes_and_weights[0])
    weights = define_c_array(f"{array_name}_WEIGHTS", f"N_{array_name}", nodes_and_weights[1])
    return abscissas | weights


ModuleConstants = Mapping[ModuleType, Sequence[str]]
"""{module: names of its constants}, which have the same names in C."""
REAL_CONSTANT_NAMES: ModuleConstants = {
    curve: ("MAX_INTERPOLATION_ERROR",),
    interface: (
        "MIN_LOG_AREA",
        "MAX_LOG_AREA",
        "MIN_LOG_LOAD_SLOPE",
        "MAX_LOG_LOAD_SLOPE",
        "NEWTON_TOLERANCE",
        "MIN_PRESSURE",
        "ONE_SIDED_DERIVATIVE_OFFSET",
    ),
}
"""Real constants of Python modules that the C of every joint with tables has under the same names."""
INTEGER_CONSTANT_NAMES: ModuleConstants = {
    curve: ("MAX_STEP_COUNT_FACTOR",),
    interface: ("MAX_INVERSION_ITERATIONS",),
}
"""Integer constants of Python modules that the C of every joint with tables has under the same names."""


def define_c_constants(
    real_constant_names: ModuleConstants, integer_constant_names: ModuleConstants
) -> CConstants:
    """Define C constants with the names and values of constants of Python modules."""
    count_values, number_values = (
        {name: getattr(module, name) for module, names in names_by_module.items() for name in names}
        for names_by_module in (integer_constant_names, real_constant_names)
    )
    return CConstants(count_values, number_values)


@dataclass(frozen=True, slots=True)
class NativeDefinition:
    """Definition of the C code of a joint: generated functions, shared C files, constants, history variables.

    add_joint_functions : function (C functions, model) that adds the C functions of the joint
    shared_file_stems   : names without extension of the files in `runtime/law/` that the joint needs, besides
        the files of every FMU
    make_c_constants    : function (C functions, model) that makes the C constants of the joint
    history_layout      : offsets of the history variables in their array, for the largest array
    """

    add_joint_functions: Callable[[CFunctionSet, Model], None]
    shared_file_stems: Sequence[str]
    make_c_constants: Callable[[CFunctionSet, Model], CConstants] = lambda graph, model: CConstants()
    history_layout: HistoryLayout = HistoryLayout({})

    @property
    def is_tabulated(self) -> bool:
        """Whether the joint evaluates a tabulated curve of load over displacement."""
        return "tabulated_joint" in self.shared_file_stems


def _add_explicit_equations(c_function_set: CFunctionSet, fmu_model: Model) -> None:
    """Add C functions of the outputs and event times of a model whose outputs are explicit functions."""
    names = (
        "time",
        *(v.name for v in fmu_model.inputs),
        *(v.name for v in fmu_model.outputs[: fmu_model.state_count]),
    )
    v: dict[str, Any] = {name: ca.SX.sym(name) for name in names}
    outputs = fmu_model.evaluate(c_function_set.symbolic_parameter_set, v)
    doc = "time, inputs, states -> outputs"
    if fmu_model.find_event_times:
        c_function_set.add_function(
            "event_times",
            "-> times at which the course of the outputs has a corner",
            [],
            fmu_model.find_event_times(c_function_set.symbolic_parameter_set),
        )
    results = [outputs[o.name] for o in fmu_model.outputs]
    leading_count = fmu_model.state_count * 3 // 2 or len(results)
    if not fmu_model.evaluate_residuals:
        c_function_set.add_function_with_derivative(
            "outputs", doc, list(v.values()), results, leading_result_count=leading_count
        )
        return
    c_function_set.add_function(
        "outputs", doc, list(v.values()), results, has_workspace=True, leading_result_count=leading_count
    )
    _add_jacobian(c_function_set, fmu_model, v, results, fmu_model.evaluate_residuals)


def _add_jacobian(
    c_function_set: CFunctionSet,
    fmu_model: Model,
    symbol_by_name: Mapping[str, ca.SX],
    output_expressions: Sequence[Any],
    evaluate_residuals: Callable[..., Sequence[Any]],
) -> None:
    """Add two C functions for the Jacobian of the outputs with respect to inputs and states.

    `outputs_jacobian` computes factors of the Jacobian, `outputs_jacobian_product` the product with a seed.
    The derivatives of the accelerations follow from derivatives of the residuals (implicit functions).
    """
    count, names = fmu_model.state_count, [v.name for v in fmu_model.outputs]
    accelerations = {name: ca.SX.sym(name) for name in names[count : count * 3 // 2]}
    residuals = ca.vertcat(
        *evaluate_residuals(c_function_set.symbolic_parameter_set, {**symbol_by_name, **accelerations})
    )
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
    c_function_set.add_function(
        "outputs_jacobian",
        doc,
        arguments,
        [x for factor in factors for x in factor.nz],
        has_workspace=True,
    )
    c_function_set.add_function(
        "outputs_jacobian_product",
        "these factors, seed of inputs and states -> rates of the outputs",
        [x for symbol in (*symbols, seed) for x in symbol.nz],
        [*ca.vertsplit(other_rates[:count]), *ca.vertsplit(rates), *ca.vertsplit(other_rates[count:])],
        has_workspace=True,
        leading_result_count=count * 3 // 2,
    )


def _define_jacobian_size(c_function_set: CFunctionSet, fmu_model: Model) -> CConstants:
    """Define the C constant with the number of factors that the C function `outputs_jacobian` computes."""
    sizes = [
        len(f.result_expressions) for f in c_function_set.c_functions if f.function_name == "outputs_jacobian"
    ]
    return CConstants({"N_JACOBIAN": sizes[0]} if sizes else {})


EXPLICIT_EQUATIONS_DEFINITION = NativeDefinition(
    _add_explicit_equations, ("equations",), _define_jacobian_size
)
"""Definition of the C code of a model whose outputs are explicit functions of time, inputs and states."""


def make_shared_c_constants(shared_file_stems: Sequence[str]) -> CConstants:
    """C constants that the shared C files of a joint need; their names are given without extension."""
    if "tabulated_joint" not in shared_file_stems:
        return CConstants()
    tables = define_c_constants(REAL_CONSTANT_NAMES, INTEGER_CONSTANT_NAMES) | CConstants(
        {"CURVE_NODES": curve.MAX_TABLE_NODES}
    )
    if "approach" not in shared_file_stems:
        return tables
    steps = {
        "APPROACH_STEPS": curve.MIN_STEPS_PER_LOG_AREA,
        "CONTACT_CLOSING_STEPS": curve.CONTACT_CLOSING_STEPS,
    }
    steps["MIN_STEP_FACTOR_BETWEEN_KINKS"] = curve.MIN_STEP_FACTOR_BETWEEN_KINKS
    ratio = {"CLOSING_END_OVER_PLASTIC_SPOT_AREA": curve.CLOSING_END_OVER_PLASTIC_SPOT_AREA}
    return (
        tables
        | CConstants(steps, ratio)
        | define_c_quadrature("APPROACH_GAUSS", curve.GAUSS_NODES_AND_WEIGHTS)
    )
