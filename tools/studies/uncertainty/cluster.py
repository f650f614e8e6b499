"""Runs of a study on the workers of a dask cluster."""

from collections import Counter, deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from itertools import islice
from typing import Any
from uuid import uuid4

from .worker import Entry, RampEvaluator, Run, make_killed_run_entry

JOBS_PER_WORKER = 4
"""Jobs submitted at once for each worker thread [1]: enough to keep the workers busy."""
MAX_WORKER_RESTARTS = 3
"""Maximum number of restarts of a job whose result was lost with its worker [1]."""


def run_on_cluster(
    scheduler_address: str, run_evaluator: RampEvaluator, jobs: Sequence[Sequence[Run]]
) -> Generator[list[Entry]]:
    """Execute runs on a dask cluster, and yield the journal entries of each job when it ends.

    scheduler_address : address of the dask scheduler
    jobs              : groups of runs; a worker executes one job at a time

    At most JOBS_PER_WORKER jobs for each worker thread are submitted at the same time.

    Raises ValueError if dask is missing or the scheduler does not answer. Raises RuntimeError if the cluster
    has no worker, or a worker cannot evaluate the study at all.
    """
    with _connect_to_scheduler(scheduler_address) as client:
        from .plugin import EvaluatorPlugin

        try:
            client.wait_for_workers(1, timeout=60)
        except TimeoutError:
            raise RuntimeError(
                f"{scheduler_address}: has had no worker for 60 s; start dask workers for this scheduler"
            ) from None
        key = f"jointfmu-{uuid4()}"
        client.register_plugin(EvaluatorPlugin(key, run_evaluator.embed_files()), name=key)
        try:
            yield from _submit_jobs(client, key, jobs)
        finally:
            with suppress(Exception):  # the scheduler may be gone
                client.unregister_worker_plugin(key)


@contextmanager
def _connect_to_scheduler(scheduler_address: str) -> Iterator[Any]:
    """Connect to a dask scheduler; TLS settings are those of dask's own configuration."""
    try:
        from distributed import Client
    except ImportError as error:
        raise ValueError(
            f"the package {error.name or 'distributed'} is missing, needed for a study on a cluster; "
            "install it with: pip install 'jointfmu[cluster]'"
        ) from None
    try:
        client = Client(scheduler_address, timeout="10s")
    except (OSError, RuntimeError, TypeError, ValueError) as error:
        reason = " ".join(str(error).split())[:200]
        raise ValueError(
            f"scheduler = {scheduler_address}: cannot be reached ({reason}); expected tls://HOST:PORT or tcp://HOST:PORT"
        ) from None
    with client:
        yield client


def _submit_jobs(dask_client: Any, study_key: str, jobs: Sequence[Sequence[Run]]) -> Iterator[list[Entry]]:
    """Submit jobs to a dask client, and yield the journal entries of each job when it ends.

    study_key : key under which the workers store the object that computes a run

    The runs of a job whose worker died are repeated at the end, one at a time with no other job on the
    cluster. So a run is recorded as the one that killed its worker only if it did.
    """
    from distributed import KilledWorker, as_completed

    from .plugin import run_on_dask_worker

    waiting, submitted, lost = iter(jobs), dict[str, Sequence[Run]](), Counter[int]()
    suspects = deque[Sequence[Run]]()

    def submit_job(job: Sequence[Run]) -> object:
        """Submit a job to the cluster, and remember it."""
        future = dask_client.submit(run_on_dask_worker, study_key, job, pure=False)
        submitted[future.key] = job
        return future

    ahead = JOBS_PER_WORKER * max(sum(dask_client.nthreads().values()), 1)
    queue = as_completed([submit_job(job) for job in islice(waiting, ahead)])
    is_suspect_alone = False
    for future in queue:
        job = submitted.pop(future.key)
        first_run = job[0][0]
        try:
            yield future.result()
        except KilledWorker:  # dask also raises it for jobs that only waited on the worker that died
            if is_suspect_alone:
                yield [make_killed_run_entry(*job[0])]
            else:
                suspects.extend([run] for run in job)
        except Exception as error:
            lost[first_run] += 1
            if not isinstance(error, CancelledError) or lost[first_run] > MAX_WORKER_RESTARTS:
                text = " ".join(str(error).split())[:200]
                error_name = type(error).__name__
                raise RuntimeError(f"run {first_run}: the worker failed: {error_name}: {text}") from None
            queue.add(submit_job(job))  # its result was lost when another run killed the worker
            continue
        for next_job in islice(waiting, 1):
            queue.add(submit_job(next_job))
        if suspects and not submitted:
            is_suspect_alone = True
            queue.add(submit_job(suspects.popleft()))
