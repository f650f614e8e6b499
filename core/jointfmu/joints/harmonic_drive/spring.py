"""Tabulated harmonic drive: midline (torque over wind-up), and outputs for a motion or a torque."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...mechanics.curve import Curve, assemble, refined
from ...mechanics.steps import mobility, stable_steps
from ...quantity import Array, Number, check_limits
from . import friction, hysteresis
from .drive import Drive, kinematic_error
from .friction import REFERENCE, Friction, limits, viscous
from .given import Given
from .hysteresis import Hysteresis
from .law import PairDrive, stiffness_with_play

STEPS = 160
"""Initial number of steps of the midline's table [1]; doubled until the table is accurate."""
SOFTEST, STIFFEST = 1e-100, 1e-6
"""Smallest K_WTS [N.m/rad], and smallest K_FTS0/K_TS [1], for which the table can be computed."""
GAUSS = np.polynomial.legendre.leggauss(4)
MEMORY = hysteresis.MEMORY | friction.MEMORY
"""History variables of the drive: hysteresis, then friction."""


def torque_curve(drive: Drive) -> Curve:
    """Midline: torque [N.m] over wind-up phi >= 0 [rad]; it is odd.

    Prescribed by nodes, or computed: phi is the integral of dT/K_WTS. Nodes of the integral are evenly spaced
    in asinh(T/T_s), so they are dense around zero torque, where the stiffness changes most. Each step is
    integrated with four Gauss-Legendre nodes.

    Raises ValueError if spots of a contact pair would yield within the table, or if K_WTS is out of range.
    """
    check_limits(drive, drive.table_limits())
    if isinstance(drive, PairDrive):
        return refined(lambda steps: _windup(drive, steps), STEPS)
    if isinstance(drive, Given):
        x, y, s, slope_before, slope_after = np.array(drive.nodes(), dtype=np.float64).T
        return Curve(x, y, s, slope_after[:-1], slope_before[1:])
    raise TypeError(f"{type(drive).__name__} is no PairDrive and not Given")


def _windup(drive: PairDrive, steps: int) -> Curve:
    """Table of the midline with `steps` steps, see `torque_curve`."""
    smoothing = drive.torque_smoothing
    xi = np.linspace(0.0, np.arcsinh(drive.max_torque / smoothing), steps + 1)
    T, half = smoothing * np.sinh(xi), 0.5 * xi[1]
    with np.errstate(all="ignore"):
        K, growth = stiffness_with_play(drive, T)
    if not np.all((K > SOFTEST) & (K < (1.0 - STIFFEST) * drive.K_FTS0)):
        raise ValueError(
            f"K_FTS0 = {drive.K_FTS0:g} N.m/rad and the contact pair give K_WTS = {K[-1]:g} N.m/rad, allowed "
            f"is ({SOFTEST:g}, {drive.K_FTS0:g}) N.m/rad with K_TS at most {1.0 / STIFFEST:g} times K_FTS0"
        )
    inner = xi[:-1, None] + half * (1.0 + GAUSS[0])
    rate = smoothing * np.cosh(inner) / stiffness_with_play(drive, smoothing * np.sinh(inner))[0]
    phi = np.concatenate([[0.0], np.cumsum(half * rate @ GAUSS[1])])
    return assemble([(phi, T, K, K * growth)])


