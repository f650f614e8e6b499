"""A study over an FMU: one ramp per sample, many at a time in processes of this machine or of a cluster."""

from collections.abc import Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from fnmatch import fnmatch
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from jointfmu_fmu_src.proof.standard import FOLDER

from jointfmu.files import archives
from jointfmu.files.reading import read_bytes
from jointfmu.files.writing import write_text
from jointfmu.parameters import ParameterFile, load
from jointfmu.progress import run_jobs, track
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal

from .. import columns
from ..host import unpacked
from ..ramps import ramp
from . import journal
from .journal import Journal
from .problem import INTERVAL, of_source
from .propagate import QUANTILES
from .study import samples_of, split, unit_design
from .worker import KILLED, LoadRamp, local_run, slim


@dataclass(frozen=True, slots=True)
class Summary:
    """What a sweep did: runs in all, done by this call, failed in all, and the first failure."""

    runs: int
    now: int
    failed: int
    first_failure: Mapping[str, Any] | None


def plan(
    fmu: Path, drive: LoadRamp, given: Mapping[str, object], count: int, seed: int
) -> tuple[dict[str, object], list[dict[str, object]]]:
    """The study as a record for its folder, and the settings of each of `count` runs.

    Raises ValueError for a file that is no FMU, an unknown name, a wrong distribution or ramp.
    """
    ramp.steps(drive.to, drive.step)
    with unpacked(fmu) as (_, description):
        variables = {v.name: v for v in description.modelVariables}
    inputs = [v.name for v in variables.values() if v.causality == "input"]
    settable = [v.name for v in variables.values() if v.causality in ("input", "parameter")]
    if drive.input not in inputs:
        raise ValueError(f"{fmu}: unknown input {drive.input!r}, allowed are {', '.join(inputs)}")
    for name in given:
        if name not in settable:
            raise ValueError(f"{fmu}: unknown name {name!r}, allowed are {', '.join(settable)}")
        if name == drive.input:
            raise ValueError(f"{fmu}: {name} is driven by the ramp and cannot be set as well")
    if INTERVAL in given.values():
        file = _declared(fmu)
        given = {name: of_source(name, value, file) for name, value in given.items()}
    real = [name for name in settable if variables[name].type in ("Real", "Float64")]
    plain, uncertain = split(given, {name: float(variables[name].start or 0.0) for name in real})
    if not uncertain:
        raise Refusal("no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings")
    if wrong := [parameter for parameter in uncertain if parameter.name not in real]:
        raise ValueError(
            f"{fmu}: {wrong[0].name} = {wrong[0].text}: is no real number and cannot be uncertain"
        )
    drawn = samples_of(uncertain, unit_design(count, len(uncertain), seed))
    runs = [plain | {name: float(column[i]) for name, column in drawn.items()} for i in range(count)]
    record = {
        "fmu": fmu.name,
        "fmu_sha256": journal.digest(read_bytes(fmu, "an FMU")),
        **asdict(drive),
        "samples": count,
        "seed": seed,
        "parameters": {parameter.name: parameter.text for parameter in uncertain} | plain,
    }
    return record, runs


def _declared(fmu: Path) -> ParameterFile:
    """The parameter file that an FMU carries in its proof.

    Raises ValueError if it has none.
    """
    with archives.open_archive(fmu) as archive, TemporaryDirectory() as folder:
        inside = [name for name in archive.namelist() if fnmatch(name, f"{FOLDER}/parameters/*.toml")]
        if own := [name for name in inside if Path(name).name != "study.toml"]:
            file = Path(folder, Path(own[0]).name)
            file.write_bytes(archives.read_member(archive, own[0]))
            return load(file)
    raise ValueError(f"{fmu}: carries no parameter file; expected LOW..HIGH in place of {INTERVAL}")


def sweep(
    fmu: Path,
    drive: LoadRamp,
    runs: Sequence[Mapping[str, object]],
    out: Path,
    scheduler: str | None = None,
    workers: int | None = None,
) -> Summary:
    """Do the runs that a claimed folder does not have yet, each written when it is finished.

    scheduler : address of a dask scheduler, whose workers do the runs
    workers   : processes of this machine, if there is no scheduler; None: one per core

    Raises ValueError if dask is missing or the scheduler does not answer, RuntimeError if its workers cannot
    run at all (the package missing there, none left).
    """
    with Journal(out, len(runs)) as held:
        before = len(held.finished)
        todo = [i for i in range(len(runs)) if i not in held.finished]
        if todo:
            if scheduler is None:
                entries = _local_runs(fmu, drive, runs, todo, workers)
            else:
                from .cluster import cluster_runs

                entries = cluster_runs(scheduler, fmu, drive, runs, todo)
            with closing(entries) as finished:
                for entry in track(finished, "sweep", len(todo)):
                    held.add(entry)
        summary = Summary(len(runs), len(held.finished) - before, held.failed, held.first_failure)
    if summary.failed < summary.runs:
        write_text(out / journal.BANDS, bands_csv(out, ramp.units(fmu)))
    return summary


def _local_runs(
    fmu: Path,
    drive: LoadRamp,
    runs: Sequence[Mapping[str, object]],
    todo: Sequence[int],
    workers: int | None,
) -> Generator[dict[str, object]]:
    """Entries of runs as they end, in processes of this machine."""
    with TemporaryDirectory(prefix="sweep-") as folder:
        small = Path(folder, fmu.name)
        slim(fmu, small)
        jobs = [(small, drive, i, runs[i]) for i in todo]
        with closing(run_jobs(local_run, jobs, workers)) as finished:
            for (_, _, i, settings), entry in finished:
                yield entry or {"run": i, "parameters": dict(settings), "error": KILLED}


def bands_csv(folder: Path, units: Mapping[str, str]) -> str:
    """Quantiles of every output at every point of the ramp over the runs that did not fail, as CSV."""
    runs: dict[str, list[Array]] = {}
    for entry in journal.entries(folder):
        for name, values in entry.get("columns", {}).items():
            runs.setdefault(name, []).append(np.asarray(values, dtype=np.float64))
    driven, *outputs = runs
    heads: list[columns.Head] = [(driven, units[driven])]
    table = [runs[driven][0]]
    for name in outputs:
        heads += [(f"{name} {100 * q:g} %", units[name]) for q in QUANTILES]
        table += list(np.quantile(np.stack(runs[name]), QUANTILES, axis=0))
    return columns.text(heads, table)
