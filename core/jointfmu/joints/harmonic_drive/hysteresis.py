r"""Hysteresis of a harmonic drive: friction torque with history, added to the torque of the midline.

The contact pair of flexspline and bearing slips spot by spot. For elastically similar bodies the friction
torque follows from the normal law of the pair alone (Jaeger 1995, Ciavarella 1998). With K_N ~ P^m its virgin
curve over the wind-up phi is

    T_h = M_f (1 - s),   s = (1 - (1 - m) K_h phi/M_f)^(1/(1 - m)),   dT_h/dphi = K_h s^m

with the limit torque M_f, the initial stiffness K_h and the share s of friction that is not yet mobilised.
After a reversal it follows Masing's rule. Jenkins sliders in parallel, with spring K_i and limit M_i,
reproduce this for any path. Each slider here has the summed stiffness and limit of all sliders whose s lies
between two values of REMAINING_FRICTION_SHARES. So torque and stiffness of the virgin curve are exact at
these values and at full slip.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...contact.interface import MAX_INVERSION_ITERATIONS
from ...contact.powerlaw import exprel
from ...mechanics.curve import Curve
from ...mechanics.history_layout import HistoryLayout
from ...mechanics.jenkins import Sliders, SliderUpdate
from ...quantity import Array, Number
from .drive import DriveParameters
from .law import ContactPairDriveParameters, contact_pair_log_area

HYSTERESIS_SLIDER_COUNT = 44
"""Number of sliders of the hysteresis [1].

