"""Functions and constants of the harmonic drive for C code generation."""

import casadi as ca

from jointfmu.joints.harmonic_drive import friction, hysteresis, spring
from jointfmu.joints.harmonic_drive.drive import (
    FRICTION_HARMONICS,
    KINEMATIC_ERROR_HARMONICS,
    kinematic_error,
    kinematic_error_amplitudes,
)
from jointfmu.joints.harmonic_drive.law import ContactPairDriveParameters, stiffness_with_play
from jointfmu.joints.harmonic_drive.prescribed_midline import (
    CatalogueDriveParameters,
    MeasuredDriveParameters,
    SplineNode,
)
from jointfmu.joints.model import Model

from ...joint_parts.graph import CasadiExpressions, CFunctionSet, make_casadi_symbols
from ...joint_parts.native import (
    CURVE_FILE_STEMS,
    CConstants,
    ModuleConstants,
    NativeDefinition,
    define_c_array,
    define_c_constants,
    define_c_quadrature,
)
from ...joint_parts.sliders import SLIDER_FILE_STEMS, add_slider_functions


def _add_joint_c_functions(c_function_set: CFunctionSet, fmu_model: Model) -> None:
    """Add the functions that the C code of the harmonic drive calls."""
    drive = c_function_set.symbolic_parameter_set
    add_slider_functions(c_function_set)
    if isinstance(drive, CatalogueDriveParameters):
        doc = "-> nodes of the midline: wind-up, torque, stiffness, its derivative before and after the node"
        c_function_set.add_function(
            "midline_nodes",
            doc,
            [],
            [number for node in drive.make_midline_nodes() for number in node],
        )
    elif isinstance(drive, ContactPairDriveParameters):
        (torque,) = make_casadi_symbols("x", 1)
        doc = "torque -> K_WTS, its derivative by the torque"
        c_function_set.add_function("stiffness_with_play", doc, [torque], stiffness_with_play(drive, torque))
        constants = [drive.torque_smoothing, drive.max_torque, drive.K_FTS0]
        c_function_set.add_function("pair_constants", "-> T_s, largest torque, K_FTS0", [], constants)
    constants = [drive.hysteresis_loss, drive.hysteresis_stiffness, drive.rated_torque]
    c_function_set.add_function("hysteresis_constants", "-> loss, stiffness, rated torque", [], constants)
    springs, limits = hysteresis.slider_shares(hysteresis.stiffness_exponent(drive))
    c_function_set.add_function(
        "slider_shares", "-> shares of the sliders in K_h, in M_f", [], [*springs, *limits]
    )
    inputs = [ca.SX.sym(i.name) for i in fmu_model.inputs]
    locked = _is_torque_input(fmu_model)
    terms = [*kinematic_error(drive, inputs[0]), *friction.friction_ripple(drive, inputs[0])]
    doc = "inputs -> kinematic error, its derivatives in phi1; friction ripple, its derivative"
    c_function_set.add_function("periodic_terms", doc, inputs, [0.0] * len(terms) if locked else terms)
    amplitudes = [*kinematic_error_amplitudes(drive), *friction.ripple_amplitudes(drive)]
    c_function_set.add_function(
        "periodic_amplitudes",
        "-> amplitudes of kinematic error and friction ripple",
        [],
        [0.0 * a if locked else a for a in amplitudes],
    )
    state = spring.SpringState(*make_casadi_symbols("state", 6))
    loss, dry_friction_torque, ripple = make_casadi_symbols("x", 3)
    friction_arguments: CasadiExpressions
    if locked:
        curve_argument, stick_stiffness, friction_arguments = inputs[0], 0.0, [0.0] * 4
        out = {
            "phi_rel": state.phi_rel,
            **spring.stiffness_outputs(drive, state.midline_torque, state.midline_stiffness),
        }
    else:
        *motion, temperature = inputs
        curve_argument = spring.wind_up(drive, motion, state.phi_error)
        stick_stiffness = friction.sticking_stiffness(drive)
        tau = spring.transmitted_torque(drive, motion, state)
        torque_limits = friction.friction_limits(drive, motion[1], tau, temperature, ripple)
        friction_arguments = [*motion[:2], *torque_limits]
        out = spring.motion_outputs(drive, motion, temperature, state, dry_friction_torque)
    doc = "inputs, kinematic error -> argument of the curve"
    c_function_set.add_function_with_derivative(
        "curve_argument", doc, [*inputs, state.phi_error], [curve_argument]
    )
    c_function_set.add_function(
        "sticking_stiffness", "-> stiffness of the friction sliders while all stick", [], [stick_stiffness]
    )
    doc = "inputs, torques of midline and hysteresis, d(error)/d(phi1), ripple -> phi1, w1, friction limits"
    x = [*inputs, state.midline_torque, state.hysteresis_torque, state.phi_error_slope, ripple]
    c_function_set.add_function_with_derivative("friction_arguments", doc, x, friction_arguments)
    out["E_loss"] = loss
    y = [out[o.name] for o in fmu_model.outputs]
    doc = (
        "inputs, wind-up, torque and stiffness of the midline, hysteresis torque, loss, kinematic "
        "error and its derivative by phi1, dry friction -> outputs"
    )
    x = [
        *(
            *inputs,
            state.phi_rel,
            state.midline_torque,
            state.midline_stiffness,
            state.hysteresis_torque,
            loss,
        ),
        *(state.phi_error, state.phi_error_slope, dry_friction_torque),
    ]
    c_function_set.add_function_with_derivative("outputs", doc, x, y, leading_result_count=1 if locked else 2)


