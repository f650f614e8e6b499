"""One run of a sweep: a load ramp of an FMU, in a worker process."""

import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.files import archives
from jointfmu.files.text import MAX_TEXT_LENGTH, replace_unprintable

from ...run.host import is_needed_to_run
from ...run.ramps import ramp

KILLED_MESSAGE = "the process of the run died"
"""Error message in the journal for a run whose process died."""


@dataclass(frozen=True, slots=True)
class LoadRamp:
    """Load ramp of all runs of a sweep: name of the driven input, end and step [unit of the input].

    See `ramp.run_ramp`.
    """

    input: str
    to: float
    step: float


def run_sample(
    fmu: Path, load_ramp: LoadRamp, index: int, settings: Mapping[str, object]
) -> dict[str, object]:
    """Run one load ramp, and return its journal entry: columns of results, or the error message.

    index    : index of the run in the study
    settings : start values of parameters and inputs
    """
    entry = {"run": index, "parameters": dict(settings)}
    try:
        result = ramp.run_ramp(fmu, load_ramp.input, load_ramp.to, load_ramp.step, settings)
    except (ValueError, RuntimeError) as error:
        return {
            **entry,
            "error": replace_unprintable(str(error).replace(str(fmu), fmu.name))[:MAX_TEXT_LENGTH],
        }
    columns = {key: column.tolist() for key, column in result.columns.items()}
    if not_finite := [key for key, column in result.columns.items() if not np.all(np.isfinite(column))]:
        return {**entry, "error": f"{not_finite[0]} is not finite"}
    return {**entry, "columns": columns}


def run_locally(job: tuple[Path, LoadRamp, int, Mapping[str, object]]) -> dict[str, object]:
    """Run one load ramp in a process of this machine; the FMU is unpacked next to its file.

    job : arguments of `run_sample`
    """
    tempfile.tempdir = str(job[0].parent)
    return run_sample(*job)


def write_slim_fmu(fmu: Path, slim_path: Path) -> None:
    """Write a copy `slim_path` of an FMU without sources, documentation and binaries of other platforms."""
    with archives.open_archive(fmu) as full, zipfile.ZipFile(slim_path, "w") as reduced:
        for item in full.infolist():
            if is_needed_to_run(item.filename) and not item.is_dir():
                reduced.writestr(item, archives.read_member(full, item.filename))
