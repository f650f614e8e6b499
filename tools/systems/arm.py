"""A serial arm with a drive in every axis, out of the section `[arm]` of a system's file.

    [arm]
    start, duration = ...
    [arm.shoulder]
    axis = "y"
    length, mass, centre, J_along, J_across, travel = ...
    model = "HarmonicDriveSpring"
    catalogue = "CSG-40-100"
    ...

with every number as { value, unit, kind, source }, and the drive as in any section of a component.

Each axis is a motor that follows its motion exactly, the drive, and an inertia: what the axis turns at the
end of the motion, the others held. On the inertia acts what the inverse dynamics of the rigid arm leaves
over, so that the drive carries the rigid arm's torque and the oscillation of its own inertia. That one axis'
wind-up moves the others is left out: it is small against the motion.

The arm itself: at zero angles it stands upright, every link lies along z, and turns about z or y against the
one before. Newton-Euler recursion (Luh, Walker and Paul, J. Dyn. Sys. Meas. Control 102, 1980) in the
ground's frame.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jointfmu_fmu_src.partners.laws import GRAVITY, TorqueCurve
from numpy.typing import ArrayLike

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default, read_entries
from jointfmu.quantity import (
    Array,
    CheckedParameters,
    build_parameter_set,
    find_problem,
    flat_fields,
    quantity_field,
    smooth_step,
    smooth_step_slopes,
)

from .system_joint import joint_file

AXES: Mapping[str, Array] = {"y": np.array([0.0, 1.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}


@dataclass(frozen=True, kw_only=True)
class Link(CheckedParameters):
    """One link behind its axis."""

    length: float = quantity_field("m", "from this axis to the next one, or to the tip", ge=0.0)
    mass: float = quantity_field("kg", "mass of the link with the next drive", gt=0.0)
    centre: float = quantity_field("m", "from the axis to the centre of mass", ge=0.0)
    J_along: float = quantity_field("kg.m2", "moment of inertia about the link's own line", gt=0.0)
    J_across: float = quantity_field("kg.m2", "the same across it, about the centre of mass", gt=0.0)
    travel: float = quantity_field("rad", "angle of the motion")


@dataclass(frozen=True)
class Arm:
    """An arm and one motion of it: all axes from upright to their travel, along a quintic from rest to rest.

    names, axes, links : of the axes, from the ground on; axes are keys of AXES
    start, duration    : of the motion [s]
    """

    names: Sequence[str]
    axes: Sequence[str]
    links: Sequence[Link]
    start: float
    duration: float

    def motion(self, time: ArrayLike) -> tuple[Array, Array, Array]:
        """Angles [rad], speeds [rad/s], accelerations [rad/s2] of all axes, (times, axes)."""
        x = (np.asarray(time, dtype=np.float64)[:, None] - self.start) / self.duration
        travel = np.array([link.travel for link in self.links])
        rate, bend = smooth_step_slopes(x)
        return (travel * smooth_step(x), travel * rate / self.duration, travel * bend / self.duration**2)

    def frames(self, q: Array) -> tuple[list[Array], list[Array], Array]:
        """Turns of the links (n, 3, 3), places of axes and tip (n, 3) [m] at angles (n, axes) [rad]."""
        turn, place = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        turns, places = [], []
        for k, (axis, link) in enumerate(zip(self.axes, self.links, strict=True)):
            turn = turn @ _rotation(axis, q[:, k])
            turns.append(turn)
            places.append(place)
            place = place + link.length * turn[:, :, 2]
        return turns, places, place

    def tip(self, q: Array) -> Array:
        """Place of the tip (n, 3) [m] at angles (n, axes) [rad]."""
        return self.frames(q)[2]

    def torques(self, q: Array, speed: Array, acceleration: Array, gravity: float = GRAVITY) -> Array:
        """Torques (n, axes) [N.m] that move the links so against their inertia and weight."""
        turns, places, tip = self.frames(q)
        n = len(q)
        w, alpha = np.zeros((n, 3)), np.zeros((n, 3))
        a = np.broadcast_to(np.array([0.0, 0.0, gravity]), (n, 3))
        forces, moments, centres = [], [], []
        for k, (axis, link) in enumerate(zip(self.axes, self.links, strict=True)):
            if k:
                arm = places[k] - places[k - 1]
                a = a + np.cross(alpha, arm) + np.cross(w, np.cross(w, arm))
            along = turns[k] @ AXES[axis]
            turning = along * speed[:, k, None]
            alpha = alpha + along * acceleration[:, k, None] + np.cross(w, turning)
            w = w + turning
            centre = link.centre * turns[k][:, :, 2]
            forces.append(link.mass * (a + np.cross(alpha, centre) + np.cross(w, np.cross(w, centre))))
            inertia = np.diag([link.J_across, link.J_across, link.J_along])
            inertia = turns[k] @ inertia @ turns[k].transpose(0, 2, 1)
            moments.append(_of(inertia, alpha) + np.cross(w, _of(inertia, w)))
            centres.append(centre)
        found = np.empty((n, len(self.links)))
        force, moment, after = np.zeros((n, 3)), np.zeros((n, 3)), tip
        for k in reversed(range(len(self.links))):
            arm = after - places[k]
            moment = moments[k] + np.cross(centres[k], forces[k]) + moment + np.cross(arm, force)
            force, after = force + forces[k], places[k]
            found[:, k] = np.sum(moment * (turns[k] @ AXES[self.axes[k]]), axis=1)
        return found

    def inertias(self, q: Array) -> Array:
        """Inertia (axes) [kg.m2] that each axis turns at angles (axes), the others held."""
        count = len(self.links)
        held = np.broadcast_to(q, (count, count))
        return np.asarray(np.diag(self.torques(held, np.zeros((count, count)), np.eye(count), 0.0)))


def _rotation(axis: str, angle: Array) -> Array:
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = {
        "y": [[c, zero, s], [zero, one, zero], [-s, zero, c]],
        "z": [[c, -s, zero], [s, c, zero], [zero, zero, one]],
    }[axis]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _of(matrices: Array, vectors: Array) -> Array:
    """A matrix times a vector, for each of many."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


