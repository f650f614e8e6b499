"""System file of the elastic axes of a robot at one pose: motor, drive and link inertia of each axis."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointfmu.files.text import format_toml_string
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from .elastic import ElasticAxis
from .names import make_identifier
from .plugin_robot import find_two_flange_fmu
from .poses import compute_link_inertia, compute_torques

WEIGHT_RAMP_DURATION = 0.5
"""Time [s] in which the weight is applied."""
STOP_TIME = 2.0
"""Stop time [s] of the experiment."""
STEPS_PER_PERIOD = 100
"""Communication steps of the system in the shortest period of vibration [1]."""


def format_axes_system(
    title: str,
    model: Any,
    axes: Sequence[ElasticAxis],
    drive_files: Mapping[str, ParameterFile],
    pose: Array,
    payload: float,
    tip_body: int,
) -> str:
    """Format the system file with the elastic axes of a robot.

    Each axis consists of a motor, the drive and a link inertia. The motor angle is an input of the system; by
    default it is constant. The drive has the parameter file NAME.toml in the same folder. The link inertia is
    that about the axis at the pose, with the payload and the other axes locked. The torque of the weight acts
    on it and is applied smoothly. The axes are not coupled.

    drive_files : {joint: parameter file of its drive}
    payload     : mass [kg] at the body `tip_body`
    """
    load, _ = compute_torques(model, axes, pose, payload, tip_body)
    link_inertias = np.diag(compute_link_inertia(model, axes, pose, payload, tip_body))
    stiffness = np.array([axis.stiffness(t) for axis, t in zip(axes, load.tolist(), strict=True)])
    step = 2.0 * np.pi / STEPS_PER_PERIOD * float(np.sqrt(link_inertias / stiffness).min())
    wires, sections = [], []
    for axis, torque, J in zip(axes, load.tolist(), link_inertias.tolist(), strict=True):
        name, file = make_identifier(axis.joint), drive_files[axis.joint]
        wires += [
            f'    ["{name}_motor", "{name}_drive.flange1"],',
            f'    ["{name}_drive.flange2", "{name}_link.flange_b"],',
            f'    ["{name}_weight", "{name}_link.flange_a"],',
        ]
        sections += [
            f'[{name}_motor]\nmodel = "AngleProfile"',
            _format_entry("height", 0.0, "rad", "the motor holds; its input phi_in turns it"),
            f'\n[{name}_drive]\nmodel = "{find_two_flange_fmu(file)}"',
            f'parameters = "{make_identifier(file.name)}.toml"',
            f'\n[{name}_link]\nmodel = "RotationalInertia"',
            _format_entry("J", J, "kg.m2", "what the axis turns at the pose, the others held"),
            f'\n[{name}_weight]\nmodel = "TorqueProfile"',
            _format_entry("ramp_height", torque, "N.m", "of the weight at the pose"),
            _format_entry("ramp_duration", WEIGHT_RAMP_DURATION, "s", "slow beside the axes' periods"),
            "",
        ]
    pose_text = ", ".join(
        f"{axis.joint} = {pose[model.joint(axis.joint).qposadr[0]]:.4g} rad" for axis in axes
    )
    head = [
        "schema = 1",
        f"name = {format_toml_string(f'Axes of {title}')}",
        f"description = {format_toml_string(f'Elastic axes with {payload:g} kg at {pose_text}')}",
        "connect = [",
        *wires,
        "]\n",
    ]
    tail = [
        "[experiment]",
        _format_entry("stop_time", STOP_TIME, "s", "the weight and the ringing after it"),
        _format_entry(
            "interval",
            float(f"{step:.2g}"),
            "s",
            f"{STEPS_PER_PERIOD} in the shortest period, of the archives",
        ),
    ]
    return "\n".join([*head, *sections, *tail, ""])


def _format_entry(name: str, value: float, unit: str, source: str) -> str:
    """TOML line of a derived value with unit and source."""
    text = format_toml_string(source)
    return f'{name} = {{ value = {value!r}, unit = "{unit}", kind = "derived", source = {text} }}'
