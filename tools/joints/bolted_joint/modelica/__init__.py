"""The joint in the Modelica library: tightened to a preload under a moment, one record for each."""

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
"""Largest relative error of a dissipation factor [1], which is interpolated linearly."""
STRONGEST = 10.0
"""End of the table: the total force over the one at tightening [1]."""
BELOW, EARLIEST = 12, 2e-3
"""Pairs of sliders that touch at tightening, and the shift at which the first of them slip over that of gross
slip [1]; the shifts at which the others do are in geometric sequence."""
ABOVE = (2.0, 5.0)
"""Forces over that at tightening [1] at which further pairs are complete, when side 2 is pressed on."""
_FINE, _COARSE = 800, 200
"""Nodes of the total on either side of the tightened state: of its force, before thinning, and of its
damping."""


class Tightened(NamedTuple):
    """A joint at a fixed preload and moment: all its nodes as one spring.

    table   : force above the tightening force [N] over the approach from the tightened state [m]
    damping : rows (n, 2) of approach [m] and dissipation factor eta_n [1]
    shear   : K_T/K_N [1]
    force   : of the interface at tightening [N]
    heights : rows (n, 3) of approach [m], normal force [N] and stiffness [N/m], between which the springs of
              friction are taken together
    sliders : rows (2 n - 2, 2) of stiffness [N/m] and friction [N] at tightening, of those that slip earlier
              first
    bolts   : force of each bolt at tightening (b) [N], all bolts of a position together
    """

    table: InterpolationTable
    damping: Array
    shear: float
    force: float
    heights: Array
    sliders: Array
    bolts: Array


def tightened(spring: BoltedJointSpring, preload: float, moment: float) -> Tightened:
    """Sum up a joint at a preload [N] per bolt and a moment [N.m].

    With one curve g(c) of the total force over the approach c = -s_z, friction follows as for one patch: the
    patches of a rigid side that does not turn share the shift, and their curves add.
    """
    start = spring.within_law(preload, moment)
    low, high = spring.curve.displacement[[0, -1]]
    area, share = spring.joint.A_0, spring.shape.share

    def total(c: Array) -> list[Array]:
        approach = start + c[:, None]
        approach[approach - low < NOTHING * (high - low)] = low  # where nodes just touch their load is zero
        each = spring.curve.derivatives(approach, 2)
        return [area * (value @ share) for value in each]

    at_rest = total(np.zeros(1))[0][0]
    first, last = float(low - np.max(start)), float(high - np.max(start))
    reach = np.linspace(0.0, last, 200)
    end = float(np.interp(STRONGEST * at_rest, total(reach)[0], reach))
    c = np.unique(np.concatenate([np.linspace(first, 0.0, _FINE), np.linspace(0.0, end, _FINE)]))
    load, stiffness, bend = total(c)
    whole = Curve(c, load, stiffness, bend[:-1], bend[1:])
    zero = int(np.searchsorted(c, 0.0))
    some = np.concatenate([np.linspace(first, 0.0, _COARSE), np.linspace(0.0, end, _COARSE)[1:]])
    eta = np.interp(c, some, _dissipation(spring, start + some[:, None]))

    def linear(i: int, j: int) -> bool:
        line = np.interp(c[i : j + 1], c[[i, j]], eta[[i, j]])
        return bool(np.all(np.abs(line - eta[i : j + 1]) <= DAMPING_TOLERANCE * eta[i : j + 1]))

    table = thinned(whole, reference=zero, keep=(zero,), fits=linear)
    damping = np.column_stack([table.rows[:, 0], np.interp(table.rows[:, 0], c, eta)])
    table.rows[:, 1] -= load[zero]
    levels = [np.interp(factor * at_rest, load, c) for factor in ABOVE]
    heights = np.concatenate([[first], first * np.geomspace(1.0, EARLIEST, BELOW)[1:], [0.0], levels])
    force, normal, _ = total(heights)
    rows = np.column_stack([heights, force, normal])
    ratio = float(spring.joint.shear_ratio())
    carried = Foundation(whole, ratio, spring.joint.mu, heights).carried(0.0)
    sliders = np.column_stack([np.concatenate([x[::2], x[1::2]]) for x in (carried.stiffness, carried.limit)])
    bolts = spring.bolts.count * spring.bolts.tightened(spring.joint, preload, moment)
    return Tightened(table, damping, ratio, at_rest, rows, sliders, bolts)


def _dissipation(spring: BoltedJointSpring, approach: Array) -> Array:
    """eta_n (m) [1] with the nodes at approaches (m, n) [m]."""
    plastic, elastic = spring.works(spring.curve.derivatives(approach, 0)[0])
    return np.asarray((plastic @ spring.shape.share) / (elastic @ spring.shape.share))


TIGHTENED = ((9e3, 0.0), (15e3, 0.0), (15e3, 4500.0))
"""Preload [N] per bolt and moment [N.m]: Zhao 2018, Table 3."""


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
