"""Functions and constants of the gear mesh for C code generation."""

import casadi as ca
import numpy as np

from jointfmu.joints.gear_mesh import spring
from jointfmu.joints.model import Model

from ...joint_parts.graph import (
    CFunctionSet,
    add_closing_pressure_function,
    add_law_functions,
    make_casadi_symbols,
)
from ...joint_parts.native import APPROACH_CURVE_FILE_STEMS, CConstants, NativeDefinition


def _add_joint_c_functions(c_function_set: CFunctionSet, fmu_model: Model) -> None:
    """Add the functions that the C code of the gear mesh calls."""
    mesh = c_function_set.symbolic_parameter_set
    add_law_functions(c_function_set, mesh, ("normal",), lambda spots, u: [])
    add_closing_pressure_function(c_function_set)
    flanks = make_casadi_symbols("flanks", 4)
    doc = "approach, pressure, dp/dx, d2p/dx2 of the flanks -> deflection, load, K, dK/ds of a tooth pair"
    c_function_set.add_function(
        "combine_flanks_and_teeth", doc, flanks, spring.combine_flanks_and_teeth(mesh, *flanks)
    )
    motion = [ca.SX.sym(v.name) for v in fmu_model.inputs]
    argument = np.abs(spring.deflection(mesh, motion))
    c_function_set.add_function_with_derivative(
        "curve_argument", "inputs -> argument of the curve", motion, [argument]
    )
    closing, load, stiffness, energy = make_casadi_symbols("pair", 4)
    out = spring.mesh_outputs(mesh, motion, load, stiffness, energy, closing)
    doc = "deflection at the end of the closing, inputs, load, K, energy of a tooth pair -> outputs"
    x = [closing, *motion, load, stiffness, energy]
    c_function_set.add_function_with_derivative(
        "outputs", doc, x, [out[o.name] for o in fmu_model.outputs], constant_argument_count=1
    )


NATIVE_DEFINITION = NativeDefinition(
    _add_joint_c_functions,
    APPROACH_CURVE_FILE_STEMS,
    lambda g, model: CConstants({"TOOTH_PAIR_CLOSING_STEPS": spring.CONTACT_CLOSING_STEPS}),
)
"""Definition of the C code of the gear mesh."""
