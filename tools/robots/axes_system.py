"""The elastic axes of a robot at a pose as a system's file: motor, drive and link each."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointfmu.files.text import toml_string
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from .elastic import ElasticAxis
from .names import identifier
from .plugged import spring_of
from .poses import inertia, torques

SETTLING, STOP = 0.5, 2.0
"""Time [s] over which the weight comes, and of the experiment."""
PER_PERIOD = 100
"""Steps of the archives in the shortest period [1]."""


def text(
    title: str,
    model: Any,
    axes: Sequence[ElasticAxis],
    files: Mapping[str, ParameterFile],
    pose: Array,
    payload: float,
    tip: int,
) -> str:
    """The file.

    Each axis is a motor whose angle is the system's input (it holds without), the drive with the parameter
    file NAME.toml beside this one, and an inertia: what the axis turns at the pose with the payload, the
    others held. On it acts the weight, which comes smoothly. Axes do not move each other.
    """
    load, _ = torques(model, axes, pose, payload, tip)
    turned = np.diag(inertia(model, axes, pose, payload, tip))
    stiff = np.array([axis.stiffness(t) for axis, t in zip(axes, load.tolist(), strict=True)])
    step = 2.0 * np.pi / PER_PERIOD * float(np.sqrt(turned / stiff).min())
    wires, parts = [], []
    for axis, torque, J in zip(axes, load.tolist(), turned.tolist(), strict=True):
        name, file = identifier(axis.joint), files[axis.joint]
        wires += [
            f'    ["{name}_motor", "{name}_drive.flange1"],',
            f'    ["{name}_drive.flange2", "{name}_link.flange_b"],',
            f'    ["{name}_weight", "{name}_link.flange_a"],',
        ]
        parts += [
            f'[{name}_motor]\nmodel = "AngleProfile"',
            _entry("height", 0.0, "rad", "the motor holds; its input phi_in turns it"),
            f'\n[{name}_drive]\nmodel = "{spring_of(file)}"\nparameters = "{identifier(file.name)}.toml"',
            f'\n[{name}_link]\nmodel = "RotationalInertia"',
            _entry("J", J, "kg.m2", "what the axis turns at the pose, the others held"),
            f'\n[{name}_weight]\nmodel = "TorqueProfile"',
            _entry("ramp_height", torque, "N.m", "of the weight at the pose"),
            _entry("ramp_duration", SETTLING, "s", "slow beside the axes' periods"),
            "",
        ]
    at = ", ".join(f"{axis.joint} = {pose[model.joint(axis.joint).qposadr[0]]:.4g} rad" for axis in axes)
    head = [
        "schema = 1",
        f"name = {toml_string(f'Axes of {title}')}",
        f"description = {toml_string(f'Elastic axes with {payload:g} kg at {at}')}",
        "connect = [",
        *wires,
        "]\n",
    ]
    tail = [
        "[experiment]",
        _entry("stop_time", STOP, "s", "the weight and the ringing after it"),
        _entry(
            "interval", float(f"{step:.2g}"), "s", f"{PER_PERIOD} in the shortest period, of the archives"
        ),
    ]
    return "\n".join([*head, *parts, *tail, ""])


def _entry(name: str, value: float, unit: str, source: str) -> str:
    return (
        f'{name} = {{ value = {value!r}, unit = "{unit}", kind = "derived", source = {toml_string(source)} }}'
    )
