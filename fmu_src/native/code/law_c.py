"""Texts of law.h and law.c: functions of a graph, and constants for the hand-written C."""

from collections.abc import Mapping
from pathlib import Path

import casadi as ca

from jointfmu.joints.model import Model

from ...joint_parts.c_text import format_array, format_number, format_string
from ...joint_parts.graph import FunctionGraph
from ...joint_parts.native import NativeDefinition, shared_definitions
from ...templates import load_template
from .emit import C_HELPER_FUNCTIONS, count_workspace, format_function

_MAX_INLINE_LINES = 150
"""Largest number of lines of an inlined function [1]: functions evaluated in every step are short."""
_REGIME_FUNCTION_PREFIXES = ("law_load", "law_totals", "law_state")
"""Name prefixes of functions that exist once for each regime of the contact law."""


def format_law(
    function_graph: FunctionGraph, model: Model, native_definition: NativeDefinition
) -> tuple[str, str]:
    """Format law.h and law.c of a graph."""
    count = {f.name: len(f.result_expressions) for f in function_graph.functions}
    series = {name: [f for f in count if f.rsplit("_", 1)[0] == name] for name in _REGIME_FUNCTION_PREFIXES}
    series = {name: regimes for name, regimes in series.items() if regimes}
    bodies, prototypes, inline = [], [], []
    looped = {f.name for f in function_graph.functions if f.called_in_loops}
    texts = _format_functions(function_graph)
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
        format_array(f"LawFunction *const {name}[N_LAW_RANGE_BOUNDS + 1]", rows)
        for name, rows in series.items()
    ]
    definitions = shared_definitions(
        native_definition.shared_file_stems
    ) | native_definition.make_definitions(function_graph, model)
    variables = [v.name for v in (*model.inputs, *model.outputs)]
    validity_limits = [
        f"{{{variables.index(o.variable_name)}, {format_string(o.doc)}}}" for o in model.validity_limits
    ]
    header = load_template(Path(__file__).with_name("law.h")).render(
        counts={
            **_list_sizes(function_graph, model, native_definition, count),
            **definitions.integer_constants,
            **_size_workspace(function_graph, texts),
        },
        macros={name: format_number(value) for name, value in definitions.real_constants.items()},
        tabulated=native_definition.is_tabulated,
        validity_limits=format_array(
            "static const ValidityLimit validity_limits[N_VALIDITY_LIMITS]", validity_limits
        ),
        arrays=definitions.real_arrays,
        prototypes=prototypes,
        series=series,
        helpers=C_HELPER_FUNCTIONS,
        inline=inline,
    )
    bodies += [_format_limit_array(function_graph)] if native_definition.is_tabulated else []
    bodies += [
        format_array(f"const double {declared}", rows) for declared, rows in definitions.real_arrays.items()
    ]
    return header + "\n", '#include "law.h"\n\n' + "\n".join(bodies)


def _format_functions(function_graph: FunctionGraph) -> dict[str, str]:
    """{name: C code} of all functions, `law_constants` first."""
    theta, no_constants = ca.vertcat(*function_graph.parameter_symbols.values()), ca.SX.sym("none", 1)
    texts = {
        "law_constants": format_function(
            "law_constants", "parameters -> further constants", theta, no_constants, function_graph.constants
        )
    }
    for f in function_graph.functions:
        derivative = f.name.endswith("_seed")
        texts[f.name] = format_function(
            f.name,
            f.doc,
            ca.vertcat(*f.argument_symbols),
            function_graph.all_constants,
            f.result_expressions,
            is_derivative=derivative,
            has_workspace=f.has_workspace,
            leading_count=f.leading_count,
        )
    return texts


def _size_workspace(function_graph: FunctionGraph, texts: Mapping[str, str]) -> dict[str, int]:
    """{name: integer} of the largest workspace of a function; empty if none has a workspace."""
    sizes = [count_workspace(texts[f.name]) for f in function_graph.functions if f.has_workspace]
    return {"N_WORKSPACE": max(sizes)} if sizes else {}


def _list_sizes(
    function_graph: FunctionGraph,
    model: Model,
    native_definition: NativeDefinition,
    output_counts: Mapping[str, int],
) -> dict[str, int]:
    """{name: integer} of array sizes in the C code, and of the offsets of the history variables.

    output_counts : {function: number of its outputs}
    """
    sizes = {"N_CONSTANTS": len(function_graph.parameter_symbols) + len(function_graph.constants)}
    if not native_definition.is_tabulated:
        return sizes
    sizes |= {
        "N_PARAMETER_LIMITS": len(function_graph.parameter_limits),
        "N_VALIDITY_LIMITS": len(model.validity_limits),
    }
    if "law_distribution" in output_counts:
        sizes |= {
            "N_LAW_DISTRIBUTION": output_counts["law_distribution"],
            "N_LAW_REGIME_ENDS": output_counts["law_regime_ends"],
            "N_LAW_RANGE_BOUNDS": output_counts["law_range_bounds"],
            "N_LAW_TOTALS": output_counts["law_totals_0"],
            "N_LAW_STATE": output_counts.get("law_state_0", 0) // 3,
        }
    return sizes | {
        f"HISTORY_{name.upper()}": offset for name, offset in native_definition.history_layout.offsets.items()
    }


def _format_limit_array(function_graph: FunctionGraph) -> str:
    """C array of the limits between parameters; at least one row, since C has no empty arrays."""
    index = {name: i for i, name in enumerate(function_graph.parameter_symbols)}
    rows = [
        f"{{{index[m.name]}, {int(m.interval.low_open)}, {int(m.interval.high_open)}, "
        f"{format_string(m.doc)}}}"
        for m in function_graph.parameter_limits
    ]
    return format_array(
        f"const ParameterLimit limited_parameters[{max(len(rows), 1)}]", rows or ['{0, 0, 0, ""}']
    )
