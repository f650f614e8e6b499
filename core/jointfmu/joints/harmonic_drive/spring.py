"""Torsional spring of a harmonic drive: contact of flexspline and flexible bearing (Hu 2023)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...asperity.hu2023 import Hu2023
from ...curve import Curve, assemble, refined
from ...footprint import lobes
from ...footprint.lobes import Lobe, Piece, lobe, lobe_pieces, two_lobes
from ...footprint.nodes import Footprint
from ...interface import checked_spots, largest_spot
from ...quantity import Interval, Limit, Number, check, check_limits, choice, group, quantity, where
from ...surface import ArealSurface, Elastic, ElasticPlastic
from ...table import Blocks, stiffness_tables

Array = NDArray[np.float64]

_AXIS = (0.0, 0.0, 1.0)
PAIR_STEPS = 25
"""Steps of the torque curve per four cells of the pair's table and unit of log-pressure [1]."""
MOST_PAIR_STEPS = 256
"""Times four: the most cells of the pair's table."""
STEPS = 160
"""Steps of the torque curve, doubled until it is accurate enough."""
SOFTEST, STIFFEST = 1e-100, 1e-6
"""Least K_WTS [N.m/rad], and least K_FTS0 over K_TS [1], that are told from none and from infinite."""
GAUSS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True, kw_only=True)
class HarmonicDrive:
    """Parameters of the harmonic drive; what `calibration` marks was fitted to published points."""

    surface: ArealSurface = group("equivalent rough surface of the contact pair")
    flexspline: ElasticPlastic = group("flexspline")
    bearing: ElasticPlastic = group("outer ring of the flexible bearing")
    mu: float = quantity("1", "coefficient of static friction, if traction is real_area", gt=0.0)
    traction_ratio: float = quantity("1", "shear over friction limit, x = T/(mu P)", ge=0.0, lt=1.0)
    shear_traction: float = quantity("Pa", "shear traction on the real area, if traction is so", gt=0.0)
    A_0: float = quantity("m2", "nominal area of the contact pair", gt=0.0)
    radius: float = quantity("m", "mean radius of the contact pair", gt=0.0)
    cup_length: float = quantity("m", "length over which the radial deformation tapers to zero", gt=0.0)
    radial_deformation: float = quantity("m", "radial deformation w of the flexspline", gt=0.0, lt=2e-3)
    eccentricity: float = quantity(
        "m", "installation eccentricity of flexspline and bearing", ge=0.0, lt=1e-3
    )
    ratio: float = quantity("1", "speed ratio of wave generator and output", gt=0.0)
    K_FTS0: float = quantity(
        "N.m/rad", "stiffness K_FTS of circular spline and flexspline", gt=0.0, calibration=True
    )
    d: float = quantity("N.m.s/rad", "viscous damping at the output", ge=0.0)
    rated_torque: float = quantity("N.m", "rated torque", gt=0.0)
    max_torque: float = quantity("N.m", "end of the tabulated law", gt=0.0)
    zero_torque_pressure: float = quantity(
        "Pa", "peak contact pressure without torque, at the optimum deformation", gt=0.0, calibration=True
    )
    rated_pressure: float = quantity(
        "Pa", "peak contact pressure at rated torque, at the optimum deformation", gt=0.0, calibration=True
    )
    torque_smoothing: float = quantity("N.m", "torque below which the lobes do not grow yet", gt=0.0)
    mismatch_pressure: float = quantity("Pa", "pressure lost from the major to the minor axis", gt=0.0)
    optimum_deformation: float = quantity("m", "radial deformation of the largest pressure", gt=0.0)
    deformation_loss: float = quantity(
        "Pa/m2", "loss of peak pressure per square of the deformation's offset", ge=0.0, calibration=True
    )
    eccentricity_loss: float = quantity(
        "Pa/m", "loss of peak pressure per eccentricity", ge=0.0, calibration=True
    )
    traction: str = choice(
        "ratio", "real_area", doc="shear of a spot: the node's traction ratio, or a traction on the real area"
    )
    pair_scale: float = quantity("1", "published K_TS over the sum of Eq. 45", gt=0.0, calibration=True)
    drive_scale: float = quantity("1", "K_TS in Eq. 46 over the published K_TS", gt=0.0, calibration=True)

    def __post_init__(self) -> None:
        check(self)
        check_limits(self, self.limits())

    def limits(self) -> list[Limit]:
        """Intervals that other parameters decide."""
        no_contact = "beyond it the pair loses contact without torque"
        zero, loss, best = self.zero_torque_pressure, self.deformation_loss, self.optimum_deformation
        with np.errstate(over="ignore"):
            reach = np.sqrt(zero / np.maximum(loss, 1e-290))
            reserve = (zero - self._deformation_loss) / np.maximum(self.eccentricity_loss, 1e-290)
        return [
            Limit("rated_pressure", Interval.of(gt=zero), "it must exceed zero_torque_pressure"),
            Limit(
                "A_0",
                Interval.of(gt=0.0, lt=2.0 * np.pi * self.radius * self.cup_length),
                "the contact must be shorter than the cup (2 pi radius cup_length)",
            ),
            Limit("radial_deformation", Interval.of(gt=best - reach, lt=best + reach), no_contact),
            Limit("eccentricity", Interval.of(ge=0.0, lt=reserve), no_contact),
        ]

    def table_limits(self) -> list[Limit]:
        """Intervals that the tabulated law needs beside."""
        highest = peak_pressure(self, self.max_torque)[0]
        meet = "the two lobes would meet below max_torque"
        return [Limit("mismatch_pressure", Interval.of(gt=highest), meet)]

    @property
    def law(self) -> Hu2023:
        """Interface law of the pair; `side1` is the body with the lower yield strength."""
        one, other = self.flexspline, self.bearing
        swap = other.sigma_y < one.sigma_y
        E, nu = where(swap, other.E, one.E), where(swap, other.nu, one.nu)
        return Hu2023(
            surface=self.surface,
            side1=Elastic(E=E, nu=nu),
            side2=Elastic(E=where(swap, one.E, other.E), nu=where(swap, one.nu, other.nu)),
            sigma_y=np.minimum(one.sigma_y, other.sigma_y),
            mu=self.mu,
            traction_ratio=self.traction_ratio,
            shear_traction=self.shear_traction,
            traction=self.traction,
            A_0=self.A_0,
        )

    @property
    def _deformation_loss(self) -> float:
        return self.deformation_loss * (self.radial_deformation - self.optimum_deformation) ** 2

    @property
    def pressure_loss(self) -> float:
        """Loss of peak pressure [Pa] by deformation off its optimum and by eccentricity."""
        return self._deformation_loss + self.eccentricity_loss * self.eccentricity