def _is_torque_input(fmu_model: Model) -> bool:
    """Whether the input of a harmonic drive's model is the torque, with the wave generator locked."""
    return fmu_model.inputs[0].name == "tau"


REAL_CONSTANT_NAMES: ModuleConstants = {
    spring: ("MIN_DRIVE_STIFFNESS", "MIN_FLEXSPLINE_OVER_CONTACT_STIFFNESS"),
    hysteresis: ("WIND_UP_TOLERANCE", "MIN_UNLOADING_OVER_REVERSAL_WIND_UP", "FRICTION_LIMIT_TOLERANCE"),
    friction: ("PRIOR_ROTATION_TIME",),
}
INTEGER_CONSTANT_NAMES: ModuleConstants = {
    hysteresis: ("MAX_FRICTION_LIMIT_ITERATIONS", "HYSTERESIS_SLIDER_COUNT"),
    friction: ("FRICTION_SLIDER_COUNT",),
}
"""Python constants of the drive with the same names in C: integers (REAL_CONSTANT_NAMES: real numbers)."""


def _make_c_constants(c_function_set: CFunctionSet, fmu_model: Model) -> CConstants:
    """Make the constants of the harmonic drive's C code from the constants of its Python modules."""
    counts = {
        "ARGUMENT_IS_LOAD": int(_is_torque_input(fmu_model)),
        "DRIVE_STEPS": spring.MIN_MIDLINE_TABLE_STEPS,
    }
    counts["N_HARMONICS"] = len(KINEMATIC_ERROR_HARMONICS) + len(FRICTION_HARMONICS)
    sliders = define_c_array("STIFFNESS_SHARES", "N_STIFFNESS_SHARES", friction.SLIDER_STIFFNESS_SHARES)
    sliders |= define_c_array("LIMIT_SHARES", "N_LIMIT_SHARES", friction.SLIDER_LIMIT_SHARES)
    constants = define_c_constants(REAL_CONSTANT_NAMES, INTEGER_CONSTANT_NAMES) | CConstants(counts) | sliders
    constants |= define_c_quadrature("DRIVE_GAUSS", spring.GAUSS_NODES_AND_WEIGHTS)
    if isinstance(c_function_set.symbolic_parameter_set, MeasuredDriveParameters):
        return constants | CConstants({}, {"MIDLINE_IS_DATA": 1})
    nodes = sum(
        len(f.result_expressions) for f in c_function_set.c_functions if f.function_name == "midline_nodes"
    ) // len(SplineNode._fields)
    return constants | CConstants({}, {"MIDLINE_NODES": nodes} if nodes else {})


NATIVE_DEFINITION = NativeDefinition(
    _add_joint_c_functions, (*CURVE_FILE_STEMS, *SLIDER_FILE_STEMS), _make_c_constants, spring.HISTORY_LAYOUT
)
"""Definition of the C code of the harmonic drive."""
