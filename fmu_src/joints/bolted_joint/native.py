"""The bolted joint in C: its functions and its nodes."""

from typing import Any

import casadi as ca
import numpy as np

from jointfmu.footprint.bolts import pressure_shape
from jointfmu.footprint.shape import PressureShape
from jointfmu.joints.bolted_joint import spring
from jointfmu.joints.model import Model

from ...native.c_text import number
from ...native.graph import Graph, law_functions, symbols
from ...native.part import APPROACH, Definitions, NativePart


def _functions(g: Graph, model: Model) -> None:
    joint = g.joint
    law_functions(
        g, joint, ("normal",), lambda s, u: [s.total("plastic_work", u), s.total("elastic_work", u)]
    )
    node = symbols("node", 4)
    preload, moment, *rest = symbols("v", 8)
    pressure = spring.node_pressure(joint, node[0], node[1], preload, moment)
    doc = "equal, tilt, preload, moment -> pressure of a node at tightening"
    g.add_with_seed("node_pressure", doc, [node[0], node[1], preload, moment], [pressure], fixed=2)
    s_rel, v_rel = rest[:3], rest[3:]
    tightened, *curve = symbols("p", 5)
    works = symbols("w", 2)
    parts = spring.node_parts(joint, node[2], node[3], s_rel, tightened, curve, works)
    doc = "x2, y2, s_rel, pressure at tightening, pressure and 3 derivatives, works -> parts of a node"
    x = [*node[2:], *s_rel, tightened, *curve, *works]
    g.add_with_seed("node_parts", doc, x, list(parts.values()), fixed=2)
    sums = dict(zip(parts, symbols("sum", len(parts)), strict=True))
    p_max = ca.SX.sym("p_max")
    out = spring.motion(joint, sums, s_rel, v_rel, p_max)
    doc = "sums of the parts, s_rel, v_rel, largest pressure -> outputs"
    y = [out[o.name] for o in model.outputs]
    g.add_with_seed("outputs", doc, [*sums.values(), *s_rel, *v_rel, p_max], y)


def _definitions(g: Graph, model: Model) -> Definitions:
    rows = merged(pressure_shape(g.joint.pattern))
    count = {f.name: len(f.y) for f in g.functions}["node_parts"]
    counts = {"SHARE": 0, "EQUAL": 1, "TILT": 2, "X2": 3, "Y2": 4, "N_NODES": len(rows)}
    nodes = ["{" + ", ".join(number(x) for x in row) + "}" for row in rows]
    return Definitions(
        {**counts, "N_PARTS": count, "N_OUTPUTS_X": count + 7}, {}, {"NODES[N_NODES][5]": nodes}
    )


def merged(shape: PressureShape) -> np.ndarray[Any, Any]:
    """Rows (n, 5) of share, equal, tilt, x2, y2: nodes that always have the same pressure as one.

    x2, y2 [m2] are the means of their squared distances from the centroid.
    """
    keys = np.round(np.column_stack([shape.equal, shape.tilt]), 11)
    _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    share = np.bincount(group.ravel(), shape.share)
    squares = [np.bincount(group.ravel(), shape.share * shape.position[:, k] ** 2) / share for k in (0, 1)]
    return np.column_stack([share, shape.equal[first], shape.tilt[first], *squares])


PART = NativePart(_functions, APPROACH, _definitions)
