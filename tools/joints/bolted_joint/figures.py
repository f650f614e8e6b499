"""Figures of the report: stiffness and damping over preload, contact pressure."""

from typing import Any

from jointfmu.parameters import default

from ...ramps.ramp import RampResult
from ...report.figure import Figure, Panel, Series
from .picture import plan

_FMU = "BoltedJoint"
_CASES = ((9e3, 0.0), (15e3, 4500.0))
"""Preload [N] and moment [N.m] of the maps."""


def figures(outcome: Any) -> list[Figure]:
    """The figures of an outcome of the main job."""
    return [
        Figure(
            "Stiffness and damping over preload",
            "Normal (zz) and tangential (xx) direction; the damping is the viscous equivalent.",
            stiffness(outcome.ramps[_FMU]),
            data=f"{_FMU}.csv",
        ),
        Figure(
            "Contact pressure",
            "Bolts are numbered. First the preload of the published pressures, then the moment that shifts "
            "the bolt forces of the two rows by 5 kN.",
            pictures=pressure_maps(),
        ),
    ]


def stiffness(result: RampResult) -> list[Panel]:
    """Stiffness and damping of the bolted joint over preload."""
    c, over = result.columns, "preload per bolt [kN]"
    load = c["preload"] / 1e3
    return [
        Panel("Stiffness", over, "K [N/um]", [Series(n, load, c[n] / 1e6) for n in ("K_zz", "K_xx")]),
        Panel("Damping", over, "C [kN s/m]", [Series(n, load, c[n] / 1e3) for n in ("C_zz", "C_xx")]),
    ]


def pressure_maps() -> list[str]:
    """Contact pressure of the box specimen, without and with the bending moment of the paper."""
    joint = default("bolted_joint").values
    return [plan(joint, *case) for case in _CASES]
