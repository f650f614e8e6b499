"""Distribution of a study to the workers of a dask cluster (needs dask.distributed)."""

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin

from .worker import Entry, RampEvaluator, Run

EVALUATORS: dict[str, tuple[RampEvaluator, Path]] = {}
"""{key of a study: its evaluator, and its folder} on this worker."""


def run_on_dask_worker(study_key: str, runs: Sequence[Run]) -> list[Entry]:
    """Execute some runs of a study on a dask worker; return their journal entries."""
    evaluator, _ = EVALUATORS[study_key]
    return [evaluator.execute_run(index, settings) for index, settings in runs]


class EvaluatorPlugin(WorkerPlugin):  # type: ignore[misc]
    """Dask plugin that gives every worker what it needs for the runs of a study, and removes it at the end.

    Workers that start later receive it, too.
    """

    def __init__(self, study_key: str, run_evaluator: RampEvaluator) -> None:
        self.key, self.evaluator = study_key, run_evaluator

    def setup(self, worker: Any) -> None:
        parent = Path(worker.local_directory)
        parent.mkdir(parents=True, exist_ok=True)  # dask may delete it when the previous worker process died
        folder = Path(tempfile.mkdtemp(prefix="study-", dir=parent))
        EVALUATORS[self.key] = self.evaluator.install_files(folder), folder

    def teardown(self, worker: Any) -> None:
        if installed := EVALUATORS.pop(self.key, None):
            shutil.rmtree(installed[1], ignore_errors=True)
