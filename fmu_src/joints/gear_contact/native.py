"""Functions of the gear contact for C code generation."""

import numpy as np

from jointfmu.contact.laws import yu2022
from jointfmu.joints.gear_contact import spring
from jointfmu.joints.model import Model

from ...joint_parts.graph import FunctionGraph, add_closing_function, add_law_functions, make_symbols
from ...joint_parts.native import APPROACH_FILES, NativeDefinition


def _add_functions(function_graph: FunctionGraph, model: Model) -> None:
    """Add the functions that the C code of the gear contact calls."""
    joint = function_graph.joint
    f, approach, stiffness, area, elastic = make_symbols("x", 5)
    pressure = np.maximum(f, 0.0) / joint.A_0
    function_graph.add_function_with_derivative("curve_argument", "inputs -> pressure", [f], [pressure])
    x = [f, approach, stiffness]
    if isinstance(joint, spring.RoughGearContactParameters | spring.TableGearContactParameters):
        add_law_functions(function_graph, joint, ("normal",), lambda spots, u: [])
        area, elastic = joint.real_area(pressure)
    else:
        add_law_functions(function_graph, joint, ("normal",), yu2022.real_area)
        x += [area, elastic]
    out = spring.contact_outputs(joint, f, approach, stiffness, area, elastic)
    add_closing_function(function_graph)
    doc = "inputs, approach, stiffness of the curve, areas if the law sums them over spots -> outputs"
    function_graph.add_function_with_derivative("outputs", doc, x, [out[o.name] for o in model.outputs])


NATIVE_PART = NativeDefinition(_add_functions, APPROACH_FILES)
"""Definition of the C code of the gear contact."""
