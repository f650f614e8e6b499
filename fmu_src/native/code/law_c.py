"""Texts of law.h and law.c: functions of a graph, and constants for the hand-written C."""

from collections.abc import Mapping
from pathlib import Path

import casadi as ca

from jointfmu.joints.model import Model

from ...joint_parts.c_text import array, number, string
from ...joint_parts.graph import Graph
from ...joint_parts.native import NativePart, shared_definitions
from ...templates import template
from .emit import HELPERS, function

_SHORT = 150
"""Largest number of lines of an inlined function [1]: functions evaluated in every step are short."""
_SERIES = ("law_load", "law_totals", "law_state")
"""Name prefixes of functions that exist once for each regime of the contact law."""


def law_c(g: Graph, model: Model, native_part: NativePart) -> tuple[str, str]:
    """Format law.h and law.c of a graph."""
    count = {f.name: len(f.y) for f in g.functions}
    series = {name: [f for f in count if f.rsplit("_", 1)[0] == name] for name in _SERIES}
    series = {name: regimes for name, regimes in series.items() if regimes}
    bodies, prototypes, inline = [], [], []
    looped = {f.name for f in g.functions if f.looped}
    for name, text in _functions(g).items():
        if name.rsplit("_", 1)[0] in series:
            bodies.append(text.replace("\nvoid ", "\nstatic void ", 1))
        elif (
            native_part.tabulated
            and name != "law_constants"
            and (name in looped or text.count("\n") <= _SHORT)
        ):
            inline.append(text.replace("\nvoid ", "\nstatic inline void ", 1))
        else:
            bodies.append(text)
            prototypes.append(name)
    bodies += [
        array(f"LawFunction *const {name}[N_LAW_RANGE_BOUNDS + 1]", rows) for name, rows in series.items()
    ]
    definitions = shared_definitions(native_part.shared) | native_part.definitions(g, model)
    variables = [v.name for v in (*model.inputs, *model.outputs)]
    validity_limits = [f"{{{variables.index(o.variable)}, {string(o.doc)}}}" for o in model.validity_limits]
    header = template(Path(__file__).with_name("law.h")).render(
        counts={**_counts(g, model, native_part, count), **definitions.counts},
        macros={name: number(value) for name, value in definitions.macros.items()},
        tabulated=native_part.tabulated,
        validity_limits=array(
            "static const ValidityLimit validity_limits[N_VALIDITY_LIMITS]", validity_limits
        ),
        arrays=definitions.arrays,
        prototypes=prototypes,
        series=series,
        helpers=HELPERS,
        inline=inline,
    )
    bodies += [_limits(g)] if native_part.tabulated else []
    bodies += [array(f"const double {declared}", rows) for declared, rows in definitions.arrays.items()]
    return header + "\n", '#include "law.h"\n\n' + "\n".join(bodies)


def _functions(g: Graph) -> dict[str, str]:
    """{name: C code} of all functions, `law_constants` first."""
    theta, no_constants = ca.vertcat(*g.theta.values()), ca.SX.sym("none", 1)
    texts = {
        "law_constants": function(
            "law_constants", "parameters -> further constants", theta, no_constants, g.constants
        )
    }
    for f in g.functions:
        derivative = f.name.endswith("_seed")
        texts[f.name] = function(f.name, f.doc, ca.vertcat(*f.x), g.c, f.y, derivative=derivative)
    return texts


def _counts(g: Graph, model: Model, native_part: NativePart, count: Mapping[str, int]) -> dict[str, int]:
    """{name: integer} of array sizes in C and of offsets in the history variables.

    output_counts : {function: number of its outputs}
    """
    sizes = {"N_CONSTANTS": len(g.theta) + len(g.constants)}
    if not native_part.tabulated:
        return sizes
    sizes |= {"N_PARAMETER_LIMITS": len(g.limits), "N_VALIDITY_LIMITS": len(model.validity_limits)}
    if "law_distribution" in count:
        sizes |= {
            "N_LAW_DISTRIBUTION": count["law_distribution"],
            "N_LAW_REGIME_ENDS": count["law_regime_ends"],
            "N_LAW_RANGE_BOUNDS": count["law_range_bounds"],
            "N_LAW_TOTALS": count["law_totals_0"],
            "N_LAW_STATE": count.get("law_state_0", 0) // 3,
        }
    return sizes | {f"HISTORY_{name.upper()}": offset for name, offset in native_part.memory.offsets.items()}


def _limits(g: Graph) -> str:
    """C array of the limits between parameters; at least one row, since C has no empty arrays."""
    index = {name: i for i, name in enumerate(g.theta)}
    rows = [
        f"{{{index[m.name]}, {int(m.interval.low_open)}, {int(m.interval.high_open)}, {string(m.doc)}}}"
        for m in g.limits
    ]
    return array(f"const ParameterLimit limited_parameters[{max(len(rows), 1)}]", rows or ['{0, 0, 0, ""}'])
