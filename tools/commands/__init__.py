"""The commands of the command line, most of them modules of their names; what they share."""

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
    """Declare an option of a joint's part."""
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
    """Save panels side by side as a picture of a size [inch]."""
    from ..report.figure import drawn

    with plots.drawing(path, size) as figure:
        drawn(figure, panels)
