"""What must hold of the drive's ramps, and the published points that its FMU shows."""

from pathlib import Path

from scipy.integrate import cumulative_simpson

from jointfmu.published.reference import Point

from ...job.checks import deviation
from ...ramps import ramp


def _compliance(folder: Path, result: ramp.RampResult) -> tuple[str, float]:
    c = result.columns
    phi = cumulative_simpson(1.0 / c["K_WTS"], x=c["tau"], initial=0.0)
    return "phi_rel against the integral of dT/K_WTS (scipy, Simpson)", deviation(c["phi_rel"], phi)


def _spring(folder: Path, result: ramp.RampResult) -> tuple[str, float]:
    c = result.columns
    tau = cumulative_simpson(c["K_WTS"], x=c["phi_rel"], initial=0.0)
    return "tau against the integral of K_WTS dphi (scipy, Simpson)", deviation(c["tau"], tau)


RAMPS = {"HarmonicDriveSpring": _spring, "HarmonicDriveCompliance": _compliance}
"""{FMU: (folder, its ramp) -> (what is compared, largest relative deviation)}."""


def through_fmu(point: Point, folder: Path) -> float | None:
    """A published point from FMUs in a folder; None where they do not show it."""
    where = point.where

    def drive(column: str, **settings: float) -> float:
        torque = where["torque"]
        fmu = folder / "HarmonicDriveCompliance.fmu"
        return float(ramp.run(fmu, "tau", torque, torque, settings).columns[column][-1])

    if point.quantity == "K_TS":
        changes = {"radial_deformation": where["deformation"]} if "deformation" in where else {}
        return drive("K_TS_pair", **changes)
    if point.quantity == "K_TS_least":
        ends = (where["lower"], where["upper"])
        return min(drive("K_TS_pair", radial_deformation=w) for w in ends)
    if point.quantity == "K_TS_change":
        changed = drive("K_TS_pair", eccentricity=where["eccentricity"])
        return 100.0 * (changed / drive("K_TS_pair") - 1.0)
    if point.quantity == "K_WTS":
        return drive("K_WTS")
    if point.quantity == "peak_pressure":
        return drive("p_max")
    return None
