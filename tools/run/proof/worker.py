"""Process in which an importer runs, so that crashes and printed output do not disturb the caller.

The process reads one JSON object, {"importer", "tasks"}, from standard input. It answers with one line of
JSON for each task: {"rows", "messages"} or {"error", "messages"}. For a task with "start", it reads the start
values of the outputs and simulates nothing.
"""

import json
import os
import re
import signal
import sys
import tempfile
from typing import Any, TextIO

from . import importers
from .task import ExperimentTask

_FMU_REFUSAL_PATTERN = re.compile(r"fmi[23](?:Error|Fatal|Discard)\s+(?P<reason>\S.*)")
"""Line in the log of ecos for a call that an FMU refused."""


def main() -> None:
    """Execute the experiments from standard input in an importer; write the answers to standard output."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    document = json.load(sys.stdin)
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as log:
        for handle in (1, 2):  # also what libraries print
            os.dup2(log.fileno(), handle)
        functions = importers.IMPORTERS[document["importer"]]
        for task in document["tasks"]:
            reads_start_values = task.pop("start", False)
            execute = importers.read_start_values if reads_start_values else functions[task["fmi_interface"]]
            reply = _execute_task(execute, task, log)
            replies.write(json.dumps(reply) + "\n")
            replies.flush()


def _execute_task(execute_experiment: Any, task_fields: dict[str, Any], log_file: TextIO) -> dict[str, Any]:
    """Execute an experiment in an importer; return its outputs or error, and the messages of the FMU.

    The answer is {"rows": outputs at the communication points} or {"error": text}, with "messages".

    execute_experiment : function of the importer
    log_file           : file with the output of the importer

    An error is one line: the message of the FMU if there is one, else that of the importer.
    """
    begin, messages = log_file.seek(0, os.SEEK_END), list[str]()
    error = ""
    rows: Any = []
    try:
        job = ExperimentTask(**task_fields)
        rows = job.mask_unneeded_rows(execute_experiment(job, messages))
    except Exception as failure:  # importers raise bare Exception
        error = " ".join(str(failure).split()) or type(failure).__name__
    log_file.seek(begin)
    if refused := _FMU_REFUSAL_PATTERN.search(log_file.read()):
        error = refused["reason"]
    error = error.removeprefix(f"{task_fields['fmu_path']}: ")
    return {"messages": messages} | ({"error": error} if error else {"rows": rows})


if __name__ == "__main__":
    main()
