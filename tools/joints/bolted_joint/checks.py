"""What must hold of the joint's ramp, and the published points that its FMU shows."""

from pathlib import Path

from scipy.integrate import cumulative_simpson

from jointfmu.published.reference import Point

from ...job.checks import deviation
from ...ramps import ramp

_FMU = "BoltedJoint"


def _pulled(folder: Path, result: ramp.RampResult) -> tuple[str, float]:
    pulled = ramp.run(folder / f"{_FMU}.fmu", "s_rel_z", 5e-6, 1e-8, {"preload": 9e3}).columns
    force = -cumulative_simpson(pulled["K_zz"], x=pulled["s_rel_z"], initial=0.0)
    return "f_z pulled apart against the integral of K_zz ds (scipy, Simpson)", deviation(
        pulled["f_z"], force
    )


RAMPS = {_FMU: _pulled}
"""{FMU: (folder, its ramp) -> (what is compared, largest relative deviation)}."""


def through_fmu(point: Point, folder: Path) -> float | None:
    """A published point from FMUs in a folder; None where they do not show it."""
    if point.quantity != "p_max":
        return None
    load = point.where["preload"]
    return float(ramp.run(folder / f"{_FMU}.fmu", "preload", load, load).columns["p_max"][-1])
