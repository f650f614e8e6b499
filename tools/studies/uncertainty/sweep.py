"""Sweep: a study with an FMU, one load ramp for each sample, in processes of this machine or on a cluster."""

from collections.abc import Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from fnmatch import fnmatch
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from jointfmu_fmu_src.proof.standard import REFERENCE_FOLDER

from jointfmu.files import archives
from jointfmu.files.reading import read_bytes
from jointfmu.files.writing import write_text
from jointfmu.parameters import ParameterFile, load_parameter_file
from jointfmu.progress import run_jobs, track_progress
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ...common import columns
from ...run.host import unpack_fmu
from ...run.ramps import ramp
from . import journal
from .journal import Journal
from .problem import INTERVAL_SETTING, resolve_interval
from .propagate import QUANTILES
from .study import draw_samples, split_settings, unit_cube_points
from .worker import KILLED_MESSAGE, LoadRamp, run_locally, write_slim_fmu


@dataclass(frozen=True, slots=True)
class SweepSummary:
    """Summary of a sweep.

    run_count     : number of runs of the study
    new_runs      : number of runs finished by this call
    failed_count  : number of failed runs of the study
    first_failure : journal entry of the first failed run, or None
    """

    run_count: int
    new_runs: int
    failed_count: int
    first_failure: Mapping[str, Any] | None


def plan_runs(
    fmu: Path, load_ramp: LoadRamp, settings: Mapping[str, object], run_count: int, seed: int
) -> tuple[dict[str, object], list[dict[str, object]]]:
    """Plan a sweep: the study as a JSON object for its folder, and the settings of each of `run_count` runs.

    settings : {name: value or text of a distribution} of parameters and inputs
    seed     : seed of the Sobol' sequence

    Raises ValueError for a file that is not an FMU, an unknown name, a wrong distribution or ramp.
    """
    ramp.ramp_points(load_ramp.to, load_ramp.step)
    with unpack_fmu(fmu) as (_, description):
        variables = {v.name: v for v in description.modelVariables}
    inputs = [v.name for v in variables.values() if v.causality == "input"]
    settable = [v.name for v in variables.values() if v.causality in ("input", "parameter")]
    if load_ramp.input not in inputs:
        raise ValueError(f"{fmu}: unknown input {load_ramp.input!r}, allowed are {', '.join(inputs)}")
    for name in settings:
        if name not in settable:
            raise ValueError(f"{fmu}: unknown name {name!r}, allowed are {', '.join(settable)}")
        if name == load_ramp.input:
            raise ValueError(f"{fmu}: {name} is the input of the ramp; do not set it too")
    if INTERVAL_SETTING in settings.values():
        file = _parameter_file_of(fmu)
        settings = {name: resolve_interval(name, value, file) for name, value in settings.items()}
    real = [name for name in settable if variables[name].type in ("Real", "Float64")]
    plain, uncertain = split_settings(settings, {name: float(variables[name].start or 0.0) for name in real})
    if not uncertain:
        raise InputRefusal(
            "no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings"
        )
    if wrong := [parameter for parameter in uncertain if parameter.name not in real]:
        raise ValueError(
            f"{fmu}: {wrong[0].name} = {wrong[0].text}: is not a real number and cannot be uncertain"
        )
    samples = draw_samples(uncertain, unit_cube_points(run_count, len(uncertain), seed))
    runs = [plain | {name: float(column[i]) for name, column in samples.items()} for i in range(run_count)]
    record = {
        "fmu": fmu.name,
        "fmu_sha256": journal.sha256_text(read_bytes(fmu, "an FMU")),
        **asdict(load_ramp),
        "samples": run_count,
        "seed": seed,
        "parameters": {parameter.name: parameter.text for parameter in uncertain} | plain,
    }
    return record, runs


