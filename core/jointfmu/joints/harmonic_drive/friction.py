r"""Friction at the wave generator of a harmonic drive: sliders between it and the housing.

Dry friction holds up to a limit that speed lowers and load raises,

    M = f_dry [friction_coulomb + friction_stribeck exp(-(w1/stribeck_speed)^2) + loss |tau/ratio|],

where f_dry is `dry_factor`, of the temperature, and loss is load_loss if the friction, and so a slip, is
against the load (the motor drives), and load_loss_back if it holds the load (the load drives the motor). So
the limit has two sides, that of positive and that of negative friction, and a slider may not leave what lies
between.

Friction builds up over the angle phi1: sliders in parallel, spring and friction each, of which every one
takes its share of M. From rest it is M (1 - exp(-phi1/presliding)) (Dahl 1968) at a steady limit, as far as
so few sliders follow it; after a reversal by Masing's rule. The springs stay while the limit changes. So a
drive at rest holds any torque below M where it is, without a threshold of speed, and the work of every path
is what the springs store and what is lost. Grease adds f_viscous friction_viscous w1.

The temperature acts by Reynolds' law of viscosity (1886), exp(-coefficient (temperature - REFERENCE)), with a
coefficient for the viscous and one for the dry part.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ...mechanics.jenkins import Moved, Sliders
from ...mechanics.memory import Layout
from ...quantity import Array, Number
from .drive import WIDTH, Drive
from .hysteresis import shares

BRAKES = 8
"""How many sliders: friction from rest within 1 % of M."""
MEMORY = Layout({"brake": (BRAKES,), "angle": (), "limit": (2,), "begun": ()})
"""What the drive remembers of it: forces [N.m], phi1 [rad], `limits` [N.m], 1 once it has begun."""
_LEFT = (*(np.linspace(1.0, 0.0, BRAKES, endpoint=False) ** 2).tolist(), 0.0)
_SHARES = shares(1.0, _LEFT)
SPRINGS, LIMITS = np.array(_SHARES[0]), np.array(_SHARES[1])
"""Springs over M/presliding and friction over M of the sliders [1]."""
REFERENCE = 293.15
"""Temperature [K] at which the friction parameters hold: that of the catalogues, 20 degrees C."""
TURNED = 0.1
"""Time [s] for which a drive that turns at initialization has turned before."""


def dry_factor(drive: Drive, temperature: Number) -> Number:
    """Limit of dry friction (...) [1] at temperatures (...) [K], over that of the parameters."""
    return drive.temperature_factor * _thinning(drive.dry_temperature_coefficient, temperature)


def _thinning(coefficient: Number, temperature: Number) -> Number:
    return np.exp(-coefficient * (temperature - REFERENCE))


def limits(drive: Drive, w1: Number, tau: Number, temperature: Number = REFERENCE) -> tuple[Number, Number]:
    """M (...) [N.m] of positive and of negative friction, at speeds (...) [rad/s] of the wave generator,
    torques (...) [N.m] at the output and temperatures (...) [K].

    |tau| is tau tanh(tau/t) with t WIDTH times the rated torque, and the load counts as driving the motor by
    (1 + tanh)/2: smooth through zero. tau/ratio is what the load turns the wave generator with.
    """
    turned = np.tanh(tau / (WIDTH * drive.rated_torque))
    size = tau * turned / np.abs(drive.ratio)
    stribeck = drive.friction_stribeck * np.exp(-((w1 / drive.stribeck_speed) ** 2))
    more = drive.loss_back - drive.load_loss
    back = 0.5 * (1.0 + turned * drive.ratio / np.abs(drive.ratio))
    sides = (drive.load_loss + more * part for part in (back, 1.0 - back))
    held = drive.friction_coulomb + stribeck
    factor = dry_factor(drive, temperature)
    positive, negative = (factor * (held + loss * size) for loss in sides)
    return positive, negative


def viscous(drive: Drive, w1: Number, temperature: Number = REFERENCE) -> Number:
    """Torque (...) [N.m] of the grease at speeds (...) [rad/s] of the wave generator and temperatures [K]."""
    factor = drive.temperature_factor * _thinning(drive.viscous_temperature_coefficient, temperature)
    return factor * drive.friction_viscous * w1


def stiffness(drive: Drive) -> Number:
    """[N.m/rad] of the sliders while all stick: M at rest, rated torque and REFERENCE over presliding."""
    return np.maximum(*limits(drive, 0.0, drive.rated_torque)) / drive.presliding


@dataclass(frozen=True, slots=True)
class Friction(Sliders):
    """The sliders of a drive; `stiffness` (n) [N.m/rad] is all zero without dry friction."""

    @classmethod
    def of(cls, drive: Drive) -> "Friction":
        """Of a drive."""
        return cls(float(stiffness(drive)) * SPRINGS)

    def moved(self, memory: Array, phi1: ArrayLike, w1: ArrayLike, most: Sequence[ArrayLike]) -> Moved:
        """The sliders on the straight path from a MEMORY (..., n) to angles (...) [rad] with `limits`.

        Each is held by the limit on the side of the force that it would have if it stuck.

        The first path of all leads to where the drive is, whatever the angle: it has turned before for as
        long as TURNED at its speed w1, and lost nothing yet.
        """
        start, now = MEMORY.split(memory), np.stack(np.broadcast_arrays(*most), axis=-1)
        if not self.acts:
            none = np.zeros(now.shape[:-1])
            return Moved(np.zeros((*none.shape, self.stiffness.size)), none, none)
        begun, force = start["begun"] > 0.0, start["brake"]
        way = np.where(begun, np.asarray(phi1) - start["angle"], TURNED * np.asarray(w1))
        negative = force + self.stiffness * way[..., None] < 0.0
        before, after = (
            np.where(negative, ends[..., 1, None], ends[..., 0, None]) * LIMITS
            for ends in (start["limit"], now)
        )
        moved = self.along(force, way, before, after)
        return replace(moved, loss=np.where(begun, moved.loss, 0.0))

    def after(self, braked: Moved, phi1: ArrayLike, most: Sequence[ArrayLike]) -> Array:
        """The MEMORY (..., n) there; none where nothing acts."""
        shape = braked.loss.shape
        if not self.acts:
            return np.zeros((*shape, MEMORY.size))
        limit = np.stack(np.broadcast_arrays(*most), axis=-1)
        return MEMORY.joined({"brake": braked.force, "angle": phi1, "limit": limit, "begun": 1.0}, *shape)
