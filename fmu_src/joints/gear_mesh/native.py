"""Functions and constants of the gear mesh for C code generation."""

import casadi as ca
import numpy as np

from jointfmu.joints.gear_mesh import spring
from jointfmu.joints.model import Model

from ...joint_parts.graph import FunctionGraph, add_closing_function, add_law_functions, make_symbols
from ...joint_parts.native import APPROACH_FILES, CDefinitions, NativeDefinition


def _add_functions(function_graph: FunctionGraph, model: Model) -> None:
    """Add the functions that the C code of the gear mesh calls."""
    mesh = function_graph.joint
    add_law_functions(function_graph, mesh, ("normal",), lambda spots, u: [])
    add_closing_function(function_graph)
    flanks = make_symbols("flanks", 4)
    doc = "approach, pressure, dp/dx, d2p/dx2 of the flanks -> deflection, load, K, dK/ds of a tooth pair"
    function_graph.add_function("combine_in_series", doc, flanks, spring.combine_in_series(mesh, *flanks))
    motion = [ca.SX.sym(v.name) for v in model.inputs]
    argument = np.abs(spring.deflection(mesh, motion))
    function_graph.add_function_with_derivative(
        "curve_argument", "inputs -> argument of the curve", motion, [argument]
    )
    closing, load, stiffness, energy = make_symbols("pair", 4)
    out = spring.mesh_outputs(mesh, motion, load, stiffness, energy, closing)
    doc = "deflection at the end of the closing, inputs, load, K, energy of a tooth pair -> outputs"
    x = [closing, *motion, load, stiffness, energy]
    function_graph.add_function_with_derivative(
        "outputs", doc, x, [out[o.name] for o in model.outputs], constant_count=1
    )


NATIVE_PART = NativeDefinition(
    _add_functions,
    APPROACH_FILES,
    lambda g, model: CDefinitions({"PAIR_CLOSING_STEPS": spring.CLOSING_STEPS}),
)
"""Definition of the C code of the gear mesh."""
