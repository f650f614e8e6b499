"""A study whose run 5 ends its process, a job that sends half of a result. Their processes import little."""

import os
import struct
import sys
import time
from pathlib import Path
from typing import Any

from jointfmu_tools.studies.uncertainty.runs import StudyExecution, evaluate_runs
from jointfmu_tools.studies.uncertainty.worker import FmuRampEvaluator, LoadRamp


class DiesAtFive(FmuRampEvaluator):
    """Evaluator that ends its process at run 5; a job has four runs, so three other runs are lost too."""

    runs_per_job = 4

    def execute_run(self, run_number, settings):
        """Outputs of one run, the same for all runs; run 5 ends the process instead."""
        if run_number == 5:
            os._exit(11)
        columns = {"tau": [0.0, 1.0], "K_WTS": [1.0, 1.0]}
        return {"run": run_number, "parameters": dict(settings), "columns": columns}


def run_until_five_dies(fmu: Path, out: Path, **execution: Any) -> tuple[int, int, dict[int, str]]:
    """Number of rows and of new runs, and errors, of a study of 24 runs with this evaluator."""
    evaluator = DiesAtFive(fmu, LoadRamp("tau", 5.0, 1.0))
    done = evaluate_runs(evaluator, [{"surface.D": 2.5}] * 24, ["K_WTS"], 2, StudyExecution(out, **execution))
    return done.accepted_mask.size, done.new_run_count, dict(done.error_messages)


def send_half_of_result(sent: Path) -> None:
    """A job that writes the start of a result to the pipe of its pool, which expects 1000 bytes more.

    sent : folder: the job writes a file there and waits to be killed; other path: the job ends its process
    """
    sys._getframe(1).f_locals["result_queue"]._writer._send(struct.pack("!i", 1000))
    if not sent.is_dir():
        os._exit(11)
    (sent / "half").touch()
    time.sleep(100.0)
