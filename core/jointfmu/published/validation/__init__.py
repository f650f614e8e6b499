"""Every published number beside the computed one."""

from .count import Counts, counts
from .rows import ValidatedPoint, compare, missed, validate
from .text import shown_claim, shown_error, shown_tolerance, summary, table

__all__ = [
    "Counts",
    "ValidatedPoint",
    "compare",
    "counts",
    "missed",
    "shown_claim",
    "shown_error",
    "shown_tolerance",
    "summary",
    "table",
    "validate",
]
