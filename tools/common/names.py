"""Known names that are similar to an unknown name, for error messages."""

import math
import re
from collections.abc import Iterable
from difflib import SequenceMatcher

MIN_NAME_SIMILARITY = 0.6
"""Smallest ratio of equal letters [1] (`SequenceMatcher.ratio`) of two similar names."""


def find_similar_names(unknown_name: str, known_names: Iterable[str], max_name_count: int = 3) -> list[str]:
    """Find the known names that are most similar to a name; the list is empty if none is similar.

    Case and separators are ignored. The similarity of the letters decides first, then the ratios of the
    numbers in both names. If a name has four digits or more in a row, these may be two numbers (csg32100 is
    CSG-32-100): then letters and digits are compared as one text.
    """
    wanted = unknown_name.lower()
    joined = bool(re.search(r"\d{4}", wanted)) and not re.search(r"\d[\W_]\d", wanted)
    compared = r"[\W_]" if joined else "[^a-z]"

    def name_distance(known_name: str) -> tuple[float, ...]:
        known_text, wanted_text = (re.sub(compared, "", text) for text in (known_name.lower(), wanted))
        similarity = SequenceMatcher(None, known_text, wanted_text).ratio()
        numbers = ([float(n) for n in re.findall(r"[1-9]\d*", text)] for text in (known_name, wanted))
        ratios = () if joined else [abs(math.log(a / b)) for a, b in zip(*numbers, strict=False)]
        return -similarity, *ratios

    similar = [(d, known) for known in known_names if (d := name_distance(known))[0] <= -MIN_NAME_SIMILARITY]
    return [known for _, known in sorted(similar, key=lambda pair: pair[0])[:max_name_count]]


def suggest_names(unknown_name: str, known_names: Iterable[str], max_name_count: int = 1) -> str:
    """Format a suggestion for an error message: the most similar known names; empty if none is similar."""
    similar = find_similar_names(unknown_name, known_names, max_name_count)
    return f"; did you mean {' or '.join(similar)}?" if similar else ""
