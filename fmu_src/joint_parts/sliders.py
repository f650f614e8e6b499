"""Return mapping of one friction slider (Jenkins element) as C functions, called by `law/sliders.c`."""

import casadi as ca

from jointfmu.mechanics.jenkins import ReturnMapping, elastic_predictor, limit_function, return_map
from jointfmu.quantity import select

from .graph import Graph, make_symbols

SLIDER_FILES = ("sliders", "vectors")
"""Shared C files of joints with friction sliders."""


def add_slider_functions(function_graph: Graph) -> None:
    """Add the slider functions: in one direction with a constant or a changing limit, and in a plane."""
    force, shift, before, after, stiffness, compliance = make_symbols("x", 6)
    tried = elastic_predictor([force], 1.0, stiffness, [shift])
    doc = "force, shift, limit, stiffness -> force if it sticks, whether that is at the limit or beyond"
    function_graph.add_function(
        "stick_line", doc, [force, shift, after, stiffness], [*tried, limit_function(tried, after)]
    )
    slid = return_map([force], 1.0, stiffness, [shift], after, after, stiffness, compliance)
    results = "force, tangent along and across, loss"
    doc = (
        f"force, limit, stiffness, compliance, shift -> {results}, its derivative in the shift: the friction"
    )
    heat = select(slid.slip_force > 0.0, slid.force[0], 0.0)
    y = [*slid.force, *slid.tangent, slid.dissipated_energy, heat]
    function_graph.add_function("slide_steady", doc, [force, after, stiffness, compliance, shift], y)
    slid = return_map([force], 1.0, stiffness, [shift], before, after, stiffness, compliance)
    doc = f"force, limit before, stiffness, compliance, shift, limit after -> {results}"
    x = [force, before, stiffness, compliance, shift, after]
    y = [*slid.force, *slid.tangent, slid.dissipated_energy]
    function_graph.add_with_derivative("slide_line", doc, x, y, constant_count=4)
    _add_plane_functions(function_graph)


def _add_plane_functions(function_graph: Graph) -> None:
    """Add the functions of a slider with two tangential directions."""
    x, (force, after, shift), slid = _slider_update()
    tried = elastic_predictor(force, x[2], x[3], shift)
    doc = "force, part kept, gain, shift"
    y = [*tried, limit_function(tried, after)]
    function_graph.add_function(
        "stick_plane",
        f"{doc}, limit -> force if it sticks, whether at the limit or beyond",
        [*x[:6], after],
        y,
    )
    doc = f"{doc}, limits before and after, stiffness, compliance"
    y = [*slid.force, *slid.tangent, slid.dissipated_energy, slid.slip_force]
    function_graph.add_function("slide_plane", f"{doc} -> force, tangent xx, xy, yy, loss, slip", x, y)
    function_graph.add_function("return_plane", f"{doc} -> force", x, slid.force)
    function_graph.add_derivative("slide_plane", doc, x, y, constant_count=2)
    x, (_, after, shift), slid = _slider_update()  # new symbols: a separate function
    y = list(ca.densify(ca.jacobian(ca.vertcat(*slid.force), ca.vertcat(*shift, after))).T.nz)
    function_graph.add_function(
        "return_slopes",
        f"{doc} -> derivatives of the force by shift and limit after",
        x,
        y,
        called_in_loops=True,
    )


def _slider_update() -> tuple[list[ca.SX], tuple[list[ca.SX], ca.SX, list[ca.SX]], ReturnMapping]:
    """Return mapping of a slider with two tangential directions, for symbolic arguments.

    Returns all arguments (force, fraction of the force retained, stiffness of the increment, displacement
    increment, limits before and after, stiffness, compliance), among them (force, limit after, increment),
    and the result.
    """
    force, shift, (keeps, carries) = make_symbols("q", 2), make_symbols("u", 2), make_symbols("k", 2)
    before, after, stiffness, compliance = ends = make_symbols("x", 4)
    slid = return_map(force, keeps, carries, shift, before, after, stiffness, compliance)
    return [*force, keeps, carries, *shift, *ends], (force, after, shift), slid
