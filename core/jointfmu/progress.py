"""Progress bars and status lines on standard error (only if it is a terminal), and worker processes."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from itertools import islice
from queue import SimpleQueue
from threading import Event, Lock, RLock, Thread, current_thread, main_thread
from typing import Any, TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")
MAX_JOB_ATTEMPTS = 4
"""Largest number of attempts [1] for a job whose process dies."""
STATUS_DELAY_ENVIRONMENT_VARIABLE = "JOINTFMU_STATUS_DELAY"
"""Environment variable with the time [s] of the first status line; inf: none."""
STATUS_DELAY = 2.0
"""Time [s] after which long work prints a status line."""
MAX_STATUS_PERIOD = 60.0
"""Time [s] between status lines where standard error is no terminal."""
_status_line: dict[str, Any] = {"step": "", "bars": 0, "is_shown": False}
"""Text of the current step of the work, number of progress bars on the screen, whether a status is shown."""
_PROCESS_START_LOCK = Lock()
"""Lock held while a process starts: its start redirects standard error, which all threads share."""


def track_progress(
    job_items: Iterable[Result], bar_label: str, item_count: int | None = None
) -> Iterator[Result]:
    """Yield the items; show a progress bar if tqdm (extra `build`) is installed and stderr is a terminal."""
    try:
        from tqdm import tqdm
    except ImportError:
        yield from job_items
        return
    tqdm.set_lock(RLock())  # tqdm's default lock is shared by processes, and left behind by killed ones
    _status_line["bars"] += 1
    try:
        yield from tqdm(
            job_items, desc=bar_label, total=item_count, file=sys.stderr, disable=None, leave=False
        )
    finally:
        _status_line["bars"] -= 1


def set_status_text(status_text: str) -> None:
    """Set the name of the current step of the work, which the status line shows."""
    _status_line["step"] = status_text


@contextmanager
def show_status(command_name: str) -> Iterator[None]:
    """Context that shows a status line: name of the command, current step, and elapsed seconds.

    The line disappears while a progress bar is shown. Where standard error is no terminal (a pipe, a
    notebook), it prints one line after STATUS_DELAY, and one every MAX_STATUS_PERIOD. Inside another such
    context it does nothing.
    """
    if _status_line["is_shown"]:
        yield
        return
    _status_line["is_shown"] = True
    try:
        with _show_outer_status(command_name):
            yield
    finally:
        _status_line["is_shown"] = False


@contextmanager
def _show_outer_status(command_name: str) -> Iterator[None]:
    """Context that shows the status line of a command; called once, by the outermost `show_status`."""
    if not sys.stderr.isatty():
        with _print_status_lines(command_name):
            yield
        return
    out, finished, began = sys.stdout, Event(), time.monotonic()
    set_status_text("")

    def clear_status() -> None:
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def print_status() -> None:
        while not finished.wait(0.5):
            elapsed = time.monotonic() - began
            if elapsed > STATUS_DELAY and not _status_line["bars"]:
                status = ", ".join(filter(None, (_status_line["step"], f"{elapsed:.0f} s")))
                print(f"\r{command_name}: {status}\x1b[K", end="", file=sys.stderr, flush=True)

    shower = Thread(target=print_status, daemon=True)
    shower.start()
    sys.stdout = _StatusClearingStream(out, clear_status)
    try:
        yield
    finally:
        sys.stdout = out
        finished.set()
        shower.join()
        if time.monotonic() - began > STATUS_DELAY:
            clear_status()


@contextmanager
def _print_status_lines(command_name: str) -> Iterator[None]:
    """Context that prints whole status lines to standard error, for pipes and notebooks."""
    stream, finished, began = sys.stderr, Event(), time.monotonic()
    delay = float(os.environ.get(STATUS_DELAY_ENVIRONMENT_VARIABLE, STATUS_DELAY))
    set_status_text("")

    def print_lines() -> None:
        wait_time = delay
        while wait_time < float("inf") and not finished.wait(wait_time):
            step = _status_line["step"] or "working"
            line = f"{command_name}: {step}, {time.monotonic() - began:.0f} s"
            with suppress(OSError, ValueError):  # the stream is closed
                print(line, file=stream, flush=True)
            wait_time = MAX_STATUS_PERIOD

    printer = Thread(target=print_lines, daemon=True)
    printer.start()
    try:
        yield
    finally:
        finished.set()
        printer.join()


class _StatusClearingStream:
    """Output stream that clears the status line before it writes."""

    def __init__(self, output_stream: Any, clear_status: Callable[[], None]) -> None:
        self._stream, self._clear = output_stream, clear_status

    def write(self, output_text: str) -> int:
        """Clear the status line and write a text; the status is later printed again, below the text."""
        self._clear()
        return int(self._stream.write(output_text))

    def __getattr__(self, attribute_name: str) -> Any:
        return getattr(self._stream, attribute_name)


def map_jobs(
    worker_pool: Executor | None, job_function: Callable[..., Result], bar_label: str, *jobs: Sequence[object]
) -> list[Result]:
    """Apply a function to all jobs; return the results in the order of the jobs. Shows a progress bar.

    worker_pool : processes that share the jobs; None: this process does them
    jobs : one sequence for each argument of the function, with its values for all jobs, as for `map`
    """
    count = len(jobs[0])
    run = worker_pool.map if worker_pool and count > 1 else map
    return list(track_progress(run(job_function, *jobs), bar_label, count))


class _WorkerPool(ProcessPoolExecutor):
    """Process pool with the start method spawn; it communicates by pipes, without network ports."""

    def __init__(self, process_count: int) -> None:
        self._process_count = process_count
        with _quiet_start_context():
            super().__init__(process_count, multiprocessing.get_context("spawn"), _set_up_worker)

    def submit(self, /, *args: Any, **arguments: Any) -> Future[Any]:
        """Start a function in a worker process, with its arguments; returns the future result."""
        with _quiet_start_context():
            future = super().submit(*args, **arguments)
            if len(self._processes) == self._process_count:
                self._leave_results_to_workers()
        return future

    def kill(self) -> None:
        """Kill all child processes of this process, and end this pool.

        The waiting futures are cancelled first: Python 3.11 prints an error if a pool finds its processes
        dead while a cancelled future waits.
        """
        manager_thread: Any = self._executor_manager_thread
        self._leave_results_to_workers()
        self.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.kill()
        if manager_thread is not None:
            manager_thread.join()

    def _leave_results_to_workers(self) -> None:
        """Close this process's copy of the pipe's end to which the workers write.

        Otherwise this process waits forever for the rest of a result whose worker died while it was writing.
        """
        queue: Any = self._result_queue
        queue._writer.close()


@contextmanager
def worker_processes(process_count: int | None = None) -> Iterator[Executor]:
    """Context with a pool of worker processes; `process_count` None: one per core.

    Functions and arguments must be picklable. The workers print no errors and ignore Ctrl-C; this process
    handles Ctrl-C and ends them. They also end if this process is killed. The program that starts them needs
    a guard, `if __name__ == "__main__"`.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # per process: more threads would only wait
    pool = _WorkerPool(process_count or os.cpu_count() or 1)
    try:
        yield pool
    except BaseException:
        pool.kill()
        raise
    pool.shutdown()


