r"""Friction between the wave generator of a harmonic drive and the housing: Jenkins sliders and viscosity.

The limit of dry friction decreases with the speed w1, grows with the torque tau, and varies over the turn of
the wave generator, with the angle phi1,

    M = f_dry [friction_coulomb + friction_stribeck exp(-(w1/stribeck_speed)^2) + ripple + loss |tau/ratio|],
    ripple = sum of friction_n sin(n phi1 + friction_n_phase),   n = FRICTION_HARMONICS,

where f_dry is `dry_friction_factor`, a function of the temperature. loss is load_loss for motion against the
load torque (the motor drives), and load_loss_back for motion in the direction of the load torque (the load
drives the motor, the friction holds it). So positive and negative friction have different limits.

Friction builds up over the angle phi1 in Jenkins sliders in parallel, each a spring in series with dry
friction that has a fixed share of M. At constant M the friction from the virgin state approximates
M (1 - exp(-k phi1/M)) (Dahl 1968); after a reversal it follows Masing's rule. The spring stiffness k =
M_r/presliding does not change with M; M_r is the limit at rated torque and zero speed. So a drive at rest
holds any torque below M without motion and without a threshold of speed, and the work on every path equals
stored energy plus loss. The lubricant adds the viscous torque f_viscous friction_viscous w1.

The temperature acts by Reynolds' law of viscosity (1886),
exp(-coefficient (temperature - REFERENCE_TEMPERATURE)), with one coefficient for viscous and one for dry
friction.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ...mechanics.history_layout import HistoryLayout
from ...mechanics.jenkins import Sliders, SliderUpdate
from ...quantity import Array, Number
from .drive import (
    FRICTION_HARMONICS,
    PLAY_TORQUE_OVER_RATED_TORQUE,
    DriveParameters,
    compute_sines_and_cosines,
)
from .hysteresis import slider_shares

FRICTION_SLIDER_COUNT = 8
"""Number of sliders of the friction [1]: from the virgin state it is then within 1 % of M of Dahl's curve."""
HISTORY_LAYOUT = HistoryLayout(
    {"friction_torque": (FRICTION_SLIDER_COUNT,), "angle": (), "limit": (2,), "begun": ()}
)
"""History variables: slider torques [N.m], phi1 [rad], friction limits [N.m], 1 after the first step."""
_REMAINING_FRICTION_SHARES = (
    *(np.linspace(1.0, 0.0, FRICTION_SLIDER_COUNT, endpoint=False) ** 2).tolist(),
    0.0,
)
"""Shares of the friction that is not yet mobilised [1], from 1 to 0, that separate the sliders."""
_SLIDER_STIFFNESS_AND_LIMIT_SHARES = slider_shares(1.0, _REMAINING_FRICTION_SHARES)
"""Shares of each slider in the total stiffness and in the total limit [1]."""
SLIDER_STIFFNESS_SHARES = np.array(_SLIDER_STIFFNESS_AND_LIMIT_SHARES[0])
SLIDER_LIMIT_SHARES = np.array(_SLIDER_STIFFNESS_AND_LIMIT_SHARES[1])
"""Shares [1] of each slider in the total spring stiffness M_r/presliding and in the total limit M."""
REFERENCE_TEMPERATURE = 293.15
"""Temperature [K] at which the friction parameters hold: 20 degrees C, as in the catalogues."""
PRIOR_ROTATION_TIME = 0.1
"""Time [s] for which a drive is assumed to have rotated at its initial speed before initialization."""


def dry_friction_factor(drive_parameters: DriveParameters, temperature: Number) -> Number:
    """Factor (...) [1] by which temperatures (...) [K] change the limit of dry friction."""
    return drive_parameters.temperature_factor * _temperature_factor(
        drive_parameters.dry_temperature_coefficient, temperature
    )


def _temperature_factor(temperature_coefficient: Number, temperature: Number) -> Number:
    """Factor [1] on viscosity or friction at temperatures (...) [K], by Reynolds' exponential law."""
    return np.exp(-temperature_coefficient * (temperature - REFERENCE_TEMPERATURE))


def friction_limits(
    drive_parameters: DriveParameters,
    w1: Number,
    tau: Number,
    temperature: Number = REFERENCE_TEMPERATURE,
    ripple_torque: Number = 0.0,
) -> tuple[Number, Number]:
    """Limits (...) [N.m] of positive and of negative dry friction torque on the wave generator.

    w1            : (...) [rad/s] speed of the wave generator
    tau           : (...) [N.m] torque at the output; tau/ratio is its torque on the wave generator
    temperature   : (...) [K] of the lubricant
    ripple_torque : (...) [N.m] part that is periodic in the angle (`friction_ripple`); 0: mean over a turn

    Two functions of the sign of tau are replaced by smooth ones, with the torque
    t = PLAY_TORQUE_OVER_RATED_TORQUE rated_torque: |tau| is tau tanh(tau/t), and the weight of load_loss_back
    is (1 +- tanh(tau/t))/2.
    """
    load_sign = np.tanh(tau / (PLAY_TORQUE_OVER_RATED_TORQUE * drive_parameters.rated_torque))
    size = tau * load_sign / np.abs(drive_parameters.ratio)
    stribeck = drive_parameters.friction_stribeck * np.exp(-((w1 / drive_parameters.stribeck_speed) ** 2))
    difference = drive_parameters.effective_load_loss_back - drive_parameters.load_loss
    back = 0.5 * (1.0 + load_sign * drive_parameters.ratio / np.abs(drive_parameters.ratio))
    sides = (drive_parameters.load_loss + difference * weight for weight in (back, 1.0 - back))
    constant = drive_parameters.friction_coulomb + stribeck + ripple_torque
    factor = dry_friction_factor(drive_parameters, temperature)
    positive, negative = (factor * (constant + loss * size) for loss in sides)
    return positive, negative


