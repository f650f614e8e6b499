"""Functions of the gear contact for C code generation."""

import numpy as np

from jointfmu.contact.laws import yu2022
from jointfmu.joints.gear_contact import spring
from jointfmu.joints.model import Model

from ...joint_parts.graph import Graph, add_closing, law_functions, symbols
from ...joint_parts.native import APPROACH, NativePart


def _functions(g: Graph, model: Model) -> None:
    """Add the functions that the C code of the gear contact calls."""
    joint = g.joint
    f, approach, stiffness, area, elastic = symbols("x", 5)
    pressure = np.maximum(f, 0.0) / joint.A_0
    g.add_with_seed("curve_argument", "inputs -> pressure", [f], [pressure])
    x = [f, approach, stiffness]
    if isinstance(joint, spring.RoughGearContact):
        law_functions(g, joint, ("normal",), lambda spots, u: [])
        area, elastic = joint.real_area(pressure)
    else:
        law_functions(g, joint, ("normal",), yu2022.real_area)
        x += [area, elastic]
    out = spring.contact_outputs(joint, f, approach, stiffness, area, elastic)
    add_closing(g)
    doc = "inputs, approach, stiffness of the curve, areas if the law sums them over spots -> outputs"
    g.add_with_seed("outputs", doc, x, [out[o.name] for o in model.outputs])


PART = NativePart(_functions, APPROACH)
