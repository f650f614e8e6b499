"""What a process of a sweep does: one load ramp of an FMU."""

import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.files import archives
from jointfmu.files.text import MAX_TEXT_LENGTH, printable

from ..host import runs
from ..ramps import ramp

KILLED = "the process of the run died"
"""What the journal says of a run that ended its process."""


@dataclass(frozen=True, slots=True)
class LoadRamp:
    """What every run of a sweep does with the FMU: see `ramp.run`."""

    input: str
    to: float
    step: float


def one_run(fmu: Path, drive: LoadRamp, index: int, settings: Mapping[str, object]) -> dict[str, object]:
    """The entry of a run in the journal: columns of its ramp, or the FMU's refusal."""
    entry = {"run": index, "parameters": dict(settings)}
    try:
        done = ramp.run(fmu, drive.input, drive.to, drive.step, settings)
    except (ValueError, RuntimeError) as error:
        return {**entry, "error": printable(str(error).replace(str(fmu), fmu.name))[:MAX_TEXT_LENGTH]}
    columns = {key: column.tolist() for key, column in done.columns.items()}
    if bad := [key for key, column in done.columns.items() if not np.all(np.isfinite(column))]:
        return {**entry, "error": f"{bad[0]} is not finite"}
    return {**entry, "columns": columns}


def local_run(job: tuple[Path, LoadRamp, int, Mapping[str, object]]) -> dict[str, object]:
    """`one_run` in a process of this machine; what it unpacks lies beside the FMU."""
    tempfile.tempdir = str(job[0].parent)
    return one_run(*job)


def slim(fmu: Path, small: Path) -> None:
    """Write an FMU without sources, documentation and other machines' binaries."""
    with archives.open_archive(fmu) as full, zipfile.ZipFile(small, "w") as less:
        for item in full.infolist():
            if runs(item.filename) and not item.is_dir():
                less.writestr(item, archives.read_member(full, item.filename))
