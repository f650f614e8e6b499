"""Figures of the report: a mesh cycle at constant force, torque over angle."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure as Canvas

from jointfmu.joints.gear_mesh.pairs import pairs
from jointfmu.joints.gear_mesh.spring import GearMeshSpring
from jointfmu.parameters import default
from jointfmu.ramp import RampResult

from ...drawing import BLUE, GREEN, RED, labels, svg
from ...report.figure import Figure

_FMU = "GearMesh"
_FORCES = ((5e2, BLUE), (1e3, RED), (2e3, GREEN))
"""Constant forces of the mesh [N], and their colours."""


def figures(outcome: Any) -> list[Figure]:
    """The figures of an outcome of the main job."""
    return [
        Figure(
            "Gear mesh: stiffness and deflection over the mesh cycle",
            "At constant forces: tooth pairs come and go, and flanks that carry more are stiffer.",
            cycle(GearMeshSpring.of(default("gear_mesh").values)),
        ),
        Figure(
            "Gear mesh: torque over angle",
            "What turns wheel 1, wheel 2 held: backlash and the flanks of both sides. Right: first touch.",
            torque_angle(outcome.ramps[_FMU]),
            f"{_FMU}.csv",
        ),
    ]


def cycle(spring: GearMeshSpring) -> str:
    """Stiffness and deflection over two mesh cycles at constant forces."""

    def draw(canvas: Canvas) -> None:
        left, right = canvas.subplots(1, 2)
        phase = np.linspace(0.0, 2.0, 401)
        count, _ = pairs(spring.joint.contact_ratio, spring.joint.engagement, phase)
        for force, color in _FORCES:
            s = spring.curve.inverse(force / count)
            K = count * spring.curve.derivatives(s, 1)[1]
            left.plot(phase, K / 1e6, color=color, label=f"{force / 1e3:g} kN")
            right.plot(phase, s * 1e6, color=color, label=f"{force / 1e3:g} kN")
        labels(left, "phase of the mesh cycle", "stiffness [N/um]")
        labels(right, "phase of the mesh cycle", "deflection [um]")
        for axes in (left, right):
            axes.legend()

    return svg(draw, (9.6, 3.8))


def torque_angle(result: RampResult) -> str:
    """Torque on wheel 1 over its angle, both flanks, and near the first touch of the driving ones."""

    def draw(canvas: Canvas) -> None:
        whole, touch = canvas.subplots(1, 2)
        angle, torque = result.columns["phi1"] * 1e3, -result.columns["tau1"]
        whole.plot(np.concatenate([-angle[::-1], angle]), np.concatenate([-torque[::-1], torque]), color=BLUE)
        first = int(np.argmax(torque > 0.0))
        some = slice(max(first - 3, 0), first + 15)
        touch.plot(angle[some], torque[some], ".-", color=BLUE)
        for axes in (whole, touch):
            axes.set_xlabel("angle of wheel 1 [mrad]")
            axes.set_ylabel("torque [N m]")

    return svg(draw, (9.6, 3.8))
