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

MIN_MIDLINE_TABLE_STEPS = 160
"""Initial number of steps of the midline's table [1]; doubled until the table is accurate."""
MIN_DRIVE_STIFFNESS, MIN_FLEXSPLINE_OVER_CONTACT_STIFFNESS = 1e-100, 1e-6
"""Smallest K_WTS [N.m/rad], and smallest K_FTS0/K_TS [1], for which the table can be computed."""
GAUSS_NODES_AND_WEIGHTS = np.polynomial.legendre.leggauss(4)
"""Nodes and weights of the Gauss-Legendre quadrature of dT/K_WTS."""
HISTORY_LAYOUT = hysteresis.HISTORY_LAYOUT | friction.HISTORY_LAYOUT
"""History variables of the drive: hysteresis, then friction."""


def torque_curve(drive_parameters: DriveParameters) -> Curve:
    """Midline of a drive, without hysteresis: torque T [N.m] as a function of wind-up phi >= 0 [rad].

    The midline is odd. It is prescribed by nodes, or computed: phi is the integral of dT/K_WTS, with the
    stiffness K_WTS of the drive. Nodes of the integral are evenly spaced in asinh(T/T_s), with
    torque_smoothing T_s, so they are dense around zero torque, where the stiffness changes most. Each step is
    integrated with four Gauss-Legendre nodes.

    Raises ValueError if spots of a contact pair would yield within the table, or if K_WTS is out of range.
    """
    check_limits(drive_parameters, drive_parameters.find_table_parameter_limits())
    if isinstance(drive_parameters, ContactPairDriveParameters):
        return refine_curve(lambda steps: _tabulate_midline(drive_parameters, steps), MIN_MIDLINE_TABLE_STEPS)
    if isinstance(drive_parameters, PrescribedDriveParameters):
        x, y, s, slope_before, slope_after = np.array(
            drive_parameters.make_midline_nodes(), dtype=np.float64
        ).T
        return Curve(x, y, s, slope_after[:-1], slope_before[1:])
    expected = "ContactPairDriveParameters nor PrescribedDriveParameters"
    raise TypeError(f"{type(drive_parameters).__name__} is neither {expected}")


def _tabulate_midline(drive_parameters: ContactPairDriveParameters, step_count: int) -> Curve:
    """Tabulate the midline, torque as a function of wind-up, with a number of steps up to max_torque."""
    smoothing = drive_parameters.torque_smoothing
    xi = np.linspace(0.0, np.arcsinh(drive_parameters.max_torque / smoothing), step_count + 1)
    T, half = smoothing * np.sinh(xi), 0.5 * xi[1]
    with np.errstate(all="ignore"):
        K, growth = stiffness_with_play(drive_parameters, T)
    if not np.all(
        (K > MIN_DRIVE_STIFFNESS)
        & (K < (1.0 - MIN_FLEXSPLINE_OVER_CONTACT_STIFFNESS) * drive_parameters.K_FTS0)
    ):
        raise ValueError(
            f"drive stiffness K_WTS = {K[-1]:g} N.m/rad, of the contact pair in series with the flexspline "
            f"K_FTS0 = {drive_parameters.K_FTS0:g} N.m/rad, is outside ({MIN_DRIVE_STIFFNESS:g}, "
            f"{drive_parameters.K_FTS0:g}) N.m/rad, or the contact pair is more than "
            f"{1.0 / MIN_FLEXSPLINE_OVER_CONTACT_STIFFNESS:g} times as stiff as K_FTS0; check K_FTS0 and the "
            "surface"
        )
    inner = xi[:-1, None] + half * (1.0 + GAUSS_NODES_AND_WEIGHTS[0])
    rate = smoothing * np.cosh(inner) / stiffness_with_play(drive_parameters, smoothing * np.sinh(inner))[0]
    phi = np.concatenate([[0.0], np.cumsum(half * rate @ GAUSS_NODES_AND_WEIGHTS[1])])
    return assemble_curve([(phi, T, K, K * growth)])


