"""Functions and constants of the gear mesh for C code generation."""

import casadi as ca
import numpy as np

from jointfmu.joints.gear_mesh import spring
from jointfmu.joints.model import Model

from ...joint_parts.graph import Graph, add_closing, law_functions, symbols
from ...joint_parts.native import APPROACH, Definitions, NativePart


def _functions(g: Graph, model: Model) -> None:
    """Add the functions that the C code of the gear mesh calls."""
    mesh = g.joint
    law_functions(g, mesh, ("normal",), lambda spots, u: [])
    add_closing(g)
    flanks = symbols("flanks", 4)
    doc = "approach, pressure, dp/dx, d2p/dx2 of the flanks -> deflection, load, K, dK/ds of a tooth pair"
    g.add("combine_in_series", doc, flanks, spring.combine_in_series(mesh, *flanks))
    motion = [ca.SX.sym(v.name) for v in model.inputs]
    argument = np.abs(spring.deflection(mesh, motion))
    g.add_with_seed("curve_argument", "inputs -> argument of the curve", motion, [argument])
    closing, load, stiffness, energy = symbols("pair", 4)
    out = spring.mesh_outputs(mesh, motion, load, stiffness, energy, closing)
    doc = "deflection at the end of the closing, inputs, load, K, energy of a tooth pair -> outputs"
    x = [closing, *motion, load, stiffness, energy]
    g.add_with_seed("outputs", doc, x, [out[o.name] for o in model.outputs], constant_count=1)


PART = NativePart(
    _functions, APPROACH, lambda g, model: Definitions({"PAIR_CLOSING_STEPS": spring.CLOSING_STEPS})
)
