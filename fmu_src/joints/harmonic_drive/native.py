"""The harmonic drive in C: its functions and the numbers of its table."""

import casadi as ca

from jointfmu.joints.harmonic_drive import hysteresis, law, spring
from jointfmu.joints.harmonic_drive.given import Given, Node
from jointfmu.joints.model import Model

from ...native.graph import Graph, symbols
from ...native.part import CURVE, Definitions, Named, NativePart, named, quadrature


def _functions(g: Graph, model: Model) -> None:
    drive = g.joint
    if isinstance(drive, Given):
        doc = "-> nodes of the midline: wind-up, torque, stiffness, its derivative before and after"
        g.add("given_nodes", doc, [], [number for node in drive.nodes() for number in node])
    else:
        (torque,) = symbols("x", 1)
        doc = "torque -> K_WTS, its slope"
        g.add("stiffness", doc, [torque], law.drive_stiffness(drive, torque))
        head = [drive.torque_smoothing, drive.max_torque, drive.K_FTS0]
        g.add("pair_head", "-> T_s, largest torque, K_FTS0", [], head)
    head = [drive.hysteresis_loss, drive.hysteresis_stiffness, drive.rated_torque]
    g.add("hysteresis_head", "-> loss, stiffness, rated torque", [], head)
    springs, friction = hysteresis.shares(hysteresis.exponent(drive))
    g.add("slider_shares", "-> springs over K_h, friction over M_f", [], [*springs, *friction])
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    x, load, stiffness, slid, loss = symbols("found", 5)
    if "tau" in v:
        argument, out = v["tau"], {"phi_rel": x, **spring.parts(drive, load, stiffness)}
    else:
        argument = spring.wind_up(drive, list(v.values()))
        out = spring.torques(drive, list(v.values()), load, stiffness, slid)
    g.add_with_seed("argument", "inputs -> argument of the curve", [*v.values()], [argument])
    out["E_loss"] = loss
    y = [out[o.name] for o in model.outputs]
    doc = "inputs, wind-up, torque and stiffness of the curve, torque and loss of the friction -> outputs"
    g.add_with_seed("outputs", doc, [*v.values(), x, load, stiffness, slid, loss], y)


NUMBERS: Named = (
    (spring, "SOFTEST"),
    (spring, "STIFFEST"),
    (hysteresis, "NEAREST"),
    (hysteresis, "REVERSAL"),
    (hysteresis, "SETTLED"),
)
COUNTS: Named = ((hysteresis, "MOST_CORRECTIONS"), (hysteresis, "SLIDERS"))
"""Numbers of the package that the C has under the same name."""


def _definitions(g: Graph, model: Model) -> Definitions:
    counts = {"ARGUMENT_IS_LOAD": int(model.inputs[0].name == "tau"), "DRIVE_STEPS": spring.STEPS}
    every = named(NUMBERS, COUNTS) | Definitions(counts) | quadrature("DRIVE_GAUSS", spring.GAUSS)
    nodes = sum(len(f.y) for f in g.functions if f.name == "given_nodes") // len(Node._fields)
    return every | Definitions({}, {"GIVEN_NODES": nodes} if nodes else {})


PART = NativePart(_functions, CURVE, _definitions)
