"""Functions and constants of the bolted joint for C code generation; its points are data of the FMU."""

import casadi as ca

from jointfmu.joints.bolted_joint import bodies, bolts, contact, equilibrium, friction, law, outputs
from jointfmu.joints.model import Model
from jointfmu.mechanics import jenkins, sliders
from jointfmu.mechanics.footprint.distribution import MAX_PATCHES

from ...joint_parts.graph import FunctionGraph, add_closing_function, add_law_functions, make_symbols
from ...joint_parts.native import APPROACH_FILES, CDefinitions, NativeDefinition
from ...joint_parts.sliders import SLIDER_FILES, add_slider_functions


def _add_functions(function_graph: FunctionGraph, model: Model) -> None:
    """Add the functions that the C code of the bolted joint calls."""
    joint = function_graph.joint
    add_law_functions(
        function_graph,
        joint,
        ("normal",),
        lambda s, u: [s.sum_over_spots("plastic_work", u), s.sum_over_spots("elastic_work", u)],
    )
    add_closing_function(function_graph)
    constants = [
        joint.memory,
        joint.mu,
        joint.shear_stiffness_ratio(),
        joint.A_0,
        joint.bolt_stiffness,
        joint.damping,
    ]
    doc = "-> memory, mu, K_T/K_N, A_0, stiffness of a bolt, damping, number of bolts"
    function_graph.add_function("joint_constants", doc, [], [*constants, joint.n_bolts])
    _add_preload_functions(function_graph)
    _add_shear_functions(function_graph)
    sums = dict(
        zip(outputs.CONTACT_SUM_NAMES, make_symbols("sum", len(outputs.CONTACT_SUM_NAMES)), strict=True)
    )
    displacement, rotation, rates = make_symbols("s", 3), make_symbols("t", 3), make_symbols("v", 6)
    p_max = ca.SX.sym("p_max")
    out = outputs.joint_outputs(joint, sums, displacement, rotation, rates, p_max)
    doc = f"sums ({', '.join(sums)}), s_rel, theta, v_rel, omega, largest pressure -> outputs"
    y = [out[o.name] for o in model.outputs if o.name in out]  # bolt forces follow from the modes
    x = [*sums.values(), *displacement, *rotation, *rates, p_max]
    function_graph.add_function_with_derivative("outputs", doc, x, y)


def _add_preload_functions(function_graph: FunctionGraph) -> None:
    """Add the C functions of the contact pressures under preload and moment."""
    equal, tilt, mean, by_moment = make_symbols("node", 4)
    preload, moment, temperature = make_symbols("v", 3)
    doc = "preload at tightening, temperature -> preload at this temperature"
    warm = law.preload_at_temperature(function_graph.joint, preload, temperature)
    function_graph.add_function_with_derivative("preload_at_temperature", doc, [preload, temperature], [warm])
    doc = "preload, moment -> mean pressure, pressure that the moment adds"
    function_graph.add_function_with_derivative(
        "bolt_pressures", doc, [preload, moment], law.bolt_pressures(function_graph.joint, preload, moment)
    )
    doc = "preload -> preload after embedding"
    function_graph.add_function_with_derivative(
        "working_preload", doc, [preload], [law.working_preload(function_graph.joint, preload)]
    )
    doc = "equal, tilt, bolt_pressures -> pressure of a node at tightening"
    pressure = law.superposed_pressure(equal, tilt, mean, by_moment)
    function_graph.add_function_with_derivative(
        "shaped_pressure", doc, [equal, tilt, mean, by_moment], [pressure], constant_count=2
    )


def _add_shear_functions(function_graph: FunctionGraph) -> None:
    """Add the C functions of elastic shear, and of friction sliders of a patch, to the function graph."""
    x = make_symbols("x", 7)
    doc = (
        "friction limit, pressure and its derivatives, displacement -> traction, tangent xx, xy, yy, "
        "added pressure and stiffness"
    )
    y = contact.elastic_shear(x[0], function_graph.joint.shear_stiffness_ratio(), x[1:5], x[5], x[6])
    function_graph.add_function_with_derivative("elastic_shear", doc, x, y)
    add_slider_functions(function_graph)
    _add_cycle_functions(function_graph)
    _add_stick_function(function_graph)
    load, stiffness, bend, width, ratio, friction = make_symbols("x", 6)
    doc = "load, stiffness, its slope, excess of the approach -> stiffness, its slope, limits of both sliders"
    x = [ratio, friction, load, stiffness, bend, width]
    y = sliders.partial_contact(load, stiffness, bend, width, ratio, friction)
    function_graph.add_function_with_derivative(
        "partial_contact", f"K_T/K_N, mu, {doc}", x, y, constant_count=2
    )
    small, first, slope, last, then, change, rise = make_symbols("x", 7)
    doc = (
        "whether small, stiffness and its slope at both ends, change of the approach, integral of the "
        "stiffness -> fraction retained, secant stiffness"
    )
    kept = sliders.retention_and_stiffness((first, slope), (last, then), change, rise, small)
    x = [small, first, slope, last, then, change, rise]
    function_graph.add_function_with_derivative("retention_and_stiffness", doc, x, kept, constant_count=1)
    across, slip = make_symbols("x", 2)
    force, moved, shift, ends, middle = (make_symbols(name, 2) for name in "qfukm")
    doc = (
        "whether the contact changes, force at both ends, displacement, stiffness at both ends, "
        "slip force, middle force -> loss"
    )
    loss = sliders.varying_stiffness_loss(force, moved, shift, (ends[0], ends[1]), slip, across, middle)
    x = [across, *force, *moved, *shift, *ends, slip, *middle]
    function_graph.add_function_with_derivative("varying_stiffness_loss", doc, x, [loss], constant_count=3)


