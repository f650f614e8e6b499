"""The load ramps through the FMUs, and what must hold of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_simpson, quad

from jointfmu import ramp
from jointfmu.interface import stiffness_curve
from jointfmu.joints import MODELS
from jointfmu.joints.gear_contact.spring import GearContact
from jointfmu.parameters import default
from jointfmu.reference import Point, points
from jointfmu.validation import Row, compare

from .ringing import DAMPING_TOLERANCE, RESONANCE_TOLERANCE, Ringing

INTEGRATION_TOLERANCE = 1e-6
"""FMU against an independent integration of its stiffness [1]."""
REPEAT_TOLERANCE = 1e-9
"""FMU at ten times larger steps against the same points [1]."""
FLAVOUR_TOLERANCE = 1e-9
"""One flavour against another [1]: both evaluate the same law, to the round-off of its inversion."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check of a ramp: largest relative deviation, what is allowed."""

    fmu: str
    name: str
    deviation: float
    allowed: float

    @property
    def passed(self) -> bool:
        """Whether the deviation is a number and small enough."""
        return bool(self.deviation <= self.allowed)


def default_ramp(name: str, folder: Path, factor: float = 1.0) -> ramp.Ramp:
    """The FMU's own load ramp, steps enlarged by a factor."""
    r = MODELS[name].ramp
    return ramp.run(folder / f"{name}.fmu", r.input, r.end, r.step * factor)


def check(name: str, folder: Path, result: ramp.Ramp) -> list[Check]:
    """All checks of an FMU's ramp."""
    coarse = default_ramp(name, folder, 10.0).columns
    worst = max(_deviation(coarse[column], fine[::10]) for column, fine in result.columns.items())
    integral = {
        "HarmonicDriveSpring": _check_spring,
        "HarmonicDriveCompliance": _check_compliance,
        "BoltedJoint": _check_bolted,
        "GearContact": _check_gear,
    }[name](folder, result)
    return [
        Check(name, "ten times larger steps, every output at the shared points", worst, REPEAT_TOLERANCE),
        Check(name, *integral, INTEGRATION_TOLERANCE),
    ]


def same(name: str, folder: Path, expected: ramp.Ramp) -> Check:
    """The ramp of another flavour against the one expected."""
    found = default_ramp(name, folder).columns
    worst = max(_deviation(found[column], value) for column, value in expected.columns.items())
    return Check(name, f"flavour {folder.name}: every output the same", worst, FLAVOUR_TOLERANCE)


def check_ringing(found: Mapping[str, Sequence[Ringing]]) -> list[Check]:
    """Simulated free motion against stiffness and damping of the joint."""
    checks = []
    for name, rings in found.items():
        frequency = max(abs(r.frequency / r.expected - 1.0) for r in rings)
        damping = max(abs(r.damping / r.stated - 1.0) for r in rings)
        checks.append(Check(name, "resonance against sqrt(K/J)", frequency, RESONANCE_TOLERANCE))
        checks.append(Check(name, "free decay against the stated damping", damping, DAMPING_TOLERANCE))
    return checks


def _deviation(value: object, expected: object) -> float:
    a, b = np.asarray(value), np.asarray(expected)
    scale = float(np.max(np.abs(b)))
    return float(np.max(np.abs(a - b))) / scale if scale > 0.0 else float(np.max(np.abs(a)))


def _check_compliance(folder: Path, result: ramp.Ramp) -> tuple[str, float]:
    c = result.columns
    phi = cumulative_simpson(1.0 / c["K_WTS"], x=c["tau"], initial=0.0)
    return "phi_rel against the integral of dT/K_WTS (scipy, Simpson)", _deviation(c["phi_rel"], phi)


def _check_spring(folder: Path, result: ramp.Ramp) -> tuple[str, float]:
    c = result.columns
    tau = cumulative_simpson(c["K_WTS"], x=c["phi_rel"], initial=0.0)
    return "tau against the integral of K_WTS dphi (scipy, Simpson)", _deviation(c["tau"], tau)


def _check_bolted(folder: Path, result: ramp.Ramp) -> tuple[str, float]:
    pulled = ramp.run(folder / "BoltedJoint.fmu", "s_rel_z", 5e-6, 1e-8, {"preload": 9e3}).columns
    force = -cumulative_simpson(pulled["K_zz"], x=pulled["s_rel_z"], initial=0.0)
    return "f_z pulled apart against the integral of K_zz ds (scipy, Simpson)", _deviation(
        pulled["f_z"], force
    )


def _check_gear(folder: Path, result: ramp.Ramp) -> tuple[str, float]:
    law = default("gear_contact").values
    assert isinstance(law, GearContact)

    def compliance(f: float) -> float:
        return float(1.0 / (law.A_0 * stiffness_curve(law, f / law.A_0)[0]))

    c, at = result.columns, [1, 10, 100, 300]
    approach = [
        quad(compliance, c["f"][i], c["f"][j], epsabs=0.0, epsrel=1e-9, limit=400)[0] for i, j in pairwise(at)
    ]
    return "s_rel against the integral of df/K of the law (scipy, quad)", _deviation(
        np.diff(c["s_rel"][at]), approach
    )


def published_through_fmus(folder: Path) -> list[Row]:
    """The published points that an FMU can show, computed by running the FMU."""
    found = []
    for paper in ("hu2023", "zhao2018"):
        for point in points(paper):
            value = _through_fmu(point, folder)
            if value is not None:
                found.append(compare(point, value))
    return found


def _through_fmu(point: Point, folder: Path) -> float | None:
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
    if point.quantity == "p_max":
        fmu, load = folder / "BoltedJoint.fmu", where["preload"]
        return float(ramp.run(fmu, "preload", load, load).columns["p_max"][-1])
    return None
