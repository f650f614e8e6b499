"""Return mapping of one friction slider (Jenkins element) as C functions, called by `law/jenkins.c`."""

import casadi as ca

from jointfmu.mechanics.jenkins import ReturnMapping, elastic_predictor, return_map, slip_limit_function
from jointfmu.quantity import select

from .graph import FunctionGraph, make_symbols

SLIDER_FILES = ("jenkins", "simd")
"""Shared C files of joints with friction sliders."""


def add_slider_functions(function_graph: FunctionGraph) -> None:
    """Add the return mappings of a friction slider to a graph.

    The functions are for one direction with a constant or a changing limit, and for a plane.
    """
    force, displacement, limit_start, limit_end, stiffness, compliance = make_symbols("x", 6)
    predictor = elastic_predictor([force], 1.0, stiffness, [displacement])
    doc = "force, displacement, limit, stiffness -> elastic predictor, its limit function"
    function_graph.add_function(
        "elastic_predictor_1d",
        doc,
        [force, displacement, limit_end, stiffness],
        [*predictor, slip_limit_function(predictor, limit_end)],
    )
    mapping = return_map([force], 1.0, stiffness, [displacement], limit_end, limit_end, stiffness, compliance)
    results = "force, tangent along and across, loss"
    derivative = "derivative of the loss by the displacement"
    doc = f"force, limit, stiffness, compliance, displacement -> {results}, {derivative}"
    loss_derivative = select(mapping.slip_force > 0.0, mapping.force[0], 0.0)
    y = [*mapping.force, *mapping.tangent, mapping.dissipated_energy, loss_derivative]
    x = [force, limit_end, stiffness, compliance, displacement]
    function_graph.add_function("return_map_1d_constant_limit", doc, x, y)
    mapping = return_map(
        [force], 1.0, stiffness, [displacement], limit_start, limit_end, stiffness, compliance
    )
    doc = f"force, limit at start, stiffness, compliance, displacement, limit at end -> {results}"
    x = [force, limit_start, stiffness, compliance, displacement, limit_end]
    y = [*mapping.force, *mapping.tangent, mapping.dissipated_energy]
    function_graph.add_function_with_derivative("return_map_1d", doc, x, y, constant_count=4)
    _add_plane_slider_functions(function_graph)


def _add_plane_slider_functions(function_graph: FunctionGraph) -> None:
    """Add the functions of a slider with two tangential directions."""
    x, (force, limit_end, displacement), mapping = _symbolic_return_mapping()
    predictor = elastic_predictor(force, x[2], x[3], displacement)
    doc = "force, retention, secant stiffness, displacement"
    y = [*predictor, slip_limit_function(predictor, limit_end)]
    function_graph.add_function(
        "elastic_predictor_2d",
        f"{doc}, limit -> elastic predictor, its limit function",
        [*x[:6], limit_end],
        y,
    )
    doc = f"{doc}, limits at start and end, stiffness, compliance"
    y = [*mapping.force, *mapping.tangent, mapping.dissipated_energy, mapping.slip_force]
    function_graph.add_function("return_map_2d", f"{doc} -> force, tangent xx, xy, yy, loss, slip", x, y)
    function_graph.add_function("return_map_2d_force", f"{doc} -> force", x, mapping.force)
    function_graph.add_derivative("return_map_2d", doc, x, y, constant_count=2)
    x, (_, limit_end, displacement), mapping = _symbolic_return_mapping()  # new symbols: a separate function
    y = list(ca.densify(ca.jacobian(ca.vertcat(*mapping.force), ca.vertcat(*displacement, limit_end))).T.nz)
    function_graph.add_function(
        "return_map_2d_derivatives",
        f"{doc} -> derivatives of the force by displacement and limit at end",
        x,
        y,
        called_in_loops=True,
    )


def _symbolic_return_mapping() -> tuple[list[ca.SX], tuple[list[ca.SX], ca.SX, list[ca.SX]], ReturnMapping]:
    """Return mapping of a slider with two tangential directions, for symbolic arguments.

    Returns a list of all arguments (force, fraction of the force retained, stiffness of the increment,
    displacement increment, limits at start and end, stiffness, compliance); three of these arguments again,
    by themselves (force, limit at the end, displacement increment); and the result of the mapping.
    """
    force, displacement = make_symbols("q", 2), make_symbols("u", 2)
    retention, secant_stiffness = make_symbols("k", 2)
    limit_start, limit_end, stiffness, compliance = ends = make_symbols("x", 4)
    mapping = return_map(
        force, retention, secant_stiffness, displacement, limit_start, limit_end, stiffness, compliance
    )
    return (
        [*force, retention, secant_stiffness, *displacement, *ends],
        (force, limit_end, displacement),
        mapping,
    )