def _add_stick_function(function_graph: FunctionGraph) -> None:
    """Add the C function of a foundation of sliders in full stick."""
    stiff, now, falls = make_symbols("x", 3)
    doc = "whether the load decreases, stiffness at both ends -> fraction retained, secant stiffness"
    y = sliders.stick_retention(stiff, now, falls)
    function_graph.add_function_with_derivative(
        "stick_retention", doc, [falls, stiff, now], y, constant_count=1
    )


def _add_cycle_functions(function_graph: FunctionGraph) -> None:
    """Add the C functions of energy loss and elastic energy of a friction cycle at constant load."""
    x = make_symbols("x", 6)
    doc = "mu, K_T/K_N, amplitude, load, load at the slipped height, integral between -> loss, elastic energy"
    function_graph.add_function_with_derivative(
        "cycle_energies", doc, x, sliders.cycle_energies(*x), constant_count=2
    )
    (mu, ratio, size), now, then = make_symbols("x", 3), make_symbols("n", 3), make_symbols("t", 3)
    doc = "mu, K_T/K_N, amplitude, three derivatives of the load at both heights -> loss, elastic energy"
    y = sliders.small_cycle_energies(mu, ratio, size, now, then)
    function_graph.add_function_with_derivative(
        "small_cycle_energies", doc, [mu, ratio, size, *now, *then], y, constant_count=2
    )


def _make_c_constants(function_graph: FunctionGraph, model: Model) -> CDefinitions:
    """Make the C constants that the C code of the bolted joint has in common with Python."""
    counts = {f"SUM_{name.upper()}": k for k, name in enumerate(outputs.CONTACT_SUM_NAMES)} | {
        "N_SUMS": len(outputs.CONTACT_SUM_NAMES)
    }
    columns = ("SHARE", "POSITION_X", "POSITION_Y", "PRELOAD_SHAPE", "MOMENT_SHAPE", "RADIUS")
    counts |= {name: k for k, name in enumerate(columns)}
    names = (
        "SMALL_APPROACH_CHANGE_OVER_INTERVAL",
        "SMALL_CYCLE_FORCE_OVER_LOAD",
        "FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT",
        "UNIFORM_DEVIATION",
        "MIN_REFERENCE_OVER_END_LOAD",
        "MAX_REFERENCE_OVER_END_LOAD",
        "DEFAULT_REFERENCE_OVER_END_LOAD",
    )
    numbers = {name: float(getattr(sliders, name)) for name in names}
    numbers["SLIDER_AT_LIMIT"] = jenkins.AT_LIMIT_TOLERANCE
    numbers["TIGHTENING_TEMPERATURE"] = law.TIGHTENING_TEMPERATURE
    counts |= {
        "N_BELOW": sliders.HEIGHTS_BELOW_REFERENCE,
        "N_ABOVE": sliders.SLIDER_HEIGHT_COUNT_ABOVE_REFERENCE,
    }
    counts |= {"UNKNOWN": friction.NO_HISTORY, "FULL_STICK": friction.FULL_STICK}
    counts |= {"SLIP_1D": friction.SLIP_1D, "SLIP_2D": friction.SLIP_2D}
    counts |= {
        "MODES": law.MAX_MODES,
        "ELASTIC": int(function_graph.joint.has_elastic_members),
        "MAX_NEWTON_ITERATIONS": equilibrium.MAX_NEWTON_ITERATIONS,
        "MAX_LINE_SEARCH": equilibrium.MAX_LINE_SEARCH,
    }
    counts["N_INTERFACE_OUTPUTS"] = len([o for o in model.outputs if not o.name.startswith("F_bolt")])
    numbers["MODE_DIGITS"], numbers["TRANSFER_SCALE"] = (
        10.0**bodies.MODAL_DISPLACEMENT_DECIMALS,
        10.0**contact.TRANSFER_DECIMALS,
    )
    numbers |= {
        name: getattr(equilibrium, name)
        for name in (
            "RELATIVE_TOLERANCE",
            "RIGID_OPENING_FORCE_FACTOR",
            "INTERMEDIATE_TOLERANCE_FACTOR",
            "MIN_LOAD_STEP",
            "MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE",
            "MIN_OVER_PREVIOUS_CORRECTION_LENGTH",
            "JACOBIAN_REUSE_RESIDUAL_DECREASE",
            "TRACTION_DIFFERENCE_STEP",
        )
    }
    numbers |= {
        "BOLT_LIFT_OFF_RATIO": bolts.LIFT_OFF_FORCE_OVER_CLOSING_LOAD,
        "BOLT_AT_LIFT_OFF": bolts.LIFT_OFF_OVER_FULL_STIFFNESS,
    }
    return CDefinitions(counts, numbers)


NATIVE_PART = NativeDefinition(
    _add_functions, (*APPROACH_FILES, *SLIDER_FILES), _make_c_constants, friction.history_layout(MAX_PATCHES)
)
"""Definition of the C code of the bolted joint."""
