"""The figures of the report, each as inline SVG."""

import numpy as np
from matplotlib.figure import Figure

from jointfmu.joints.bolted_joint.spring import BoltedJointSpring, bolt_pattern
from jointfmu.parameters import default
from jointfmu.ramp import Ramp
from jointfmu.validation import Row

from ..drawing import BLUE, GREEN, GREY, RED, labels, svg


def harmonic_stiffness(result: Ramp, rows: list[Row]) -> str:
    """K_WTS and its parts over torque, with the published points on the curves."""

    def draw(figure: Figure) -> None:
        c = result.columns
        drive, pair = figure.subplots(1, 2)
        for name, color in (("K_WTS", BLUE), ("K_TS", RED), ("K_FTS", GREEN)):
            drive.plot(c["tau"], c[name] / 1e3, color=color, label=name)
        pair.plot(c["tau"], c["K_TS_pair"], color=RED, label="K_TS on the paper's scale")
        least = {row.point.where["torque"]: row for row in rows if row.point.quantity == "K_TS_least"}
        most = [r for r in rows if r.point.quantity == "K_TS" and "deformation" in r.point.where]
        x = [r.point.where["torque"] for r in most]
        pair.plot(x, [r.computed for r in most], "_", color=GREY, ms=14, label="largest and least over w")
        pair.plot(list(least), [r.computed for r in least.values()], "_", color=GREY, ms=14)
        for row in rows:
            target = {"K_WTS": drive, "K_TS": pair, "K_TS_least": pair}.get(row.point.quantity)
            if target is None:
                continue
            filled = row.point.role == "validation"
            scale = 1e-3 if target is drive else 1.0
            target.plot(
                row.point.where["torque"],
                float(row.point.value) * scale,
                "o",
                color="black",
                mfc="black" if filled else "white",
                ms=5,
            )
        for axes in (drive, pair):
            axes.plot([], [], "o", color="black", mfc="white", ms=5, label="published, calibrates")
            axes.plot([], [], "o", color="black", ms=5, label="published, validates")
            axes.legend(loc="best", fontsize=8)
        labels(drive, "torque [N m]", "stiffness [kN m/rad]")
        labels(pair, "torque [N m]", "K_TS [N m/rad]")

    return svg(draw, (9.6, 4.2))


def torque_angle(result: Ramp) -> str:
    """Wind-up over torque, both signs."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        tau, angle = result.columns["tau"], np.degrees(result.columns["phi_rel"]) * 60.0
        axes.plot(np.concatenate([-angle[::-1], angle]), np.concatenate([-tau[::-1], tau]), color=BLUE)
        axes.set_xlabel("wind-up at the output [arcmin]")
        axes.set_ylabel("torque [N m]")

    return svg(draw)


def bolted_stiffness(result: Ramp) -> str:
    """Stiffness and damping of the bolted joint over preload."""

    def draw(figure: Figure) -> None:
        c = result.columns
        left, right = figure.subplots(1, 2)
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

    def draw(figure: Figure) -> None:
        spring = BoltedJointSpring.of(default("bolted_joint").values)
        share, xy = spring.shape.share, spring.shape.position * 1e3
        axes = figure.subplots(1, 2, sharey=True)
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
            figure.colorbar(points, ax=ax, label="pressure [MPa]", shrink=0.8)
        axes[0].set_ylabel("y [mm]")

    return svg(draw, (9.6, 5.0))


def gear_stiffness(result: Ramp) -> str:
    """Stiffness and approach of the gear contact over load."""

    def draw(figure: Figure) -> None:
        c = result.columns
        left, right = figure.subplots(1, 2)
        left.plot(c["f"] / 1e3, c["K_N"] / 1e9, color=BLUE)
        right.plot(c["f"] / 1e3, c["s_rel"] * 1e6, color=BLUE)
        labels(left, "load [kN]", "stiffness [kN/um]")
        labels(right, "load [kN]", "approach [um]")

    return svg(draw, (9.6, 3.8))