def run_jobs(
    job_function: Callable[[Job], Result], jobs: Iterable[Job], process_count: int | None = None
) -> Generator[tuple[Job, Result | None]]:
    """Run a function for all jobs in several processes; yield (job, result) in the order of completion.

    Each process does one job at a time, so the job of a process that died is known. This job is repeated; its
    result is None after MAX_JOB_ATTEMPTS. Exceptions of the function are raised here. Close the iterator if
    you stop before its end: this ends the processes. `process_count` None: one process per core.
    """
    waiting = iter(jobs)
    finished: SimpleQueue[Future[Result]] = SimpleQueue()
    with ExitStack() as entered:
        running: dict[Future[Result], tuple[Job, int, Executor]] = {}

        def submit_job(job: Job, attempt_number: int, worker_pool: Executor | None) -> None:
            """Submit a job to a worker process, and store how many times the job was attempted."""
            try:
                worker_pool = worker_pool or entered.enter_context(worker_processes(1))
                future = worker_pool.submit(job_function, job)
            except BrokenProcessPool:  # its process died after its last job
                submit_job(job, attempt_number, None)
            else:
                running[future] = job, attempt_number, worker_pool
                future.add_done_callback(finished.put)

        for job in islice(waiting, process_count or os.cpu_count() or 1):
            with defer_interrupt():
                submit_job(job, 1, None)
        while running:
            future = finished.get()
            with defer_interrupt():
                job, attempt, pool = running.pop(future)
                died = isinstance(future.exception(), BrokenProcessPool)
                if died and attempt < MAX_JOB_ATTEMPTS:
                    submit_job(job, attempt + 1, None)
                    continue
                for next_job in islice(waiting, 1):
                    submit_job(next_job, 1, None if died else pool)
                result = None if died else future.result()
            yield job, result


@contextmanager
def defer_interrupt() -> Iterator[None]:
    """Context that defers Ctrl-C to its end, for code that an interrupt would leave with a lock held.

    The threads of a process pool would wait for the lock forever. Only the main thread is interrupted.
    """
    previous_handler = signal.getsignal(signal.SIGINT)
    if current_thread() is not main_thread() or previous_handler is None:
        yield
        return
    signals: list[int] = []
    signal.signal(signal.SIGINT, lambda number, frame: signals.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous_handler)
    if signals:
        signal.raise_signal(signals[0])


@contextmanager
def _quiet_start_context() -> Iterator[None]:
    """Context in which new processes start with Ctrl-C blocked and without standard error.

    A terminal sends Ctrl-C to all processes of a program, also to those that have just started.
    """
    with _PROCESS_START_LOCK, ExitStack() as cleanup:
        if sys.platform != "win32":  # on Windows Ctrl-C acts until `_set_up_worker` ignores it
            old_mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            cleanup.callback(signal.pthread_sigmask, signal.SIG_SETMASK, old_mask)
        with suppress(OSError):  # standard error is closed
            stderr_copy = os.dup(2)
            cleanup.callback(os.close, stderr_copy)
            with open(os.devnull, "wb") as nowhere:
                os.dup2(nowhere.fileno(), 2)
            cleanup.callback(os.dup2, stderr_copy, 2)
        yield


def _set_up_worker() -> None:
    """Set up a worker process: no standard error, ignore Ctrl-C, end when the parent process ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    Thread(target=_end_with_parent_process, daemon=True).start()


def _end_with_parent_process() -> None:
    """Wait until the parent process ends, then end this worker process."""
    if parent := multiprocessing.parent_process():
        parent.join()
        os._exit(1)