def _parameter_file_of(fmu: Path) -> ParameterFile:
    """Load the parameter file that an FMU contains with its experiments.

    Raises ValueError if the FMU contains none.
    """
    with archives.open_archive(fmu) as archive, TemporaryDirectory() as folder:
        members = [
            name for name in archive.namelist() if fnmatch(name, f"{REFERENCE_FOLDER}/parameters/*.toml")
        ]
        if parameter_files := [name for name in members if Path(name).name != "study.toml"]:
            file = Path(folder, Path(parameter_files[0]).name)
            file.write_bytes(archives.read_member(archive, parameter_files[0]))
            return load_parameter_file(file)
    raise ValueError(f"{fmu}: contains no parameter file; state LOW..HIGH in place of {INTERVAL_SETTING}")


def sweep(
    fmu: Path,
    load_ramp: LoadRamp,
    runs: Sequence[Mapping[str, object]],
    out: Path,
    scheduler: str | None = None,
    workers: int | None = None,
) -> SweepSummary:
    """Execute the runs that are not yet in the folder `out`, and write each run when it is finished.

    runs      : settings of all runs of the study
    out       : folder of the sweep, see `journal.claim_folder`
    scheduler : address of a dask scheduler, whose workers execute the runs
    workers   : number of processes on this machine, if there is no scheduler; None: one for each core

    At the end the quantiles of all finished runs are written to bands.csv in the folder.

    Raises ValueError if dask is missing or the scheduler does not answer, RuntimeError if its workers cannot
    execute any run (jointfmu is not installed there, or no worker is left).
    """
    with Journal(out, len(runs)) as runs_file:
        count_before = len(runs_file.finished_runs)
        todo = [i for i in range(len(runs)) if i not in runs_file.finished_runs]
        if todo:
            if scheduler is None:
                entries = _run_locally(fmu, load_ramp, runs, todo, workers)
            else:
                from .cluster import run_on_cluster

                entries = run_on_cluster(scheduler, fmu, load_ramp, runs, todo)
            with closing(entries) as finished:
                for entry in track_progress(finished, "sweep", len(todo)):
                    runs_file.add(entry)
        new_runs = len(runs_file.finished_runs) - count_before
        summary = SweepSummary(len(runs), new_runs, runs_file.failed_count, runs_file.first_failure)
    if summary.failed_count < summary.run_count:
        write_text(out / journal.BANDS_FILE, format_bands_csv(out, ramp.variable_units(fmu)))
    return summary


def _run_locally(
    fmu: Path,
    load_ramp: LoadRamp,
    runs: Sequence[Mapping[str, object]],
    pending: Sequence[int],
    workers: int | None,
) -> Generator[dict[str, object]]:
    """Execute runs in processes of this machine, and yield the journal entry of each run when it ends."""
    with TemporaryDirectory(prefix="sweep-") as folder:
        small = Path(folder, fmu.name)
        write_slim_fmu(fmu, small)
        jobs = [(small, load_ramp, i, runs[i]) for i in pending]
        with closing(run_jobs(run_locally, jobs, workers)) as finished:
            for (_, _, i, settings), entry in finished:
                yield entry or {"run": i, "parameters": dict(settings), "error": KILLED_MESSAGE}


def format_bands_csv(folder: Path, units: Mapping[str, str]) -> str:
    """CSV text: quantiles of each output at each point of the ramp, over all runs that did not fail."""
    runs: dict[str, list[Array]] = {}
    for entry in journal.read_entries(folder):
        for name, values in entry.get("columns", {}).items():
            runs.setdefault(name, []).append(np.asarray(values, dtype=np.float64))
    driven, *outputs = runs
    heads: list[columns.ColumnHead] = [(driven, units[driven])]
    table = [runs[driven][0]]
    for name in outputs:
        heads += [(f"{name} {100 * q:g} %", units[name]) for q in QUANTILES]
        table += list(np.quantile(np.stack(runs[name]), QUANTILES, axis=0))
    return columns.format_table(heads, table)
