"""Figures of the report: stiffness over torque, torque over wind-up, what friction costs."""

from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.published.validation import ValidatedPoint

from ...ramps.ramp import RampResult
from ...report.figure import Figure, Panel, Series, published
from . import efficiency

_FMU = "HarmonicDriveCompliance"


def figures(outcome: Any) -> list[Figure]:
    """The figures of an outcome of the main job."""
    result = outcome.ramps[_FMU]
    return [
        Figure(
            "Stiffness over torque",
            "K_WTS and the contact pair's part of it on the drive's scale, as the FMU gives them; then the "
            "pair on the scale of the paper's figures.",
            stiffness(result, outcome.rows),
            data=f"{_FMU}.csv",
        ),
        Figure(
            "Torque over wind-up",
            "The integral of dT/K_WTS, odd in the torque.",
            [torque_angle(result)],
            data=f"{_FMU}.csv",
        ),
        Figure(
            "What friction costs",
            "By the FMU with the friction of catalogue drives: efficiency over load, with what is published "
            "at rated torque and 2000 rev/min, and the torque at the output that moves a drive without "
            "motor. Starting and running torque fix friction_coulomb and friction_viscous, the efficiency "
            "load_loss, the back-driving torque load_loss_back. Of the CSF drives the running torque is an "
            "estimate, and the back-driving torque fixes both where that is not below 0.",
            friction(_spring(outcome)),
        ),
    ]


def _spring(outcome: Any) -> Path:
    """The FMU between two flanges, FMI 2.0."""
    paths: list[Path] = outcome.built
    return next(p for p in paths if (p.parent.name, p.stem) == ("fmi2", "HarmonicDriveSpring"))


def friction(fmu: Path) -> list[Panel]:
    """Efficiency over load at some speeds, and the torques that move the catalogue's drives backwards."""
    panels, published_torques, found_torques = [], [], []
    drives, share = efficiency.printed_drives(), np.linspace(0.1, 1.0, 41) ** 2
    for drive in drives:
        rated, back = drive.numbers["rated_torque"].value, drive.numbers["back_driving_torque"].value
        with efficiency.bench(fmu, efficiency.parameters(drive)) as bench:
            rows = {
                rpm: [bench.efficiency(rpm * np.pi / 30.0, load) for load in rated * share]
                for rpm in (500, 2000, 3500)
            }
            found_torques.append(bench.back_driving_torque(10.0 * back))
        published_torques.append(back)
        series = [Series(f"{rpm} rev/min", rated * share, row) for rpm, row in rows.items()]
        if "efficiency" in drive.numbers:
            known = [drive.numbers["efficiency"].value]
            series.append(Series("published, 2000 rev/min", [rated], known, "empty", titles=[drive.name]))
        panels.append(Panel(f"Efficiency of {drive.name}", "load [N m]", "efficiency", series))
    ends = [0.0, max(published_torques)]
    names = [drive.name for drive in drives]
    marks = Series("FMU", published_torques, found_torques, "full", titles=names)
    both = [marks, Series("equal", ends, ends, dashed=True)]
    return [*panels, Panel("Back-driving torque", "published [N m]", "FMU [N m]", both)]


def stiffness(result: RampResult, rows: list[ValidatedPoint]) -> list[Panel]:
    """K_WTS and the pair's part over torque, with the published points on the curves."""
    c = result.columns
    points = [row.point for row in rows]
    drive = [Series(name, c["tau"], c[name]) for name in ("K_WTS", "K_TS")]
    drive += published([p for p in points if p.quantity == "K_WTS"], "torque")
    least = [row for row in rows if row.point.quantity == "K_TS_least"]
    most = [r for r in rows if r.point.quantity == "K_TS" and "deformation" in r.point.where]
    ends = [*most, *least]
    pair = [
        Series("K_TS on the paper's scale", c["tau"], c["K_TS_pair"]),
        Series(
            "computed: largest and least over w",
            [r.point.where["torque"] for r in ends],
            [float(r.computed) for r in ends],
            "empty",
            titles=[r.point.id for r in ends],
        ),
        *published([p for p in points if p.quantity in ("K_TS", "K_TS_least")], "torque"),
    ]
    return [
        Panel("Stiffness of the drive", "torque [N m]", "K [N m/rad]", drive),
        Panel("Stiffness of the contact pair", "torque [N m]", "K_TS [N m/rad]", pair),
    ]


def torque_angle(result: RampResult) -> Panel:
    """Torque over wind-up, both signs."""
    tau, angle = result.columns["tau"], np.degrees(result.columns["phi_rel"]) * 60.0
    both = np.concatenate([-angle[::-1], angle]), np.concatenate([-tau[::-1], tau])
    return Panel("Torque over wind-up", "wind-up [arcmin]", "torque [N m]", [Series("torque", *both)])
