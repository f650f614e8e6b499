"""The figure of the report: stiffness and approach over load."""

from typing import Any

from matplotlib.figure import Figure as Canvas

from jointfmu.ramp import RampResult

from ...drawing import BLUE, labels, svg
from ...report.figure import Figure

_FMU = "GearContact"


def figures(outcome: Any) -> list[Figure]:
    """The figure of an outcome of the main job."""
    return [
        Figure(
            "Gear contact: stiffness and approach over load",
            "Up to about a tenth of the nominal area in real contact.",
            stiffness(outcome.ramps[_FMU]),
            f"{_FMU}.csv",
        )
    ]


def stiffness(result: RampResult) -> str:
    """Stiffness and approach of the gear contact over load."""

    def draw(canvas: Canvas) -> None:
        c = result.columns
        left, right = canvas.subplots(1, 2)
        left.plot(c["f"] / 1e3, c["K_N"] / 1e9, color=BLUE)
        right.plot(c["f"] / 1e3, c["s_rel"] * 1e6, color=BLUE)
        labels(left, "load [kN]", "stiffness [kN/um]")
        labels(right, "load [kN]", "approach [um]")

    return svg(draw, (9.6, 3.8))
