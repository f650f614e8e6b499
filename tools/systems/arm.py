"""Serial arm with a drive in every axis, defined by the section `[arm]` of a system file.

    [arm]
    start, duration = ...
    [arm.shoulder]
    axis = "y"
    length, mass, centre, J_along, J_across, travel = ...
    model = "HarmonicDriveSpring"
    catalogue = "CSG-40-100"
    ...

Every number is { value, unit, kind, source }; the drive is defined as in any section of a component.

Each axis consists of a motor that follows its motion exactly, the drive, and a link. The one FMU of the
system has the coupled links, see `fmu.arm_links`. In archives of separate FMUs and in Modelica, each link is
an inertia. The inertia is that about the axis at the end of the motion with the other axes locked. A torque
acts on it: the inertia torque of the motion minus the torque by inverse dynamics of the rigid arm. So the
drive carries the torque of the rigid arm and the oscillation of the link inertia. The coupling of the axes by
their wind-up is neglected, see UNCOUPLED_AXES_NOTE.

At zero angles the arm is upright: every link is along z. Each link rotates about z or y relative to the link
before it. Inverse dynamics by the Newton-Euler recursion (Luh, Walker and Paul, J. Dyn. Sys. Meas. Control
102, 1980) in the ground frame.
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
    flatten_fields,
    quantity_field,
    smooth_step,
    smooth_step_slopes,
)

from .system_joint import load_joint_file

UNCOUPLED_AXES_NOTE = (
    "The axes are not coupled: tip errors are right within 1 %, but the oscillation of the shipped arm after "
    "its motion is too small by factors up to 60 (wrist). The one FMU of the system has the coupled dynamics."
)
"""Size of the error of separate inertias, for files that have them."""
AXIS_VECTORS: Mapping[str, Array] = {"y": np.array([0.0, 1.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}
"""{name of a rotation axis: unit vector (3) in the frame of the link}."""


@dataclass(frozen=True, kw_only=True)
class Link(CheckedParameters):
    """Link of a serial arm, from its axis to the next axis or to the tip."""

    length: float = quantity_field("m", "distance from this axis to the next axis, or to the tip", ge=0.0)
    mass: float = quantity_field("kg", "mass of the link with the next drive", gt=0.0)
    centre: float = quantity_field("m", "distance from the axis to the centre of mass", ge=0.0)
    J_along: float = quantity_field("kg.m2", "moment of inertia about the link's own line", gt=0.0)
    J_across: float = quantity_field(
        "kg.m2", "moment of inertia across the link's line, about the centre of mass", gt=0.0
    )
    travel: float = quantity_field("rad", "angle of the motion")


@dataclass(frozen=True)
class Arm:
    """Serial arm and its motion: all axes rotate from zero to their travel, by a quintic from rest to rest.

    axis_names      : names of the axes, starting at the ground
    rotation_axes   : direction of each axis, a key of AXIS_VECTORS
    links           : link behind each axis
    motion_start    : start time of the motion [s]
    motion_duration : duration of the motion [s]
    """

    axis_names: Sequence[str]
    rotation_axes: Sequence[str]
    links: Sequence[Link]
    motion_start: float
    motion_duration: float

    def compute_motion(self, sample_times: ArrayLike) -> tuple[Array, Array, Array]:
        """Angles [rad], speeds [rad/s], accelerations [rad/s2] of all axes, shape (times, axes)."""
        x = (np.asarray(sample_times, dtype=np.float64)[:, None] - self.motion_start) / self.motion_duration
        travel = np.array([link.travel for link in self.links])
        first, second = smooth_step_slopes(x)
        return (
            travel * smooth_step(x),
            travel * first / self.motion_duration,
            travel * second / self.motion_duration**2,
        )

    def compute_frames(self, axis_angles: Array) -> tuple[list[Array], list[Array], Array]:
        """Kinematics at angles (n, axes) [rad].

        Returns the rotation matrix (n, 3, 3) of each link, the position (n, 3) [m] of each axis, and the
        position (n, 3) [m] of the tip.
        """
        rotation, position = (
            np.broadcast_to(np.eye(3), (len(axis_angles), 3, 3)),
            np.zeros((len(axis_angles), 3)),
        )
        rotations, positions = [], []
        for k, (axis, link) in enumerate(zip(self.rotation_axes, self.links, strict=True)):
            rotation = rotation @ _rotation_matrices(axis, axis_angles[:, k])
            rotations.append(rotation)
            positions.append(position)
            position = position + link.length * rotation[:, :, 2]
        return rotations, positions, position

    def compute_tip_position(self, axis_angles: Array) -> Array:
        """Position (n, 3) [m] of the tip at angles (n, axes) [rad]."""
        return self.compute_frames(axis_angles)[2]

    def inverse_dynamics(
        self, axis_angles: Array, axis_speeds: Array, axis_accelerations: Array, gravity: float = GRAVITY
    ) -> Array:
        """Inverse dynamics: torques (n, axes) [N.m] of the rigid arm for a motion, with inertia and weight.

        axis_angles        : (n, axes) [rad]
        axis_speeds        : (n, axes) [rad/s]
        axis_accelerations : (n, axes) [rad/s2]
        gravity            : acceleration of free fall [m/s2]
        """
        rotations, positions, tip = self.compute_frames(axis_angles)
        n = len(axis_angles)
        w, alpha = np.zeros((n, 3)), np.zeros((n, 3))
        a = np.broadcast_to(np.array([0.0, 0.0, gravity]), (n, 3))
        forces, moments, centres = [], [], []
        for k, (axis, link) in enumerate(zip(self.rotation_axes, self.links, strict=True)):
            if k:
                lever = positions[k] - positions[k - 1]
                a = a + np.cross(alpha, lever) + np.cross(w, np.cross(w, lever))
            axis_vector = rotations[k] @ AXIS_VECTORS[axis]
            relative_speed = axis_vector * axis_speeds[:, k, None]
            alpha = alpha + axis_vector * axis_accelerations[:, k, None] + np.cross(w, relative_speed)
            w = w + relative_speed
            centre = link.centre * rotations[k][:, :, 2]
            forces.append(link.mass * (a + np.cross(alpha, centre) + np.cross(w, np.cross(w, centre))))
            inertia = np.diag([link.J_across, link.J_across, link.J_along])
            inertia = rotations[k] @ inertia @ rotations[k].transpose(0, 2, 1)
            moments.append(_multiply_vectors(inertia, alpha) + np.cross(w, _multiply_vectors(inertia, w)))
            centres.append(centre)
        torques = np.empty((n, len(self.links)))
        force, moment, next_position = np.zeros((n, 3)), np.zeros((n, 3)), tip
        for k in reversed(range(len(self.links))):
            lever = next_position - positions[k]
            moment = moments[k] + np.cross(centres[k], forces[k]) + moment + np.cross(lever, force)
            force, next_position = force + forces[k], positions[k]
            torques[:, k] = np.sum(moment * (rotations[k] @ AXIS_VECTORS[self.rotation_axes[k]]), axis=1)
        return torques

    def compute_axis_inertias(self, axis_angles: Array) -> Array:
        """Inertia (axes) [kg.m2] of the arm about each axis at angles q (axes) [rad], other axes locked."""
        count = len(self.links)
        angles = np.broadcast_to(axis_angles, (count, count))
        return np.asarray(
            np.diag(self.inverse_dynamics(angles, np.zeros((count, count)), np.eye(count), 0.0))
        )


def _rotation_matrices(axis_name: str, rotation_angles: Array) -> Array:
    """Rotation matrices (n, 3, 3) about an axis of AXIS_VECTORS by angles (n) [rad]."""
    c, s, zero, one = (
        np.cos(rotation_angles),
        np.sin(rotation_angles),
        np.zeros_like(rotation_angles),
        np.ones_like(rotation_angles),
    )
    rows = {
        "y": [[c, zero, s], [zero, one, zero], [-s, zero, c]],
        "z": [[c, -s, zero], [s, c, zero], [zero, zero, one]],
    }[axis_name]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _multiply_vectors(matrices: Array, vectors: Array) -> Array:
    """Products (n, 3) of rotation matrices (n, 3, 3) and vectors (n, 3)."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


