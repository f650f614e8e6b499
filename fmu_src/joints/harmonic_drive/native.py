"""The harmonic drive in C: its functions and the numbers of its tables."""

import casadi as ca
import numpy as np

from jointfmu import table
from jointfmu.footprint import lobes
from jointfmu.joints.harmonic_drive import law, spring
from jointfmu.joints.model import Model

from ...native.graph import Graph, law_functions, symbols
from ...native.part import TABLES, Definitions, Named, NativePart, column, named, quadrature


def _functions(g: Graph, model: Model) -> None:
    drive = g.joint
    law_functions(g, drive.law, ("normal", "tangential"))
    torque, peak, pressure, z, local, pair, slope = symbols("x", 7)
    g.add("peak", "torque -> peak pressure, its slope", [torque], law.peak_pressure(drive, torque))
    length = law.contact_length(drive)
    head = [length, drive.torque_smoothing, drive.max_torque, drive.pair_scale, drive.K_FTS0]
    g.add("drive_head", "-> contact length, T_s, largest torque, pair_scale, K_FTS0", [], head)
    height = law.height_at(drive, peak, pressure)
    g.add(
        "lobe_height",
        "peak, pressure -> height [m] where the axis has this pressure",
        [peak, pressure],
        [height],
    )
    g.add(
        "lobe_local",
        "peak, height -> pressure on the axis there",
        [peak, z],
        [law.local(drive, peak, z)],
    )
    end = law.angle_at(drive, local, pressure)
    g.add("lobe_end", "pressure on the axis, pressure -> t where it is met", [local, pressure], [end])
    sine, cosine = symbols("t", 2)
    point = law.lobe_point(drive, sine, cosine, z, local)
    y = [point.pressure, point.along**2, point.square - point.along**2, 2.0 / np.pi * point.stretch]
    doc = "sin t, cos t, height, pressure on the axis -> pressure, weights of k_n and k_t, d theta/d t"
    g.add("lobe", doc, [sine, cosine, z, local], y)
    doc = "K_TS on the paper's scale, its slope -> K_WTS, its slope"
    g.add("in_series", doc, [pair, slope], law.in_series(drive, pair, slope))
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    x, load, stiffness = symbols("curve", 3)
    if "tau" in v:
        argument, out = v["tau"], {"phi_rel": x, **spring.parts(drive, load, stiffness)}
    else:
        argument = spring.wind_up(drive, list(v.values()))
        out = spring.torques(drive, list(v.values()), load, stiffness)
    g.add_with_seed("argument", "inputs -> argument of the curve", [*v.values()], [argument])
    y = [out[o.name] for o in model.outputs]
    doc = "inputs, wind-up, torque and stiffness of the curve -> outputs"
    g.add_with_seed("outputs", doc, [*v.values(), x, load, stiffness], y)


NUMBERS: Named = ((table, "CELL"), (spring, "SOFTEST"), (spring, "STIFFEST"))
COUNTS: Named = ((table, "MOST_CELLS"), (spring, "PAIR_STEPS"), (spring, "MOST_PAIR_STEPS"))
"""Numbers of the package that the C has under the same name: real ones, and whole ones."""


def _definitions(g: Graph, model: Model) -> Definitions:
    counts = {"ARGUMENT_IS_LOAD": int(model.inputs[0].name == "tau"), "DRIVE_STEPS": spring.STEPS}
    return (
        named(NUMBERS, COUNTS)
        | Definitions(counts)
        | column("PLACES", "N_PLACES", lobes.PLACES)
        | column("WEIGHTS", "N_PLACES", lobes.WEIGHTS)
        | column("HEIGHTS", "N_HEIGHTS", lobes.HEIGHTS)
        | column("HEIGHT_WEIGHTS", "N_HEIGHTS", lobes.HEIGHT_WEIGHTS)
        | quadrature("DRIVE_GAUSS", spring.GAUSS)
    )


PART = NativePart(_functions, (*TABLES, "table"), _definitions)
