"""Functions shared by the fits of the drive: start parameters, bounds, wind-up, and the row of a catalogue.

Catalogues state three stiffnesses: K1 below the torque T1, K2 between T1 and T2, K3 above T2. The wind-up is

    theta(T) = T1/K1 + (T2 - T1)/K2 + (T - T2)/K3   for T > T2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.law import ContactPairDriveParameters
from jointfmu.joints.harmonic_drive.spring import torque_curve
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, build_parameter_set, check_fields, flatten_fields, quantity_field
from jointfmu.quantity.units import UnitSizes, conversion_factor, unit_sizes

from ....inputs.catalogue import SourcedNumber
from ....inputs.fitting.measurement import MeasurementColumns
from ....inputs.fitting.outcome import FitPlot

STIFFNESS_PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "hu2023": ("K_FTS0", "drive_scale"),
    "catalogue": ("K1", "K2", "K3"),
}
"""{law: parameters}; one factor on all of these scales K_WTS (Hu 2023, Eq. 46)."""
MIN_ZERO_TORQUE_PRESSURE_OVER_RATED_PRESSURE = 0.05
"""Lower bound in a fit of the peak pressure at zero torque, over that at rated torque [1]."""


PLAUSIBLE_WIND_UP_RANGE = (1e-5, 0.1)
"""Plausible wind-up [rad] at rated torque: from a hundredth to a hundred times the usual 1e-3."""


COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "torque": unit_sizes("N.m", "mN.m", "kN.m"),
    "angle": unit_sizes("rad", "mrad", "deg", "arcmin", "arcsec"),
}
"""{column: {unit: size in SI}} of measured torque and wind-up."""
LOOP_COLUMN_NAMES = MeasurementColumns("torque", "angle", *COLUMN_UNITS.values())
"""Columns of torque and angle in a measured file, with their units."""
RAD_PER_ARCMIN = COLUMN_UNITS["angle"]["arcmin"]
"""Size of an arc minute [rad]."""


def compute_wind_up(drive_parameters: DriveParameters, torque: Array) -> Array:
    """Wind-up (...) [rad] of a drive without hysteresis at torques (...) [N.m], equal to its FMU's output."""
    return torque_curve(drive_parameters).odd_inverse(torque)


def change_rated_torque(
    start_file: ParameterFile,
    rated_torque: float,
    max_over_rated_torque: float,
    torque_origin: str,
    torque_source: str,
) -> ParameterFile:
    """Change the rated torque [N.m] of a drive; its parameter `torque_smoothing` changes in proportion.

    max_over_rated_torque        : new max_torque over the new rated torque [1]
    torque_origin, torque_source : origin and source of the new rated torque, for the parameter file

    Raises ValueError if the rated torque is not positive and finite.
    """
    if not 0.0 < rated_torque < np.inf:
        raise ValueError(f"rated torque = {rated_torque:g} N.m is outside (0, inf): the drive's rated torque")
    drive = start_file.values
    file = start_file.with_values({"rated_torque": rated_torque}, torque_origin, torque_source)
    if "max_torque" in file.values_by_name:
        file = file.with_values(
            {"max_torque": max_over_rated_torque * rated_torque},
            "estimate",
            f"{max_over_rated_torque:g} times rated_torque",
        )
    if "torque_smoothing" not in file.values_by_name:
        return file
    smoothing = drive.torque_smoothing * rated_torque / drive.rated_torque
    return file.with_values(
        {"torque_smoothing": smoothing},
        "estimate",
        f"{smoothing / rated_torque:.2g} of rated_torque, as in {start_file.name}",
    )


def scale_stiffness(
    start_file: ParameterFile, fitted_names: tuple[str, ...], measured_torques: Array, measured_angles: Array
) -> ParameterFile:
    """Scale the stiffness of the start parameters to a measured curve, angles (n) [rad] at torques (n) [N.m].

    `start_file` is returned unchanged unless all STIFFNESS_PARAMETERS of the law are among the names to fit.
    """
    ratio = float(
        np.sum(compute_wind_up(start_file.values, measured_torques) * measured_angles)
        / np.sum(measured_angles**2)
    )
    level = {
        name: start_file.values_by_name[name] * ratio
        for name in STIFFNESS_PARAMETERS.get(start_file.law, ())
        if name in fitted_names
    }
    is_complete = level and len(level) == len(STIFFNESS_PARAMETERS[start_file.law])
    return start_file.with_values(level, "calibration", "start") if is_complete else start_file


