"""Functions and constants of the harmonic drive for C code generation."""

import casadi as ca

from jointfmu.joints.harmonic_drive import friction, hysteresis, spring
from jointfmu.joints.harmonic_drive.drive import HARMONICS, error_amplitudes, kinematic_error
from jointfmu.joints.harmonic_drive.given import CatalogueDrive, MeasuredDrive, SplineNode
from jointfmu.joints.harmonic_drive.law import ContactPairDrive, stiffness_with_play
from jointfmu.joints.model import Model

from ...joint_parts.graph import Graph, Symbols, symbols
from ...joint_parts.native import CURVE, Definitions, Named, NativePart, column, named, quadrature
from ...joint_parts.sliders import SLIDERS, add_sliders


def _functions(g: Graph, model: Model) -> None:
    """Add the functions that the C code of the harmonic drive calls."""
    drive = g.joint
    add_sliders(g)
    if isinstance(drive, CatalogueDrive):
        doc = "-> nodes of the midline: wind-up, torque, stiffness, its derivative before and after the node"
        g.add("midline_nodes", doc, [], [number for node in drive.make_nodes() for number in node])
    elif isinstance(drive, ContactPairDrive):
        (torque,) = symbols("x", 1)
        doc = "torque -> K_WTS, its derivative by the torque"
        g.add("stiffness_with_play", doc, [torque], stiffness_with_play(drive, torque))
        head = [drive.torque_smoothing, drive.max_torque, drive.K_FTS0]
        g.add("pair_constants", "-> T_s, largest torque, K_FTS0", [], head)
    head = [drive.hysteresis_loss, drive.hysteresis_stiffness, drive.rated_torque]
    g.add("hysteresis_constants", "-> loss, stiffness, rated torque", [], head)
    springs, limits = hysteresis.slider_shares(hysteresis.stiffness_exponent(drive))
    g.add("slider_shares", "-> shares of the sliders in K_h, in M_f", [], [*springs, *limits])
    inputs = [ca.SX.sym(i.name) for i in model.inputs]
    locked = _given_torque(model)
    waves = [0.0] * 3 if locked else kinematic_error(drive, inputs[0])
    g.add("kinematic_error", "inputs -> kinematic error, its derivatives in phi1", inputs, waves)
    errors = [0.0 * a if locked else a for a in error_amplitudes(drive)]
    g.add("error_amplitudes", "-> amplitudes of the kinematic error", [], errors)
    x, load, stiffness, slid, loss, error, slope, dry = symbols("found", 8)
    turn: Symbols
    if locked:
        argument, brake, turn = inputs[0], 0.0, [0.0, 0.0, 0.0, 0.0]
        out = {"phi_rel": x, **spring.stiffness_outputs(drive, load, stiffness)}
    else:
        state = spring.SpringState(x, load, stiffness, slid, error, slope)
        *motion, temperature = inputs
        argument, brake = spring.wind_up(drive, motion, error), friction.sticking_stiffness(drive)
        tau = spring.transmitted_torque(drive, motion, state)
        turn = [*motion[:2], *friction.friction_limits(drive, motion[1], tau, temperature)]
        out = spring.motion_outputs(drive, motion, temperature, state, dry)
    doc = "inputs, kinematic error -> argument of the curve"
    g.add_with_seed("curve_argument", doc, [*inputs, error], [argument])
    g.add("sticking_stiffness", "-> stiffness of the friction sliders while all stick", [], [brake])
    doc = "inputs, torques of midline and hysteresis, d(error)/d(phi1) -> phi1, w1, friction limits"
    g.add_with_seed("friction_arguments", doc, [*inputs, load, slid, slope], turn)
    out["E_loss"] = loss
    y = [out[o.name] for o in model.outputs]
    doc = (
        "inputs, wind-up, torque and stiffness of the midline, hysteresis torque, loss, kinematic "
        "error and its derivative by phi1, dry friction -> outputs"
    )
    g.add_with_seed("outputs", doc, [*inputs, x, load, stiffness, slid, loss, error, slope, dry], y)


def _given_torque(model: Model) -> bool:
    """Whether the torque is the input and the wave generator is locked."""
    return model.inputs[0].name == "tau"


NUMBERS: Named = {
    spring: ("MIN_STIFFNESS", "MIN_STIFFNESS_MARGIN"),
    hysteresis: ("WIND_UP_TOLERANCE", "MIN_REVERSAL_RATIO", "LIMIT_TOLERANCE"),
    friction: ("PRIOR_ROTATION_TIME",),
}
COUNTS: Named = {hysteresis: ("MAX_LIMIT_ITERATIONS", "HYSTERESIS_SLIDERS"), friction: ("FRICTION_SLIDERS",)}
"""Python constants of the drive that have the same names in C: integers (NUMBER_NAMES: real numbers)."""


def _definitions(g: Graph, model: Model) -> Definitions:
    """Constants for the C code of the harmonic drive."""
    counts = {"ARGUMENT_IS_LOAD": int(_given_torque(model)), "DRIVE_STEPS": spring.MIN_TABLE_STEPS}
    counts["N_HARMONICS"] = len(HARMONICS)
    sliders = column("STIFFNESS_SHARES", "N_STIFFNESS_SHARES", friction.STIFFNESS_SHARES)
    sliders |= column("LIMIT_SHARES", "N_LIMIT_SHARES", friction.LIMIT_SHARES)
    constants = named(NUMBERS, COUNTS) | Definitions(counts) | sliders
    constants |= quadrature("DRIVE_GAUSS", spring.GAUSS_RULE)
    if isinstance(g.joint, MeasuredDrive):
        return constants | Definitions({}, {"MIDLINE_IS_DATA": 1})
    nodes = sum(len(f.y) for f in g.functions if f.name == "midline_nodes") // len(SplineNode._fields)
    return constants | Definitions({}, {"MIDLINE_NODES": nodes} if nodes else {})


PART = NativePart(_functions, (*CURVE, *SLIDERS), _definitions, spring.HISTORY_LAYOUT)
