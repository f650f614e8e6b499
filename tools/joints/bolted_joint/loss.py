"""Loss factor of the interface under a shear force, between rigid sides: exactly, and for many samples."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jointfmu.joints.bolted_joint.law import (
    Bolted,
    interface_alone,
    node_pressure,
    slip_force,
    working_preload,
)
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

SHEAR = 0.05
"""Shear over the force of all bolts [1] at which `uncertainty` tells the loss factor: half of what the least
usual mu carries."""
MOST = 0.8
"""Most shear over that at which all slips [1]: of less friction the loss factor is told there."""
STEPS = 6
"""Of the integration up to the shear [1]."""
TOLD_AT = 0.1
"""Shear over mu times the normal force [1] at which the band of the friction is told."""


class Band(NamedTuple):
    """mu [1], the shear [N] at which all slips, and the loss factor [1] at a shear that is stated."""

    mu: float
    slip_force: float
    loss_factor: float


def friction_band(file: ParameterFile, preload: float) -> tuple[float, list[Band]]:
    """Shear [N] of the loss factors; what the file's mu makes of a preload [N], and both ends of its range.

    The loss factor is that of a loop of the interface between rigid sides, under the same shear force.
    """
    joint = interface_alone(file.values)
    left = float(working_preload(joint, preload))
    shear = TOLD_AT * float(slip_force(joint, left))
    rows = []
    for mu in (joint.mu, *file.ranges.get("mu", ())):
        other = replace(joint, mu=mu)
        lost = loss_factor(BoltedJointSpring.of(other), left, shear)
        rows.append(Band(mu, float(slip_force(other, left)), lost))
    return shear, rows


def loss_factor(spring: BoltedJointSpring, left: float, shear: float) -> float:
    """Loss over 2 pi times the stored energy of a loop with an amplitude of the shear force [N].

    left : [N] force of each bolt, without a moment
    """
    joint, shape = spring.joint, spring.patches
    law = spring.foundation()
    approach = spring.curve.inverse(node_pressure(joint, shape.equal, shape.tilt, left, 0.0))
    low, size = 0.0, law.friction / law.ratio * float(np.max(approach - spring.curve.displacement[0]))
    for _ in range(60):
        middle = 0.5 * (low + size)
        carried = joint.A_0 * float(law.backbone(approach, middle) @ shape.share)
        low, size = (middle, size) if carried < shear else (low, middle)
    lost, stored = (float(shape.share @ each) for each in law.loop(approach, np.full(approach.size, size)))
    return lost / (2.0 * np.pi * stored)


def shear_at(joint: Bolted, left: float) -> float:
    """Shear [N] of `uncertainty` under the force [N] of each bolt."""
    return joint.n_bolts * left * min(SHEAR, MOST * joint.mu)


def loss_factors(
    stiffness: Callable[[Array], Array], pressure: Array, share: Array, mu: Array, shape: tuple[int, int]
) -> Array:
    """The same at SHEAR for samples and loads (n, m).

    stiffness : (n, m, e) [1] of pressures over mean pressure (n, m, e), up to a factor of each (n, m)
    pressure  : (e) [1] over mean pressure, with shares (e) of the area
    mu        : (n, 1)

    Shear falls short of the friction by what the pressure p - S of an earlier approach has: at each place
    p(delta - v) falls with v = u K_T/(K_N mu), and the mean fall S carries the shear mu S. With dv/dS = c the
    loss is 4 mu^2 K_N/K_T times the integral of (2 S - S_end) c, the stored energy half of mu^2 K_N/K_T S_end
    times that of c.
    """
    end = np.minimum(SHEAR / mu, MOST) + np.zeros(shape)
    step = end / STEPS
    now = np.broadcast_to(pressure, (*shape, pressure.size))

    def rate(there: Array) -> tuple[Array, Array]:
        k = stiffness(np.maximum(there, 1e-30))
        c = 1.0 / (k @ share)
        return -k * c[..., None], c

    h, moments = step[..., None], np.zeros((2, *shape))
    for i in range(STEPS):
        first, c0 = rate(now)
        second, c1 = rate(now + 0.5 * h * first)
        third, c2 = rate(now + 0.5 * h * second)
        fourth, c3 = rate(now + h * third)
        now = now + h / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        for part, c in zip((0.0, 0.5, 1.0), (c0 / 6.0, (c1 + c2) / 3.0, c3 / 6.0), strict=True):
            moments += np.stack([c, (2.0 * (i + part) * step - end) * c]) * step
    return np.asarray(4.0 / np.pi * moments[1] / (end * moments[0]))