_MOTION_ENTRIES = {
    "start": quantity_field("s", "start time of the motion", ge=0.0),
    "duration": quantity_field("s", "duration of the motion", gt=0.0),
}
"""Entries of the section [arm] for the motion, as dataclass fields."""
ComponentSections = dict[str, dict[str, object]]
"""{component: its section, as in a system file}."""


def read_arm(system_path: Path, arm_section: object) -> tuple[Arm, ComponentSections, list[tuple[str, str]]]:
    """Read the section [arm] of a system file: the arm, and sections and connections of its components.

    The components of an axis NAME are `NAME_motor`, `NAME_drive`, `NAME_link` and `NAME_load`.

    Raises ValueError with one line that names the entry and what is allowed.
    """
    if not isinstance(arm_section, Mapping):
        raise ValueError(f"arm = {arm_section!r}, expected a section [arm]")
    motion = {key: value for key, value in arm_section.items() if key in _MOTION_ENTRIES}
    axes = {key: value for key, value in arm_section.items() if key not in _MOTION_ENTRIES}
    times, _, _ = read_entries(system_path, _MOTION_ENTRIES, motion)
    for name, item in _MOTION_ENTRIES.items():
        if text := find_problem(name, times.get(name), item):
            raise ValueError(f"arm.{text}")
    fields, links, drives = dict(flatten_fields(Link)), [], {}
    for name, axis_section in axes.items():
        if not isinstance(axis_section, Mapping) or axis_section.get("axis") not in AXIS_VECTORS:
            axis_name = axis_section.get("axis") if isinstance(axis_section, Mapping) else axis_section
            raise ValueError(f"arm.{name}.axis = {axis_name!r}, allowed are {', '.join(AXIS_VECTORS)}")
        try:
            values, _, _ = read_entries(
                system_path, fields, {k: v for k, v in axis_section.items() if k in fields}
            )
            links.append(build_parameter_set(Link, values))
        except ValueError as error:
            raise ValueError(f"arm.{name}: {str(error).removeprefix(f'{system_path}: ')}") from None
        drives[name] = {
            key: value for key, value in axis_section.items() if key not in fields and key != "axis"
        }
    if not axes:
        raise ValueError("arm has no axis, expected a section [arm.NAME] for each")
    arm = Arm(
        list(axes),
        [axis_section["axis"] for axis_section in axes.values()],
        links,
        times["start"],
        times["duration"],
    )
    sections: ComponentSections = {}
    wires: list[tuple[str, str]] = []
    for name, drive in drives.items():
        ratio = _find_gear_ratio(system_path, name, drive)
        sections |= _make_axis_sections(arm, name, drive, ratio)
        wires += [
            (f"{name}_motor", f"{name}_drive.flange1"),
            (f"{name}_drive.flange2", f"{name}_link.flange_b"),
            (f"{name}_load", f"{name}_link.flange_a"),
        ]
    return arm, sections, wires


