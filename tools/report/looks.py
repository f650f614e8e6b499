"""Style and scripts of the pages of this folder."""

from pathlib import Path

from jointfmu_fmu_src.joint_parts import chart

from ..laboratory.assemble import web_file


def style() -> str:
    """The style sheet."""
    return chart.style() + web_file("style.css") + _own("report.css")


def script(*names: str) -> str:
    """The charts of the figures, and scripts of this folder that use them."""
    return chart.script("figures") + "".join(map(_own, names))


def _own(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")
