"""Repeats `spring.torque_curve` for many samples at once: K_WTS and wind-up along a torque ramp."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from jointfmu.joints.harmonic_drive import KIND
from jointfmu.joints.harmonic_drive.drive import Drive, lost_motion_angle
from jointfmu.joints.harmonic_drive.law import ContactPairDrive, drive_stiffness
from jointfmu.joints.harmonic_drive.prescribed_midline import CatalogueDrive, TableDrive
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring, torque_curve
from jointfmu.quantity import Array

from ...studies.batch import approach
from ...studies.batch.approach import columns
from ...studies.uncertainty.problem import ReducedCurves

RAMP = 33
"""Torques [1] between which K_WTS is a polynomial in asinh(T/T_s)."""
CORRECTIONS = 20
"""Newton steps [1] within a corner of a catalogue's lines: the stiffness changes by a few tenths there."""


def evaluate(
    parameters: type[Any], values: Mapping[str, Any], loads: Array, factor: Array
) -> dict[str, Array]:
    """K_WTS [N.m/rad] and phi_rel [rad] (n, m) at the torques factor (n, 1) times loads (m) [N.m].

    values : by structured name, numbers or samples (n)
    """
    drive = columns(parameters, values, 1)
    if isinstance(drive, ContactPairDrive):
        return _pair(drive, loads, factor)
    torque = factor * loads
    K, phi = _lines(drive, torque) if isinstance(drive, CatalogueDrive) else _table(drive, torque)
    angle, compliance, _ = lost_motion_angle(drive, torque)
    found = {"K_WTS": K / (1.0 + K * compliance), "phi_rel": phi + angle}
    return {name: np.broadcast_to(value, torque.shape) for name, value in found.items()}


def _pair(drive: ContactPairDrive, loads: Array, factor: Array) -> dict[str, Array]:
    """Of drives with a contact pair."""
    smoothing = float(np.median(drive.torque_smoothing))
    xi = np.arcsinh(loads / smoothing)
    span = xi[-1] * approach.nodes(RAMP)
    rate = smoothing * xi[-1] * np.cosh(span)
    K = drive_stiffness(drive, factor * smoothing * np.sinh(span))[0]
    K = np.broadcast_to(K, (factor.size, RAMP))
    angle, compliance, _ = lost_motion_angle(drive, factor * loads)
    tangent = K @ approach.interpolation(RAMP, xi / xi[-1])
    wound_up = factor * ((rate / K) @ approach.integration(RAMP, xi / xi[-1]))
    return {"K_WTS": tangent / (1.0 + tangent * compliance), "phi_rel": wound_up + angle}


def _table(drive: TableDrive, torque: Array) -> tuple[Array, Array]:
    """K_WTS and wind-up of a measured midline, which no sample changes."""
    curve = torque_curve(drive)
    phi = curve.inverse(torque)
    return curve.derivatives(phi, 1)[1], phi


def _lines(drive: CatalogueDrive, torque: Array) -> tuple[Array, Array]:
    """K_WTS and wind-up of a catalogue's three lines: along a line, or by Newton's method within a corner."""
    first, second = drive.corner_angles
    K = np.where(torque < drive.T1, drive.K1, np.where(torque < drive.T2, drive.K2, drive.K3))
    phi = np.minimum(torque, drive.T1) / drive.K1 + np.maximum(torque - drive.T2, 0.0) / drive.K3
    phi = phi + np.clip(torque - drive.T1, 0.0, drive.T2 - drive.T1) / drive.K2
    for at, T, low, high in ((first, drive.T1, drive.K1, drive.K2), (second, drive.T2, drive.K2, drive.K3)):
        half = drive.corner * at
        beyond = (torque - T + low * half) / (2.0 * half)  # torque within the corner over its width
        t = np.clip(beyond / low, 0.0, 1.0)
        for _ in range(CORRECTIONS):
            slope = low + (high - low) * t**2 * (3.0 - 2.0 * t)
            t = np.clip(t + (beyond - low * t - (high - low) * t**3 * (1.0 - 0.5 * t)) / slope, 0.0, 1.0)
        inside = (beyond > 0.0) & (beyond < 0.5 * (low + high))
        K = np.where(inside, low + (high - low) * t**2 * (3.0 - 2.0 * t), K)
        phi = np.where(inside, at + half * (2.0 * t - 1.0), phi)
    return K, phi


def exact(joint: Drive, loads: Array) -> dict[str, Array]:
    """K_WTS and phi_rel (m) of the exported spring's midline at torques (m) [N.m]."""
    state = HarmonicDriveSpring.tabulate(replace(joint, hysteresis_loss=0.0)).evaluate_torque(loads)
    return {name: state[name] for name in REDUCED.units}


REDUCED = ReducedCurves(
    load=KIND.variables["tau"],
    outputs=tuple(KIND.variables[name] for name in ("K_WTS", "phi_rel")),
    default_end=lambda drive: float(drive.rated_torque),
    max_load=lambda drive: drive.max_table_torque,
    evaluate=evaluate,
    exact=exact,
)
