"""Where a sweep runs: the workers of a dask scheduler, or processes of this machine."""

import logging
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_NO_DASK = "the package {} is missing, needed for a sweep; install it with: pip install 'jointfmu[sweep]'"


@contextmanager
def client(scheduler: str | None, workers: int | None) -> Iterator[Any]:
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
    with _deaf():
        cluster = LocalCluster(
            n_workers=workers,
            processes=True,
            threads_per_worker=1,
            dashboard_address=None,
            silence_logs=logging.CRITICAL,
        )
    with cluster, Client(cluster) as dask_client:
        dask_client.run(_quiet)
        yield dask_client


@contextmanager
def _deaf() -> Iterator[None]:
    """Processes started inside do not hear Ctrl-C, which a terminal sends to all: this one ends them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _quiet() -> None:
    """A local worker shares the terminal: no progress bars of single runs there."""
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115
