"""What the page of a user's bolted joint shows of the whole: interface, members and bolts side by side."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jointfmu_fmu_src.joint_parts.chart import Panel, Series
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint.contact import Place
from jointfmu.joints.bolted_joint.law import pressures, working_preload
from jointfmu.joints.bolted_joint.outputs import bolt_force
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ...report.beside import Beside
from ...report.course import Course
from ...report.figure import Figure
from ...shown import quantity
from .new.whole import named, opening_load

Array = NDArray[np.float64]

DIRECTIONS = {"x": "N/m", "y": "N/m", "z": "N/m", "rx": "N.m/rad", "ry": "N.m/rad", "rz": "N.m/rad"}
"""{force along or moment about an axis: unit of its stiffness}."""
MATTERS = 0.1
"""Part of the whole's compliance [1] from which on the interface is worth a law of its own."""
BEYOND = 4.0
"""Way that is drawn over that at which all is open [1]."""


class Compliances(NamedTuple):
    """Of the tightened joint, under a unit force along x, y, z and a unit moment about them.

    parts      : (3, 6) [m/N, rad/(N.m)] twice the energy that interface, members and bolts store
    rigid      : (6) of the interface alone between rigid sides, without bolts
    bolt_force : (bolts, 6) [N per N, N per N.m] what each bolt gets of it
    """

    parts: Array
    rigid: Array
    bolt_force: Array

    @property
    def whole(self) -> Array:
        """(6) of the joint."""
        return np.asarray(self.parts.sum(axis=0))


def compliances(spring: BoltedJointSpring, preload: float, moment: float = 0.0) -> Compliances:
    """Of a joint with elastic sides, tightened by the force of each bolt [N] and a moment [N.m]."""
    whole, modes, bolt = spring.whole, spring.modes, spring.joint.bolt_stiffness
    there = spring.curve.inverse(pressures(spring.joint, spring.patches, preload, moment))
    stick = spring.foundation().stick(there)[:, None] * np.array([1.0, 0.0, 1.0])
    normal = spring.curve.derivatives(spring.tightened(preload, moment), 1)[1]
    H = whole.slope(normal, stick)
    motion = np.linalg.inv(whole.condensed(H))
    amplitude = -np.linalg.solve(H[6:, 6:], H[6:, :6] @ motion)
    force = bolt * (whole.seats @ motion[2:5] + modes.stretch @ amplitude)
    members = modes.stiffness @ amplitude**2
    bolts = np.sum(force**2, axis=0) / bolt if bolt > 0.0 else np.zeros(6)
    interface = np.diag(motion) - members - bolts
    alone = H[:6, :6].copy()
    alone[2:5, 2:5] -= bolt * whole.seats.T @ whole.seats
    return Compliances(np.stack([interface, members, bolts]), np.diag(np.linalg.inv(alone)), force)


def whole_joint(course: Course) -> list[Figure]:
    """The whole joint beside its interface and its bolts, and the force of each bolt over a force along z."""
    joint, spring = course.file.values, course.spring
    if not joint.elastic:
        return []
    assert isinstance(spring, BoltedJointSpring)
    preload, moment = (float(course.about.get(name, 0.0)) for name in ("preload", "moment"))
    found = compliances(spring, preload, moment)
    left = float(working_preload(joint, preload))
    opening = opening_load(left, found.bolt_force[:, 2])
    limit = joint.mu * joint.n_bolts * left
    panel = _bolt_forces(spring, preload, moment, opening * found.whole[2])
    text = _text(found, left, moment) + (
        f" It takes {_told(opening, 'N')} along z to open the interface everywhere, by these stiffnesses, "
        f"and {_told(limit, 'N')} along x or y to slip wholly; slip begins at the edges far below, and what "
        "it loses is under Loops."
    )
    return [Figure("The whole joint", text, [panel], table=_rows(found, spring))]


def _told(value: float, unit: str) -> str:
    return " ".join(quantity(value, unit, 4))


def _rows(found: Compliances, spring: BoltedJointSpring) -> list[tuple[str, ...]]:
    """Stiffnesses, and parts of the compliance, by direction."""
    seats = spring.whole.seats
    bolts = [0.0, 0.0, *np.diag(seats.T @ seats) * spring.joint.bolt_stiffness, 0.0]
    heads = ("whole joint", "interface alone", "bolts alone", "interface", "members", "bolts")
    rows: list[tuple[str, ...]] = [("", *heads)]
    for i, (name, unit) in enumerate(DIRECTIONS.items()):
        stiffness = (1.0 / found.whole[i], 1.0 / found.rigid[i], bolts[i])
        told = [_told(value, unit) if value > 0.0 else "none" for value in stiffness]
        parts = (f"{part / found.whole[i]:.1%}" for part in found.parts[:, i])
        rows.append((f"K_{named(name)}", *told, *parts))
    return rows


def _text(found: Compliances, tension: float, moment: float) -> str:
    share = found.parts[0] / found.whole
    most = float(np.max(share))
    matters = "it has a say in the stiffness" if most >= MATTERS else "the stiffness hardly knows of it"
    return (
        f"Small motions of the attachments about the tightened state, {_told(tension, 'N')} in each bolt"
        + (f" with a moment of {moment:g} N m" if moment else "")
        + ". The last three columns are parts of the compliance, by the energy stored. The interface has "
        f"{share[2]:.1%} of it along z and at most {most:.1%} in any direction: {matters}. Of a force along "
        f"z the bolts take {found.bolt_force[:, 2].sum():.3f} (load factor n Phi_K of VDI 2230); when the "
        "interface opens they take all, as drawn."
    )


def _bolt_forces(spring: BoltedJointSpring, preload: float, moment: float, opens: float) -> Panel:
    """Force of each bolt over the force along z that pulls, to beyond the way [m] at which all is open."""
    memory, pulls, forces = spring.at_rest(), [], []
    names = [bolt_force(j) for j in range(len(spring.modes.bolts))]
    for s in opens * np.linspace(0.0, BEYOND, 25):
        place = Place.of(np.array([0.0, 0.0, s, 0.0, 0.0, 0.0]))
        out, memory = spring.evolve(preload, moment, place, (0.0,) * 6, memory)
        pulls.append(-1e-3 * float(out["f_z"]))
        forces.append([1e-3 * float(out[name]) for name in names])
    series = [Series(name, pulls, column) for name, column in zip(names, np.transpose(forces), strict=True)]
    return Panel("Bolts under a force along z", "force that pulls [kN]", "force of a bolt [kN]", series)


FIGURES = {"BoltedJoint": whole_joint}
BESIDE: dict[str, Callable[[Model, ParameterFile], list[Beside]]] = {}
"""No catalogue prints what a bolted joint does."""
