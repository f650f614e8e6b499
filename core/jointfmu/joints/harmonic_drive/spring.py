"""The exported harmonic drive: tables of stiffness and wind-up, and what it gives at a motion or torque."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...curve import Curve, assemble, refined
from ...quantity import Number, check_limits
from ...table import Blocks, stiffness_tables
from .law import HarmonicDrive, in_series, peak_pressure, pieces

Array = NDArray[np.float64]

PAIR_STEPS = 25
"""Steps of the torque curve per four cells of the pair's table and unit of log-pressure [1]."""
MOST_PAIR_STEPS = 256
"""Times four: the most cells of the pair's table."""
STEPS = 160
"""Steps of the torque curve, doubled until it is accurate enough."""
SOFTEST, STIFFEST = 1e-100, 1e-6
"""Least K_WTS [N.m/rad], and least K_FTS0 over K_TS [1], that are told from none and from infinite."""
GAUSS = np.polynomial.legendre.leggauss(4)


def pair_table(drive: HarmonicDrive, steps: int) -> tuple[Blocks, float]:
    """`pair_stiffness` over the log of the peak pressure, with its largest relative interpolation error.

    The stiffness of the nodes comes from tables over the log-pressure instead of an inversion each,
    which makes it hundreds of times faster. Below the last edge there is no stiffness.
    """
    low, high = (float(peak_pressure(drive, torque)[0]) for torque in (0.0, drive.max_torque))
    edges, tables = stiffness_tables(drive.law, high)
    cells = 4 * int(np.clip(np.ceil(steps / PAIR_STEPS * np.log(high / low)), 1, MOST_PAIR_STEPS))
    x = np.linspace(np.log(low), np.log(high), cells + 1)
    value, slope = np.zeros((2, cells + 1))
    for piece, table in zip(pieces(drive, np.exp(x), edges), reversed(tables), strict=False):
        point = piece.point
        (normal, tangential), (normal_slope, tangential_slope) = table(np.log(point.pressure))
        along = point.along**2
        across = point.square - along
        rise = piece.share * piece.axis / point.pressure
        value += np.sum(piece.share * (normal * along + tangential * across), axis=(1, 2))
        slope += np.sum(rise * (normal_slope * along + tangential_slope * across), axis=(1, 2))
    value, slope = drive.pair_scale * value[None], drive.pair_scale * slope[None]
    fine = Blocks.of(x[0], x[1] - x[0], value, slope)
    coarse = Blocks.of(x[0], x[2] - x[0], value[:, ::2], slope[:, ::2])
    points = x[:-1, None] + (x[1] - x[0]) * np.array([0.25, 0.5, 0.75])
    exact = fine(points)[0]
    with np.errstate(invalid="ignore"):
        return fine, float(np.max(np.abs(coarse(points)[0] / exact - 1.0)) / 2.0)


def torque_curve(drive: HarmonicDrive) -> Curve:
    """Torque [N.m] over wind-up [rad] for phi >= 0 (the law is odd): the integral of dT/K_WTS.

    Nodes are evenly spaced in asinh(T/T_s), dense where the stiffness bends; the wind-up is integrated
    by four Gauss-Legendre nodes per step.

    Raises ValueError if the two lobes would meet within the table, where K_TS has a kink.
    """
    check_limits(drive, drive.table_limits())
    return refined(lambda steps: _windup(drive, steps), STEPS)


