"""The figure of the report: stiffness and approach over load."""

from typing import Any

from ...report.figure import Figure, Panel, Series

_FMU = "GearContact"


def figures(outcome: Any) -> list[Figure]:
    """The figure of an outcome of the main job."""
    c = outcome.ramps[_FMU].columns
    load = c["f"] / 1e3
    panels = [
        Panel("Stiffness over load", "load [kN]", "K_N [N/um]", [Series("K_N", load, c["K_N"] / 1e6)]),
        Panel("Approach over load", "load [kN]", "s_rel [um]", [Series("s_rel", load, c["s_rel"] * 1e6)]),
    ]
    text = "Up to about a tenth of the nominal area in real contact."
    return [Figure("Stiffness and approach over load", text, panels, data=f"{_FMU}.csv")]
