"""Markdown tables of benchmarks/validity.py."""

from pathlib import Path

import numpy as np

IMAGES = Path(__file__).resolve().parent.parent / "docs" / "images"


def row(*cells):
    """One line of a Markdown table."""
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def heading(title, *names):
    """Title and head of a table."""
    print(f"\n{title}\n")
    row(*names)
    print("|" + "---|" * len(names))


def spread(values, form="{:.2g}"):
    """Mean and standard deviation over the first axis, as text."""
    values = np.asarray(values)
    return f"{form.format(values.mean())} ± {form.format(values.std(ddof=1))}"
