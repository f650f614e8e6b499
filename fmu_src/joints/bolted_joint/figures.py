"""Figures of the report: stiffness and damping over preload, contact pressure."""

from typing import Any

from matplotlib.figure import Figure as Canvas

from jointfmu.joints.bolted_joint.law import bolt_pattern
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.parameters import default
from jointfmu.ramp import RampResult

from ...drawing import BLUE, RED, labels, svg
from ...report.figure import Figure

_FMU = "BoltedJoint"


def figures(outcome: Any) -> list[Figure]:
    """The figures of an outcome of the main job."""
    return [
        Figure(
            "Bolted joint: stiffness and damping over preload",
            "Normal (zz) and tangential (xx) direction; the damping is the viscous equivalent.",
            stiffness(outcome.ramps[_FMU]),
            f"{_FMU}.csv",
        ),
        Figure(
            "Bolted joint: contact pressure",
            "White: bolts. Left the preload of the published pressures, right the moment that shifts "
            "the bolt forces of the two rows by 5 kN.",
            pressure_map(9e3),
        ),
    ]


def stiffness(result: RampResult) -> str:
    """Stiffness and damping of the bolted joint over preload."""

    def draw(canvas: Canvas) -> None:
        c = result.columns
        left, right = canvas.subplots(1, 2)
        for name, color in (("K_zz", BLUE), ("K_xx", RED)):
            left.plot(c["preload"] / 1e3, c[name] / 1e9, color=color, label=name)
        for name, color in (("C_zz", BLUE), ("C_xx", RED)):
            right.plot(c["preload"] / 1e3, c[name] / 1e3, color=color, label=name)
        labels(left, "preload per bolt [kN]", "stiffness [kN/um]")
        labels(right, "preload per bolt [kN]", "damping [kN s/m]")
        for axes in (left, right):
            axes.legend()

    return svg(draw, (9.6, 4.0))


def pressure_map(preload: float) -> str:
    """Contact pressure of the box specimen, without and with the bending moment of the paper."""

    def draw(canvas: Canvas) -> None:
        spring = BoltedJointSpring.of_nodes(default("bolted_joint").values)
        share, xy = spring.shape.share, spring.shape.position * 1e3
        axes = canvas.subplots(1, 2, sharey=True)
        cases = ((preload, 0.0), (15e3, 4500.0))
        maps = [spring.curve.derivatives(spring.tightened(*case), 0)[0] / 1e6 for case in cases]
        for ax, (load, moment), p in zip(axes, cases, maps, strict=True):
            points = ax.scatter(
                xy[:, 0], xy[:, 1], c=p, s=14.0 * share / share.max(), marker="s", cmap="viridis"
            )
            ax.plot(*(bolt_pattern(spring.joint).bolts * 1e3).T, "o", color="white", mec="black", ms=6)
            ax.set_aspect("equal")
            ax.grid(False)
            ax.set_title(
                f"{load / 1e3:g} kN, {moment:g} N m: {p.min():.2f} to {p.max():.2f} MPa", fontsize=10
            )
            ax.set_xlabel("x [mm]")
            canvas.colorbar(points, ax=ax, label="pressure [MPa]", shrink=0.8)
        axes[0].set_ylabel("y [mm]")

    return svg(draw, (9.6, 5.0))