def peak_pressure(drive: HarmonicDrive, torque: Number) -> tuple[Number, Number]:
    """Peak contact pressure (...) [Pa] at the major axis and opening, and its torque derivative [Pa/(N.m)].

    `sqrt(p_0^2 + (p_r^2 - p_0^2) g(T)/g(T_r)) - loss` with `g(T) = sqrt(T^2 + T_s^2) - T_s`: the peak
    pressure of a line contact grows with the square root of its load, here a part without torque and
    a part in proportion to |T|, even and smooth through T = 0.
    """
    T, smoothing = torque, drive.torque_smoothing

    def growth(x: Number) -> Number:
        return x * x / (np.hypot(x, smoothing) + smoothing)

    zero, rated = drive.zero_torque_pressure, drive.rated_pressure
    factor = (rated**2 - zero**2) / growth(drive.rated_torque)
    free = np.sqrt(zero**2 + factor * growth(T))
    return free - drive.pressure_loss, 0.5 * factor * T / np.hypot(T, smoothing) / free


def footprint(drive: HarmonicDrive, torque: ArrayLike) -> Footprint:
    """Nodes of one quarter of the contact pair at torques (...) [N.m]; shares stand for the whole."""
    law = drive.law
    spots = checked_spots(law)
    breaks = spots.total("load", np.array(spots.breaks)) / law.A_0
    return two_lobes(peak_pressure(drive, torque)[0], breaks, **_lobe_sizes(drive))


