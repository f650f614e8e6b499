"""Bolted joint in the Modelica library: one record for each working point (preload, moment)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.reproducible import NOTHING
from jointfmu.mechanics.sliders import SPREAD, Foundation
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....modelica.records import (
    COMPUTED,
    InterpolationTable,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    computed,
    given,
    identifier,
    matrix,
    number,
    thinned,
)

DAMPING_TOLERANCE = 1e-3
"""Largest relative error [1] of the linearly interpolated dissipation factor."""
STRONGEST = 10.0
"""Total contact force at the end of the table over the one at tightening [1]."""
BELOW, EARLIEST = 12, 2e-3
"""Number of slider pairs in contact at tightening, and slip displacement of the first pair over that of gross
slip [1]. The slip displacements of the pairs form a geometric sequence."""
ABOVE = (2.0, 5.0)
"""Forces over the one at tightening [1] at which further slider pairs are in full contact, in compression."""
_FINE, _COARSE = 800, 200
"""Sample points on either side of the tightened state: for the force, before decimation, and for the
damping."""


class Tightened(NamedTuple):
    """Bolted joint at fixed preload and moment, with all nodes combined to one spring.

    table           : increase of the force [N] from the tightened state, over the approach from there [m]
    damping         : rows (n, 2) of approach [m] and dissipation factor eta_n [1]
    shear_ratio     : K_T/K_N [1]
    force           : normal force of the interface at tightening [N]
    pair_boundaries : rows (n, 3) of approach [m], normal force [N] and stiffness [N/m]; the friction springs
                       between two rows are combined to one pair of sliders
    sliders         : rows (2 n - 2, 2) of stiffness [N/m] and friction limit [N] at tightening: first the
                       slider of each pair that slips earlier, then the other slider of each pair
    bolts           : preload force (b) [N] at each bolt position, all bolts of a position together
    """

    table: InterpolationTable
    damping: Array
    shear: float
    force: float
    heights: Array
    sliders: Array
    bolts: Array


def tightened(spring: BoltedJointSpring, preload: float, moment: float) -> Tightened:
    """Combine all nodes of a joint to one spring, at a preload [N] per bolt and a moment [N.m].

    Side 2 is rigid and does not rotate. So all patches have the same tangential displacement and their curves
    add: friction follows, as for one patch, from the total force g(c) at the approach c = -s_z.
    """
    start = spring.within_law(preload, moment)
    low, high = spring.curve.displacement[[0, -1]]
    area, share = spring.joint.A_0, spring.shape.share

    def total(c: Array) -> list[Array]:
        approach = start + c[:, None]
        approach[approach - low < NOTHING * (high - low)] = low  # nodes that just touch have no load
        nodal = spring.curve.derivatives(approach, 2)
        return [area * (value @ share) for value in nodal]

    preload_force = total(np.zeros(1))[0][0]
    first, last = float(low - np.max(start)), float(high - np.max(start))
    compression = np.linspace(0.0, last, 200)
    end = float(np.interp(STRONGEST * preload_force, total(compression)[0], compression))
    c = np.unique(np.concatenate([np.linspace(first, 0.0, _FINE), np.linspace(0.0, end, _FINE)]))
    load, stiffness, d2_load = total(c)
    curve = Curve(c, load, stiffness, d2_load[:-1], d2_load[1:])
    zero = int(np.searchsorted(c, 0.0))
    coarse = np.concatenate([np.linspace(first, 0.0, _COARSE), np.linspace(0.0, end, _COARSE)[1:]])
    eta = np.interp(c, coarse, _dissipation(spring, start + coarse[:, None]))

    def linear(i: int, j: int) -> bool:
        line = np.interp(c[i : j + 1], c[[i, j]], eta[[i, j]])
        return bool(np.all(np.abs(line - eta[i : j + 1]) <= DAMPING_TOLERANCE * eta[i : j + 1]))

    table = thinned(curve, reference=zero, keep=(zero,), fits=linear)
    damping = np.column_stack([table.rows[:, 0], np.interp(table.rows[:, 0], c, eta)])
    table.rows[:, 1] -= load[zero]
    levels = [np.interp(factor * preload_force, load, c) for factor in ABOVE]
    heights = np.concatenate([[first], first * np.geomspace(1.0, EARLIEST, BELOW)[1:], [0.0], levels])
    force, normal, _ = total(heights)
    rows = np.column_stack([heights, force, normal])
    ratio = float(spring.joint.shear_ratio())
    carried = Foundation(curve, ratio, spring.joint.mu, heights).carried(0.0)
    sliders = np.column_stack([np.concatenate([x[::2], x[1::2]]) for x in (carried.stiffness, carried.limit)])
    bolts = spring.bolts.count * spring.bolts.tightened(spring.joint, preload, moment)
    return Tightened(table, damping, ratio, preload_force, rows, sliders, bolts)


def _dissipation(spring: BoltedJointSpring, approach: Array) -> Array:
    """Normal dissipation factor eta_n (m) [1], at nodal approaches (m, n) [m]."""
    plastic, elastic = spring.works(spring.curve.derivatives(approach, 0)[0])
    return np.asarray((plastic @ spring.shape.share) / (elastic @ spring.shape.share))


TIGHTENED = ((9e3, 0.0), (15e3, 0.0), (15e3, 4500.0))
"""Working points of the default records: preload [N] per bolt and moment [N.m], from Zhao 2018, Table 3."""


def _records(file: ParameterFile, points: Sequence[WorkingPoint]) -> list[ModelicaRecord]:
    spring = BoltedJointSpring.of_nodes(file.values)
    return [_record(file.name, spring, *point) for point in points]


def _record(name: str, spring: BoltedJointSpring, preload: float, moment: float) -> ModelicaRecord:
    tight = tightened(spring, preload, moment)
    rest = spring.motion(preload, moment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    values = given(
        {
            "preload": preload,
            "moment": moment,
            "mass": spring.joint.mass,
            "bolts": float(spring.joint.n_bolts * spring.joint.bolt_stiffness),
            "plastic_damping": spring.joint.plastic_damping,
            "memory": spring.joint.memory,
            "damping": spring.joint.damping,
            "mu": spring.joint.mu,
        }
    ) | computed({"tight": tight.force, "shear": tight.shear, "eta_t": float(rest["eta_t"])})
    force = f"{preload / 1e3:g} kN"
    return ModelicaRecord(
        name=identifier(f"{name} {force}" + (f" {moment:g} Nm" if moment else "")),
        title=f"{name}, {force} per bolt" + (f" and {moment:g} N m" if moment else ""),
        table=tight.table,
        values=values
        | {
            "heights": matrix(tight.heights),
            "sliders": matrix(tight.sliders),
            "eta_n": matrix(tight.damping),
            "bolt_forces": f"{{{', '.join(number(force, COMPUTED) for force in tight.bolts)}}}",
        },
        more="; where the force is below the one at tightening, relative to that",
    )


COMPONENT = ModelicaComponent(
    name="BoltedJoint",
    base="BoltedJoint",
    points=TIGHTENED,
    records=_records,
    flanges=("flange_x", "flange_y", "flange_z"),
    texts=lambda joint: {
        "damping_tolerance": f"{DAMPING_TOLERANCE:g}",
        "strongest": f"{STRONGEST:g}",
        "spread": f"{SPREAD:.15g}",
        "sliders": f"{2 * (BELOW + len(ABOVE))}",
    },
)
