"""Distribution of an FMU to the workers of a dask cluster (needs dask.distributed)."""

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin

from .worker import LoadRamp, run_sample, write_slim_fmu

FMU_PATHS: dict[str, Path] = {}
"""{key: path} of the FMUs stored on this worker."""


def run_on_dask_worker(
    key: str, load_ramp: LoadRamp, index: int, settings: Mapping[str, object]
) -> dict[str, object]:
    """Run one load ramp on a dask worker, with the FMU stored there under `key`; see `run_sample`."""
    return run_sample(FMU_PATHS[key], load_ramp, index, settings)


class FmuDistribution(WorkerPlugin):  # type: ignore[misc]
    """Dask plugin that stores an FMU on every worker, and deletes the FMU at the end.

    Workers that start later receive the FMU, too. Sources, documentation and binaries of other platforms are
    removed from the FMU, so that each run unpacks it faster.
    """

    def __init__(self, key: str, file_name: str, data: bytes) -> None:
        self.key, self.file_name, self.data = key, file_name, data

    def setup(self, worker: Any) -> None:
        folder = Path(tempfile.mkdtemp(prefix="fmu-", dir=worker.local_directory))
        full = folder / f"{self.file_name}.full"
        full.write_bytes(self.data)
        write_slim_fmu(full, folder / self.file_name)
        full.unlink()
        FMU_PATHS[self.key] = folder / self.file_name

    def teardown(self, worker: Any) -> None:
        if path := FMU_PATHS.pop(self.key, None):
            shutil.rmtree(path.parent, ignore_errors=True)