def pieces(drive: HarmonicDrive, peak: Array, breaks: Array) -> Iterator[Piece]:
    """The same nodes at peak pressures (...) [Pa], between breaks of the law [Pa], see `lobe_pieces`."""
    return lobe_pieces(peak, breaks, **_lobe_sizes(drive))


def _lobe_sizes(drive: HarmonicDrive) -> dict[str, float]:
    return {
        "mismatch": drive.mismatch_pressure,
        "radius": drive.radius,
        "deformation": drive.radial_deformation,
        "length": contact_length(drive),
        "cup": drive.cup_length,
    }


def pair_stiffness(drive: HarmonicDrive, torque: ArrayLike) -> tuple[Array, Array]:
    """K_TS (...) [N.m/rad] of the contact pair on the paper's scale (Eq. 45), and dK_TS/dT [1/rad].

    The derivative is exact: at a fixed place the pressure grows with the peak in proportion to the
    taper, and at the lobe's edge, which moves, the stiffness is zero.
    """
    nodes, law = footprint(drive, torque), drive.law
    spots, u = law.spots(), largest_spot(law, nodes.pressure)
    per_pressure = law.A_0 / spots.slope("load", u)
    value = nodes.rotation(spots.total("normal", u), spots.total("tangential", u), _AXIS)
    taper = 1.0 - nodes.position[..., 2] / drive.cup_length
    growth = nodes.rotation(
        spots.slope("normal", u) * per_pressure * taper,
        spots.slope("tangential", u) * per_pressure * taper,
        _AXIS,
    )
    return drive.pair_scale * value, drive.pair_scale * growth * peak_pressure(drive, torque)[1]


def drive_stiffness(drive: HarmonicDrive, torque: ArrayLike) -> tuple[Array, Array]:
    """K_WTS (...) [N.m/rad] by Eq. 46, 1/K_WTS = 1/K_FTS + 1/K_TS, and dK_WTS/dT [1/rad]."""
    total, growth = in_series(drive, *pair_stiffness(drive, np.abs(torque)))
    return total, growth * np.sign(torque)


def in_series(drive: HarmonicDrive, pair: Number, growth: Number) -> tuple[Number, Number]:
    """K_WTS [N.m/rad] by Eq. 46 and its derivative, from K_TS on the paper's scale and its derivative."""
    contact = drive.drive_scale * pair
    total = 1.0 / (1.0 / drive.K_FTS0 + 1.0 / contact)
    return total, (total / contact) ** 2 * drive.drive_scale * growth


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


def lobe_point(drive: HarmonicDrive, sine_t: Number, cosine_t: Number, z: Number, axis: Number) -> Lobe:
    """The point of the contact pair at a height [m] and an angle, see `lobe`."""
    return lobe(
        sine_t,
        cosine_t,
        z,
        axis,
        mismatch=drive.mismatch_pressure,
        radius=drive.radius,
        deformation=drive.radial_deformation,
        cup=drive.cup_length,
    )


def contact_length(drive: HarmonicDrive) -> Number:
    """Length [m] of the contact along the drive's axis."""
    return drive.A_0 / (2.0 * np.pi * drive.radius)


def local(drive: HarmonicDrive, peak: Number, z: Number) -> Number:
    """Pressure [Pa] on the major axis at a height [m]."""
    return peak * (1.0 - z / drive.cup_length)


def height_at(drive: HarmonicDrive, peak: Number, pressure: Number) -> Number:
    """Height [m] at which the major axis has a pressure [Pa], see `lobes.height_at`."""
    return lobes.height_at(peak, pressure, contact_length(drive), drive.cup_length)


def angle_at(drive: HarmonicDrive, axis: Number, pressure: Number) -> Number:
    """Where a lobe with a pressure [Pa] on its axis has another pressure, see `lobes.angle_at`."""
    return lobes.angle_at(axis, pressure, drive.mismatch_pressure)


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