def ripple_amplitudes(drive_parameters: DriveParameters) -> list[Number]:
    """Amplitudes [N.m] of the periodic part of the dry friction, one for each of FRICTION_HARMONICS."""
    return [getattr(drive_parameters, f"friction_{n}") for n in FRICTION_HARMONICS]


def friction_ripple(drive_parameters: DriveParameters, phi1: Number) -> tuple[Number, Number]:
    """Periodic part (...) [N.m] of the dry friction at wave generator angles phi1 (...) [rad].

    Returns also its derivative [N.m/rad] with respect to phi1.
    """
    ripple = slope = 0.0
    harmonics = compute_sines_and_cosines(phi1, FRICTION_HARMONICS)
    for (n, (sine, cosine)), amplitude in zip(
        harmonics.items(), ripple_amplitudes(drive_parameters), strict=True
    ):
        phase = getattr(drive_parameters, f"friction_{n}_phase")
        ripple = ripple + amplitude * (sine * np.cos(phase) + cosine * np.sin(phase))
        slope = slope + n * amplitude * (cosine * np.cos(phase) - sine * np.sin(phase))
    return ripple, slope


def viscous_torque(
    drive_parameters: DriveParameters, w1: Number, temperature: Number = REFERENCE_TEMPERATURE
) -> Number:
    """Viscous friction torque (...) [N.m] at wave generator speeds (...) [rad/s], temperatures (...) [K]."""
    factor = drive_parameters.temperature_factor * _temperature_factor(
        drive_parameters.viscous_temperature_coefficient, temperature
    )
    return factor * drive_parameters.friction_viscous * w1


def sticking_stiffness(drive_parameters: DriveParameters) -> Number:
    """Total spring stiffness [N.m/rad] of the friction sliders before slip: M_r/presliding.

    M_r is the larger friction limit of both directions, at zero speed, rated torque and
    REFERENCE_TEMPERATURE; presliding [rad] is a parameter of the drive.
    """
    return (
        np.maximum(*friction_limits(drive_parameters, 0.0, drive_parameters.rated_torque))
        / drive_parameters.presliding
    )


@dataclass(frozen=True, slots=True)
class FrictionSliders(Sliders):
    """Spring-slider elements (Jenkins) of a drive's dry friction, in parallel, on the wave generator.

    stiffness : (n) [N.m/rad] of the n springs, all zero without dry friction
    """

    @classmethod
    def from_drive(cls, drive_parameters: DriveParameters) -> "FrictionSliders":
        """Spring-slider elements of the dry friction, from the parameters of a drive."""
        return cls(float(sticking_stiffness(drive_parameters)) * SLIDER_STIFFNESS_SHARES)

    def advance(
        self,
        history_variables: Array,
        phi1: ArrayLike,
        w1: ArrayLike,
        end_friction_limits: Sequence[ArrayLike],
    ) -> SliderUpdate:
        """Advance the sliders of the dry friction on a straight path to the angle phi1.

        history_variables   : (..., n) the n history variables of HISTORY_LAYOUT at the start of the path
        phi1                : (...) [rad] angle of the wave generator at the end
        w1                  : (...) [rad/s] speed there, used only in the first step
        end_friction_limits : limits (...) [N.m] of positive and negative friction, see `friction_limits`

        The sign of the elastic predictor of a slider selects the limit that holds for it. The first step
        initializes the sliders: they advance by PRIOR_ROTATION_TIME w1, whatever phi1 is, without loss.
        """
        start, now = (
            HISTORY_LAYOUT.split(history_variables),
            np.stack(np.broadcast_arrays(*end_friction_limits), axis=-1),
        )
        if not self.has_friction:
            none = np.zeros(now.shape[:-1])
            return SliderUpdate(np.zeros((*none.shape, self.stiffness.size)), none, none)
        begun, force = start["begun"] > 0.0, start["friction_torque"]
        way = np.where(begun, np.asarray(phi1) - start["angle"], PRIOR_ROTATION_TIME * np.asarray(w1))
        negative = force + self.stiffness * way[..., None] < 0.0
        before, after = (
            np.where(negative, ends[..., 1, None], ends[..., 0, None]) * SLIDER_LIMIT_SHARES
            for ends in (start["limit"], now)
        )
        moved = self.advance_1d(force, way, before, after)
        return replace(moved, dissipated_energy=np.where(begun, moved.dissipated_energy, 0.0))

    def pack_history(
        self, slider_update: SliderUpdate, phi1: ArrayLike, end_friction_limits: Sequence[ArrayLike]
    ) -> Array:
        """Pack the n history variables (..., n) of the dry friction at an angle phi1 (...) [rad].

        All are zero without dry friction.

        slider_update : state of the spring-slider elements at phi1
        """
        shape = slider_update.dissipated_energy.shape
        if not self.has_friction:
            return np.zeros((*shape, HISTORY_LAYOUT.value_count))
        limit = np.stack(np.broadcast_arrays(*end_friction_limits), axis=-1)
        return HISTORY_LAYOUT.join(
            {"friction_torque": slider_update.force, "angle": phi1, "limit": limit, "begun": 1.0}, *shape
        )
