"""Markdown tables, and the command line of a study.

This module also puts `tests` on the import path, where the package `oracles` is: import it first.
"""

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"
sys.path.append(str(ROOT / "tests"))


def print_table_row(*cells):
    """Print one row of a Markdown table."""
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def print_table_head(title, *columns):
    """Print the title and the head of a Markdown table."""
    print(f"\n{title}\n" if title else "")
    print_table_row(*columns)
    print("|" + "---|" * len(columns))


def print_table(columns, rows):
    """Print a Markdown table without a title."""
    print_table_head("", *columns)
    for cells in rows:
        print_table_row(*cells)


def format_mean_and_deviation(values, form="{:.2g}"):
    """Format mean and standard deviation of values over the first axis."""
    values = np.asarray(values)
    return f"{form.format(values.mean())} ± {form.format(values.std(ddof=1))}"


def run_study(
    description: str | None,
    sections: Mapping[str, Callable[..., object]],
    on_request: Sequence[str] = (),
    options: Mapping[str, Mapping[str, object]] | None = None,
) -> None:
    """Run the sections that the command line names; by default all except those `on_request`.

    sections : {name: function}; with options, the function gets the parsed options
    options  : {flag: keywords of argparse's add_argument}
    """
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    usual = [name for name in sections if name not in on_request]
    more = f"; on request: {', '.join(on_request)}" if on_request else ""
    parser.add_argument(
        "section", nargs="*", help=f"sections to run: {', '.join(usual)} (default: all of these){more}"
    )
    for flag, keywords in (options or {}).items():
        parser.add_argument(flag, **keywords)  # type: ignore[arg-type]
    given = parser.parse_args()
    if unknown := [name for name in given.section if name not in sections]:
        parser.error(f"section {unknown[0]}: unknown; the sections are {', '.join(sections)}")
    for name in given.section or usual:
        print(f"# {name}")
        sections[name](*[given] * bool(options))
        print(flush=True)
