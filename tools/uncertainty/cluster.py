"""Where a sweep runs: the workers of a dask scheduler, or processes of this machine."""

import logging
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any, NoReturn, TypeVar, cast

T = TypeVar("T")

_NO_DASK = "the package {} is missing, needed for a sweep; install it with: pip install 'jointfmu[sweep]'"


@contextmanager
def client(scheduler: str | None, workers: int | None) -> Iterator[object]:
    """A dask client: of a scheduler's address, or of local processes.

    Raises ValueError if dask is missing or the scheduler does not answer.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise ValueError(_NO_DASK.format(error.name or "distributed")) from None
    if scheduler is not None:
        try:
            dask_client = Client(scheduler, timeout="10s")
        except (OSError, ValueError) as error:
            reason = " ".join(str(error).split())[:200]
            raise ValueError(
                f"scheduler = {scheduler}: cannot be reached ({reason}); expected tcp://HOST:PORT"
            ) from None
        with dask_client:
            yield dask_client
        return

    def local() -> tuple[Any, Any]:
        cluster = LocalCluster(
            n_workers=workers,
            processes=True,
            threads_per_worker=1,
            dashboard_address=None,
            silence_logs=logging.CRITICAL,
        )
        return cluster, Client(cluster)

    with _mute():
        started, dask_client = _without_interrupt(local)
        with started, dask_client:
            dask_client.run(_quiet)
            yield dask_client


@contextmanager
def _mute() -> Iterator[None]:
    """Processes that start here print no error; this one does.

    A worker that starts while this process ends would print a traceback of its own. After Ctrl-C it stays so:
    this process ends as well, see `leave`.
    """
    if sys.platform == "win32" or sys.stderr is not sys.__stderr__:  # somebody else has the stream
        yield
        return
    before = cast(Any, sys.stderr)
    before.flush()
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    sys.stderr = open(  # noqa: SIM115
        kept, "w", buffering=1, encoding=before.encoding, errors="backslashreplace"
    )
    os.dup2(nowhere, 2)
    os.close(nowhere)
    try:
        yield
    except KeyboardInterrupt:
        raise
    except BaseException:
        _unmute(before, kept)
        raise
    _unmute(before, kept)


def _unmute(before: object, kept: int) -> None:
    os.dup2(kept, 2)
    own: Any = sys.stderr
    own.close()
    sys.stderr = before


def _without_interrupt(make: Callable[[], T]) -> T:
    """What `make` returns. Processes that it starts do not hear Ctrl-C, which a terminal sends to all of its
    processes; this one hears it all the time.

    A signal that is blocked stays so in threads and processes started from there (on Windows they hear it).
    """
    made = Future[T]()

    def work() -> None:
        if sys.platform != "win32":
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            made.set_result(make())
        except BaseException as error:
            made.set_exception(error)

    if sys.platform != "win32":
        from multiprocessing import resource_tracker

        # Here, as it unblocks the signal where it starts; without its warning of what `leave` leaves.
        sys.warnoptions.append("ignore:resource_tracker")
        resource_tracker.ensure_running()
        sys.warnoptions.remove("ignore:resource_tracker")
    threading.Thread(target=work, daemon=True).start()
    return made.result()


def leave(status: int) -> NoReturn:
    """End this process and its workers at once: dask's orderly end takes seconds, or hangs as it starts."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for process in multiprocessing.active_children():
        process.kill()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def _quiet() -> None:
    """A local worker shares the terminal: no progress bars of single runs there."""
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115
