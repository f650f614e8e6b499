"""Commands of the command line, and functions that several commands use.

Most commands are in a module of the same name.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...common import plots
from ...common.options import Option, format_option_flag

if TYPE_CHECKING:
    from ...pages.report.figure import Panel


def declare_option(parser: argparse.ArgumentParser, option: Option) -> None:
    """Add an option that a joint defines to the parser of a command."""
    help_text = option.help_text.replace("%", "%%")  # argparse formats the text
    if option.is_flag:
        parser.add_argument(format_option_flag(option.name), action="store_true", help=help_text)
        return
    parser.add_argument(
        format_option_flag(option.name),
        nargs="+" if option.is_list else "?" if option.lone_value else None,
        const=option.lone_value or None,
        type=float if option.is_number else str,
        default=option.default,
        choices=option.choices or None,
        required=option.is_required,
        metavar=None if option.choices else option.metavar,
        help=help_text,
    )


def save_panels(path: Path, panels: "Sequence[Panel]", figure_size: tuple[float, float]) -> None:
    """Draw panels side by side and save them as a picture.

    figure_size : width and height [inch]
    """
    from ...pages.report.figure import draw_panels

    with plots.open_figure(path, figure_size) as figure:
        draw_panels(figure, panels)