The virgin curve is then within 0.2 % of M_f, the loop area within 1 % for amplitudes above 0.1 M_f."""
_SLIDER_SHARE_GRADING_RATE, _SLIDER_SHARE_GRADING_EXPONENT = 3.5, 2.5
"""Grading of REMAINING_FRICTION_SHARES [1]: fine where the first sliders slip, coarse where the last do."""
_MOBILISED_FRICTION_SHARES = np.expm1(
    _SLIDER_SHARE_GRADING_RATE * np.arange(HYSTERESIS_SLIDER_COUNT) / HYSTERESIS_SLIDER_COUNT
) / np.expm1(_SLIDER_SHARE_GRADING_RATE)
"""Values of 1 - s [1], the mobilised share of friction, that separate the sliders; graded towards 0."""
HISTORY_LAYOUT = HistoryLayout({"force": (HYSTERESIS_SLIDER_COUNT,), "wind_up": (), "loss": ()})
"""History variables of the hysteresis: slider torques [N.m], wind-up [rad], loss [J]."""
REMAINING_FRICTION_SHARES = (
    *((1.0 - _MOBILISED_FRICTION_SHARES) ** _SLIDER_SHARE_GRADING_EXPONENT).tolist(),
    0.0,
)
"""Values of s [1], from 1 down to 0, that separate the sliders."""
WIND_UP_TOLERANCE = 4e-16
"""Change of the wind-up [1], over the sum of wind-up and M_f/K_h, below which its iteration stops."""
MIN_UNLOADING_OVER_REVERSAL_WIND_UP = 4.0
"""Smallest K_h phi/(2 M_f) [1] on the unloading path from rated torque to zero, if hysteresis_stiffness is 0:
at zero torque the friction has then reversed to 1 - 2 exp(-4) = 0.96 of its limit."""
FRICTION_LIMIT_TOLERANCE, MAX_FRICTION_LIMIT_ITERATIONS = 1e-13, 400
"""Relative change of M_f [1] at which its iteration has converged, and the largest number of iterations. More
would mean that the loop can hardly open as far as required."""


def stiffness_exponent(drive_parameters: DriveParameters) -> Number:
    """Exponent m [1] of the contact pair's normal stiffness ~ pressure^m, at zero torque.

    1 for a drive without a contact pair. m = 1 holds for rough surfaces at any pressure and for Hu's law: the
    hysteresis torque on the virgin curve is then M_f (1 - exp(-K_h phi/M_f)) at the wind-up phi, with
    friction limit M_f and initial stiffness K_h, as in Dahl's friction model.
    """
    if not isinstance(drive_parameters, ContactPairDriveParameters):
        return 1.0
    spots, u = (
        drive_parameters.contact_pair_law.spot_distribution(),
        contact_pair_log_area(drive_parameters, 0.0),
    )
    power = spots.log_sum_over_spots("load", 0.0)[1]
    return spots.sum_over_spots_derivative("normal", u) / (spots.sum_over_spots("normal", u) * power)


def slider_shares(
    stiffness_exponent: Number, remaining_friction_shares: Sequence[float] = REMAINING_FRICTION_SHARES
) -> tuple[list[Number], list[Number]]:
    """Shares [1] of each slider in the total stiffness K_h and in the total friction limit M_f.

    The shares in K_h have the sum 1, and those in M_f, too.

    stiffness_exponent        : exponent m of the contact pair's normal stiffness ~ pressure^m
    remaining_friction_shares : shares s [1] of the friction that is not mobilised yet, decreasing from 1 to
                                0, that separate the sliders
    """
    rate = [remaining**stiffness_exponent if remaining else 0.0 for remaining in remaining_friction_shares]
    used_shares = [
        1.0 - remaining - _relative_wind_up(remaining, stiffness_exponent) * r if remaining else 1.0
        for remaining, r in zip(remaining_friction_shares, rate, strict=True)
    ]
    return [a - b for a, b in pairwise(rate)], [b - a for a, b in pairwise(used_shares)]


def _relative_wind_up(remaining_friction_share: float, stiffness_exponent: Number) -> Number:
    """Relative wind-up [1] on the virgin curve at which a share s [1] of friction is not mobilised yet.

    The wind-up phi is divided by friction limit/initial stiffness: K_h phi/M_f = (1 - s^(1 - m))/(1 - m),
    with `stiffness_exponent` m.
    """
    logarithm = float(np.log(remaining_friction_share))
    return -logarithm * exprel((1.0 - stiffness_exponent) * logarithm)


@dataclass(frozen=True, slots=True)
class HysteresisSliders(Sliders):
    """Spring-slider elements (Jenkins) of a drive's hysteresis, in parallel, between input and output.

    stiffness      : (n) [N.m/rad] of the n springs
    friction_limit : (n) [N.m] of their torques; all zero without hysteresis
    """

    friction_limit: Array

    @classmethod
    def from_drive(cls, drive_parameters: DriveParameters, midline_curve: Curve) -> "HysteresisSliders":
        """Spring-slider elements of the hysteresis, from the parameters of a drive and its midline.

        midline_curve : torque [N.m] as a function of wind-up >= 0 [rad], without hysteresis; it is odd

        Raises ValueError if no loop through rated torque can open by hysteresis_loss.
        """
        half_loop_torque = float(midline_curve.derivatives(0.5 * drive_parameters.hysteresis_loss)[0])
        if not half_loop_torque < 0.5 * drive_parameters.rated_torque:
            raise ValueError(
                f"hysteresis_loss = {drive_parameters.hysteresis_loss:g} rad is outside "
                f"[0, {2.0 * float(midline_curve.inverse(0.5 * drive_parameters.rated_torque)):g}) rad: "
                "above it the hysteresis friction would exceed half of the rated torque"
            )
        springs, friction = (
            np.array(share, dtype=np.float64) for share in slider_shares(stiffness_exponent(drive_parameters))
        )
        unit_sliders = cls(
            _initial_stiffness(drive_parameters, midline_curve, half_loop_torque) * springs, friction
        )
        limit = _find_limit_torque(drive_parameters, midline_curve, unit_sliders, half_loop_torque) * friction
        return replace(unit_sliders, friction_limit=limit)

    @property
    def has_friction(self) -> bool:
        """Whether the drive has hysteresis."""
        return bool(self.friction_limit[-1] > 0.0)

    @property
    def characteristic_wind_up(self) -> float:
        """Characteristic wind-up [rad] of the hysteresis: friction limit divided by initial stiffness."""
        return float(np.sum(self.friction_limit) / np.sum(self.stiffness))

    def unloading_friction(
        self, midline_curve: Curve, reversal_torque: float, half_opening_angle: float
    ) -> float:
        """Minus the friction torque [N.m] when unloading from a torque has reached half_opening_angle.

        reversal_torque    : [N.m] torque at which unloading begins
        half_opening_angle : [rad] wind-up at the end of the unloading

        The friction torque (negative there; the result is positive) follows from Masing's rule. The torque of
        the drive is the torque of the midline plus the friction torque: it is 0 if the result equals the
        midline torque at half_opening_angle. The hysteresis loop is then 2 half_opening_angle wide at zero
        torque.
        """
        turn_wind_up = float(
            self.solve_wind_up(midline_curve, HISTORY_LAYOUT.virgin_history(), reversal_torque)
        )
        friction_back, friction_at_turn = self.advance(
            HISTORY_LAYOUT.virgin_history(), [0.5 * (turn_wind_up - half_opening_angle), turn_wind_up]
        ).traction
        return float(2.0 * friction_back - friction_at_turn)

    def advance(self, history_variables: Array, wind_up: ArrayLike) -> SliderUpdate:
        """Advance the spring-slider elements from the history variables (..., n) to wind-ups (...) [rad]."""
        variables = HISTORY_LAYOUT.split(history_variables)
        increment = np.asarray(wind_up, dtype=np.float64) - variables["wind_up"]
        return self.advance_1d(variables["force"], increment, self.friction_limit, self.friction_limit)

    def pack_history(self, slider_update: SliderUpdate, wind_up: ArrayLike, total_loss: Array) -> Array:
        """Pack the n history variables (..., n) of the hysteresis at wind-ups (...) [rad].

        The loss total_loss (...) [J] is the energy dissipated so far.
        """
        return HISTORY_LAYOUT.join(
            {"force": slider_update.force, "wind_up": wind_up, "loss": total_loss}, *total_loss.shape
        )

    def solve_wind_up(
        self, midline_curve: Curve, history_variables: Array, target_torque: ArrayLike
    ) -> Array:
        """Wind-up (...) [rad] at which midline and friction together carry torques (...) [N.m].

        history_variables : (..., n) the n history variables at the start of the path

        Safeguarded Newton iteration: the total torque increases monotonically with the wind-up. The iteration
        starts at the present wind-up, limited to the range in which not all sliders slip.
        """
        tau, friction_sum = np.asarray(target_torque, dtype=np.float64), float(np.sum(self.friction_limit))
        slipping = midline_curve.odd_inverse(np.stack([tau - friction_sum, tau + friction_sum]))
        phi = np.clip(HISTORY_LAYOUT.split(history_variables)["wind_up"], *slipping)
        low, high = np.full(tau.shape, -np.inf), np.full(tau.shape, np.inf)
        for _ in range(MAX_INVERSION_ITERATIONS):
            load, stiffness = midline_curve.derivatives(np.abs(phi), 1)
            update = self.advance(history_variables, phi)
            residual = tau - (np.copysign(load, phi) + update.traction)
            low, high = np.where(residual > 0.0, phi, low), np.where(residual < 0.0, phi, high)
            step = phi + residual / (stiffness + update.tangent)
            with np.errstate(invalid="ignore"):
                new = np.where((step >= low) & (step <= high), step, 0.5 * (low + high))
            change, phi = np.abs(new - phi), new
            if np.all(change <= WIND_UP_TOLERANCE * (np.abs(phi) + self.characteristic_wind_up)):
                break
        return phi


def _initial_stiffness(
    drive_parameters: DriveParameters, midline_curve: Curve, half_loop_torque: float
) -> float:
    """Initial stiffness K_h [N.m/rad] of the hysteresis: hysteresis_stiffness, or a default if this is 0.

    half_loop_torque : [N.m] torque of the midline at half of hysteresis_loss
    """
    if drive_parameters.hysteresis_stiffness > 0.0:
        return drive_parameters.hysteresis_stiffness
    back = (
        float(midline_curve.inverse(drive_parameters.rated_torque - half_loop_torque))
        - 0.5 * drive_parameters.hysteresis_loss
    )
    return max(
        float(midline_curve.stiffness[0]), 2.0 * MIN_UNLOADING_OVER_REVERSAL_WIND_UP * half_loop_torque / back
    )


def _find_limit_torque(
    drive_parameters: DriveParameters,
    midline_curve: Curve,
    sliders_with_unit_limit: HysteresisSliders,
    half_loop_torque: float,
) -> float:
    """Find the friction limit M_f [N.m] at which the hysteresis loop through rated torque has a given width.

    The width is the wind-up between both branches at zero torque: hysteresis_loss.

    sliders_with_unit_limit : sliders with the sum of limits 1 N.m
    half_loop_torque        : [N.m] midline torque at half of hysteresis_loss. At zero total torque the
        friction balances it; M_f equals it if all sliders have reversed.

    Raises ValueError if hysteresis_stiffness is too small for such a loop.
    """
    limit = half_loop_torque
    for _ in range(MAX_FRICTION_LIMIT_ITERATIONS):
        if limit == 0.0:
            return limit
        sliders = replace(
            sliders_with_unit_limit, friction_limit=limit * sliders_with_unit_limit.friction_limit
        )
        previous = limit
        opening = sliders.unloading_friction(
            midline_curve, drive_parameters.rated_torque, 0.5 * drive_parameters.hysteresis_loss
        )
        limit *= half_loop_torque / opening if opening > 0.0 else np.inf
        if not limit < drive_parameters.rated_torque:
            break
        if abs(limit - previous) <= FRICTION_LIMIT_TOLERANCE * limit:
            return previous
    raise ValueError(
        f"hysteresis_stiffness = {drive_parameters.hysteresis_stiffness:g} N.m/rad is too small for a loop "
        f"up to rated torque with hysteresis_loss = {drive_parameters.hysteresis_loss:g} rad; expected a "
        "larger value, or 0 for the default"
    )
