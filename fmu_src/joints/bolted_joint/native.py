"""Functions and constants of the bolted joint for C code generation; its points are data of the FMU."""

import casadi as ca

from jointfmu.joints.bolted_joint import bodies, bolts, contact, equilibrium, friction, law, outputs
from jointfmu.joints.model import Model
from jointfmu.mechanics import sliders
from jointfmu.mechanics.footprint.distribution import MAX_PATCHES

from ...joint_parts.graph import (
    CFunctionSet,
    add_closing_pressure_function,
    add_law_functions,
    make_casadi_symbols,
)
from ...joint_parts.native import APPROACH_CURVE_FILE_STEMS, CConstants, NativeDefinition
from ...joint_parts.sliders import SLIDER_FILE_STEMS, add_slider_functions


def _add_joint_c_functions(c_function_set: CFunctionSet, fmu_model: Model) -> None:
    """Add the functions that the C code of the bolted joint calls."""
    joint = c_function_set.symbolic_parameter_set
    add_law_functions(
        c_function_set,
        joint,
        ("normal",),
        lambda s, u: [s.sum_over_spots("plastic_work", u), s.sum_over_spots("elastic_work", u)],
    )
    add_closing_pressure_function(c_function_set)
    constants = [
        joint.memory,
        joint.mu,
        joint.shear_stiffness_ratio(),
        joint.A_0,
        joint.bolt_stiffness,
        joint.damping,
    ]
    doc = "-> memory, mu, K_T/K_N, A_0, stiffness of a bolt, damping, number of bolts"
    c_function_set.add_function("joint_constants", doc, [], [*constants, joint.n_bolts])
    _add_preload_functions(c_function_set)
    _add_shear_functions(c_function_set)
    sums = dict(
        zip(
            outputs.CONTACT_SUM_NAMES, make_casadi_symbols("sum", len(outputs.CONTACT_SUM_NAMES)), strict=True
        )
    )
    displacement, rotation, rates = (
        make_casadi_symbols("s", 3),
        make_casadi_symbols("t", 3),
        make_casadi_symbols("v", 6),
    )
    p_max = ca.SX.sym("p_max")
    out = outputs.joint_outputs(joint, sums, displacement, rotation, rates, p_max)
    doc = f"sums ({', '.join(sums)}), s_rel, theta, v_rel, omega, largest pressure -> outputs"
    y = [out[o.name] for o in fmu_model.outputs if o.name in out]  # bolt forces follow from the modes
    x = [*sums.values(), *displacement, *rotation, *rates, p_max]
    c_function_set.add_function_with_derivative("outputs", doc, x, y)


def _add_preload_functions(c_function_set: CFunctionSet) -> None:
    """Add the C functions of the contact pressures of the points under preload and moment."""
    equal, tilt, mean, by_moment = make_casadi_symbols("node", 4)
    preload, moment, temperature = make_casadi_symbols("v", 3)
    doc = "preload at tightening, temperature -> preload at this temperature"
    warm = law.preload_at_temperature(c_function_set.symbolic_parameter_set, preload, temperature)
    c_function_set.add_function_with_derivative("preload_at_temperature", doc, [preload, temperature], [warm])
    doc = "preload, moment -> mean pressure, pressure that the moment adds"
    c_function_set.add_function_with_derivative(
        "bolt_pressures",
        doc,
        [preload, moment],
        law.bolt_pressures(c_function_set.symbolic_parameter_set, preload, moment),
    )
    doc = "preload -> preload after embedding"
    c_function_set.add_function_with_derivative(
        "working_preload",
        doc,
        [preload],
        [law.working_preload(c_function_set.symbolic_parameter_set, preload)],
    )
    doc = "equal, tilt, bolt_pressures -> pressure of a node at tightening"
    pressure = law.superposed_pressure(equal, tilt, mean, by_moment)
    c_function_set.add_function_with_derivative(
        "superposed_pressure", doc, [equal, tilt, mean, by_moment], [pressure], constant_argument_count=2
    )


def _add_shear_functions(c_function_set: CFunctionSet) -> None:
    """Add the C functions of shear of a contact patch: elastic without friction, sliders with friction."""
    x = make_casadi_symbols("x", 7)
    doc = (
        "friction limit, pressure and its derivatives, displacement -> traction, tangent xx, xy, yy, "
        "added pressure and stiffness"
    )
    y = contact.elastic_shear(
        x[0], c_function_set.symbolic_parameter_set.shear_stiffness_ratio(), x[1:5], x[5], x[6]
    )
    c_function_set.add_function_with_derivative("elastic_shear", doc, x, y)
    add_slider_functions(c_function_set)
    _add_cycle_functions(c_function_set)
    _add_full_stick_function(c_function_set)
    load, stiffness, bend, width, ratio, friction = make_casadi_symbols("x", 6)
    doc = "load, stiffness, its slope, excess of the approach -> stiffness, its slope, limits of both sliders"
    x = [ratio, friction, load, stiffness, bend, width]
    y = sliders.partial_contact(load, stiffness, bend, width, ratio, friction)
    c_function_set.add_function_with_derivative(
        "partial_contact", f"K_T/K_N, mu, {doc}", x, y, constant_argument_count=2
    )
    small, first, slope, last, then, change, rise = make_casadi_symbols("x", 7)
    doc = (
        "whether small, stiffness and its slope at both ends, change of the approach, integral of the "
        "stiffness -> fraction retained, secant stiffness"
    )
    kept = sliders.retention_and_stiffness((first, slope), (last, then), change, rise, small)
    x = [small, first, slope, last, then, change, rise]
    c_function_set.add_function_with_derivative(
        "retention_and_stiffness", doc, x, kept, constant_argument_count=1
    )
    across, slip = make_casadi_symbols("x", 2)
    force, moved, shift, ends, middle = (make_casadi_symbols(name, 2) for name in "qfukm")
    doc = (
        "whether the contact changes, force at both ends, displacement, stiffness at both ends, "
        "slip force, middle force -> loss"
    )
    loss = sliders.varying_stiffness_loss(force, moved, shift, (ends[0], ends[1]), slip, across, middle)
    x = [across, *force, *moved, *shift, *ends, slip, *middle]
    c_function_set.add_function_with_derivative(
        "varying_stiffness_loss", doc, x, [loss], constant_argument_count=3
    )


