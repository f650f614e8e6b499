"""A progress bar on standard error, where that is a terminal."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

T = TypeVar("T")


def track(items: Iterable[T], text: str, total: int | None = None) -> Iterator[T]:
    """Pass items on, with a bar if tqdm (extra `build`) is there and standard error is a terminal."""
    try:
        from tqdm import tqdm
    except ImportError:
        yield from items
        return
    yield from tqdm(items, desc=text, total=total, file=sys.stderr, disable=None, leave=False)
