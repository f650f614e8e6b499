"""Figures of the report: stiffness over torque, torque over wind-up, what friction costs."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from jointfmu.plots import published_mark
from jointfmu.ramp import RampResult
from jointfmu.reference import Point
from jointfmu.validation import Row

from ...drawing import BLUE, GREEN, GREY, RED, labels, svg
from ...report.figure import Figure
from . import efficiency

_FMU = "HarmonicDriveCompliance"


def figures(outcome: Any) -> list[Figure]:
    """The figures of an outcome of the main job."""
    result = outcome.ramps[_FMU]
    return [
        Figure(
            "Harmonic drive: stiffness over torque",
            "Left: K_WTS and its parts on the drive's scale, as the FMU gives them. Right: the contact "
            "pair on the scale of the paper's figures.",
            stiffness(result, outcome.rows),
            f"{_FMU}.csv",
        ),
        Figure(
            "Harmonic drive: torque over wind-up",
            "The integral of dT/K_WTS, odd in the torque.",
            torque_angle(result),
            f"{_FMU}.csv",
        ),
        Figure(
            "Harmonic drive: what friction costs",
            "By the FMU with the friction of catalogue drives. Left: efficiency over load; its speed "
            "dependence follows from an estimated running torque, and no catalogue's curve is compared. "
            "Right: torque at which drives begin to move over the catalogue's; the starting torque fixes "
            "friction_coulomb, the back-driving torque load_loss where that is not below 0.",
            friction(_spring(outcome)),
        ),
    ]


def _spring(outcome: Any) -> Path:
    """The FMU between two flanges, FMI 2.0."""
    paths: list[Path] = outcome.built
    return next(p for p in paths if (p.parent.name, p.stem) == ("fmi2", "HarmonicDriveSpring"))


def stiffness(result: RampResult, rows: list[Row]) -> str:
    """K_WTS and its parts over torque, with the published points on the curves."""

    def draw(canvas: Canvas) -> None:
        c = result.columns
        drive, pair = canvas.subplots(1, 2)
        for name, color in (("K_WTS", BLUE), ("K_TS", RED), ("K_FTS", GREEN)):
            drive.plot(c["tau"], c[name] / 1e3, color=color, label=name)
        pair.plot(c["tau"], c["K_TS_pair"], color=RED, label="K_TS on the paper's scale")
        least = {row.point.where["torque"]: row for row in rows if row.point.quantity == "K_TS_least"}
        most = [r for r in rows if r.point.quantity == "K_TS" and "deformation" in r.point.where]
        x = [r.point.where["torque"] for r in most]
        pair.plot(x, [r.computed for r in most], "_", color=GREY, ms=14, label="largest and least over w")
        pair.plot(list(least), [r.computed for r in least.values()], "_", color=GREY, ms=14)
        points = [row.point for row in rows]
        _mark(drive, [p for p in points if p.quantity == "K_WTS"], 1e-3)
        _mark(pair, [p for p in points if p.quantity in ("K_TS", "K_TS_least")], 1.0)
        for axes in (drive, pair):
            axes.legend(loc="best", fontsize=8)
        labels(drive, "torque [N m]", "stiffness [kN m/rad]")
        labels(pair, "torque [N m]", "K_TS [N m/rad]")

    return svg(draw, (9.6, 4.2))


def _mark(axes: Axes, points: list[Point], scale: float) -> None:
    """Published stiffness over torque, in the marks of the points' roles."""
    for role in dict.fromkeys(p.role for p in points):
        some = [p for p in points if p.role == role]
        axes.plot([p.where["torque"] for p in some], [scale * p.value for p in some], **published_mark(role))


def torque_angle(result: RampResult) -> str:
    """Wind-up over torque, both signs."""

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        tau, angle = result.columns["tau"], np.degrees(result.columns["phi_rel"]) * 60.0
        axes.plot(np.concatenate([-angle[::-1], angle]), np.concatenate([-tau[::-1], tau]), color=BLUE)
        axes.set_xlabel("wind-up at the output [arcmin]")
        axes.set_ylabel("torque [N m]")

    return svg(draw)


def friction(fmu: Path) -> str:
    """Efficiency over load at some speeds, and torques that set the catalogue's drives in motion."""
    drives = efficiency.catalogue()

    def draw(canvas: Canvas) -> None:
        over_load, beside = canvas.subplots(1, 2, width_ratios=(3, 2))
        for drive, style in zip(drives, ("-", "--"), strict=True):
            share = np.linspace(0.02, 1.0, 25)
            with efficiency.bench(fmu, drive.parameters) as bench:
                for rpm, color in ((500, GREEN), (2000, BLUE), (3500, RED)):
                    found = [bench.efficiency(rpm * np.pi / 30.0, x * drive.rated_torque) for x in share]
                    over_load.plot(share, found, style, color=color, label=f"{drive.name}, {rpm} rpm")
                back = bench.back_driving_torque(10.0 * drive.back_driving_torque)
                start = bench.starting_torque()
            ratios = [start / drive.starting_torque, back / drive.back_driving_torque]
            beside.plot(["starting", "back-driving"], ratios, "o", label=drive.name)
        over_load.legend(fontsize=8)
        labels(over_load, "load over rated torque", "efficiency")
        beside.axhline(1.0, color=GREY, lw=0.8)
        beside.set_ylim(0.8, 1.2)
        beside.set_ylabel("FMU over catalogue")
        beside.legend(fontsize=8)

    return svg(draw, (9.6, 4.2))