def _find_gear_ratio(system_path: Path, axis_name: str, drive_section: Mapping[str, object]) -> float:
    """Gear ratio of the drive of an axis: stated in its section, or by its parameter file."""
    model = drive_section.get("model")
    if model not in MODELS or "ratio" not in MODELS[model].parameter_fields():
        models = [n for n, m in MODELS.items() if "ratio" in m.parameter_fields() and len(m.inputs) >= 4]
        raise ValueError(f"arm.{axis_name}.model = {model!r}, allowed are {', '.join(models)}")
    entry = drive_section.get("ratio")
    if isinstance(entry, Mapping) and isinstance(entry.get("value"), int | float):
        return float(entry["value"])
    joint = MODELS[model].joint
    file = load_joint_file(system_path.parent, f"arm.{axis_name}", joint, drive_section) or load_default(
        joint
    )
    return float(file.values_by_name["ratio"])


def _make_axis_sections(
    arm: Arm, axis_name: str, drive_section: Mapping[str, object], gear_ratio: float
) -> ComponentSections:
    """Make the sections of a system file for the components of one axis of the arm."""
    k = arm.axis_names.index(axis_name)
    link = arm.links[k]
    end = np.array([[link.travel for link in arm.links]])
    inertia = float(arm.compute_axis_inertias(end[0])[k])
    phase = np.linspace(0.0, 1.0, 201)
    q, speed, acceleration = arm.compute_motion(arm.motion_start + arm.motion_duration * phase)
    load = inertia * acceleration[:, k] - arm.inverse_dynamics(q, speed, acceleration)[:, k]
    points = TorqueCurve.fit_control_points(phase, load)  # digits beyond 1e-8 N.m depend on the processor
    times = {"start": (arm.motion_start, "s"), "duration": (arm.motion_duration, "s")}
    return {
        f"{axis_name}_motor": _make_component_section(
            "AngleProfile", times | {"height": (gear_ratio * link.travel, "rad")}
        ),
        f"{axis_name}_drive": dict(drive_section),
        f"{axis_name}_link": _make_component_section(
            "RotationalInertia", {"J": (inertia, "kg.m2"), "m": (0.0, "kg"), "l": (0.0, "m")}
        ),
        f"{axis_name}_load": _make_component_section(
            "TorqueCurve", times | {key: (round(value, 8) + 0.0, "N.m") for key, value in points.items()}
        ),
    }


def _make_component_section(
    model_name: str, derived_values: Mapping[str, tuple[float, str]]
) -> dict[str, object]:
    """Make the section of a system file for a component with derived values.

    derived_values : {name: (value, unit)}
    """
    source = "kinematics and inverse dynamics of [arm]"
    return {"model": model_name} | {
        name: {"value": value, "unit": unit, "kind": "derived", "source": source}
        for name, (value, unit) in derived_values.items()
    }
