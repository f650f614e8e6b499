"""The bolted joint in C: its functions and its nodes."""

import casadi as ca
import numpy as np

from jointfmu.footprint.bolts import pressure_shape
from jointfmu.footprint.shape import MergedShape
from jointfmu.joints.bolted_joint import law, spring
from jointfmu.joints.model import Model

from ...native.c_text import number
from ...native.graph import Graph, add_closing, law_functions, symbols
from ...native.part import APPROACH, Definitions, NativePart


def _functions(g: Graph, model: Model) -> None:
    joint = g.joint
    law_functions(
        g, joint, ("normal",), lambda s, u: [s.total("plastic_work", u), s.total("elastic_work", u)]
    )
    add_closing(g)
    equal, tilt, mean, shift = symbols("node", 4)
    preload, moment, *rest = symbols("v", 8)
    doc = "preload, moment -> mean pressure, pressure that the moment adds"
    bolts = law.bolt_pressures(joint, preload, moment)
    g.add_with_seed("bolt_pressures", doc, [preload, moment], bolts)
    doc = "equal, tilt, bolt_pressures -> pressure of a node at tightening"
    pressure = law.shaped_pressure(equal, tilt, mean, shift)
    g.add_with_seed("shaped_pressure", doc, [equal, tilt, mean, shift], [pressure], fixed=2)
    s_rel, v_rel = rest[:3], rest[3:]
    sums = dict(zip(spring.SUMS, symbols("sum", len(spring.SUMS)), strict=True))
    p_max = ca.SX.sym("p_max")
    out = spring.motion(joint, sums, s_rel, v_rel, p_max)
    doc = f"sums over the nodes ({', '.join(sums)}), s_rel, v_rel, largest pressure -> outputs"
    y = [out[o.name] for o in model.outputs]
    g.add_with_seed("outputs", doc, [*sums.values(), *s_rel, *v_rel, p_max], y)


def _definitions(g: Graph, model: Model) -> Definitions:
    shape = pressure_shape(g.joint.pattern)
    counts = {f"SUM_{name.upper()}": k for k, name in enumerate(spring.SUMS)} | {"N_SUMS": len(spring.SUMS)}
    counts |= {name: k for k, name in enumerate(("SHARE", "SHARE_X2", "SHARE_Y2", "EQUAL", "TILT"))}
    nodes = _nodes("NODES", shape.merged()) | _nodes("EVEN_NODES", shape.merged(moment=False))
    return Definitions(counts) | nodes


def _nodes(name: str, shape: MergedShape) -> Definitions:
    """Rows (n, 5) of share, share times x2 and y2, equal, tilt; neighbours have similar pressures."""
    share = shape.share
    rows = np.column_stack([share, share * shape.x2, share * shape.y2, shape.equal, shape.tilt])
    rows = rows[np.lexsort((shape.equal, shape.tilt > 0.0))]
    texts = ["{" + ", ".join(number(x) for x in row) + "}" for row in rows]
    return Definitions({f"N_{name}": len(rows)}, {}, {f"{name}[N_{name}][5]": texts})


PART = NativePart(_functions, APPROACH, _definitions)
