"""Runs of a sweep on the workers of a dask cluster."""

from collections import Counter
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path
from typing import Any
from uuid import uuid4

from .worker import KILLED_MESSAGE, LoadRamp

RUNS_PER_WORKER = 4
"""Runs submitted at once for each worker thread [1]: enough to keep the workers busy."""
MAX_RESTARTS = 3
"""Maximum number of restarts of a run whose result was lost with its worker [1]."""


def run_on_cluster(
    scheduler: str,
    fmu: Path,
    load_ramp: LoadRamp,
    runs: Sequence[Mapping[str, Any]],
    pending: Sequence[int],
) -> Generator[dict[str, object]]:
    """Run the ramps on a dask cluster, and yield the journal entry of each run when it ends.

    scheduler : address of the dask scheduler
    runs      : settings of all runs
    pending   : indices of the runs to be executed

    At most RUNS_PER_WORKER runs for each worker thread are submitted at the same time.

    Raises ValueError if dask is missing or the scheduler does not answer. Raises RuntimeError if the cluster
    has no worker, or a worker cannot run the FMU at all.
    """
    with _connect(scheduler) as client:
        from .plugin import FmuDistribution

        try:
            client.wait_for_workers(1, timeout=60)
        except TimeoutError:
            raise RuntimeError(f"{scheduler}: has had no worker for 60 s") from None
        key = f"jointfmu-{uuid4()}"
        client.register_plugin(FmuDistribution(key, fmu.name, fmu.read_bytes()), name=key)
        try:
            yield from _submit_runs(client, key, load_ramp, runs, pending)
        finally:
            with suppress(Exception):  # the scheduler may be gone
                client.unregister_worker_plugin(key)


@contextmanager
def _connect(scheduler: str) -> Iterator[Any]:
    """Connect to a dask scheduler; TLS settings are those of dask's own configuration."""
    try:
        from distributed import Client
    except ImportError as error:
        raise ValueError(
            f"the package {error.name or 'distributed'} is missing, needed for a sweep on a cluster; "
            "install it with: pip install 'jointfmu[cluster]'"
        ) from None
    try:
        client = Client(scheduler, timeout="10s")
    except (OSError, RuntimeError, TypeError, ValueError) as error:
        reason = " ".join(str(error).split())[:200]
        raise ValueError(
            f"scheduler = {scheduler}: cannot be reached ({reason}); expected tls://HOST:PORT or tcp://HOST:PORT"
        ) from None
    with client:
        yield client


def _submit_runs(
    client: Any, fmu_key: str, load_ramp: LoadRamp, runs: Sequence[Mapping[str, Any]], pending: Sequence[int]
) -> Iterator[dict[str, object]]:
    """Submit runs to a dask client, and yield the journal entry of each run when it ends.

    fmu_key : key under which the workers have the FMU
    """
    from distributed import KilledWorker, as_completed

    from .plugin import run_on_dask_worker

    waiting, indices, lost = iter(pending), {}, Counter[int]()

    def submit(index: int) -> object:
        future = client.submit(run_on_dask_worker, fmu_key, load_ramp, index, runs[index], pure=False)
        indices[future.key] = index
        return future

    ahead = RUNS_PER_WORKER * max(sum(client.nthreads().values()), 1)
    queue = as_completed([submit(i) for i in islice(waiting, ahead)])
    for future in queue:
        index = indices.pop(future.key)
        try:
            yield future.result()
        except KilledWorker:
            yield {"run": index, "parameters": dict(runs[index]), "error": KILLED_MESSAGE}
        except Exception as error:
            lost[index] += 1
            if not isinstance(error, CancelledError) or lost[index] > MAX_RESTARTS:
                text = " ".join(str(error).split())[:200]
                error_name = type(error).__name__
                raise RuntimeError(f"run {index}: the worker failed: {error_name}: {text}") from None
            queue.add(submit(index))  # its result was lost when another run killed the worker
            continue
        for following in islice(waiting, 1):
            queue.add(submit(following))
