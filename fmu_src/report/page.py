"""The page: figures, the table of published against computed, the checks."""

import platform
from pathlib import Path
from typing import Any

from jointfmu import __version__
from jointfmu.joints import KINDS
from jointfmu.parameters import write_text
from jointfmu.reference import ROLES
from jointfmu.stamp import build_time
from jointfmu.validation import shown_claim, shown_error, shown_tolerance, summary

from ..joints import part
from ..templates import template
from .figure import Figure
from .motion import motions
from .systems import resonances, ring_downs


def write_report(path: Path, outcome: Any) -> None:
    """Write the self-contained page of an outcome of the main job."""
    page = template(Path(__file__).with_name("page.html")).render(
        version=__version__,
        python=platform.python_version(),
        when=build_time().strftime("%Y-%m-%d %H:%M UTC"),
        outcome=outcome,
        roles=ROLES,
        sentence=summary(outcome.rows),
        shown_error=shown_error,
        shown_tolerance=shown_tolerance,
        shown_claim=shown_claim,
        fmu_values={(r.point.paper, r.point.id): r for r in outcome.fmu_rows},
        figures=[
            *_of_joints(outcome),
            *resonances(outcome.ringing),
            *ring_downs(outcome.decays),
            *motions(outcome.arms),
        ],
    )
    write_text(path, page)


def _of_joints(outcome: Any) -> list[Figure]:
    """The figures that the joints' files draw of an outcome."""
    modules = [part(kind, "figures") for kind in KINDS.values()]
    return [figure for module in modules if module for figure in module.figures(outcome)]
