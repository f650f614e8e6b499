"""Long work: a progress bar on standard error, where that is a terminal, and processes that share it."""

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from threading import RLock
from typing import TypeVar

T = TypeVar("T")


def track(items: Iterable[T], text: str, total: int | None = None) -> Iterator[T]:
    """Pass items on, with a bar if tqdm (extra `build`) is there and standard error is a terminal."""
    try:
        from tqdm import tqdm
    except ImportError:
        yield from items
        return
    tqdm.set_lock(RLock())  # its own is shared by processes, and left behind by those that are ended
    yield from tqdm(items, desc=text, total=total, file=sys.stderr, disable=None, leave=False)


def each(pool: Executor | None, work: Callable[..., T], text: str, *jobs: Sequence[object]) -> list[T]:
    """Results of a function for all jobs, in their order, with a bar.

    pool : processes that share several jobs; None: this one does them
    jobs : an argument of the function each
    """
    count = len(jobs[0])
    run = pool.map if pool and count > 1 else map
    return list(track(run(work, *jobs), text, count))


@contextmanager
def processes() -> Iterator[Executor]:
    """As many processes as there are cores, for functions and arguments that can be pickled.

    They print nothing and do not hear Ctrl-C; this process does, and ends them. The program that starts
    them needs a guard, `if __name__ == "__main__"`.
    """
    pool = ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), _quiet)
    try:
        yield pool
    except BaseException:
        for process in multiprocessing.active_children():
            process.kill()
        pool.shutdown(cancel_futures=True)
        raise
    pool.shutdown()


def _quiet() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115
