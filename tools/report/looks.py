"""Style and scripts of the pages of this folder, which take their charts from the laboratory."""

from pathlib import Path

from ..laboratory import web_file


def style() -> str:
    """The style sheet."""
    return web_file("style.css") + _own("report.css")


def script(*names: str) -> str:
    """The charts, and scripts of this folder that use them."""
    return web_file("text.js") + web_file("chart.js") + "".join(map(_own, names))


def _own(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")
