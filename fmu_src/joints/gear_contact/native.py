"""Functions of the gear contact for C code generation."""

import numpy as np

from jointfmu.contact.laws import yu2022
from jointfmu.joints.gear_contact import spring
from jointfmu.joints.model import Model

from ...joint_parts.graph import (
    CFunctionSet,
    add_closing_pressure_function,
    add_law_functions,
    make_casadi_symbols,
)
from ...joint_parts.native import APPROACH_CURVE_FILE_STEMS, NativeDefinition


def _add_joint_c_functions(c_function_set: CFunctionSet, fmu_model: Model) -> None:
    """Add the functions that the C code of the gear contact calls."""
    joint = c_function_set.symbolic_parameter_set
    f, approach, stiffness, area, elastic = make_casadi_symbols("x", 5)
    pressure = np.maximum(f, 0.0) / joint.A_0
    c_function_set.add_function_with_derivative("curve_argument", "inputs -> pressure", [f], [pressure])
    x = [f, approach, stiffness]
    if isinstance(joint, spring.RoughGearContactParameters | spring.TableGearContactParameters):
        add_law_functions(c_function_set, joint, ("normal",), lambda spots, u: [])
        area, elastic = joint.real_area(pressure)
    else:
        add_law_functions(c_function_set, joint, ("normal",), yu2022.real_area)
        x += [area, elastic]
    out = spring.contact_outputs(joint, f, approach, stiffness, area, elastic)
    add_closing_pressure_function(c_function_set)
    doc = "inputs, approach, stiffness of the curve, areas if the law sums them over spots -> outputs"
    c_function_set.add_function_with_derivative("outputs", doc, x, [out[o.name] for o in fmu_model.outputs])


NATIVE_DEFINITION = NativeDefinition(_add_joint_c_functions, APPROACH_CURVE_FILE_STEMS)
"""Definition of the C code of the gear contact."""
