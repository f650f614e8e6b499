"""The process in which an importer runs: a crash, and what it prints, stay here.

It reads one JSON document, {"importer", "tasks"}, and answers with one line of JSON per task: {"rows",
"messages"} or {"error", "messages"}. A task that has "start" is read for its start values instead.
"""

import json
import os
import re
import signal
import sys
import tempfile
from typing import Any, TextIO

from . import importers
from .task import Task

_REFUSED = re.compile(r"fmi[23](?:Error|Fatal|Discard)\s+(?P<reason>\S.*)")
"""How ecos logs what an FMU refuses."""


def main() -> None:
    """Execute the tasks of standard input."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    document = json.load(sys.stdin)
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as log:
        for handle in (1, 2):  # also what libraries print
            os.dup2(log.fileno(), handle)
        known = importers.IMPORTERS[document["importer"]]
        for task in document["tasks"]:
            started = task.pop("start", False)
            execute = importers.start_values if started else known[task["interface"]]
            reply = _reply(execute, task, log)
            replies.write(json.dumps(reply) + "\n")
            replies.flush()


def _reply(execute: Any, task: dict[str, Any], log: TextIO) -> dict[str, Any]:
    """What becomes of a task; an error is one line, the FMU's own where it gives one."""
    begin, messages = log.seek(0, os.SEEK_END), list[str]()
    error = ""
    rows: Any = []
    try:
        asked = Task(**task)
        rows = asked.compared(execute(asked, messages))
    except Exception as failure:  # importers raise bare Exception
        error = " ".join(str(failure).split()) or type(failure).__name__
    log.seek(begin)
    refused = _REFUSED.search(log.read())
    if refused:
        error = refused["reason"]
    elif error and messages:
        error = messages[0]
    error = error.removeprefix(f"{task['fmu']}: ")
    return {"messages": messages} | ({"error": error} if error else {"rows": rows})


if __name__ == "__main__":
    main()
