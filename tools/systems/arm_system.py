"""The components of a serial arm with a drive in every axis, out of the section `[arm]` of a system's file.

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
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jointfmu_fmu_src.partners.laws import TorqueCurve

from jointfmu.joints import MODELS
from jointfmu.parameters import default, entries
from jointfmu.quantity import build, flat_fields, problem, quantity

from .arm import AXES, Arm, Link
from .system_joint import joint_file

_MOTION = {
    "start": quantity("s", "begin of the motion", ge=0.0),
    "duration": quantity("s", "from its begin to its end", gt=0.0),
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
    times, _, _ = entries(path, _MOTION, own)
    for name, item in _MOTION.items():
        if text := problem(name, times.get(name), item):
            raise ValueError(f"arm.{text}")
    fields, links, drives = dict(flat_fields(Link)), [], {}
    for name, given in axes.items():
        if not isinstance(given, Mapping) or given.get("axis") not in AXES:
            axis = given.get("axis") if isinstance(given, Mapping) else given
            raise ValueError(f"arm.{name}.axis = {axis!r}, allowed are {', '.join(AXES)}")
        try:
            values, _, _ = entries(path, fields, {k: v for k, v in given.items() if k in fields})
            links.append(build(Link, values))
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
    file = joint_file(path.parent, f"arm.{name}", joint, drive) or default(joint)
    return float(file.flat["ratio"])


def _axis(arm: Arm, name: str, drive: Mapping[str, object], ratio: float) -> Sections:
    """The sections of one axis."""
    k = arm.names.index(name)
    link = arm.links[k]
    end = np.array([[one.travel for one in arm.links]])
    inertia = float(arm.inertias(end[0])[k])
    phase = np.linspace(0.0, 1.0, 201)
    q, speed, acceleration = arm.motion(arm.start + arm.duration * phase)
    left = inertia * acceleration[:, k] - arm.torques(q, speed, acceleration)[:, k]
    points = TorqueCurve.fitted(phase, left)
    times = {"start": (arm.start, "s"), "duration": (arm.duration, "s")}
    return {
        f"{name}_motor": _section("AngleProfile", times | {"height": (ratio * link.travel, "rad")}),
        f"{name}_drive": dict(drive),
        f"{name}_link": _section(
            "RotationalInertia", {"J": (inertia, "kg.m2"), "m": (0.0, "kg"), "l": (0.0, "m")}
        ),
        f"{name}_load": _section(
            "TorqueCurve", times | {key: (_clean(value), "N.m") for key, value in points.items()}
        ),
    }


def _clean(torque: float) -> float:
    """To 1e-8 N.m: later digits depend on the processor."""
    return round(torque, 8) + 0.0


def _section(model: str, values: Mapping[str, tuple[float, str]]) -> dict[str, object]:
    text = "kinematics and inverse dynamics of [arm]"
    return {"model": model} | {
        name: {"value": value, "unit": unit, "kind": "derived", "source": text}
        for name, (value, unit) in values.items()
    }
