"""Harmonic drive: its parameters, and the stiffness of flexspline and flexible bearing (Hu 2023)."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...asperity.hu2023 import Hu2023
from ...footprint import lobes
from ...footprint.lobes import Lobe, Piece, lobe, lobe_pieces, two_lobes
from ...footprint.nodes import Footprint
from ...interface import checked_spots, largest_spot
from ...quantity import Interval, Limit, Number, check, check_limits, choice, group, quantity, where
from ...surface import ArealSurface, Elastic, ElasticPlastic

Array = NDArray[np.float64]

_AXIS = (0.0, 0.0, 1.0)


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
        cup, ring = self.flexspline, self.bearing
        swap = ring.sigma_y < cup.sigma_y
        E, nu = where(swap, ring.E, cup.E), where(swap, ring.nu, cup.nu)
        return Hu2023(
            surface=self.surface,
            side1=Elastic(E=E, nu=nu),
            side2=Elastic(E=where(swap, cup.E, ring.E), nu=where(swap, cup.nu, ring.nu)),
            sigma_y=np.minimum(cup.sigma_y, ring.sigma_y),
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
