"""What a worker of a sweep does: one ramp of an FMU."""

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..host import runs
from ..ramps import ramp


@dataclass(frozen=True, slots=True)
class LoadRamp:
    """What every run of a sweep does with the FMU: see `ramp.run`."""

    input: str
    to: float
    step: float


def one_run(fmu: str, drive: LoadRamp, index: int, settings: Mapping[str, object]) -> dict[str, object]:
    """One run, on a worker that has the FMU: its ramp. A refusal is a result, too."""
    path = FILES[fmu]
    entry = {"run": index, "parameters": dict(settings)}
    try:
        done = ramp.run(path, drive.input, drive.to, drive.step, settings)
    except (ValueError, RuntimeError) as error:
        return {**entry, "error": str(error).replace(str(path), path.name)}
    columns = {key: column.tolist() for key, column in done.columns.items()}
    if bad := [key for key, column in done.columns.items() if not np.all(np.isfinite(column))]:
        return {**entry, "error": f"{bad[0]} is not finite"}
    return {**entry, "columns": columns}


FILES: dict[str, Path] = {}
"""{key: path} of the FMUs that this worker has."""


def slim(data: bytes) -> bytes:
    """The FMU without sources, documentation and other machines' binaries."""
    small = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as full, zipfile.ZipFile(small, "w") as less:
        for item in full.infolist():
            if runs(item.filename) and not item.is_dir():
                less.writestr(item, full.read(item))
    return small.getvalue()
