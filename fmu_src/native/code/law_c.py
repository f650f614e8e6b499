"""Texts of law.h and law.c: functions of a graph, and constants for the hand-written C."""

from collections.abc import Mapping
from pathlib import Path

import casadi as ca

from jointfmu.joints.model import Model

from ...joint_parts.c_text import format_array_definition, format_double_literal, format_string_literal
from ...joint_parts.graph import CFunctionSet
from ...joint_parts.native import NativeDefinition, make_shared_c_constants
from ...templates import load_jinja_template
from .emit import C_HELPER_FUNCTIONS, count_workspace_values, format_function

_MAX_INLINE_LINES = 150
"""Largest number of lines of an inlined function [1]: functions evaluated in every step are short."""
_REGIME_FUNCTION_PREFIXES = ("law_load", "law_totals", "law_state")
"""Name prefixes of functions that exist once for each regime of the contact law."""


def format_law_sources(
    c_function_set: CFunctionSet, fmu_model: Model, native_definition: NativeDefinition
) -> tuple[str, str]:
    """Format the C files law.h and law.c: generated functions, constants, validity limits."""
    count = {f.function_name: len(f.result_expressions) for f in c_function_set.c_functions}
    series = {name: [f for f in count if f.rsplit("_", 1)[0] == name] for name in _REGIME_FUNCTION_PREFIXES}
    series = {name: regimes for name, regimes in series.items() if regimes}
    bodies, prototypes, inline = [], [], []
    looped = {f.function_name for f in c_function_set.c_functions if f.is_called_in_loops}
    texts = _format_c_functions(c_function_set)
    for name, text in texts.items():
        if name.rsplit("_", 1)[0] in series:
            bodies.append(text.replace("\nvoid ", "\nstatic void ", 1))
        elif (
            native_definition.is_tabulated
            and name != "law_constants"
            and (name in looped or text.count("\n") <= _MAX_INLINE_LINES)
        ):
            inline.append(text.replace("\nvoid ", "\nstatic inline void ", 1))
        else:
            bodies.append(text)
            prototypes.append(text[text.index("void ") : text.index("\n{")])
    bodies += [
        format_array_definition(f"LawFunction *const {name}[N_LAW_RANGE_BOUNDS + 1]", rows)
        for name, rows in series.items()
    ]
    definitions = make_shared_c_constants(
        native_definition.shared_file_stems
    ) | native_definition.make_c_constants(c_function_set, fmu_model)
    variables = [v.name for v in (*fmu_model.inputs, *fmu_model.outputs)]
    validity_limits = [
        f"{{{variables.index(o.variable_name)}, {format_string_literal(o.doc)}}}"
        for o in fmu_model.validity_limits
    ]
    header = load_jinja_template(Path(__file__).with_name("law.h")).render(
        counts={
            **_list_array_sizes(c_function_set, fmu_model, native_definition, count),
            **definitions.integer_constants,
            **_make_workspace_size_constant(c_function_set, texts),
        },
        macros={name: format_double_literal(value) for name, value in definitions.real_constants.items()},
        tabulated=native_definition.is_tabulated,
        validity_limits=format_array_definition(
            "static const ValidityLimit validity_limits[N_VALIDITY_LIMITS]", validity_limits
        ),
        arrays=definitions.real_arrays,
        prototypes=prototypes,
        series=series,
        helpers=C_HELPER_FUNCTIONS,
        inline=inline,
    )
    bodies += [_format_parameter_limit_array(c_function_set)] if native_definition.is_tabulated else []
    bodies += [
        format_array_definition(f"const double {declared}", rows)
        for declared, rows in definitions.real_arrays.items()
    ]
    return header + "\n", '#include "law.h"\n\n' + "\n".join(bodies)


def _format_c_functions(c_function_set: CFunctionSet) -> dict[str, str]:
    """Format the C functions of an FMU as {name: C code}; the first one computes the constants."""
    theta, no_constants = ca.vertcat(*c_function_set.parameter_symbols.values()), ca.SX.sym("none", 1)
    texts = {
        "law_constants": format_function(
            "law_constants",
            "parameters -> further constants",
            theta,
            no_constants,
            c_function_set.constant_expressions,
        )
    }
    for f in c_function_set.c_functions:
        derivative = f.function_name.endswith("_seed")
        texts[f.function_name] = format_function(
            f.function_name,
            f.signature_comment,
            ca.vertcat(*f.argument_symbols),
            c_function_set.all_constant_symbols,
            f.result_expressions,
            is_derivative=derivative,
            has_workspace=f.has_workspace,
            leading_result_count=f.leading_result_count,
        )
    return texts


def _make_workspace_size_constant(
    c_function_set: CFunctionSet, function_texts: Mapping[str, str]
) -> dict[str, int]:
    """C constant {name: size} of the largest workspace of a C function; empty if no function has one."""
    sizes = [
        count_workspace_values(function_texts[f.function_name])
        for f in c_function_set.c_functions
        if f.has_workspace
    ]
    return {"N_WORKSPACE": max(sizes)} if sizes else {}


def _list_array_sizes(
    c_function_set: CFunctionSet,
    fmu_model: Model,
    native_definition: NativeDefinition,
    result_counts: Mapping[str, int],
) -> dict[str, int]:
    """C constants {name: integer} of array sizes, and of offsets of the history variables.

    result_counts : {C function: number of its results}
    """
    sizes = {"N_CONSTANTS": len(c_function_set.parameter_symbols) + len(c_function_set.constant_expressions)}
    if not native_definition.is_tabulated:
        return sizes
    sizes |= {
        "N_PARAMETER_LIMITS": len(c_function_set.parameter_limits),
        "N_VALIDITY_LIMITS": len(fmu_model.validity_limits),
    }
    if "law_distribution" in result_counts:
        sizes |= {
            "N_LAW_DISTRIBUTION": result_counts["law_distribution"],
            "N_LAW_REGIME_ENDS": result_counts["law_regime_ends"],
            "N_LAW_RANGE_BOUNDS": result_counts["law_range_bounds"],
            "N_LAW_TOTALS": result_counts["law_totals_0"],
            "N_LAW_STATE": result_counts.get("law_state_0", 0) // 3,
        }
    return sizes | {
        f"HISTORY_{name.upper()}": offset
        for name, offset in native_definition.history_layout.first_value_indices.items()
    }


def _format_parameter_limit_array(c_function_set: CFunctionSet) -> str:
    """Format the C array of parameters whose allowed interval depends on other parameters.

    The array has at least one row, because C has no empty arrays.
    """
    index = {name: i for i, name in enumerate(c_function_set.parameter_symbols)}
    rows = [
        f"{{{index[m.name]}, {int(m.interval.low_open)}, {int(m.interval.high_open)}, "
        f"{format_string_literal(m.doc)}}}"
        for m in c_function_set.parameter_limits
    ]
    return format_array_definition(
        f"const ParameterLimit limited_parameters[{max(len(rows), 1)}]", rows or ['{0, 0, 0, ""}']
    )