def _windup(drive: HarmonicDrive, steps: int) -> Curve:
    """The table with a number of steps."""
    smoothing = drive.torque_smoothing
    xi = np.linspace(0.0, np.arcsinh(drive.max_torque / smoothing), steps + 1)
    T, half = smoothing * np.sinh(xi), 0.5 * xi[1]
    table, error = pair_table(drive, steps)

    def stiffness(torque: Array) -> tuple[Array, Array]:
        peak, rise = peak_pressure(drive, torque)
        (pair,), (slope,) = table(np.log(peak))
        with np.errstate(divide="ignore", invalid="ignore"):
            return in_series(drive, pair, slope / peak * rise)

    K, growth = stiffness(T)
    if not np.all((K > SOFTEST) & (K < (1.0 - STIFFEST) * drive.K_FTS0)):
        raise ValueError(
            f"K_FTS0 = {drive.K_FTS0:g} N.m/rad, pair_scale = {drive.pair_scale:g} and drive_scale = "
            f"{drive.drive_scale:g} give K_WTS = {K[-1]:g} N.m/rad, allowed is ({SOFTEST:g}, "
            f"{drive.K_FTS0:g}) N.m/rad with K_TS at most {1.0 / STIFFEST:g} times K_FTS0"
        )
    inner = xi[:-1, None] + half * (1.0 + GAUSS[0])
    rate = smoothing * np.cosh(inner) / stiffness(smoothing * np.sinh(inner))[0]
    phi = np.concatenate([[0.0], np.cumsum(half * rate @ GAUSS[1])])
    return assemble([(phi, T, K, K * growth)], error)


@dataclass(frozen=True, slots=True)
class HarmonicDriveSpring:
    """The exported spring: motion in, torque out; and torque in, motion out."""

    joint: HarmonicDrive
    curve: Curve

    @classmethod
    def of(cls, drive: HarmonicDrive) -> "HarmonicDriveSpring":
        """Tabulate a drive."""
        return cls(drive, torque_curve(drive))

    def motion(self, phi1: ArrayLike, w1: ArrayLike, phi2: ArrayLike, w2: ArrayLike) -> dict[str, Array]:
        """Torques and stiffnesses at flange angles [rad] and speeds [rad/s] (...)."""
        motion = tuple(np.asarray(x, dtype=np.float64) for x in (phi1, w1, phi2, w2))
        phi = wind_up(self.joint, motion)
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        return torques(self.joint, motion, np.copysign(load, phi), stiffness)

    def windup(self, tau: ArrayLike) -> dict[str, Array]:
        """Wind-up and stiffnesses at torques (...) [N.m] with the wave generator locked."""
        phi = self.curve.inverse(np.abs(tau))
        load, stiffness = self.curve.derivatives(phi, 1)
        return {"phi_rel": np.copysign(phi, tau), **parts(self.joint, load, stiffness)}


def wind_up(drive: HarmonicDrive, motion: Sequence[Number]) -> Number:
    """phi_rel [rad], the wind-up at the output, for phi1, w1, phi2, w2."""
    phi1, _, phi2, _ = motion
    return phi2 - phi1 / drive.ratio


def torques(
    drive: HarmonicDrive, motion: Sequence[Number], load: Number, stiffness: Number
) -> dict[str, Number]:
    """What the spring exports at a motion phi1, w1, phi2, w2.

    Given are torque [N.m] and stiffness [N.m/rad] of the curve there.
    """
    _, w1, _, w2 = motion
    tau = load + drive.d * (w2 - w1 / drive.ratio)
    ends = {"tau1": tau / drive.ratio, "tau2": -tau, "phi_rel": wind_up(drive, motion), "tau": tau}
    return {**ends, **parts(drive, load, stiffness)}


def parts(drive: HarmonicDrive, load: Number, stiffness: Number) -> dict[str, Number]:
    """K_WTS and its parts at an elastic torque, and the peak contact pressure.

    K_TS_pair is K_TS on the scale of the paper's Fig. 11.
    """
    K_TS = stiffness * drive.K_FTS0 / (drive.K_FTS0 - stiffness)
    return {
        "K_WTS": stiffness,
        "K_TS": K_TS,
        "K_FTS": drive.K_FTS0 + 0.0 * stiffness,
        "K_TS_pair": K_TS / drive.drive_scale,
        "p_max": peak_pressure(drive, load)[0],
    }