def change_law(
    start_file: ParameterFile,
    law_parameter_class: type[DriveParameters],
    parameter_set_name: str,
    sourced_numbers: Mapping[str, SourcedNumber],
    copied_parameter_names: Sequence[str] = (),
) -> ParameterFile:
    """Change the law of a drive.

    law_parameter_class    : parameter class of the new law
    parameter_set_name     : name of the parameter set in the new file
    sourced_numbers        : {parameter: number with source} of the new law
    copied_parameter_names : parameters of the law of `start_file` to copy, in addition to those of all drives
    """
    shared = [label for label, _ in flatten_fields(DriveParameters) if label in start_file.values_by_name] + [
        *copied_parameter_names
    ]
    values = {label: start_file.values_by_name[label] for label in shared} | {
        k: p.si_value for k, p in sourced_numbers.items()
    }
    kinds = {k: v for k, v in start_file.origins.items() if k in shared} | {
        k: p.value_origin for k, p in sourced_numbers.items()
    }
    sources = {k: v for k, v in start_file.sources.items() if k in shared}
    sources |= {k: p.value_source for k, p in sourced_numbers.items()}
    return ParameterFile(
        start_file.joint, parameter_set_name, build_parameter_set(law_parameter_class, values), kinds, sources
    )


def parameter_bounds(start_file: ParameterFile) -> Mapping[str, tuple[float, float]]:
    """Bounds {parameter: (low, high)} with which the contact pair stays closed at zero torque.

    Empty for a law without a contact pair.
    """
    drive: Any = start_file.values
    if not isinstance(drive, ContactPairDriveParameters):
        return {}
    rated, loss = drive.rated_pressure, drive.peak_pressure_reduction
    lowest = loss + MIN_ZERO_TORQUE_PRESSURE_OVER_RATED_PRESSURE * rated
    return {
        "zero_torque_pressure": (lowest, rated),
        "rated_pressure": (drive.zero_torque_pressure, np.inf),
        "torque_smoothing": (1e-3 * drive.rated_torque, drive.rated_torque),
    }


COMMON_STIFFNESS_UNITS = ("1e4 N.m/rad", "N.m/arcmin", "kN.m/rad", "kgf.m/arcmin", "N.m/mrad", "N.mm/rad")
"""Units of the stiffness in catalogues."""


