"""The gear contact in C: its functions."""

from typing import Any

import numpy as np

from jointfmu.joints.gear_contact import spring
from jointfmu.joints.model import Model
from jointfmu.powerlaw import Spots

from ...native.graph import Graph, add_closing, law_functions, symbols
from ...native.part import APPROACH, NativePart


def _functions(g: Graph, model: Model) -> None:
    joint = g.joint

    def state(spots: Spots, u: Any) -> list[Any]:
        area = spots.total("area", u)
        return [area, spots.total("elastic_area", u) / area]

    law_functions(g, joint, ("normal",), state)
    add_closing(g)
    f, approach, stiffness, area, elastic = symbols("x", 5)
    g.add_with_seed("argument", "inputs -> pressure", [f], [np.maximum(f, 0.0) / joint.A_0])
    out = spring.contact(joint, f, approach, stiffness, area, elastic)
    doc = "inputs, approach, stiffness of the curve, real area, elastic part -> outputs"
    y = [out[o.name] for o in model.outputs]
    g.add_with_seed("outputs", doc, [f, approach, stiffness, area, elastic], y)


PART = NativePart(_functions, APPROACH)
