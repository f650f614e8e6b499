"""The exported harmonic drive: its table of torque over wind-up, and what it gives at a motion or torque."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...curve import Curve, assemble, refined
from ...quantity import Number, check_limits
from .drive import Drive
from .given import Given
from .hysteresis import Hysteresis, Slid
from .law import PairDrive, drive_stiffness

Array = NDArray[np.float64]

STEPS = 160
"""Steps of the torque curve, doubled until it is accurate enough."""
SOFTEST, STIFFEST = 1e-100, 1e-6
"""Least K_WTS [N.m/rad], and least K_FTS0 over K_TS [1], that are told from none and from infinite."""
GAUSS = np.polynomial.legendre.leggauss(4)


def torque_curve(drive: Drive) -> Curve:
    """Torque [N.m] over wind-up [rad] for phi >= 0 (the law is odd): as given, or the integral of dT/K_WTS.

    Nodes of the integral are evenly spaced in asinh(T/T_s), dense where the stiffness bends; the wind-up is
    integrated by four Gauss-Legendre nodes per step.

    Raises ValueError if spots of a contact pair would yield within the table.
    """
    check_limits(drive, drive.table_limits())
    if isinstance(drive, PairDrive):
        return refined(lambda steps: _windup(drive, steps), STEPS)
    if isinstance(drive, Given):
        x, y, s, before, after = np.array(drive.nodes(), dtype=np.float64).T
        return Curve(x, y, s, after[:-1], before[1:])
    raise TypeError(f"{type(drive).__name__} is no PairDrive and not Given")


def _windup(drive: PairDrive, steps: int) -> Curve:
    """The table with a number of steps."""
    smoothing = drive.torque_smoothing
    xi = np.linspace(0.0, np.arcsinh(drive.max_torque / smoothing), steps + 1)
    T, half = smoothing * np.sinh(xi), 0.5 * xi[1]
    with np.errstate(all="ignore"):
        K, growth = drive_stiffness(drive, T)
    if not np.all((K > SOFTEST) & (K < (1.0 - STIFFEST) * drive.K_FTS0)):
        raise ValueError(
            f"K_FTS0 = {drive.K_FTS0:g} N.m/rad and the contact pair give K_WTS = {K[-1]:g} N.m/rad, allowed "
            f"is ({SOFTEST:g}, {drive.K_FTS0:g}) N.m/rad with K_TS at most {1.0 / STIFFEST:g} times K_FTS0"
        )
    inner = xi[:-1, None] + half * (1.0 + GAUSS[0])
    rate = smoothing * np.cosh(inner) / drive_stiffness(drive, smoothing * np.sinh(inner))[0]
    phi = np.concatenate([[0.0], np.cumsum(half * rate @ GAUSS[1])])
    return assemble([(phi, T, K, K * growth)])


@dataclass(frozen=True, slots=True)
class HarmonicDriveSpring:
    """The exported spring: motion in, torque out; and torque in, motion out."""

    joint: Drive
    curve: Curve
    hysteresis: Hysteresis

    @classmethod
    def of(cls, drive: Drive) -> "HarmonicDriveSpring":
        """Tabulate a drive.

        Raises ValueError as `torque_curve` and `Hysteresis.of`.
        """
        curve = torque_curve(drive)
        return cls(drive, curve, Hysteresis.of(drive, curve))

    def motion(self, phi1: ArrayLike, w1: ArrayLike, phi2: ArrayLike, w2: ArrayLike) -> dict[str, Array]:
        """Torques and stiffnesses at flange angles [rad] and speeds [rad/s] (...), on the way from rest."""
        return self.driven((phi1, w1, phi2, w2), self.hysteresis.rest())[0]

    def windup(self, tau: ArrayLike) -> dict[str, Array]:
        """Wind-up and stiffnesses at torques (...) [N.m], wave generator locked, on the way from rest."""
        return self.loaded(tau, self.hysteresis.rest())[0]

    def driven(self, motion: Sequence[ArrayLike], memory: Array) -> tuple[dict[str, Array], Array]:
        """What the spring exports at phi1, w1, phi2, w2 (...), from a memory (n + 2) on, and the new one."""
        motion = tuple(np.asarray(x, dtype=np.float64) for x in motion)
        phi = wind_up(self.joint, motion)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        slid, loss, new = self._slid(phi, memory)
        load = np.copysign(load, phi)
        return torques(self.joint, motion, load, stiffness, slid.torque) | {"E_loss": loss}, new

    def loaded(self, tau: ArrayLike, memory: Array) -> tuple[dict[str, Array], Array]:
        """Wind-up and stiffnesses at torques (...), from a memory (n + 2) on, and the new one."""
        if self.hysteresis.acts:
            phi = self.hysteresis.wind_up(self.curve, memory, tau)
        else:
            phi = np.copysign(self.curve.inverse(np.abs(tau)), tau)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        _, loss, new = self._slid(phi, memory)
        return {"phi_rel": phi, **parts(self.joint, load, stiffness), "E_loss": loss}, new

    def _slid(self, phi: Array, memory: Array) -> tuple[Slid, Array, Array]:
        """The sliders at wind-ups (...), the loss so far, the memory (..., n + 2)."""
        slid = self.hysteresis.moved(memory, phi)
        loss = memory[..., -1] + slid.loss
        return slid, loss, np.concatenate([slid.force, phi[..., None], loss[..., None]], axis=-1)


def wind_up(drive: Drive, motion: Sequence[Number]) -> Number:
    """phi_rel [rad], the wind-up at the output, for phi1, w1, phi2, w2."""
    phi1, _, phi2, _ = motion
    return phi2 - phi1 / drive.ratio


def torques(
    drive: Drive, motion: Sequence[Number], load: Number, stiffness: Number, friction: Number
) -> dict[str, Number]:
    """What the spring exports at a motion phi1, w1, phi2, w2, but for the loss.

    Given are torque [N.m] and stiffness [N.m/rad] of the curve there, and the torque [N.m] of friction.
    """
    _, w1, _, w2 = motion
    tau = load + friction + drive.d * (w2 - w1 / drive.ratio)
    ends = {"tau1": tau / drive.ratio, "tau2": -tau, "phi_rel": wind_up(drive, motion), "tau": tau}
    return {**ends, **parts(drive, load, stiffness)}


def parts(drive: Drive, load: Number, stiffness: Number) -> dict[str, Number]:
    """K_WTS and its parts at an elastic torque, and the peak contact pressure.

    K_TS_pair is K_TS on the scale of the paper's Fig. 11.
    """
    K_TS = stiffness * drive.K_FTS / (drive.K_FTS - stiffness)
    return {
        "K_WTS": stiffness,
        "K_TS": K_TS,
        "K_FTS": drive.K_FTS + 0.0 * stiffness,
        "K_TS_pair": K_TS / drive.pair_units,
        "p_max": drive.pressure(load),
    }
