"""Long work: a bar or a line on standard error, where that is a terminal, and processes that share it."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from itertools import islice
from threading import Event, Lock, RLock, Thread
from typing import Any, TypeVar

J = TypeVar("J")
T = TypeVar("T")
MAX_ATTEMPTS = 4
"""How often a job is begun [1] whose process dies."""
PATIENCE = 2.0
"""Time [s] after which a command says what it does."""
_now: dict[str, Any] = {"step": "", "bars": 0}
"""What goes on, and how many bars show it."""
_STARTS = Lock()
"""Held while a process starts: standard error belongs to all threads."""


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


class _Pool(ProcessPoolExecutor):
    """Processes that start from nothing (spawn), and talk to this one by pipes: none opens a port."""

    def __init__(self, count: int) -> None:
        with _quiet_start():
            super().__init__(count, multiprocessing.get_context("spawn"), _follow_parent)

    def submit(self, /, *args: Any, **arguments: Any) -> Future[Any]:
        with _quiet_start():
            return super().submit(*args, **arguments)


@contextmanager
def processes(count: int | None = None) -> Iterator[Executor]:
    """Processes for functions and arguments that can be pickled; as many as there are cores by default.

    They print no errors and do not hear Ctrl-C; this process does, and ends them. They also end if this
    process is killed. The program that starts them needs a guard, `if __name__ == "__main__"`.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of each: they would spin in vain
    pool = _Pool(count or os.cpu_count() or 1)
    try:
        yield pool
    except BaseException:
        for process in multiprocessing.active_children():
            process.kill()
        pool.shutdown(cancel_futures=True)
        raise
    pool.shutdown()


def run_jobs(
    work: Callable[[J], T], jobs: Iterable[J], count: int | None = None
) -> Generator[tuple[J, T | None]]:
    """(job, result of the function) in the order in which jobs end, from `count` processes.

    A process does one job at a time, so that the job of a process that died is known: it is done again, and
    after MAX_ATTEMPTS its result is None. Raises what the function raises. Close the iterator, if it is left
    before its end: this ends the processes.
    """
    waiting = iter(jobs)
    with ExitStack() as entered:
        running: dict[Future[T], tuple[J, int, Executor]] = {}

        def begin(job: J, attempt: int, pool: Executor | None) -> None:
            try:
                pool = pool or entered.enter_context(processes(1))
                running[pool.submit(work, job)] = job, attempt, pool
            except BrokenProcessPool:  # its process died after its last job
                begin(job, attempt, None)

        for job in islice(waiting, count or os.cpu_count() or 1):
            begin(job, 1, None)
        while running:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                job, attempt, pool = running.pop(future)
                died = isinstance(future.exception(), BrokenProcessPool)
                if died and attempt < MAX_ATTEMPTS:
                    begin(job, attempt + 1, None)
                    continue
                for following in islice(waiting, 1):
                    begin(following, 1, None if died else pool)
                yield job, None if died else future.result()


@contextmanager
def _quiet_start() -> Iterator[None]:
    """Processes that start here do not hear Ctrl-C, which a terminal sends to all of them, and print no
    errors: when this process ends, they may just be starting.
    """
    with _STARTS, ExitStack() as after:
        if sys.platform != "win32":  # there they hear it until `_follow_parent`
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            after.callback(signal.pthread_sigmask, signal.SIG_SETMASK, before)
        with suppress(OSError):  # standard error is closed
            kept = os.dup(2)
            after.callback(os.close, kept)
            with open(os.devnull, "wb") as nowhere:
                os.dup2(nowhere.fileno(), 2)
            after.callback(os.dup2, kept, 2)
        yield


def _follow_parent() -> None:
    """What a process does as it starts: it is silent, ignores Ctrl-C, and ends when its parent has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    if parent := multiprocessing.parent_process():
        parent.join()
        os._exit(1)
