"""How an FMU gets to the workers of a sweep (needs dask.distributed)."""

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin

from .worker import LoadRamp, one_run, slim

FILES: dict[str, Path] = {}
"""{key: path} of the FMUs that this worker has."""


def distributed_run(
    key: str, drive: LoadRamp, index: int, settings: Mapping[str, object]
) -> dict[str, object]:
    """`one_run` on a worker that has the FMU."""
    return one_run(FILES[key], drive, index, settings)


class FmuDistribution(WorkerPlugin):  # type: ignore[misc]
    """Gives an FMU to every worker, also to one that is started later, and takes it away in the end.

    Only what the machine runs is kept of it, so that it unpacks faster for every run.
    """

    def __init__(self, key: str, file_name: str, data: bytes) -> None:
        self.key, self.file_name, self.data = key, file_name, data

    def setup(self, worker: Any) -> None:
        folder = Path(tempfile.mkdtemp(prefix="fmu-", dir=worker.local_directory))
        full = folder / f"{self.file_name}.full"
        full.write_bytes(self.data)
        slim(full, folder / self.file_name)
        full.unlink()
        FILES[self.key] = folder / self.file_name

    def teardown(self, worker: Any) -> None:
        if path := FILES.pop(self.key, None):
            shutil.rmtree(path.parent, ignore_errors=True)
