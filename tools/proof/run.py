"""Execute all experiments of an FMU and compare with its reference results."""

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu_fmu_src.proof.standard import CO_SIMULATION, MODEL_EXCHANGE

from jointfmu.progress import track

from ..host import unpacked
from .importers import PACKAGES, SYSTEM_LIBRARIES, VERSIONS, interfaces
from .manifest import Experiment, Related
from .outcome import Proof
from .plan import ExperimentPlan, task
from .values import has_start, start

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


@dataclass(frozen=True, slots=True)
class Expected:
    """What somebody else says of an FMU.

    source  : who
    starts  : {variable: start value}
    members : {path: content} of a manifest and its files
    """

    source: str
    starts: Mapping[str, object]
    members: Mapping[str, bytes]


def prove(fmu: Path, importer: str = "fmpy", expected: Expected | None = None) -> Proof:
    """Execute what the manifest of an FMU names, or another one.

    Raises ValueError, one line: no FMU, none that runs here, no manifest, a broken one, an importer that is
    not installed or does not know the FMU's version of FMI.
    """
    experiments = Related(fmu, expected.members if expected else None).experiments()
    _check_importer(importer)
    with unpacked(fmu, exchange=True) as (folder, description):
        if description.fmiVersion[0] not in VERSIONS[importer]:
            raise ValueError(
                f"{fmu}: is of FMI {description.fmiVersion}, {importer} takes "
                f"{' and '.join(f'{digit}.0' for digit in VERSIONS[importer])}"
            )
        offered = _offered(description)
        common = [name for name in interfaces(importer) if name in offered]
        if not common:
            raise ValueError(
                f"{fmu}: is for {' and '.join(offered)}, {importer} runs {' and '.join(interfaces(importer))}"
            )
        plans = [
            ExperimentPlan.of(fmu, folder, one, interface, description)
            for one in experiments
            for interface in _executed(one, common)
        ]
        starting = [v for v in description.modelVariables if has_start(v)]
        begin = {**task(fmu, folder, offered[0], outputs=[v.name for v in starting]), "start": True}
        tasks = [plan.task for plan in plans if plan.task]
        answers = _answers("fmpy", [begin, *(tasks if importer == "fmpy" else [])])
        first = next(answers)
        if "error" in first:
            return Proof(fmu, importer, common, 0, [f"start: {first['error']}"], [])
        found = {v.name: value for v, value in zip(starting, first["rows"][0], strict=True)}
        differing = [
            f"{v.name} starts at {_shown(found[v.name])}, modelDescription.xml says {v.start}"
            for v in starting
            if found[v.name] != start(v)
        ]
        differing += _differing(found, expected) if expected else []
        if importer != "fmpy":
            answers = _answers(importer, tasks)
        bar = track(plans, fmu.stem, len(plans))
        outcomes = [plan.outcome(next(answers) if plan.task else None) for plan in bar]
    return Proof(fmu, importer, common, len(starting), differing, outcomes)


def _check_importer(importer: str) -> None:
    """Raise ValueError, one line, if the package of an importer or a library that it loads is missing."""
    if find_spec(PACKAGES[importer]) is None:
        raise ValueError(
            f"the package {PACKAGES[importer]} is missing, needed to run FMUs in {importer}; "
            "install it with: pip install 'jointfmu[test]'"
        )
    if importer in SYSTEM_LIBRARIES:
        code = f"from {__package__}.importers import load; load({importer!r})"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, errors="replace")
        if done.returncode:
            reason = (done.stderr.strip() or f"exit status {done.returncode}").splitlines()[-1]
            raise ValueError(
                f"{importer} cannot be loaded ({reason}); on Debian, install {SYSTEM_LIBRARIES[importer]}"
            )


def _differing(found: Mapping[str, object], expected: Expected) -> list[str]:
    """A line for each start value that is not the one expected."""
    return [
        f"{name} {f'starts at {_shown(found[name])}' if name in found else 'is no parameter of the FMU'}, "
        f"{expected.source} says {_shown(value)}"
        for name, value in expected.starts.items()
        if name not in found or found[name] != value
    ]


def _offered(description: "ModelDescription") -> list[str]:
    """Interfaces of an FMU."""
    kinds = {CO_SIMULATION: description.coSimulation, MODEL_EXCHANGE: description.modelExchange}
    return [name for name, kind in kinds.items() if kind is not None]


def _executed(experiment: Experiment, common: Sequence[str]) -> Sequence[str]:
    """Interfaces in which an experiment is executed; one without a name if in none."""
    found = [] if experiment.unfit else [name for name in common if name in experiment.interfaces]
    return found or [""]


def _answers(importer: str, tasks: Sequence[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Answers of a `worker` process as they come; if it dies, the rest says so."""
    if not tasks:
        return
    command = [sys.executable, "-m", f"{__package__}.worker"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
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


def _shown(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)