_MOTION = {
    "start": quantity_field("s", "begin of the motion", ge=0.0),
    "duration": quantity_field("s", "from its begin to its end", gt=0.0),
}
Sections = dict[str, dict[str, object]]


def arm_parts(path: Path, section: object) -> tuple[Arm, Sections, list[tuple[str, str]]]:
    """The arm, and the sections and connections of its components: `NAME_motor`, `NAME_drive`,
    `NAME_link`, `NAME_load` of the axis NAME.

    Raises ValueError with one line that names the entry and what is allowed.
    """
    if not isinstance(section, Mapping):
        raise ValueError(f"arm = {section!r}, expected a section [arm]")
    own = {key: value for key, value in section.items() if key in _MOTION}
    axes = {key: value for key, value in section.items() if key not in _MOTION}
    times, _, _ = read_entries(path, _MOTION, own)
    for name, item in _MOTION.items():
        if text := find_problem(name, times.get(name), item):
            raise ValueError(f"arm.{text}")
    fields, links, drives = dict(flat_fields(Link)), [], {}
    for name, given in axes.items():
        if not isinstance(given, Mapping) or given.get("axis") not in AXES:
            axis = given.get("axis") if isinstance(given, Mapping) else given
            raise ValueError(f"arm.{name}.axis = {axis!r}, allowed are {', '.join(AXES)}")
        try:
            values, _, _ = read_entries(path, fields, {k: v for k, v in given.items() if k in fields})
            links.append(build_parameter_set(Link, values))
        except ValueError as error:
            raise ValueError(f"arm.{name}: {str(error).removeprefix(f'{path}: ')}") from None
        drives[name] = {key: value for key, value in given.items() if key not in fields and key != "axis"}
    if not axes:
        raise ValueError("arm has no axis, expected a section [arm.NAME] for each")
    arm = Arm(
        list(axes), [given["axis"] for given in axes.values()], links, times["start"], times["duration"]
    )
    sections: Sections = {}
    wires: list[tuple[str, str]] = []
    for name, drive in drives.items():
        ratio = _ratio(path, name, drive)
        sections |= _axis(arm, name, drive, ratio)
        wires += [
            (f"{name}_motor", f"{name}_drive.flange1"),
            (f"{name}_drive.flange2", f"{name}_link.flange_b"),
            (f"{name}_load", f"{name}_link.flange_a"),
        ]
    return arm, sections, wires


def _ratio(path: Path, name: str, drive: Mapping[str, object]) -> float:
    """Of the drive of an axis: its own, or that of its parameters."""
    model = drive.get("model")
    if model not in MODELS or "ratio" not in MODELS[model].parameter_fields():
        able = [n for n, m in MODELS.items() if "ratio" in m.parameter_fields() and len(m.inputs) >= 4]
        raise ValueError(f"arm.{name}.model = {model!r}, allowed are {', '.join(able)}")
    entry = drive.get("ratio")
    if isinstance(entry, Mapping) and isinstance(entry.get("value"), int | float):
        return float(entry["value"])
    joint = MODELS[model].joint
    file = joint_file(path.parent, f"arm.{name}", joint, drive) or load_default(joint)
    return float(file.values_by_name["ratio"])


def _axis(arm: Arm, name: str, drive: Mapping[str, object], ratio: float) -> Sections:
    """The sections of one axis."""
    k = arm.names.index(name)
    link = arm.links[k]
    end = np.array([[one.travel for one in arm.links]])
    inertia = float(arm.inertias(end[0])[k])
    phase = np.linspace(0.0, 1.0, 201)
    q, speed, acceleration = arm.motion(arm.start + arm.duration * phase)
    left = inertia * acceleration[:, k] - arm.torques(q, speed, acceleration)[:, k]
    points = TorqueCurve.fitted(phase, left)  # digits beyond 1e-8 N.m depend on the processor
    times = {"start": (arm.start, "s"), "duration": (arm.duration, "s")}
    return {
        f"{name}_motor": _section("AngleProfile", times | {"height": (ratio * link.travel, "rad")}),
        f"{name}_drive": dict(drive),
        f"{name}_link": _section(
            "RotationalInertia", {"J": (inertia, "kg.m2"), "m": (0.0, "kg"), "l": (0.0, "m")}
        ),
        f"{name}_load": _section(
            "TorqueCurve", times | {key: (round(value, 8) + 0.0, "N.m") for key, value in points.items()}
        ),
    }


def _section(model: str, values: Mapping[str, tuple[float, str]]) -> dict[str, object]:
    text = "kinematics and inverse dynamics of [arm]"
    return {"model": model} | {
        name: {"value": value, "unit": unit, "kind": "derived", "source": text}
        for name, (value, unit) in values.items()
    }
