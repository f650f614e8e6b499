"""Tabulated harmonic drive: midline (torque over wind-up), and outputs for a motion or a torque."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...mechanics.curve import Curve, assemble_curve, refine_curve
from ...mechanics.stable_steps import largest_stable_steps, mobility
from ...quantity import Array, Number, check_limits
from . import friction, hysteresis
from .drive import DriveParameters, kinematic_error
from .friction import (
    REFERENCE_TEMPERATURE,
    FrictionSliders,
    friction_limits,
    friction_ripple,
    viscous_torque,
)
from .hysteresis import HysteresisSliders
from .law import ContactPairDriveParameters, stiffness_with_play
from .prescribed_midline import PrescribedDriveParameters

MIN_TABLE_STEPS = 160
"""Initial number of steps of the midline's table [1]; doubled until the table is accurate."""
MIN_STIFFNESS, MIN_STIFFNESS_MARGIN = 1e-100, 1e-6
"""Smallest K_WTS [N.m/rad], and smallest K_FTS0/K_TS [1], for which the table can be computed."""
GAUSS_RULE = np.polynomial.legendre.leggauss(4)
"""Nodes and weights of the Gauss-Legendre quadrature of dT/K_WTS."""
HISTORY_LAYOUT = hysteresis.HISTORY_LAYOUT | friction.HISTORY_LAYOUT
"""History variables of the drive: hysteresis, then friction."""


def torque_curve(drive: DriveParameters) -> Curve:
    """Midline: torque [N.m] over wind-up phi >= 0 [rad]; it is odd.

    Prescribed by nodes, or computed: phi is the integral of dT/K_WTS. Nodes of the integral are evenly spaced
    in asinh(T/T_s), so they are dense around zero torque, where the stiffness changes most. Each step is
    integrated with four Gauss-Legendre nodes.

    Raises ValueError if spots of a contact pair would yield within the table, or if K_WTS is out of range.
    """
    check_limits(drive, drive.find_table_parameter_limits())
    if isinstance(drive, ContactPairDriveParameters):
        return refine_curve(lambda steps: _tabulate_midline(drive, steps), MIN_TABLE_STEPS)
    if isinstance(drive, PrescribedDriveParameters):
        x, y, s, slope_before, slope_after = np.array(drive.make_midline_nodes(), dtype=np.float64).T
        return Curve(x, y, s, slope_after[:-1], slope_before[1:])
    expected = "ContactPairDriveParameters nor PrescribedDriveParameters"
    raise TypeError(f"{type(drive).__name__} is neither {expected}")


def _tabulate_midline(drive: ContactPairDriveParameters, step_count: int) -> Curve:
    """Tabulate the midline, torque over wind-up, with a number of steps; see `torque_curve`."""
    smoothing = drive.torque_smoothing
    xi = np.linspace(0.0, np.arcsinh(drive.max_torque / smoothing), step_count + 1)
    T, half = smoothing * np.sinh(xi), 0.5 * xi[1]
    with np.errstate(all="ignore"):
        K, growth = stiffness_with_play(drive, T)
    if not np.all((K > MIN_STIFFNESS) & (K < (1.0 - MIN_STIFFNESS_MARGIN) * drive.K_FTS0)):
        raise ValueError(
            f"K_FTS0 = {drive.K_FTS0:g} N.m/rad and the contact pair give K_WTS = {K[-1]:g} N.m/rad, allowed "
            f"is ({MIN_STIFFNESS:g}, {drive.K_FTS0:g}) N.m/rad with K_TS at most "
            f"{1.0 / MIN_STIFFNESS_MARGIN:g} times K_FTS0"
        )
    inner = xi[:-1, None] + half * (1.0 + GAUSS_RULE[0])
    rate = smoothing * np.cosh(inner) / stiffness_with_play(drive, smoothing * np.sinh(inner))[0]
    phi = np.concatenate([[0.0], np.cumsum(half * rate @ GAUSS_RULE[1])])
    return assemble_curve([(phi, T, K, K * growth)])