def _add_full_stick_function(c_function_set: CFunctionSet) -> None:
    """Generate the C function for a friction patch in full stick when its normal load changes.

    It gives the fraction of the friction force that remains (below 1 if the load decreases) and the secant
    stiffness during the change.
    """
    stiff, now, falls = make_casadi_symbols("x", 3)
    doc = "whether the load decreases, stiffness at both ends -> fraction retained, secant stiffness"
    y = sliders.stick_retention(stiff, now, falls)
    c_function_set.add_function_with_derivative(
        "stick_retention", doc, [falls, stiff, now], y, constant_argument_count=1
    )


def _add_cycle_functions(c_function_set: CFunctionSet) -> None:
    """Add the C functions of dissipated and elastic energy of a friction cycle at constant normal load."""
    x = make_casadi_symbols("x", 6)
    doc = "mu, K_T/K_N, amplitude, load, load at the slipped height, integral between -> loss, elastic energy"
    c_function_set.add_function_with_derivative(
        "cycle_energies", doc, x, sliders.cycle_energies(*x), constant_argument_count=2
    )
    (mu, ratio, size), now, then = (
        make_casadi_symbols("x", 3),
        make_casadi_symbols("n", 3),
        make_casadi_symbols("t", 3),
    )
    doc = "mu, K_T/K_N, amplitude, three derivatives of the load at both heights -> loss, elastic energy"
    y = sliders.small_cycle_energies(mu, ratio, size, now, then)
    c_function_set.add_function_with_derivative(
        "small_cycle_energies", doc, [mu, ratio, size, *now, *then], y, constant_argument_count=2
    )


def _make_c_constants(c_function_set: CFunctionSet, fmu_model: Model) -> CConstants:
    """Make the constants of the bolted joint's C code from the constants of its Python modules."""
    counts = {f"SUM_{name.upper()}": k for k, name in enumerate(outputs.CONTACT_SUM_NAMES)} | {
        "N_SUMS": len(outputs.CONTACT_SUM_NAMES)
    }
    columns = (
        "SHARE",
        "POSITION_X",
        "POSITION_Y",
        "PRELOAD_PRESSURE_RATIO",
        "MOMENT_PRESSURE_RATIO",
        "RADIUS",
    )
    counts |= {name: k for k, name in enumerate(columns)}
    names = (
        "SMALL_APPROACH_CHANGE_OVER_INTERVAL",
        "SMALL_CYCLE_FORCE_OVER_LOAD",
        "FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT",
        "UNIFORM_DISTRIBUTION_DEVIATION",
        "MIN_REFERENCE_LOAD_OVER_END_LOAD",
        "MAX_REFERENCE_LOAD_OVER_END_LOAD",
        "DEFAULT_REFERENCE_LOAD_OVER_END_LOAD",
    )
    numbers = {name: float(getattr(sliders, name)) for name in names}
    numbers["TIGHTENING_TEMPERATURE"] = law.TIGHTENING_TEMPERATURE
    heights = "HEIGHTS_BELOW_REFERENCE", "HEIGHTS_ABOVE_REFERENCE"
    counts |= {name: getattr(sliders, name) for name in heights}
    states = "BEFORE_FIRST_STEP", "FULL_STICK", "SLIP_1D", "SLIP_2D"
    counts |= {name: getattr(friction, name) for name in states}
    counts |= {
        "MODES": law.MAX_MODES,
        "ELASTIC": int(c_function_set.symbolic_parameter_set.has_elastic_members),
        "MAX_NEWTON_ITERATIONS": equilibrium.MAX_NEWTON_ITERATIONS,
        "MAX_LINE_SEARCH_TRIALS": equilibrium.MAX_LINE_SEARCH_TRIALS,
    }
    counts["N_INTERFACE_OUTPUTS"] = len([o for o in fmu_model.outputs if not o.name.startswith("F_bolt")])
    numbers["MODE_DIGITS"], numbers["TRANSFER_SCALE"] = (
        10.0**bodies.MODAL_DISPLACEMENT_DECIMALS,
        10.0**contact.FORCE_TRANSFER_DECIMALS,
    )
    numbers |= {
        name: getattr(equilibrium, name)
        for name in (
            "RELATIVE_RESIDUAL_TOLERANCE",
            "RIGID_OPENING_WEIGHT_IN_TOLERANCE",
            "INTERMEDIATE_TOLERANCE_FACTOR",
            "MIN_STEP_FRACTION_INCREMENT",
            "MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE",
            "MIN_SHORTENING_FACTOR",
            "MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE",
            "TRACTION_FINITE_DIFFERENCE_STEP",
        )
    }
    lift_off = "LIFT_OFF_FORCE_OVER_CLOSING_END_FORCE", "LIFT_OFF_OVER_FULL_STIFFNESS"
    numbers |= {name: getattr(bolts, name) for name in lift_off}
    return CConstants(counts, numbers)


NATIVE_DEFINITION = NativeDefinition(
    _add_joint_c_functions,
    (*APPROACH_CURVE_FILE_STEMS, *SLIDER_FILE_STEMS),
    _make_c_constants,
    friction.history_layout(MAX_PATCHES),
)
"""Definition of the C code of the bolted joint."""
