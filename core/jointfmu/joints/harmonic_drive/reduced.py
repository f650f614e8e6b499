"""Repeats `spring.torque_curve` for many samples at once: K_WTS and wind-up along a torque ramp."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...batch import chebyshev
from ...batch.samples import columns
from ..reduced import Reduced
from . import KIND
from .law import Drive, drive_stiffness
from .lost_motion import play
from .spring import HarmonicDriveSpring

Array = NDArray[np.float64]

RAMP = 33
"""Torques [1] between which K_WTS is a polynomial in asinh(T/T_s)."""


def evaluate(
    parameters: type[Any], values: Mapping[str, Any], loads: Array, factor: Array
) -> dict[str, Array]:
    """K_WTS [N.m/rad] and phi_rel [rad] (n, m) at the torques factor (n, 1) times loads (m) [N.m].

    values : by structured name, numbers or samples (n)
    """
    drive = columns(parameters, values, 1)
    smoothing = float(np.median(drive.torque_smoothing))
    xi = np.arcsinh(loads / smoothing)
    span = xi[-1] * chebyshev.nodes(RAMP)
    rate = smoothing * xi[-1] * np.cosh(span)
    K = drive_stiffness(drive, factor * smoothing * np.sinh(span))[0]
    K = np.broadcast_to(K, (factor.size, RAMP))
    angle, compliance, _ = play(drive, factor * loads)
    tangent = K @ chebyshev.interpolation(RAMP, xi / xi[-1])
    wound_up = factor * ((rate / K) @ chebyshev.integration(RAMP, xi / xi[-1]))
    return {"K_WTS": tangent / (1.0 + tangent * compliance), "phi_rel": wound_up + angle}


def exact(joint: Drive, loads: Array) -> dict[str, Array]:
    """K_WTS and phi_rel (m) of the exported spring's midline at torques (m) [N.m]."""
    state = HarmonicDriveSpring.of(replace(joint, hysteresis_loss=0.0)).windup(loads)
    return {name: state[name] for name in REDUCED.units}


REDUCED = Reduced(
    load=KIND.variables["tau"],
    outputs=tuple(KIND.variables[name] for name in ("K_WTS", "phi_rel")),
    to=lambda drive: float(drive.rated_torque),
    most=lambda drive: drive.max_torque,
    evaluate=evaluate,
    exact=exact,
)