@dataclass(frozen=True, slots=True)
class HarmonicDriveSpring:
    """Tabulated harmonic drive: motion in, torque out; or torque in, motion out.

    joint      : parameter set
    curve      : midline, torque [N.m] over wind-up [rad] >= 0
    hysteresis : friction torque added to the midline
    friction   : friction at the wave generator
    """

    joint: DriveParameters
    curve: Curve
    hysteresis: HysteresisSliders
    friction: FrictionSliders

    @classmethod
    def tabulate(cls, drive: DriveParameters) -> "HarmonicDriveSpring":
        """Tabulate the midline for a parameter set, and find the sliders of hysteresis and friction.

        Raises ValueError as `torque_curve` and `HysteresisSliders.for_drive` do.
        """
        curve = torque_curve(drive)
        return cls(drive, curve, HysteresisSliders.for_drive(drive, curve), FrictionSliders.for_drive(drive))

    def evaluate_motion(
        self,
        phi1: ArrayLike,
        w1: ArrayLike,
        phi2: ArrayLike,
        w2: ArrayLike,
        temperature: ArrayLike = REFERENCE_TEMPERATURE,
    ) -> dict[str, Array]:
        """Outputs after a straight path from the virgin state to a motion and temperatures (...) [K].

        phi1, w1, phi2, w2 : (...) [rad], [rad/s] angles and speeds of the flanges
        """
        return self.advance_motion((phi1, w1, phi2, w2), self.initial_history(), temperature)[0]

    def evaluate_torque(self, tau: ArrayLike) -> dict[str, Array]:
        """Outputs after a path from the virgin state to torques (...) [N.m], wave generator locked."""
        return self.advance_torque(tau, self.initial_history())[0]

    def initial_history(self) -> Array:
        """History variables (n) of the virgin state."""
        return HISTORY_LAYOUT.virgin_history()

    def advance_motion(
        self, motion: Sequence[ArrayLike], history: Array, temperature: ArrayLike = REFERENCE_TEMPERATURE
    ) -> tuple[dict[str, Array], Array]:
        """Compute outputs and new history variables after a straight path to a motion.

        motion      : phi1, w1, phi2, w2 (...) [rad, rad/s]
        history     : (n) history variables at the start of the path
        temperature : (...) [K] of the lubricant
        """
        motion = tuple(np.asarray(x, dtype=np.float64) for x in motion)
        kelvin = np.asarray(temperature, dtype=np.float64)
        hysteresis_history, friction_history = _split_history(history)
        error, slope, _ = kinematic_error(self.joint, motion[0])
        phi = wind_up(self.joint, motion, error)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        hysteresis_update = self.hysteresis.advance(hysteresis_history, phi)
        load = np.copysign(load, phi)
        state = SpringState(phi, load, stiffness, hysteresis_update.traction, error, slope)
        tau, ripple = (
            transmitted_torque(self.joint, motion, state),
            friction_ripple(self.joint, motion[0])[0],
        )
        friction_limits_ = friction_limits(self.joint, motion[1], tau, kelvin, ripple)
        friction_update = self.friction.advance(friction_history, motion[0], motion[1], friction_limits_)
        loss = (
            hysteresis.HISTORY_LAYOUT.split(hysteresis_history)["loss"]
            + hysteresis_update.dissipated_energy
            + friction_update.dissipated_energy
        )
        out = motion_outputs(self.joint, motion, kelvin, state, friction_update.traction) | {"E_loss": loss}
        new_friction = self.friction.pack_history(friction_update, motion[0], friction_limits_)
        return out, np.concatenate(
            [self.hysteresis.pack_history(hysteresis_update, phi, loss), new_friction], axis=-1
        )

    def advance_torque(self, tau: ArrayLike, history: Array) -> tuple[dict[str, Array], Array]:
        """Compute outputs and new history variables after a path to torques [N.m], wave generator locked."""
        hysteresis_history, friction_history = _split_history(history)
        if self.hysteresis.is_active:
            phi = self.hysteresis.solve_wind_up(self.curve, hysteresis_history, tau)
        else:
            phi = self.curve.odd_inverse(tau)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        update = self.hysteresis.advance(hysteresis_history, phi)
        loss = hysteresis.HISTORY_LAYOUT.split(hysteresis_history)["loss"] + update.dissipated_energy
        new = self.hysteresis.pack_history(update, phi, loss)
        locked = np.broadcast_to(friction_history, (*new.shape[:-1], friction_history.shape[-1]))
        out = {"phi_rel": phi, **stiffness_outputs(self.joint, load, stiffness), "E_loss": loss}
        return out, np.concatenate([new, locked], axis=-1)


