"""Figures of the report: stiffness and damping over preload, contact pressure."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure as Canvas

from jointfmu.fmi.ramp import RampResult
from jointfmu.joints.bolted_joint.law import bolt_pattern
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.parameters import default

from ...report.drawing import svg
from ...report.figure import Figure, Panel, Series

_FMU = "BoltedJoint"
_CASES = ((9e3, 0.0), (15e3, 4500.0))
"""Preload [N] and moment [N.m] of the maps."""
_SIZE, _TEXT = (4.6, 5.2), {"font.size": 12.0, "axes.titlesize": 12.0}
"""Of a map [inch]; of its text [pt], so that it can be read on a phone."""


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
            "White: bolts. First the preload of the published pressures, then the moment that shifts "
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
    spring = BoltedJointSpring.of_nodes(default("bolted_joint").values)
    share, xy = spring.shape.share, spring.shape.position * 1e3
    bolts = bolt_pattern(spring.joint).bolts * 1e3

    def drawn(load: float, moment: float) -> str:
        p = np.asarray(spring.curve.derivatives(spring.tightened(load, moment), 0)[0]) / 1e6

        def draw(canvas: Canvas) -> None:
            ax = canvas.subplots()
            size = 14.0 * share / share.max()
            points = ax.scatter(xy[:, 0], xy[:, 1], c=p, s=size, marker="s", cmap="viridis")
            ax.plot(*bolts.T, "o", color="white", mec="black", ms=6)
            ax.set_aspect("equal")
            ax.grid(False)
            ax.set_title(f"{load / 1e3:g} kN, {moment:g} N m: {p.min():.2f} to {p.max():.2f} MPa")
            ax.set_xlabel("x [mm]")
            ax.set_ylabel("y [mm]")
            canvas.colorbar(points, ax=ax, label="pressure [MPa]", shrink=0.8)

        return svg(draw, _SIZE, _TEXT, layout="tight")

    return [drawn(*case) for case in _CASES]
