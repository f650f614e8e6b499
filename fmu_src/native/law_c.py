"""law.h and law.c: the functions of a graph, and the constants that the hand-written C takes."""

import casadi as ca

from jointfmu.joints.model import Model

from ..joint_parts.c_text import array, number, string
from ..joint_parts.graph import Graph
from ..joint_parts.native import NativePart, shared_definitions
from .emit import HELPERS, function

_SHORT = 90
"""Lines of a function that is worth to be inline: what a step evaluates is short."""


def law_c(g: Graph, model: Model, part: NativePart) -> tuple[str, str]:
    """Texts of law.h and law.c."""
    return _tabulated(g, model, part) if part.tabulated else _equations(g)


def _equations(g: Graph) -> tuple[str, str]:
    """law.h and law.c of a model without tables: functions of time, inputs and states."""
    texts = _functions(g)
    header = [
        "#ifndef JOINTFMU_LAW_H",
        "#define JOINTFMU_LAW_H",
        "",
        "#include <math.h>",
        "",
        '#include "elementary.h"',
        "",
        f"enum {{ N_CONSTANTS = {len(g.theta) + len(g.constants)} }};",
        "",
        *(f"void {name}(const double *x, const double *c, double *y);" for name in texts),
        "",
        HELPERS,
        "#endif",
        "",
    ]
    return "\n".join(header), '#include "law.h"\n\n' + "\n".join(texts.values())


def _functions(g: Graph) -> dict[str, str]:
    """C of all functions by name, `law_constants` first."""
    theta, none = ca.vertcat(*g.theta.values()), ca.SX.sym("none", 1)
    texts = {
        "law_constants": function(
            "law_constants", "parameters -> further constants", theta, none, g.constants
        )
    }
    for f in g.functions:
        derivative = f.name.endswith("_seed")
        texts[f.name] = function(f.name, f.doc, ca.vertcat(*f.x), g.c, f.y, derivative=derivative)
    return texts


def _tabulated(g: Graph, model: Model, part: NativePart) -> tuple[str, str]:
    """law.h and law.c of a joint with a curve, perhaps with an interface law to invert."""
    count = {f.name: len(f.y) for f in g.functions}
    regimes = sum(name.startswith("law_load_") for name in count)
    state = count.get("law_state_0", 0)
    names = {
        "N_CONSTANTS": len(g.theta) + len(g.constants),
        "N_LIMITS": len(g.limits),
        "N_WARNINGS": len(model.outside),
    }
    if regimes:
        names |= {
            "N_LAW_HEAD": count["law_head"],
            "N_LAW_ENDS": count["law_ends"],
            "N_LAW_SWITCHES": regimes - 1,
            "N_LAW_TABLE": count["law_table_0"],
            "N_LAW_STATE": state // 3,
        }
    names |= {f"AT_{name.upper()}": place for name, place in part.memory.places.items()}
    given = shared_definitions(part.shared) | part.definitions(g, model)
    series = ["law_load", "law_table"] if regimes else []
    series += ["law_state"] if state else []
    variables = [v.name for v in (*model.inputs, *model.outputs)]
    watched = [f"{{{variables.index(o.variable)}, {string(o.doc)}}}" for o in model.outside]
    bodies, prototypes, inline = [], [], []
    for name, text in _functions(g).items():
        if name.rsplit("_", 1)[0] in series:
            bodies.append(text.replace("\nvoid ", "\nstatic void ", 1))
        elif name != "law_constants" and text.count("\n") <= _SHORT:
            inline.append(text.replace("\nvoid ", "\nstatic inline void ", 1))
        else:
            bodies.append(text)
            prototypes.append(name)
    header = [
        "#ifndef JOINTFMU_LAW_H",
        "#define JOINTFMU_LAW_H",
        "",
        "#include <math.h>",
        "",
        '#include "elementary.h"',
        "",
        "enum {",
        *(f"    {name} = {value}," for name, value in {**names, **given.counts}.items()),
        "};",
        "",
        *(f"#define {name} {number(value)}" for name, value in given.macros.items()),
        "",
        "/* An interval of a parameter that other parameters decide. */",
        "typedef struct {",
        "    int parameter; /* its place in the list of parameters */",
        "    unsigned char low_open, high_open;",
        "    const char *doc;",
        "} Limit;",
        f"extern const Limit limits[{max(names['N_LIMITS'], 1)}];",
        "",
        "/* A way to leave the tables: an input or output outside its interval. */",
        "typedef struct {",
        "    int variable; /* its place in the list of inputs and outputs */",
        "    const char *doc;",
        "} Warning;",
        array("static const Warning warnings[N_WARNINGS]", watched),
        *(f"extern const double {declared};" for declared in given.arrays),
        "",
        "/* y = name(x); c are the constants: parameters, fixed ones, then what law_constants computes. */",
        *(f"void {name}(const double *x, const double *c, double *y);" for name in prototypes),
        *(["typedef void Law(const double *x, const double *c, double *y);"] if series else []),
        *(f"extern Law *const {name}[N_LAW_SWITCHES + 1];" for name in series),
        "",
        HELPERS,
        *inline,
        "#endif",
        "",
    ]
    for name in series:
        rows = [f"{name}_{k}" for k in range(regimes)]
        bodies.append(array(f"Law *const {name}[N_LAW_SWITCHES + 1]", rows))
    place = {name: i for i, name in enumerate(g.theta)}
    rows = [
        f"{{{place[m.name]}, {int(m.interval.low_open)}, {int(m.interval.high_open)}, {string(m.doc)}}}"
        for m in g.limits
    ]
    bodies.append(array(f"const Limit limits[{max(len(rows), 1)}]", rows or ['{0, 0, 0, ""}']))
    bodies += [array(f"const double {declared}", rows) for declared, rows in given.arrays.items()]
    return "\n".join(header), '#include "law.h"\n\n' + "\n".join(bodies)