@dataclass(frozen=True, slots=True)
class HarmonicDriveSpring:
    """Tabulated harmonic drive: motion in, torque out; or torque in, motion out.

    joint      : parameter set
    curve      : midline, torque [N.m] as a function of wind-up [rad] >= 0, without hysteresis
    hysteresis : spring-slider elements whose friction torque is added to the midline
    friction   : spring-slider elements of the dry friction at the wave generator
    """

    joint: DriveParameters
    curve: Curve
    hysteresis: HysteresisSliders
    friction: FrictionSliders

    @classmethod
    def tabulate(cls, drive_parameters: DriveParameters) -> "HarmonicDriveSpring":
        """Tabulate the midline of a parameter set, and find the sliders of hysteresis and dry friction.

        Raises ValueError as `torque_curve` and `HysteresisSliders.from_drive` do.
        """
        curve = torque_curve(drive_parameters)
        return cls(
            drive_parameters,
            curve,
            HysteresisSliders.from_drive(drive_parameters, curve),
            FrictionSliders.from_drive(drive_parameters),
        )

    def evaluate_motion(
        self,
        phi1: ArrayLike,
        w1: ArrayLike,
        phi2: ArrayLike,
        w2: ArrayLike,
        temperature: ArrayLike = REFERENCE_TEMPERATURE,
    ) -> dict[str, Array]:
        """Evaluate all outputs after a straight path from the virgin state to a motion of the flanges.

        temperature        : (...) [K] of the lubricant

        phi1, w1, phi2, w2 : (...) [rad], [rad/s] angles and speeds of the flanges
        """
        return self.advance_motion((phi1, w1, phi2, w2), self.initial_history(), temperature)[0]

    def evaluate_torque(self, tau: ArrayLike) -> dict[str, Array]:
        """Evaluate outputs on a path from the virgin state to torques [N.m], with locked wave generator."""
        return self.advance_torque(tau, self.initial_history())[0]

    def initial_history(self) -> Array:
        """History variables (n) of hysteresis and dry friction in the virgin state: all zero."""
        return HISTORY_LAYOUT.virgin_history()

    def advance_motion(
        self,
        flange_motion: Sequence[ArrayLike],
        history_variables: Array,
        temperature: ArrayLike = REFERENCE_TEMPERATURE,
    ) -> tuple[dict[str, Array], Array]:
        """Compute outputs and new history variables after a straight path to a motion of the flanges.

        flange_motion : (...) angles and speeds phi1, w1, phi2, w2 [rad, rad/s] at the end of the path
        history_variables : (n) history variables at the start of the path
        temperature   : (...) [K] of the lubricant
        """
        flange_motion = tuple(np.asarray(x, dtype=np.float64) for x in flange_motion)
        kelvin = np.asarray(temperature, dtype=np.float64)
        hysteresis_history, friction_history = _split_history(history_variables)
        error, slope, _ = kinematic_error(self.joint, flange_motion[0])
        phi = wind_up(self.joint, flange_motion, error)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        hysteresis_update = self.hysteresis.advance(hysteresis_history, phi)
        load = np.copysign(load, phi)
        state = SpringState(phi, load, stiffness, hysteresis_update.traction, error, slope)
        tau, ripple = (
            transmitted_torque(self.joint, flange_motion, state),
            friction_ripple(self.joint, flange_motion[0])[0],
        )
        friction_limits_ = friction_limits(self.joint, flange_motion[1], tau, kelvin, ripple)
        friction_update = self.friction.advance(
            friction_history, flange_motion[0], flange_motion[1], friction_limits_
        )
        loss = (
            hysteresis.HISTORY_LAYOUT.split(hysteresis_history)["loss"]
            + hysteresis_update.dissipated_energy
            + friction_update.dissipated_energy
        )
        out = motion_outputs(self.joint, flange_motion, kelvin, state, friction_update.traction) | {
            "E_loss": loss
        }
        new_friction = self.friction.pack_history(friction_update, flange_motion[0], friction_limits_)
        return out, np.concatenate(
            [self.hysteresis.pack_history(hysteresis_update, phi, loss), new_friction], axis=-1
        )

    def advance_torque(self, tau: ArrayLike, history_variables: Array) -> tuple[dict[str, Array], Array]:
        """Compute outputs and new history variables after a path to torques [N.m], wave generator locked."""
        hysteresis_history, friction_history = _split_history(history_variables)
        if self.hysteresis.has_friction:
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


