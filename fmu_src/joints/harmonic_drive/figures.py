"""Figures of the report: stiffness over torque, torque over wind-up."""

from typing import Any

import numpy as np

from jointfmu.ramp import RampResult
from jointfmu.validation import Row

from ...report.figure import Figure, Panel, Series, published

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
    ]


def stiffness(result: RampResult, rows: list[Row]) -> list[Panel]:
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
