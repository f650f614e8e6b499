"""Execute all experiments of an FMU and compare with its reference results."""

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from .. import ramp
from ..progress import track
from .importers import PACKAGES, VERSIONS
from .manifest import Related
from .outcome import Proof
from .plan import REAL, Plan, task

STARTS = (*REAL, "Boolean", "Integer", "Enumeration", "Int32", "Int64")
"""Types of variables whose start values are compared."""


def prove(fmu: Path, importer: str = "fmpy") -> Proof:
    """Execute what the manifest of an FMU names.

    Raises ValueError, one line: no FMU, none that runs here, no manifest, a broken one, an importer that is
    not installed or does not know the FMU's version of FMI.
    """
    experiments = Related(fmu).experiments()
    if find_spec(PACKAGES[importer]) is None:
        raise ValueError(
            f"the package {PACKAGES[importer]} is missing, needed to run FMUs in {importer}; "
            "install it with: pip install 'jointfmu[test]'"
        )
    with ramp.unpacked(fmu) as (folder, description):
        if description.fmiVersion[0] not in VERSIONS[importer]:
            raise ValueError(
                f"{fmu}: is of FMI {description.fmiVersion}, {importer} takes "
                f"{' and '.join(f'{digit}.0' for digit in VERSIONS[importer])}"
            )
        variables = {v.name: v for v in description.modelVariables}
        plans = [Plan.of(fmu, folder, experiment, description, variables) for experiment in experiments]
        starting = [
            v
            for v in description.modelVariables
            if v.causality in ("parameter", "input") and v.start is not None and v.type in STARTS
        ]
        begin = {**task(fmu, folder, outputs=[v.name for v in starting]), "start": True}
        (first,) = _answers("fmpy", [begin])
        if "error" in first:
            return Proof(fmu, importer, 0, [f"start: {first['error']}"], [])
        differing = [
            f"{v.name} starts at {_shown(value)}, modelDescription.xml says {v.start}"
            for v, value in zip(starting, first["rows"][0], strict=True)
            if value != _stated(v)
        ]
        answers = _answers(importer, [plan.task for plan in plans if plan.task])
        bar = track(plans, fmu.stem, len(plans))
        outcomes = [plan.outcome(next(answers) if plan.task else None) for plan in bar]
    return Proof(fmu, importer, len(starting), differing, outcomes)


def _answers(importer: str, tasks: Sequence[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Answers of a `worker` process as they come; if it dies, the rest says so."""
    if not tasks:
        return
    start = [sys.executable, "-m", f"{__package__}.worker"]
    with subprocess.Popen(
        start, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as work:
        assert work.stdin is not None
        assert work.stdout is not None
        try:
            with suppress(BrokenPipeError):  # it is gone; the end of its answers says so
                work.stdin.write(json.dumps({"importer": importer, "tasks": tasks}).encode())
                work.stdin.close()
            done = 0
            for line in work.stdout:
                done += 1
                yield json.loads(line)
            status = work.wait()
        finally:
            work.kill()
    for _ in tasks[done:]:
        yield {"error": f"{importer} ended with status {status}; the FMU's library may be broken"}


def _stated(variable: Any) -> Any:
    """A start value of modelDescription.xml as a number or truth value."""
    text = str(variable.start)
    if variable.type == "Boolean":
        return text in ("true", "1")
    return float(text) if variable.type in REAL else int(text)


def _shown(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)
