r"""Hysteresis of a harmonic drive: friction torque with history, added to the torque of the midline.

The contact pair of flexspline and bearing slips spot by spot. For elastically similar bodies the friction
torque follows from the normal law of the pair alone (Jaeger 1995, Ciavarella 1998). With K_N ~ P^m its virgin
curve over the wind-up phi is

    T_h = M_f (1 - s),   s = (1 - (1 - m) K_h phi/M_f)^(1/(1 - m)),   dT_h/dphi = K_h s^m

with the limit torque M_f, the initial stiffness K_h and the share s of friction that is not yet mobilised.
After a reversal it follows Masing's rule. Jenkins sliders in parallel, with spring K_i and limit M_i,
reproduce this for any path. Each slider here has the summed stiffness and limit of all sliders whose s lies
between two values of REMAINING_SHARES. So torque and stiffness of the virgin curve are exact at these values
and at full slip.
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
"""Number of sliders: virgin curve within 0.2 % of M_f, loop area within 1 % for amplitudes above 0.1 M_f."""
_CROWDING, _POWER = 3.5, 2.5
"""Grading of REMAINING_SHARES [1]: fine where the first sliders slip, coarse where the last ones do."""
_USED = np.expm1(_CROWDING * np.arange(SLIDERS) / SLIDERS) / np.expm1(_CROWDING)
MEMORY = Layout({"force": (SLIDERS,), "wind_up": (), "loss": ()})
"""History variables of the hysteresis: slider torques [N.m], wind-up [rad], loss [J]."""
LEFT = (*((1.0 - _USED) ** _POWER).tolist(), 0.0)
"""Values of s [1], from 1 down to 0, that separate the sliders."""
NEAREST = 4e-16
"""Change of the wind-up [1], over the sum of wind-up and M_f/K_h, below which its iteration stops."""
REVERSAL = 4.0
"""Smallest K_h phi/(2 M_f) [1] on the unloading path from rated torque to zero, if hysteresis_stiffness is 0:
at zero torque the friction has then reversed to 1 - 2 exp(-4) = 0.96 of its limit."""
SETTLED, MOST_CORRECTIONS = 1e-13, 400
"""Relative change of M_f [1] at which its iteration has converged, and the largest number of iterations. More
would mean that the loop can hardly open as far as required."""


def exponent(drive: Drive) -> Number:
    """Exponent m [1] of K_N ~ P^m of the contact pair at zero torque; 1 for a drive without a contact pair.

    m = 1 holds for rough surfaces at any pressure and for Hu's law: T_h = M_f (1 - exp(-K_h phi/M_f)), as in
    Dahl's friction model.
    """
    if not isinstance(drive, PairDrive):
        return 1.0
    spots, u = drive.pair_law.spots(), pair_log_area(drive, 0.0)
    power = spots.log_total("load", 0.0)[1]
    return spots.slope("normal", u) / (spots.total("normal", u) * power)


def shares(m: Number, places: Sequence[float] = LEFT) -> tuple[list[Number], list[Number]]:
    """Shares of the sliders in K_h and in M_f [1], each with the sum 1.

    m                : exponent of K_N ~ P^m
    remaining_shares : values of s [1], decreasing from 1 to 0, that separate the sliders
    """
    rate = [remaining**m if remaining else 0.0 for remaining in places]
    used_shares = [
        1.0 - remaining - _travel(remaining, m) * r if remaining else 1.0
        for remaining, r in zip(places, rate, strict=True)
    ]
    return [a - b for a, b in pairwise(rate)], [b - a for a, b in pairwise(used_shares)]


def _travel(left: float, m: Number) -> Number:
    """K_h phi/M_f [1] on the virgin curve at the remaining share s [1]: (1 - s^(1 - m))/(1 - m)."""
    logarithm = float(np.log(left))
    return -logarithm * exprel((1.0 - m) * logarithm)


@dataclass(frozen=True, slots=True)
class Hysteresis(Sliders):
    """Sliders of the hysteresis of a drive.

    stiffness : (n) [N.m/rad] of the springs
    limit     : (n) [N.m] of the friction torques; all zero without hysteresis
    """

    limit: Array

    @classmethod
    def of(cls, drive: Drive, curve: Curve) -> "Hysteresis":
        """Sliders for a drive with the odd midline `curve`.

        Raises ValueError if no loop through rated torque can open by hysteresis_loss.
        """
        half_loop_torque = float(curve.derivatives(0.5 * drive.hysteresis_loss)[0])
        if not half_loop_torque < 0.5 * drive.rated_torque:
            raise ValueError(
                f"hysteresis_loss = {drive.hysteresis_loss:g} rad is outside "
                f"[0, {2.0 * float(curve.inverse(0.5 * drive.rated_torque)):g}) rad: "
                "friction would hold half of the rated torque"
            )
        springs, friction = (np.array(share, dtype=np.float64) for share in shares(exponent(drive)))
        unit_sliders = cls(_extra_stiffness(drive, curve, half_loop_torque) * springs, friction)
        return replace(unit_sliders, limit=_limit(drive, curve, unit_sliders, half_loop_torque) * friction)

    @property
    def acts(self) -> bool:
        """Whether the drive has hysteresis."""
        return bool(self.limit[-1] > 0.0)

    @property
    def length(self) -> float:
        """Characteristic wind-up M_f/K_h [rad] of the hysteresis."""
        return float(np.sum(self.limit) / np.sum(self.stiffness))

    def opening(self, curve: Curve, torque: float, half: float) -> float:
        """Negative friction torque [N.m] on unloading from a torque [N.m], at the wind-up half_opening [rad].

        By Masing's rule. If it equals the torque of the midline at half_opening, the total torque is zero
        there: the branches of the loop are then 2 half_opening apart at zero torque.
        """
        turn_wind_up = float(self.wind_up(curve, MEMORY.rest(), torque))
        friction_back, friction_at_turn = self.moved(
            MEMORY.rest(), [0.5 * (turn_wind_up - half), turn_wind_up]
        ).traction
        return float(2.0 * friction_back - friction_at_turn)

    def moved(self, memory: Array, phi: ArrayLike) -> Moved:
        """Advance the sliders from history variables (..., n) on a path to wind-ups phi (...) [rad]."""
        variables = MEMORY.split(memory)
        increment = np.asarray(phi, dtype=np.float64) - variables["wind_up"]
        return self.along(variables["force"], increment, self.limit, self.limit)

    def after(self, moved: Moved, phi: ArrayLike, loss: Array) -> Array:
        """New history variables (..., n) after the path to phi (...) [rad]; loss (...) [J] is the total."""
        return MEMORY.joined({"force": moved.force, "wind_up": phi, "loss": loss}, *loss.shape)

    def wind_up(self, curve: Curve, memory: Array, torque: ArrayLike) -> Array:
        """Wind-up (...) [rad] at torques (...) [N.m] of midline plus friction, from a history (..., n).

        Safeguarded Newton iteration: the total torque increases monotonically with the wind-up. The iteration
        starts at the present wind-up, limited to the range in which not all sliders slip.
        """
        tau, friction_sum = np.asarray(torque, dtype=np.float64), float(np.sum(self.limit))
        slipping = curve.odd_inverse(np.stack([tau - friction_sum, tau + friction_sum]))
        phi = np.clip(MEMORY.split(memory)["wind_up"], *slipping)
        low, high = np.full(tau.shape, -np.inf), np.full(tau.shape, np.inf)
        for _ in range(MOST_STEPS):
            load, stiffness = curve.derivatives(np.abs(phi), 1)
            update = self.moved(memory, phi)
            residual = tau - (np.copysign(load, phi) + update.traction)
            low, high = np.where(residual > 0.0, phi, low), np.where(residual < 0.0, phi, high)
            step = phi + residual / (stiffness + update.tangent)
            with np.errstate(invalid="ignore"):
                new = np.where((step >= low) & (step <= high), step, 0.5 * (low + high))
            change, phi = np.abs(new - phi), new
            if np.all(change <= NEAREST * (np.abs(phi) + self.length)):
                break
        return phi


def _extra_stiffness(drive: Drive, curve: Curve, least: float) -> float:
    """K_h [N.m/rad]; half_loop_torque [N.m] is the midline's torque at half of hysteresis_loss."""
    if drive.hysteresis_stiffness > 0.0:
        return drive.hysteresis_stiffness
    back = float(curve.inverse(drive.rated_torque - least)) - 0.5 * drive.hysteresis_loss
    return max(float(curve.stiffness[0]), 2.0 * REVERSAL * least / back)


def _limit(drive: Drive, curve: Curve, drawn: Hysteresis, least: float) -> float:
    """M_f [N.m] for which the loop through rated torque opens by hysteresis_loss, by fixed-point iteration.

    unit_sliders     : sliders with the sum of limits 1 N.m
    half_loop_torque : [N.m] midline torque at half of hysteresis_loss. At zero total torque the friction
        balances it; M_f equals it if all sliders have reversed.

    Raises ValueError if hysteresis_stiffness is too small for such a loop.
    """
    limit = least
    for _ in range(MOST_CORRECTIONS):
        if limit == 0.0:
            return limit
        sliders = replace(drawn, limit=limit * drawn.limit)
        previous, opening = limit, sliders.opening(curve, drive.rated_torque, 0.5 * drive.hysteresis_loss)
        limit *= least / opening if opening > 0.0 else np.inf
        if not limit < drive.rated_torque:
            break
        if abs(limit - previous) <= SETTLED * limit:
            return previous
    raise ValueError(
        f"hysteresis_stiffness = {drive.hysteresis_stiffness:g} N.m/rad is too small for a loop through "
        f"rated torque that opens by {drive.hysteresis_loss:g} rad; allowed are 0 and larger ones"
    )
