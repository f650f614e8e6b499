"""Long work: a bar or a line on standard error, where that is a terminal, and processes that share it."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from threading import Event, RLock, Thread
from typing import Any, TypeVar

T = TypeVar("T")
PATIENCE = 2.0
"""Time [s] after which a command says what it does."""
_now: dict[str, Any] = {"step": "", "bars": 0}
"""What goes on, and how many bars show it."""


def track(items: Iterable[T], text: str, total: int | None = None) -> Iterator[T]:
    """Pass items on, with a bar if tqdm (extra `build`) is there and standard error is a terminal."""
    try:
        from tqdm import tqdm
    except ImportError:
        yield from items
        return
    tqdm.set_lock(RLock())  # its own is shared by processes, and left behind by those that are ended
    _now["bars"] += 1
    try:
        yield from tqdm(items, desc=text, total=total, file=sys.stderr, disable=None, leave=False)
    finally:
        _now["bars"] -= 1


def step(text: str) -> None:
    """What goes on from here, for the line that `told` shows."""
    _now["step"] = text


@contextmanager
def told(name: str) -> Iterator[None]:
    """Show a line with name, step and seconds while work goes on without a bar, on a terminal."""
    if not sys.stderr.isatty():
        yield
        return
    out, done, began = sys.stdout, Event(), time.monotonic()
    step("")

    def clear() -> None:
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def show() -> None:
        while not done.wait(0.5):
            passed = time.monotonic() - began
            if passed > PATIENCE and not _now["bars"]:
                what = ", ".join(filter(None, (_now["step"], f"{passed:.0f} s")))
                print(f"\r{name}: {what}\x1b[K", end="", file=sys.stderr, flush=True)

    shower = Thread(target=show, daemon=True)
    shower.start()
    sys.stdout = _Clearing(out, clear)
    try:
        yield
    finally:
        sys.stdout = out
        done.set()
        shower.join()
        if time.monotonic() - began > PATIENCE:
            clear()


class _Clearing:
    """A stream before whose text the line goes away."""

    def __init__(self, stream: Any, clear: Callable[[], None]) -> None:
        self._stream, self._clear = stream, clear

    def write(self, text: str) -> int:
        """Write; the line is shown again below if the work goes on."""
        self._clear()
        return int(self._stream.write(text))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


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
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of each: they would spin in vain
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
