"""Commands of the command line, and functions that several commands use.

Most commands are in a module of the same name.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...common import plots
from ...common.options import Option, format_option_flag
from ..command import format_default

if TYPE_CHECKING:
    from ...pages.report.figure import Panel


def declare_option(parser: argparse.ArgumentParser, joint_option: Option) -> None:
    """Declare an option, defined by a joint, in the parser of a command."""
    # argparse formats the text
    help_text = joint_option.help_text.replace("%", "%%") + format_default(joint_option.default)
    if joint_option.is_flag:
        parser.add_argument(format_option_flag(joint_option.name), action="store_true", help=help_text)
        return
    parser.add_argument(
        format_option_flag(joint_option.name),
        nargs="+" if joint_option.is_list else "?" if joint_option.lone_value else None,
        const=joint_option.lone_value or None,
        type=float if joint_option.is_number else str,
        default=joint_option.default,
        choices=joint_option.choices or None,
        required=joint_option.is_required,
        metavar=None if joint_option.choices else joint_option.metavar,
        help=help_text,
    )


def save_panels(picture_path: Path, plot_panels: "Sequence[Panel]", figure_size: tuple[float, float]) -> None:
    """Draw panels side by side and save them as a picture.

    figure_size : width and height [inch]
    """
    from ...pages.report.figure import draw_panels

    with plots.open_figure(picture_path, figure_size) as figure:
        draw_panels(figure, plot_panels)