@dataclass(frozen=True, slots=True)
class HarmonicDriveSpring:
    """Tabulated harmonic drive: motion in, torque out; or torque in, motion out.

    joint      : parameter set
    curve      : midline, torque [N.m] over wind-up [rad] >= 0
    hysteresis : friction torque added to the midline
    friction   : friction at the wave generator
    """

    joint: Drive
    curve: Curve
    hysteresis: Hysteresis
    friction: Friction

    @classmethod
    def of(cls, drive: Drive) -> "HarmonicDriveSpring":
        """Tabulate a parameter set.

        Raises ValueError as `torque_curve` and `Hysteresis.for_drive` do.
        """
        curve = torque_curve(drive)
        return cls(drive, curve, Hysteresis.of(drive, curve), Friction.of(drive))

    def motion(
        self,
        phi1: ArrayLike,
        w1: ArrayLike,
        phi2: ArrayLike,
        w2: ArrayLike,
        temperature: ArrayLike = REFERENCE,
    ) -> dict[str, Array]:
        """Outputs at flange angles [rad], speeds [rad/s] and temperatures [K] (...), after a straight path
        from the virgin state.
        """
        return self.driven((phi1, w1, phi2, w2), self.rest(), temperature)[0]

    def windup(self, tau: ArrayLike) -> dict[str, Array]:
        """Outputs at torques (...) [N.m] after a path from the virgin state, wave generator locked."""
        return self.loaded(tau, self.rest())[0]

    def rest(self) -> Array:
        """History variables (n) of the virgin state."""
        return MEMORY.rest()

    def driven(
        self, motion: Sequence[ArrayLike], memory: Array, temperature: ArrayLike = REFERENCE
    ) -> tuple[dict[str, Array], Array]:
        """Outputs and new history variables after a straight path to a motion.

        motion      : phi1, w1, phi2, w2 (...) [rad, rad/s]
        history     : (n) history variables at the start of the path
        temperature : (...) [K] of the lubricant
        """
        motion = tuple(np.asarray(x, dtype=np.float64) for x in motion)
        kelvin = np.asarray(temperature, dtype=np.float64)
        hysteresis_history, friction_history = _parts(memory)
        error, slope, _ = kinematic_error(self.joint, motion[0])
        phi = wind_up(self.joint, motion, error)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        hysteresis_update = self.hysteresis.moved(hysteresis_history, phi)
        load = np.copysign(load, phi)
        state = State(phi, load, stiffness, hysteresis_update.traction, error, slope)
        friction_limits_ = limits(self.joint, motion[1], transmitted(self.joint, motion, state), kelvin)
        friction_update = self.friction.moved(friction_history, motion[0], motion[1], friction_limits_)
        loss = (
            hysteresis.MEMORY.split(hysteresis_history)["loss"]
            + hysteresis_update.loss
            + friction_update.loss
        )
        out = exported(self.joint, motion, kelvin, state, friction_update.traction) | {"E_loss": loss}
        new_friction = self.friction.after(friction_update, motion[0], friction_limits_)
        return out, np.concatenate(
            [self.hysteresis.after(hysteresis_update, phi, loss), new_friction], axis=-1
        )

    def loaded(self, tau: ArrayLike, memory: Array) -> tuple[dict[str, Array], Array]:
        """Outputs and new history variables after a path to torques tau (...) [N.m], phi1 locked."""
        hysteresis_history, friction_history = _parts(memory)
        if self.hysteresis.acts:
            phi = self.hysteresis.wind_up(self.curve, hysteresis_history, tau)
        else:
            phi = self.curve.odd_inverse(tau)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        update = self.hysteresis.moved(hysteresis_history, phi)
        loss = hysteresis.MEMORY.split(hysteresis_history)["loss"] + update.loss
        new = self.hysteresis.after(update, phi, loss)
        locked = np.broadcast_to(friction_history, (*new.shape[:-1], friction_history.shape[-1]))
        out = {"phi_rel": phi, **parts(self.joint, load, stiffness), "E_loss": loss}
        return out, np.concatenate([new, locked], axis=-1)


def _parts(memory: Array) -> tuple[Array, Array]:
    """History variables (..., n) of the hysteresis and of the friction."""
    return memory[..., : hysteresis.MEMORY.size], memory[..., hysteresis.MEMORY.size :]


@dataclass(frozen=True, slots=True)
class State:
    """State of the spring at a motion: numbers, arrays or symbols.

    phi_rel   : [rad] wind-up
    load      : [N.m] torque of the midline
    stiffness : [N.m/rad] of the midline
    friction  : [N.m] torque of the hysteresis
    error     : [rad] kinematic error
    slope     : [1] derivative of the kinematic error with respect to phi1
    """

    phi_rel: Number
    load: Number
    stiffness: Number
    friction: Number
    error: Number
    slope: Number


def wind_up(drive: Drive, motion: Sequence[Number], error: Number) -> Number:
    """Wind-up phi_rel [rad] at the output, for (phi1, w1, phi2, w2) and the kinematic error [rad]."""
    phi1, _, phi2, _ = motion
    return phi2 - phi1 / drive.ratio - error


def exported(
    drive: Drive, motion: Sequence[Number], temperature: Number, state: State, dry: Number
) -> dict[str, Number]:
    """Outputs of the spring except E_loss, at a motion (phi1, w1, phi2, w2).

    temperature  : [K] of the lubricant
    state        : state of the spring at this motion
    dry_friction : [N.m] at the wave generator
    """
    tau, friction = transmitted(drive, motion, state), dry + viscous(drive, motion[1], temperature)
    w = mobility(drive.inertia1, 1.0 / drive.ratio) + mobility(drive.inertia2)
    at_once, side_by_side = stable_steps(state.stiffness, drive.d, w)
    return {
        "tau1": tau / drive.ratio + state.slope * tau - friction,
        "tau2": -tau,
        "phi_rel": state.phi_rel,
        "tau": tau,
        **parts(drive, state.load, state.stiffness),
        "tau_friction": friction,
        "phi_error": state.error,
        "step_at_once": at_once,
        "step_side_by_side": side_by_side,
    }


def transmitted(drive: Drive, motion: Sequence[Number], state: State) -> Number:
    """Torque tau [N.m] at the output: sum of midline, hysteresis and damping."""
    _, w1, _, w2 = motion
    return state.load + state.friction + drive.d * (w2 - w1 / drive.ratio - state.slope * w1)


def parts(drive: Drive, load: Number, stiffness: Number) -> dict[str, Number]:
    """Outputs K_WTS, K_TS, K_FTS, K_TS_pair [N.m/rad] and p_max [Pa] at a torque `load` of the midline.

    K_TS includes the lost motion; K_TS_pair is K_TS on the scale of Fig. 11 of Hu 2023.
    """
    K_TS = stiffness * drive.K_FTS / (drive.K_FTS - stiffness)
    return {
        "K_WTS": stiffness,
        "K_TS": K_TS,
        "K_FTS": drive.K_FTS + 0.0 * stiffness,
        "K_TS_pair": K_TS / drive.pair_units,
        "p_max": drive.pressure(load),
    }
