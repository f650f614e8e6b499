"""Runs of a study: in this process, in processes of this machine or on a cluster; kept in a folder or not."""

import math
import os
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from jointfmu.progress import run_jobs, track_progress

from . import journal
from .worker import Entry, RampEvaluator, Run, Settings, make_killed_run_entry, run_job

Mask = NDArray[np.bool_]
"""Boolean array: which runs are selected."""
SinglePrecisionArray = NDArray[np.float32]
"""Array of numbers in single precision, to save memory."""


@dataclass(frozen=True, slots=True)
class StudyExecution:
    """Processes that execute the runs of a study, and the folder that stores the results.

    study_folder      : folder that stores study and results; None: the results are not stored
    scheduler_address : address of a dask scheduler, whose workers do the runs; None: this machine does them
    process_count     : number of processes on this machine, if there is no scheduler; None: one for each core
    """

    study_folder: Path | None = None
    scheduler_address: str | None = None
    process_count: int | None = None


LOCAL_UNSAVED_EXECUTION = StudyExecution()
"""Runs on this machine, whose results are not written to a folder."""


@dataclass(frozen=True, slots=True)
class SampledOutputs:
    """Outputs of n runs, in single precision.

    output_arrays  : {name: (m, n)}; NaN for runs that failed
    error_messages : {index of a run that failed: error message}, in ascending order
    new_run_count  : number of runs that were not in the folder before
    """

    output_arrays: Mapping[str, SinglePrecisionArray]
    error_messages: Mapping[int, str]
    new_run_count: int

    @property
    def accepted_mask(self) -> Mask:
        """Mask (n) of the runs that did not fail, for statistics."""
        mask = np.ones(next(iter(self.output_arrays.values())).shape[1], dtype=bool)
        mask[list(self.error_messages)] = False
        return mask


def evaluate_runs(
    run_evaluator: RampEvaluator,
    run_settings: Sequence[Settings],
    output_names: Iterable[str],
    values_per_output: int,
    execution: StudyExecution = LOCAL_UNSAVED_EXECUTION,
    journal_file_name: str = journal.RUNS_FILE,
    progress_label: str = "samples",
) -> SampledOutputs:
    """Execute the runs that the folder of a study does not contain yet, and store each finished run.

    run_settings      : settings of all runs
    output_names      : outputs that are returned, of `values_per_output` values each
    journal_file_name : file of the runs in the folder

    The results do not depend on the order of the runs, or on the machine that executes them.

    Raises ValueError if dask is missing, the scheduler does not answer or the folder cannot be used,
    RuntimeError if the workers of the scheduler cannot do any run.
    """
    outputs = {
        name: np.full((values_per_output, len(run_settings)), np.nan, np.float32) for name in output_names
    }
    errors: dict[int, str] = {}

    def collect_entry(journal_entry: Entry) -> None:
        """Store the outputs, or the error, of a finished run."""
        if "error" in journal_entry:
            errors[journal_entry["run"]] = journal_entry["error"]
            return
        columns = journal_entry["columns"]
        if any(len(columns.get(name, ())) != values_per_output for name in outputs):
            text = (
                f"run {journal_entry['run']}: its columns are not those of the study; expected another folder"
            )
            raise ValueError(f"{execution.study_folder}: {text}")
        for name, values in outputs.items():
            values[:, journal_entry["run"]] = columns[name]

    with _open_journal(execution.study_folder, len(run_settings), journal_file_name) as kept:
        finished: set[int] = set()
        if kept:
            finished |= kept.finished_runs
            for entry in journal.read_journal_entries(kept.path.parent, journal_file_name):
                collect_entry(entry)
        pending = [(i, settings) for i, settings in enumerate(run_settings) if i not in finished]
        with closing(_execute_runs(run_evaluator, pending, execution)) as entries:
            for entry in track_progress(_write_to_journal(entries, kept), progress_label, len(pending)):
                collect_entry(entry)
    return SampledOutputs(outputs, dict(sorted(errors.items())), len(pending))


@contextmanager
def _open_journal(
    study_folder: Path | None, run_count: int, journal_file_name: str
) -> Iterator[journal.RunJournal | None]:
    """Context with the journal of a study's folder; None without a folder."""
    if study_folder is None:
        yield None
    else:
        with journal.RunJournal(study_folder, run_count, journal_file_name) as kept:
            yield kept


def _write_to_journal(
    finished_jobs: Iterable[Sequence[Entry]], run_journal: journal.RunJournal | None
) -> Iterator[Entry]:
    """Write the journal entries of each finished job to the file of runs, and yield them."""
    for entries in finished_jobs:
        if run_journal:
            run_journal.append_entries(*entries)
        yield from entries


def _execute_runs(
    run_evaluator: RampEvaluator, pending_runs: Sequence[Run], execution: StudyExecution
) -> Generator[Sequence[Entry]]:
    """Execute runs of a study, and yield the journal entries of each job when it ends."""
    size = run_evaluator.runs_per_job
    jobs = [pending_runs[i : i + size] for i in range(0, len(pending_runs), size)]
    if not jobs:
        return
    if execution.scheduler_address is None:
        yield from _run_locally(run_evaluator, jobs, execution.process_count)
    else:
        from .cluster import run_on_cluster

        yield from run_on_cluster(execution.scheduler_address, run_evaluator, jobs)


def _run_locally(
    run_evaluator: RampEvaluator, jobs: Sequence[Sequence[Run]], max_process_count: int | None
) -> Generator[Sequence[Entry]]:
    """Execute jobs (groups of runs) on this machine, and yield the journal entries of each job when it ends.

    jobs : runs of each job, which one process executes one after the other

    If the process of a job dies, its runs are repeated one by one, to find the run that kills the process.
    """
    processes = max_process_count or os.cpu_count() or 1
    with TemporaryDirectory(prefix="study-") as folder:
        installed = run_evaluator.install_files(Path(folder))
        if share := run_evaluator.runs_per_process:
            processes = min(processes, math.ceil(sum(map(len, jobs)) / share))
            if processes == 1:
                for job in jobs:
                    yield [installed.execute_run(*run) for run in job]
                return
        while jobs:
            died: list[Run] = []
            arguments = ((installed, Path(folder), job) for job in jobs)
            with closing(run_jobs(run_job, arguments, processes)) as finished:
                for (_, _, job), entries in finished:
                    if entries is not None:
                        yield entries
                    elif len(job) > 1:
                        died += job
                    else:
                        yield [make_killed_run_entry(*job[0])]
            jobs = [[run] for run in died]
