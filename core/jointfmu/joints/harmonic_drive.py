"""Torsional spring of a harmonic drive: contact of flexspline and flexible bearing (Hu 2023)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..asperity.hu2023 import Hu2023
from ..curve import Curve, assemble, refined
from ..footprint.lobes import two_lobes
from ..footprint.nodes import Footprint
from ..interface import checked_spots, largest_spot
from ..quantity import check, choice, group, quantity
from ..surface import ArealSurface, Elastic, ElasticPlastic

Array = NDArray[np.float64]

_AXIS = (0.0, 0.0, 1.0)
_STEPS, _SOFTEST, _STIFFEST = 160, 1e-100, 1e-6
_GAUSS = np.polynomial.legendre.leggauss(4)


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
        if self.rated_pressure <= self.zero_torque_pressure:
            raise ValueError(
                f"rated_pressure = {self.rated_pressure:g} Pa is outside "
                f"({self.zero_torque_pressure:g}, inf): it must exceed zero_torque_pressure"
            )
        most = 2.0 * np.pi * self.radius * self.cup_length
        if most <= self.A_0:
            raise ValueError(
                f"A_0 = {self.A_0:g} m2 is outside (0, {most:g}): the contact must be shorter than the cup "
                f"(cup_length = {self.cup_length:g} m at radius = {self.radius:g} m)"
            )
        self._check_contact()

    def _check_contact(self) -> None:
        """Refuse a deformation or eccentricity that leaves no contact without torque."""
        reserve = self.zero_torque_pressure - self._deformation_loss
        if reserve <= 0.0:
            reach = (self.zero_torque_pressure / self.deformation_loss) ** 0.5
            low, high = self.optimum_deformation - reach, self.optimum_deformation + reach
            raise ValueError(
                f"radial_deformation = {self.radial_deformation:g} m is outside ({low:g}, {high:g}): "
                "beyond it the pair loses contact without torque"
            )
        if self.eccentricity_loss * self.eccentricity >= reserve:
            high = reserve / self.eccentricity_loss
            raise ValueError(
                f"eccentricity = {self.eccentricity:g} m is outside [0, {high:g}): "
                "beyond it the pair loses contact without torque"
            )

    @property
    def law(self) -> Hu2023:
        """Interface law of the pair; `side1` is the body with the lower yield strength."""
        softer, harder = self.flexspline, self.bearing
        if harder.sigma_y < softer.sigma_y:
            softer, harder = harder, softer
        return Hu2023(
            surface=self.surface,
            side1=Elastic(E=softer.E, nu=softer.nu),
            side2=Elastic(E=harder.E, nu=harder.nu),
            sigma_y=softer.sigma_y,
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


def peak_pressure(drive: HarmonicDrive, torque: ArrayLike) -> tuple[Array, Array]:
    """Peak contact pressure (...) [Pa] at the major axis and opening, and its torque derivative [Pa/(N.m)].

    `sqrt(p_0^2 + (p_r^2 - p_0^2) g(T)/g(T_r)) - loss` with `g(T) = sqrt(T^2 + T_s^2) - T_s`: the peak
    pressure of a line contact grows with the square root of its load, here a part without torque and
    a part in proportion to |T|, even and smooth through T = 0.
    """
    T, smoothing = np.asarray(torque, dtype=np.float64), drive.torque_smoothing

    def growth(x: Array) -> Array:
        return x * x / (np.hypot(x, smoothing) + smoothing)

    zero, rated = drive.zero_torque_pressure, drive.rated_pressure
    factor = (rated**2 - zero**2) / growth(np.asarray(drive.rated_torque))
    free = np.sqrt(zero**2 + factor * growth(T))
    return free - drive.pressure_loss, 0.5 * factor * T / np.hypot(T, smoothing) / free


def footprint(drive: HarmonicDrive, torque: ArrayLike) -> Footprint:
    """Nodes of one quarter of the contact pair at torques (...) [N.m]; shares stand for the whole."""
    law = drive.law
    spots = checked_spots(law)
    return two_lobes(
        peak_pressure(drive, torque)[0],
        spots.total("load", np.array(spots.breaks)) / law.A_0,
        mismatch=drive.mismatch_pressure,
        radius=drive.radius,
        deformation=drive.radial_deformation,
        length=drive.A_0 / (2.0 * np.pi * drive.radius),
        cup=drive.cup_length,
    )


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
    pair, growth = pair_stiffness(drive, np.abs(torque))
    contact = drive.drive_scale * pair
    total = 1.0 / (1.0 / drive.K_FTS0 + 1.0 / contact)
    return total, (total / contact) ** 2 * drive.drive_scale * growth * np.sign(torque)


def torque_curve(drive: HarmonicDrive) -> Curve:
    """Torque [N.m] over wind-up [rad] for phi >= 0 (the law is odd): the integral of dT/K_WTS.

    Nodes are evenly spaced in asinh(T/T_s), dense where the stiffness bends; the wind-up is integrated
    by four Gauss-Legendre nodes per step.

    Raises ValueError if the two lobes would meet within the table, where K_TS has a kink.
    """
    highest = float(peak_pressure(drive, drive.max_torque)[0])
    if highest >= drive.mismatch_pressure:
        raise ValueError(
            f"mismatch_pressure = {drive.mismatch_pressure:g} Pa is outside ({highest:g}, inf): "
            f"the two lobes would meet below {drive.max_torque:g} N.m"
        )
    return refined(lambda steps: _windup(drive, steps), _STEPS)


def _windup(drive: HarmonicDrive, steps: int) -> Curve:
    """The table with a number of steps."""
    smoothing = drive.torque_smoothing
    xi = np.linspace(0.0, np.arcsinh(drive.max_torque / smoothing), steps + 1)
    T, half = smoothing * np.sinh(xi), 0.5 * xi[1]
    K, growth = drive_stiffness(drive, T)
    if not np.all((K > _SOFTEST) & (K < (1.0 - _STIFFEST) * drive.K_FTS0)):
        raise ValueError(
            f"K_FTS0 = {drive.K_FTS0:g} N.m/rad, pair_scale = {drive.pair_scale:g} and drive_scale = "
            f"{drive.drive_scale:g} give K_WTS = {K[-1]:g} N.m/rad, allowed is ({_SOFTEST:g}, "
            f"{drive.K_FTS0:g}) N.m/rad with K_TS at most {1.0 / _STIFFEST:g} times K_FTS0"
        )
    inner = xi[:-1, None] + half * (1.0 + _GAUSS[0])
    rate = smoothing * np.cosh(inner) / drive_stiffness(drive, smoothing * np.sinh(inner))[0]
    phi = np.concatenate([[0.0], np.cumsum(half * rate @ _GAUSS[1])])
    return assemble([(phi, T, K, K * growth)])


@dataclass(frozen=True, slots=True)
class HarmonicDriveSpring:
    """The exported spring: motion in, torque out; and torque in, motion out."""

    drive: HarmonicDrive
    curve: Curve

    @classmethod
    def of(cls, drive: HarmonicDrive) -> "HarmonicDriveSpring":
        """Tabulate a drive."""
        return cls(drive, torque_curve(drive))

    def motion(self, phi1: ArrayLike, w1: ArrayLike, phi2: ArrayLike, w2: ArrayLike) -> dict[str, Array]:
        """Torques and stiffnesses at flange angles [rad] and speeds [rad/s] (...)."""
        ratio = self.drive.ratio
        phi = np.asarray(phi2) - np.asarray(phi1) / ratio
        speed = np.asarray(w2) - np.asarray(w1) / ratio
        load, stiffness = self.curve.derivatives(np.abs(phi), 1)
        tau = np.copysign(load, phi) + self.drive.d * speed
        parts = self.parts(load, stiffness)
        return {"tau1": tau / ratio, "tau2": -tau, "phi_rel": phi, "tau": tau, **parts}

    def windup(self, tau: ArrayLike) -> dict[str, Array]:
        """Wind-up and stiffnesses at torques (...) [N.m] with the wave generator locked."""
        phi = self.curve.inverse(np.abs(tau))
        load, stiffness = self.curve.derivatives(phi, 1)
        return {"phi_rel": np.copysign(phi, tau), **self.parts(load, stiffness)}

    def parts(self, load: Array, stiffness: Array) -> dict[str, Array]:
        """K_WTS and its parts at an elastic torque, and the peak contact pressure.

        K_TS_pair is K_TS on the scale of the paper's Fig. 11.
        """
        K_FTS = np.full_like(stiffness, self.drive.K_FTS0)
        K_TS = 1.0 / (1.0 / stiffness - 1.0 / K_FTS)
        return {
            "K_WTS": stiffness,
            "K_TS": K_TS,
            "K_FTS": K_FTS,
            "K_TS_pair": K_TS / self.drive.drive_scale,
            "p_max": peak_pressure(self.drive, load)[0],
        }
