"""Commands of the command line, most of them in a module of the same name. Functions that they share."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .. import plots
from ..command_line.common import flag
from ..joint_parts import Option

if TYPE_CHECKING:
    from ..report.figure import Panel


def declare(sub: argparse.ArgumentParser, option: Option) -> None:
    """Declare on the command line an option that a joint defines."""
    if option.flag:
        sub.add_argument(flag(option.name), action="store_true", help=option.text)
        return
    sub.add_argument(
        flag(option.name),
        nargs="+" if option.many else None,
        type=float if option.number else str,
        default=option.default,
        choices=option.choices or None,
        required=option.required,
        metavar=None if option.choices else option.metavar,
        help=option.text,
    )


def draw(path: Path, panels: "Sequence[Panel]", size: tuple[float, float]) -> None:
    """Draw panels side by side and save them as a picture.

    size : width and height [inch]
    """
    from ..report.figure import drawn

    with plots.drawing(path, size) as figure:
        drawn(figure, panels)