def _split_history(history_variables: Array) -> tuple[Array, Array]:
    """Split history variables (..., n) into history variables of hysteresis and of friction."""
    return history_variables[..., : hysteresis.HISTORY_LAYOUT.value_count], history_variables[
        ..., hysteresis.HISTORY_LAYOUT.value_count :
    ]


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


def wind_up(drive_parameters: DriveParameters, flange_motion: Sequence[Number], phi_error: Number) -> Number:
    """Wind-up [rad] at the output: phi2 - phi1/ratio - kinematic error.

    flange_motion : angles and speeds phi1, w1, phi2, w2 of wave generator (1) and output (2)
    phi_error     : [rad] kinematic error
    """
    phi1, _, phi2, _ = flange_motion
    return phi2 - phi1 / drive_parameters.ratio - phi_error


def motion_outputs(
    drive_parameters: DriveParameters,
    flange_motion: Sequence[Number],
    temperature: Number,
    spring_state: SpringState,
    dry_friction_torque: Number,
) -> dict[str, Number]:
    """Outputs of the drive at a motion of the flanges, except the dissipated energy E_loss.

    flange_motion       : angles and speeds phi1, w1, phi2, w2 of wave generator (1) and output (2)
    temperature         : [K] of the lubricant
    spring_state        : state of the spring at this motion
    dry_friction_torque : [N.m] at the wave generator
    """
    tau = transmitted_torque(drive_parameters, flange_motion, spring_state)
    friction = dry_friction_torque + viscous_torque(drive_parameters, flange_motion[1], temperature)
    w = mobility(drive_parameters.inertia1, 1.0 / drive_parameters.ratio) + mobility(
        drive_parameters.inertia2
    )
    at_once, side_by_side = largest_stable_steps(spring_state.midline_stiffness, drive_parameters.d, w)
    return {
        "tau1": tau / drive_parameters.ratio + spring_state.phi_error_slope * tau - friction,
        "tau2": -tau,
        "phi_rel": spring_state.phi_rel,
        "tau": tau,
        **stiffness_outputs(drive_parameters, spring_state.midline_torque, spring_state.midline_stiffness),
        "tau_friction": friction,
        "phi_error": spring_state.phi_error,
        "step_at_once": at_once,
        "step_side_by_side": side_by_side,
    }


def transmitted_torque(
    drive_parameters: DriveParameters, flange_motion: Sequence[Number], spring_state: SpringState
) -> Number:
    """Torque tau [N.m] at the output: sum of midline, hysteresis and damping."""
    _, w1, _, w2 = flange_motion
    return (
        spring_state.midline_torque
        + spring_state.hysteresis_torque
        + drive_parameters.d * (w2 - w1 / drive_parameters.ratio - spring_state.phi_error_slope * w1)
    )


def stiffness_outputs(
    drive_parameters: DriveParameters, midline_torque: Number, midline_stiffness: Number
) -> dict[str, Number]:
    """Stiffness outputs [N.m/rad] and peak contact pressure p_max [Pa] at a torque [N.m] of the midline.

    K_WTS     : torsional stiffness of the whole drive: K_FTS and K_TS in series
    K_FTS     : of the flexspline and the circular spline
    K_TS      : of the contact pair, with lost motion
    K_TS_pair : K_TS on the scale of Fig. 11 of Hu 2023
    """
    K_TS = midline_stiffness * drive_parameters.K_FTS / (drive_parameters.K_FTS - midline_stiffness)
    return {
        "K_WTS": midline_stiffness,
        "K_TS": K_TS,
        "K_FTS": drive_parameters.K_FTS + 0.0 * midline_stiffness,
        "K_TS_pair": K_TS / drive_parameters.contact_pair_stiffness_scale,
        "p_max": drive_parameters.pressure(midline_torque),
    }
