"""The report page of all joints: a tab per joint with figures, comparison with published numbers, checks."""

import platform
from pathlib import Path
from typing import Any

from jointfmu_fmu_src.joint_parts.chart import encode_panels
from jointfmu_fmu_src.templates import load_template

from jointfmu import __version__
from jointfmu.files.timestamp import build_time
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.joints.kind import JointKind

from ..joint_parts import load_tool_module
from ..published.reference import ROLES
from ..published.validation import format_claim, format_error, format_tolerance, summary
from ..systems.system import systems
from .figure import Figure, page_script, style_sheet
from .systems import motion_figures, resonance_figures, ring_down_figures


def build_figures(outcome: Any) -> dict[str, list[Figure]]:
    """Build the figures of all joints: {joint: figures}.

    job_result : result of `python build_fmus.py` with simulated systems
    """
    return {name: _joint_figures(kind, outcome) for name, kind in KINDS.items()}


def write_report(path: Path, outcome: Any) -> None:
    """Write the self-contained page.

    outcome : result of `python build_fmus.py`, with the figures of `build_figures`
    """
    page = load_template(Path(__file__).with_name("page.html")).render(
        version=__version__,
        python=platform.python_version(),
        when=build_time().strftime("%Y-%m-%d %H:%M UTC"),
        outcome=outcome,
        roles=ROLES,
        sentence=summary(outcome.rows),
        shown_error=format_error,
        shown_tolerance=format_tolerance,
        shown_claim=format_claim,
        fmu_values={(r.point.paper, r.point.id): r for r in outcome.fmu_rows},
        tabs=[_tab_terms(kind, outcome) for kind in KINDS.values()],
        style=style_sheet(),
        script=page_script("tabs.js"),
    )
    write_text(path, page)


def _tab_terms(kind: JointKind, outcome: Any) -> dict[str, Any]:
    """Template variables for the tab of one joint."""
    names = [model.name for model in kind.models]
    kinds = {name: {j.kind for j in system.joints.values()} for name, system in systems().items()}
    names += [name for name, joints in kinds.items() if kind.name in joints]
    return {
        "name": kind.name,
        "title": kind.title,
        "figures": [(figure, encode_panels(figure.panels)) for figure in outcome.figures[kind.name]],
        "rows": [row for row in outcome.rows if row.point.joint == kind.name],
        "checks": [check for check in outcome.checks if check.fmu in names],
        "proofs": [proof for proof in outcome.proofs if proof.fmu.stem in names],
    }


def _joint_figures(kind: JointKind, outcome: Any) -> list[Figure]:
    module = load_tool_module(kind, "figures")
    figures: list[Figure] = module.figures(outcome) if module else []
    figures += [
        *resonance_figures(outcome.ringing, kind.name, outcome.fmi2_folder),
        *ring_down_figures(outcome.decays, kind.name),
    ]
    return figures + motion_figures(outcome.arms, kind.name)
