"""The report page of all joints: a tab per joint with figures, comparison with published numbers, checks."""

import platform
from pathlib import Path
from typing import Any

from jointfmu_fmu_src.joint_parts.chart import encode_panels
from jointfmu_fmu_src.templates import load_jinja_template

from jointfmu.files.timestamp import get_build_time
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.joints.kind import JointKind
from jointfmu.version import __version__

from ...common.joint_parts import load_tool_module
from ...studies.published.law_reference import format_law_summary
from ...studies.published.reference import POINT_ROLES
from ...studies.published.validation import (
    format_claim,
    format_error,
    format_tolerance,
    format_validation_summary,
)
from ...systems.system import load_systems
from .figure import Figure, read_page_script, read_style_sheet
from .systems import motion_figures, resonance_figures, ring_down_figures


def build_figures(pipeline_result: Any) -> dict[str, list[Figure]]:
    """Build the figures of the report for all joints: {joint: figures}.

    pipeline_result : result of `python build_fmus.py` with simulated systems
    """
    return {name: _joint_figures(kind, pipeline_result) for name, kind in KINDS.items()}


def write_report(page_path: Path, pipeline_result: Any) -> None:
    """Write the report page of all joints; it contains its scripts and data.

    pipeline_result : result of `python build_fmus.py`, with the figures of `build_figures`
    """
    page = load_jinja_template(Path(__file__).with_name("page.html")).render(
        version=__version__,
        python=platform.python_version(),
        when=get_build_time().strftime("%Y-%m-%d %H:%M UTC"),
        outcome=pipeline_result,
        roles=POINT_ROLES,
        law_sentence=format_law_summary(pipeline_result.law_comparisons),
        sentence=format_validation_summary(pipeline_result.validated_points),
        shown_error=format_error,
        shown_tolerance=format_tolerance,
        shown_claim=format_claim,
        fmu_values={
            (r.published_point.paper, r.published_point.id): r for r in pipeline_result.fmu_validated_points
        },
        tabs=[_tab_template_variables(kind, pipeline_result) for kind in KINDS.values()],
        style=read_style_sheet(),
        script=read_page_script("tabs.js"),
    )
    write_text(page_path, page)


def _tab_template_variables(joint_kind: JointKind, pipeline_result: Any) -> dict[str, Any]:
    """Template variables for the tab of one joint."""
    names = [model.name for model in joint_kind.models]
    kinds = {name: {j.joint_kind for j in system.joints.values()} for name, system in load_systems().items()}
    names += [name for name, joints in kinds.items() if joint_kind.name in joints]
    return {
        "name": joint_kind.name,
        "title": joint_kind.title,
        "figures": [
            (figure, encode_panels(figure.plot_panels))
            for figure in pipeline_result.report_figures[joint_kind.name]
        ],
        "rows": [
            row for row in pipeline_result.validated_points if row.published_point.joint == joint_kind.name
        ],
        "checks": [check for check in pipeline_result.numerical_checks if check.fmu_name in names],
        "proofs": [proof for proof in pipeline_result.fmu_proofs if proof.fmu_path.stem in names],
    }


def _joint_figures(joint_kind: JointKind, pipeline_result: Any) -> list[Figure]:
    """Figures of one joint in the report: published comparisons, loops, systems."""
    module = load_tool_module(joint_kind, "figures")
    figures: list[Figure] = module.make_figures(pipeline_result) if module else []
    figures += [
        *resonance_figures(pipeline_result.free_vibrations, joint_kind.name, pipeline_result.fmi2_folder),
        *ring_down_figures(pipeline_result.free_decays, joint_kind.name),
    ]
    return figures + motion_figures(pipeline_result.arm_results, joint_kind.name)
