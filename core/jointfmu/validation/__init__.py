"""Every published number beside the computed one."""

from .count import Counts, counts
from .rows import Row, compare, missed, natural_frequencies, validate
from .text import shown_claim, shown_error, shown_tolerance, summary, table

__all__ = [
    "Counts",
    "Row",
    "compare",
    "counts",
    "missed",
    "natural_frequencies",
    "shown_claim",
    "shown_error",
    "shown_tolerance",
    "summary",
    "table",
    "validate",
]
