"""A study whose run 5 ends its process. Processes that do its runs import little."""

import os
from pathlib import Path
from typing import Any

from jointfmu_tools.studies.uncertainty.runs import Execution, evaluate_runs
from jointfmu_tools.studies.uncertainty.worker import FmuRamp, LoadRamp


class DiesAtFive(FmuRamp):
    """Evaluator that ends its process at run 5; a job has four runs, so three other runs are lost too."""

    runs_per_job = 4

    def run(self, index, settings):
        if index == 5:
            os._exit(11)
        columns = {"tau": [0.0, 1.0], "K_WTS": [1.0, 1.0]}
        return {"run": index, "parameters": dict(settings), "columns": columns}


def run_until_five_dies(fmu: Path, out: Path, **execution: Any) -> tuple[int, int, dict[int, str]]:
    """Number of rows and of new runs, and errors, of a study of 24 runs with this evaluator."""
    evaluator = DiesAtFive(fmu, LoadRamp("tau", 5.0, 1.0))
    done = evaluate_runs(evaluator, [{"surface.D": 2.5}] * 24, ["K_WTS"], 2, Execution(out, **execution))
    return done.accepted.size, done.new_run_count, dict(done.errors)
