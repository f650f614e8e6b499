"""Return mapping of one friction slider (Jenkins element) as C functions, called by `law/jenkins.c`."""

import casadi as ca

from jointfmu.mechanics.jenkins import ReturnMapping, elastic_predictor, return_map, slip_limit_function
from jointfmu.quantity import select

from .graph import CFunctionSet, make_casadi_symbols

SLIDER_FILE_STEMS = ("jenkins", "simd")
"""Shared C files of joints with friction sliders."""


def add_slider_functions(c_function_set: CFunctionSet) -> None:
    """Add the C functions of the return mapping of a friction slider (Jenkins element).

    The slider moves in one direction or in a plane; its friction limit is constant or changes in the step.
    """
    force, displacement, limit_start, limit_end, stiffness, compliance = make_casadi_symbols("x", 6)
    predictor = elastic_predictor([force], 1.0, stiffness, [displacement])
    doc = "force, displacement, limit, stiffness -> elastic predictor, its limit function"
    c_function_set.add_function(
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
    c_function_set.add_function("return_map_1d_constant_limit", doc, x, y)
    mapping = return_map(
        [force], 1.0, stiffness, [displacement], limit_start, limit_end, stiffness, compliance
    )
    doc = f"force, limit at start, stiffness, compliance, displacement, limit at end -> {results}"
    x = [force, limit_start, stiffness, compliance, displacement, limit_end]
    y = [*mapping.force, *mapping.tangent, mapping.dissipated_energy]
    c_function_set.add_function_with_derivative("return_map_1d", doc, x, y, constant_argument_count=4)
    _add_plane_slider_functions(c_function_set)


def _add_plane_slider_functions(c_function_set: CFunctionSet) -> None:
    """Add the C functions of the return mapping of a friction slider with two tangential directions."""
    x, (force, limit_end, displacement), mapping = _make_symbolic_return_mapping()
    predictor = elastic_predictor(force, x[2], x[3], displacement)
    doc = "force, retention, secant stiffness, displacement"
    y = [*predictor, slip_limit_function(predictor, limit_end)]
    c_function_set.add_function(
        "elastic_predictor_2d",
        f"{doc}, limit -> elastic predictor, its limit function",
        [*x[:6], limit_end],
        y,
    )
    doc = f"{doc}, limits at start and end, stiffness, compliance"
    y = [*mapping.force, *mapping.tangent, mapping.dissipated_energy, mapping.slip_force]
    c_function_set.add_function("return_map_2d", f"{doc} -> force, tangent xx, xy, yy, loss, slip", x, y)
    c_function_set.add_function("return_map_2d_force", f"{doc} -> force", x, mapping.force)
    c_function_set.add_derivative("return_map_2d", doc, x, y, constant_argument_count=2)
    x, (_, limit_end, displacement), mapping = (
        _make_symbolic_return_mapping()
    )  # new symbols: a separate function
    y = list(ca.densify(ca.jacobian(ca.vertcat(*mapping.force), ca.vertcat(*displacement, limit_end))).T.nz)
    c_function_set.add_function(
        "return_map_2d_derivatives",
        f"{doc} -> derivatives of the force by displacement and limit at end",
        x,
        y,
        is_called_in_loops=True,
    )


def _make_symbolic_return_mapping() -> tuple[
    list[ca.SX], tuple[list[ca.SX], ca.SX, list[ca.SX]], ReturnMapping
]:
    """Return mapping of a friction slider with two tangential directions as CasADi expressions.

    Returns the symbols of all arguments (force, fraction of the force retained, stiffness of the increment,
    displacement increment, friction limits at start and end, stiffness, compliance); the symbols of three
    arguments (force, limit at the end, displacement increment); and the result of the mapping.
    """
    force, displacement = make_casadi_symbols("q", 2), make_casadi_symbols("u", 2)
    retention, secant_stiffness = make_casadi_symbols("k", 2)
    limit_start, limit_end, stiffness, compliance = ends = make_casadi_symbols("x", 4)
    mapping = return_map(
        force, retention, secant_stiffness, displacement, limit_start, limit_end, stiffness, compliance
    )
    return (
        [*force, retention, secant_stiffness, *displacement, *ends],
        (force, limit_end, displacement),
        mapping,
    )