def _split_history(history: Array) -> tuple[Array, Array]:
    """Split history variables (..., n) into history variables of hysteresis and of friction."""
    return history[..., : hysteresis.HISTORY_LAYOUT.size], history[..., hysteresis.HISTORY_LAYOUT.size :]


@dataclass(frozen=True, slots=True)
class SpringState:
    """State of the drive's spring at a motion: wind-up, midline, hysteresis and kinematic error.

    Values are numbers, arrays or symbols.

    phi_rel           : [rad] wind-up
    midline_torque    : [N.m] torque of the midline
    midline_stiffness : [N.m/rad] of the midline
    hysteresis_torque : [N.m] torque of the hysteresis
    phi_error         : [rad] kinematic error
    phi_error_slope   : [1] derivative of the kinematic error with respect to phi1
    """

    phi_rel: Number
    midline_torque: Number
    midline_stiffness: Number
    hysteresis_torque: Number
    phi_error: Number
    phi_error_slope: Number


def wind_up(drive: DriveParameters, motion: Sequence[Number], phi_error: Number) -> Number:
    """Wind-up phi_rel [rad] at the output, for (phi1, w1, phi2, w2) and the kinematic error [rad]."""
    phi1, _, phi2, _ = motion
    return phi2 - phi1 / drive.ratio - phi_error


def motion_outputs(
    drive: DriveParameters,
    motion: Sequence[Number],
    temperature: Number,
    spring_state: SpringState,
    dry_friction_torque: Number,
) -> dict[str, Number]:
    """Outputs of the spring except E_loss, at a motion (phi1, w1, phi2, w2).

    temperature         : [K] of the lubricant
    spring_state        : state of the spring at this motion
    dry_friction_torque : [N.m] at the wave generator
    """
    tau = transmitted_torque(drive, motion, spring_state)
    friction = dry_friction_torque + viscous_torque(drive, motion[1], temperature)
    w = mobility(drive.inertia1, 1.0 / drive.ratio) + mobility(drive.inertia2)
    at_once, side_by_side = largest_stable_steps(spring_state.midline_stiffness, drive.d, w)
    return {
        "tau1": tau / drive.ratio + spring_state.phi_error_slope * tau - friction,
        "tau2": -tau,
        "phi_rel": spring_state.phi_rel,
        "tau": tau,
        **stiffness_outputs(drive, spring_state.midline_torque, spring_state.midline_stiffness),
        "tau_friction": friction,
        "phi_error": spring_state.phi_error,
        "step_at_once": at_once,
        "step_side_by_side": side_by_side,
    }


def transmitted_torque(drive: DriveParameters, motion: Sequence[Number], spring_state: SpringState) -> Number:
    """Torque tau [N.m] at the output: sum of midline, hysteresis and damping."""
    _, w1, _, w2 = motion
    return (
        spring_state.midline_torque
        + spring_state.hysteresis_torque
        + drive.d * (w2 - w1 / drive.ratio - spring_state.phi_error_slope * w1)
    )


def stiffness_outputs(
    drive: DriveParameters, midline_torque: Number, midline_stiffness: Number
) -> dict[str, Number]:
    """Outputs K_WTS, K_TS, K_FTS, K_TS_pair [N.m/rad] and p_max [Pa] at a torque [N.m] of the midline.

    K_TS includes the lost motion; K_TS_pair is K_TS on the scale of Fig. 11 of Hu 2023.
    """
    K_TS = midline_stiffness * drive.K_FTS / (drive.K_FTS - midline_stiffness)
    return {
        "K_WTS": midline_stiffness,
        "K_TS": K_TS,
        "K_FTS": drive.K_FTS + 0.0 * midline_stiffness,
        "K_TS_pair": K_TS / drive.pair_stiffness_scale,
        "p_max": drive.pressure(midline_torque),
    }
