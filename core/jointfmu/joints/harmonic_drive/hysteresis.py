r"""Hysteresis of a harmonic drive: a friction torque with memory beside the torque of the midline.

The pair of flexspline and bearing slips spot by spot. For elastically similar bodies the friction torque
follows from the pair's normal law alone (Jaeger 1995, Ciavarella 1998); with K_N ~ P^m it grows from rest as

    T_h = M_f (1 - s),   s = (1 - (1 - m) K_h phi/M_f)^(1/(1 - m)),   dT_h/dphi = K_h s^m

and after every reversal by Masing's rule. Sliders in parallel do the same for any path: spring K_i, friction
M_i. Here each stands for all whose s lies between two of the places LEFT, with the sums of their springs and
of their friction, so that torque and stiffness from rest are exact at these places and at full slip.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...contact.interface import MOST_STEPS
from ...contact.powerlaw import exprel
from ...mechanics.curve import Curve
from ...mechanics.jenkins import Moved, Sliders
from ...mechanics.memory import Layout
from ...quantity import Array, Number
from .drive import Drive
from .law import PairDrive, pair_log_area

SLIDERS = 44
"""How many: torque from rest within 0.2 % of M_f, area of a loop within 1 % from a tenth of M_f on."""
_CROWDING, _POWER = 3.5, 2.5
"""Their places: closer where the first ones slip, and wide enough where the last ones do."""
_USED = np.expm1(_CROWDING * np.arange(SLIDERS) / SLIDERS) / np.expm1(_CROWDING)
MEMORY = Layout({"force": (SLIDERS,), "wind_up": (), "loss": ()})
"""What the drive remembers of it: forces [N.m], wind-up [rad], loss [J]."""
LEFT = (*((1.0 - _USED) ** _POWER).tolist(), 0.0)
"""Share of the friction that is not used yet [1], from 1 down to 0: between which the sliders are."""
NEAREST = 4e-16
"""Change of the wind-up [1], over itself or the length of the hysteresis, that is round-off."""
REVERSAL = 4.0
"""K_h phi/(2 M_f) [1] on the way back from rated torque, at least, where no extra stiffness is given: the
friction has turned round, by 1 - 2 exp(-4) = 0.96, when the torque is zero."""
SETTLED, MOST_CORRECTIONS = 1e-13, 400
"""Change [1] of the limit of the friction with which it is found, and the steps for that: more would mean
that the loop hardly opens as far as it should."""


def exponent(drive: Drive) -> Number:
    """m [1] of K_N ~ P^m of the contact pair, at the pressure without torque; 1 of a law without a pair.

    1 is that of rough surfaces under any pressure and of Hu's law: T_h = M_f (1 - exp(-K_h phi/M_f)), as in
    Dahl's model of friction.
    """
    if not isinstance(drive, PairDrive):
        return 1.0
    spots, u = drive.pair_law.spots(), pair_log_area(drive, 0.0)
    power = spots.log_total("load", 0.0)[1]
    return spots.slope("normal", u) / (spots.total("normal", u) * power)


def shares(m: Number, places: Sequence[float] = LEFT) -> tuple[list[Number], list[Number]]:
    """Springs over K_h and friction over M_f of the sliders [1] between places; the sum of each is 1."""
    rate = [left**m if left else 0.0 for left in places]
    used = [1.0 - left - _travel(left, m) * r if left else 1.0 for left, r in zip(places, rate, strict=True)]
    return [a - b for a, b in pairwise(rate)], [b - a for a, b in pairwise(used)]


def _travel(left: float, m: Number) -> Number:
    """K_h phi/M_f [1] from rest at which so much of the friction is left: (1 - s^(1 - m))/(1 - m)."""
    logarithm = float(np.log(left))
    return -logarithm * exprel((1.0 - m) * logarithm)


@dataclass(frozen=True, slots=True)
class Hysteresis(Sliders):
    """The friction torque of a drive: sliders with springs in N.m/rad.

    limit : (n) [N.m] of their friction; all zero without hysteresis
    """

    limit: Array

    @classmethod
    def of(cls, drive: Drive, curve: Curve) -> "Hysteresis":
        """Of a drive whose midline is `curve`, odd.

        Raises ValueError if no loop through rated torque opens as far as hysteresis_loss.
        """
        least = float(curve.derivatives(0.5 * drive.hysteresis_loss)[0])
        if not least < 0.5 * drive.rated_torque:
            raise ValueError(
                f"hysteresis_loss = {drive.hysteresis_loss:g} rad is outside "
                f"[0, {2.0 * float(curve.inverse(0.5 * drive.rated_torque)):g}) rad: "
                "friction would hold half of the rated torque"
            )
        springs, friction = (np.array(share, dtype=np.float64) for share in shares(exponent(drive)))
        drawn = cls(_extra_stiffness(drive, curve, least) * springs, friction)
        return replace(drawn, limit=_limit(drive, curve, drawn, least) * friction)

    @property
    def acts(self) -> bool:
        """Whether there is any."""
        return bool(self.limit[-1] > 0.0)

    @property
    def length(self) -> float:
        """Wind-up [rad] over which the sliders begin to slip, M_f/K_h."""
        return float(np.sum(self.limit) / np.sum(self.stiffness))

    def opening(self, curve: Curve, torque: float, half: float) -> float:
        """Friction [N.m] against the midline on the way back from a torque, at the wind-up `half`.

        By Masing's rule. Where it is the midline's torque there, the branches are 2 `half` apart.
        """
        turn = float(self.wind_up(curve, MEMORY.rest(), torque))
        back, there = self.moved(MEMORY.rest(), [0.5 * (turn - half), turn]).traction
        return float(2.0 * back - there)

    def moved(self, memory: Array, phi: ArrayLike) -> Moved:
        """The sliders on the straight path from a MEMORY (..., n) to wind-ups (...) [rad]."""
        before = MEMORY.split(memory)
        way = np.asarray(phi, dtype=np.float64) - before["wind_up"]
        return self.along(before["force"], way, self.limit, self.limit)

    def after(self, moved: Moved, phi: ArrayLike, loss: Array) -> Array:
        """The MEMORY (..., n) there, with the loss (...) so far."""
        return MEMORY.joined({"force": moved.force, "wind_up": phi, "loss": loss}, *loss.shape)

    def wind_up(self, curve: Curve, memory: Array, torque: ArrayLike) -> Array:
        """Wind-up (...) [rad] where the way from a memory ends that leads to torques (...) [N.m].

        Newton's method in a bracket that shrinks: midline and friction together grow with the wind-up all
        over. It begins where the way did, or where the sliders all slip, if that is nearer.
        """
        tau, most = np.asarray(torque, dtype=np.float64), float(np.sum(self.limit))
        slipping = curve.odd_inverse(np.stack([tau - most, tau + most]))
        phi = np.clip(MEMORY.split(memory)["wind_up"], *slipping)
        low, high = np.full(tau.shape, -np.inf), np.full(tau.shape, np.inf)
        for _ in range(MOST_STEPS):
            load, stiffness = curve.derivatives(np.abs(phi), 1)
            moved = self.moved(memory, phi)
            rest = tau - (np.copysign(load, phi) + moved.traction)
            low, high = np.where(rest > 0.0, phi, low), np.where(rest < 0.0, phi, high)
            step = phi + rest / (stiffness + moved.tangent)
            with np.errstate(invalid="ignore"):
                new = np.where((step >= low) & (step <= high), step, 0.5 * (low + high))
            change, phi = np.abs(new - phi), new
            if np.all(change <= NEAREST * (np.abs(phi) + self.length)):
                break
        return phi


def _extra_stiffness(drive: Drive, curve: Curve, least: float) -> float:
    """K_h [N.m/rad]; `least` is the midline's torque at half of hysteresis_loss."""
    if drive.hysteresis_stiffness > 0.0:
        return drive.hysteresis_stiffness
    back = float(curve.inverse(drive.rated_torque - least)) - 0.5 * drive.hysteresis_loss
    return max(float(curve.stiffness[0]), 2.0 * REVERSAL * least / back)


def _limit(drive: Drive, curve: Curve, drawn: Hysteresis, least: float) -> float:
    """M_f [N.m] of a loop through rated torque that opens by hysteresis_loss; `drawn` are sliders for 1 N.m.

    Without torque the friction carries the midline there: M_f is `least` if all sliders have turned round.
    """
    limit = least
    for _ in range(MOST_CORRECTIONS):
        if limit == 0.0:
            return limit
        found = replace(drawn, limit=limit * drawn.limit)
        before, opening = limit, found.opening(curve, drive.rated_torque, 0.5 * drive.hysteresis_loss)
        limit *= least / opening if opening > 0.0 else np.inf
        if not limit < drive.rated_torque:
            break
        if abs(limit - before) <= SETTLED * limit:
            return before
    raise ValueError(
        f"hysteresis_stiffness = {drive.hysteresis_stiffness:g} N.m/rad is too small for a loop through "
        f"rated torque that opens by {drive.hysteresis_loss:g} rad; allowed are 0 and larger ones"
    )