def _likely_unit_hint(wind_up_at_T2: float) -> str:
    """Text that names the unit of a stiffness column that makes the wind-up [rad] at torque T2 plausible."""
    typical = np.sqrt(np.prod(PLAUSIBLE_WIND_UP_RANGE))
    sizes = {u: conversion_factor(u, "N.m/rad") for u in COMMON_STIFFNESS_UNITS}
    unit = min(sizes, key=lambda u: abs(np.log(wind_up_at_T2 / sizes[u] / typical)))
    if not 0.1 < wind_up_at_T2 / sizes[unit] / typical < 10.0:
        return "no usual unit explains it"
    return f"likely they are in {unit}: times {sizes[unit]:g} (--stiffness-unit)"


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueRow:
    """Torsional stiffness and rated torque in a catalogue row: K1 up to torque T1, K2 up to T2, K3 above.

    Raises ValueError if K1, K2, K3 or T1, T2 are not ascending, or if the wind-up at rated torque is outside
    PLAUSIBLE_WIND_UP_RANGE.
    """

    K1: float = quantity_field("N.m/rad", "stiffness below T1", gt=0.0)
    K2: float = quantity_field("N.m/rad", "stiffness between T1 and T2", gt=0.0)
    K3: float = quantity_field("N.m/rad", "stiffness above T2", gt=0.0)
    T1: float = quantity_field("N.m", "torque at the first corner", gt=0.0)
    T2: float = quantity_field("N.m", "torque at the second corner", gt=0.0)
    rated_torque: float = quantity_field("N.m", "rated torque", gt=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        for low, high in (("K1", "K2"), ("K2", "K3")):
            if not getattr(self, low) <= getattr(self, high):
                raise ValueError(
                    f"{high} = {getattr(self, high):g} N.m/rad is outside [{getattr(self, low):g}, inf): "
                    f"the drive stiffens, {high} is at least {low}"
                )
        if not self.T1 < self.T2:
            raise ValueError(f"T2 = {self.T2:g} N.m is outside ({self.T1:g}, inf): T2 exceeds T1")
        least, most = PLAUSIBLE_WIND_UP_RANGE
        angle, at_T2 = (float(self.wind_up(T)) for T in (self.rated_torque, self.T2))
        if not least <= angle <= most:
            raise ValueError(
                f"K1 = {self.K1:g} N.m/rad winds up {angle:.3g} rad at the rated torque "
                f"{self.rated_torque:g} N.m, allowed are {least:g} to {most:g} rad: are K1, K2 and K3 in "
                f"N.m/rad? {_likely_unit_hint(at_T2)}"
            )

    def wind_up(self, torque: ArrayLike) -> Array:
        """Wind-up theta (...) [rad] at torques (...) >= 0 [N.m]."""
        T = np.asarray(torque, dtype=np.float64)
        first, second = np.minimum(T, self.T1), np.clip(T - self.T1, 0.0, self.T2 - self.T1)
        return np.asarray(first / self.K1 + second / self.K2 + np.maximum(T - self.T2, 0.0) / self.K3)

    def stiffness(self, torque: ArrayLike) -> Array:
        """Stiffness K1, K2 or K3 (...) [N.m/rad] at torques (...) >= 0 [N.m]; at T1 and T2 the lower one."""
        T = np.asarray(torque, dtype=np.float64)
        return np.where(T <= self.T1, self.K1, np.where(T <= self.T2, self.K2, self.K3))

    @property
    def torques_of_exact_angles(self) -> Array:
        """Torques T1, T2 and rated [N.m], ascending, at which a fitted law must meet the angle."""
        return np.unique([self.T1, self.T2, self.rated_torque])

    def __str__(self) -> str:
        return (
            f"K1 = {self.K1:g}, K2 = {self.K2:g}, K3 = {self.K3:g} N.m/rad, "
            f"T1 = {self.T1:g}, T2 = {self.T2:g} N.m"
        )


_CURVE_POINT_COUNT = 400
"""Number of points of a plotted curve [1]."""


def compute_stiffness(drive_parameters: DriveParameters, torque: Array) -> Array:
    """Stiffness K_WTS (...) [N.m/rad] of the FMU without hysteresis, at torques (...) >= 0 [N.m]."""
    curve = torque_curve(drive_parameters)
    return curve.derivatives(curve.inverse(torque), 1)[1]


def draw_wind_up_picture(
    catalogue_row: CatalogueRow,
    fitted_drive: DriveParameters,
    other_plotted_drives: Mapping[str, DriveParameters],
    plotted_torques: Array,
) -> FitPlot:
    """Plot of the wind-up of a drive at n torques [N.m]: catalogue, fitted law, and errors of the law.

    other_plotted_drives : {name in the legend: drive with another law}
    """
    grid, target = (
        np.linspace(0.0, plotted_torques[-1], _CURVE_POINT_COUNT),
        catalogue_row.wind_up(plotted_torques),
    )
    return FitPlot(
        measured_x=plotted_torques,
        measured_y=target / RAD_PER_ARCMIN,
        misfit=100.0 * (target / compute_wind_up(fitted_drive, plotted_torques) - 1.0),
        law_curve=(grid, compute_wind_up(fitted_drive, grid) / RAD_PER_ARCMIN),
        axis_labels=("torque [N.m]", "wind-up [arcmin]", "catalogue / law - 1 [%]"),
        highlighted_points=np.isin(plotted_torques, catalogue_row.torques_of_exact_angles),
        other_laws={
            name: (grid, compute_wind_up(other, grid) / RAD_PER_ARCMIN)
            for name, other in other_plotted_drives.items()
        },
    )


def draw_stiffness_picture(
    catalogue_row: CatalogueRow,
    fitted_drive: DriveParameters,
    other_plotted_drives: Mapping[str, DriveParameters],
    max_torque: float,
) -> FitPlot:
    """Plot of the stiffness of a drive up to `max_torque` [N.m]: catalogue, fitted law, errors of the law.

    The torques T1 and T2, at which the catalogue's stiffness jumps, are left out.

    other_plotted_drives : {name in the legend: drive with another law}
    """
    grid = np.linspace(0.0, max_torque, _CURVE_POINT_COUNT)
    torque = grid[1::2][~np.isin(grid[1::2], (catalogue_row.T1, catalogue_row.T2))]
    steps = catalogue_row.stiffness(torque)
    return FitPlot(
        measured_x=torque,
        measured_y=steps / 1e3,
        misfit=100.0 * (steps / compute_stiffness(fitted_drive, torque) - 1.0),
        law_curve=(grid, compute_stiffness(fitted_drive, grid) / 1e3),
        axis_labels=("torque [N.m]", "stiffness [kN.m/rad]", "catalogue / law - 1 [%]"),
        other_laws={
            name: (grid, compute_stiffness(other, grid) / 1e3) for name, other in other_plotted_drives.items()
        },
    )
