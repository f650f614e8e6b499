"""Execute all experiments of an FMU in an importer, and compare with the reference results."""

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

from jointfmu.progress import track_progress

from ..host import unpack_fmu
from .importers import (
    DEBIAN_PACKAGES_OF_IMPORTERS,
    PYTHON_PACKAGES_OF_IMPORTERS,
    SUPPORTED_FMI_VERSIONS,
    list_supported_interfaces,
)
from .manifest import Experiment, RelatedFileReader
from .outcome import ProofResult
from .plan import ExperimentPlan, make_task_fields
from .values import has_start_value, read_start_value

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


@dataclass(frozen=True, slots=True)
class ExpectedFmuContents:
    """Start values and experiments that an FMU should contain, from another source than the FMU itself.

    source_name     : name of the source, for messages
    start_values    : {variable: start value}
    member_contents : {path: content} of a manifest and its related files, used instead of those in the FMU
    """

    source_name: str
    start_values: Mapping[str, object]
    member_contents: Mapping[str, bytes]


def prove(
    fmu_path: Path, importer_name: str = "fmpy", expected_contents: ExpectedFmuContents | None = None
) -> ProofResult:
    """Execute the experiments that an FMU contains in an importer; compare outputs with references.

    Raises ValueError, one line: no FMU, an FMU that does not run on this platform, no manifest, a broken
    manifest, an importer that is not installed or does not support the FMI version of the FMU.
    """
    experiments = RelatedFileReader(
        fmu_path, expected_contents.member_contents if expected_contents else None
    ).read_experiments()
    with unpack_fmu(fmu_path, accepts_model_exchange=True) as (folder, description):
        if description.fmiVersion[0] not in SUPPORTED_FMI_VERSIONS[importer_name]:
            raise ValueError(
                f"{fmu_path}: is of FMI {description.fmiVersion}, but {importer_name} takes only "
                f"{' and '.join(f'{digit}.0' for digit in SUPPORTED_FMI_VERSIONS[importer_name])}; choose "
                "another importer"
            )
        _check_importer(importer_name)
        offered = _offered_interfaces(description)
        common = [name for name in list_supported_interfaces(importer_name) if name in offered]
        if not common:
            raise ValueError(
                f"{fmu_path}: has only {' and '.join(offered)}, but {importer_name} runs only "
                f"{' and '.join(list_supported_interfaces(importer_name))}; choose another importer"
            )
        plans = [
            ExperimentPlan.plan_experiment(fmu_path, folder, experiment, interface, description)
            for experiment in experiments
            for interface in _usable_interfaces(experiment, common)
        ]
        started = [v for v in description.modelVariables if has_start_value(v)]
        start_task = {
            **make_task_fields(fmu_path, folder, offered[0], output_names=[v.name for v in started]),
            "start": True,
        }
        tasks = [plan.experiment_task_fields for plan in plans if plan.experiment_task_fields]
        answers = _run_worker("fmpy", [start_task, *(tasks if importer_name == "fmpy" else [])])
        first = next(answers)
        if "error" in first:
            return ProofResult(fmu_path, importer_name, common, 0, [f"start: {first['error']}"], [])
        starts = {v.name: value for v, value in zip(started, first["rows"][0], strict=True)}
        differences = [
            f"{v.name} starts at {_format_start_value(starts[v.name])}, modelDescription.xml says {v.start}"
            for v in started
            if starts[v.name] != read_start_value(v)
        ]
        differences += _list_start_value_differences(starts, expected_contents) if expected_contents else []
        if importer_name != "fmpy":
            answers = _run_worker(importer_name, tasks)
        tracked_plans = track_progress(plans, fmu_path.stem, len(plans))
        outcomes = [
            plan.evaluate_importer_answer(next(answers) if plan.experiment_task_fields else None)
            for plan in tracked_plans
        ]
    return ProofResult(fmu_path, importer_name, common, len(started), differences, outcomes)


def _check_importer(importer_name: str) -> None:
    """Raise ValueError, one line, if the package of an importer or a library that it loads is missing."""
    if find_spec(PYTHON_PACKAGES_OF_IMPORTERS[importer_name]) is None:
        raise ValueError(
            f"the package {PYTHON_PACKAGES_OF_IMPORTERS[importer_name]} is missing, needed to run FMUs in "
            f"{importer_name}; install it with: pip install 'jointfmu[test]'"
        )
    if importer_name in DEBIAN_PACKAGES_OF_IMPORTERS:
        code = f"from {__package__}.importers import load_importer; load_importer({importer_name!r})"
        command = [sys.executable, "-c", code]
        result = subprocess.run(command, capture_output=True, text=True, errors="replace")
        if result.returncode:
            reason = (result.stderr.strip() or f"exit status {result.returncode}").splitlines()[-1]
            raise ValueError(
                f"{importer_name} cannot be loaded ({reason}); on Debian, install "
                f"{DEBIAN_PACKAGES_OF_IMPORTERS[importer_name]}"
            )


def _list_start_value_differences(
    start_values: Mapping[str, object], expected_contents: ExpectedFmuContents
) -> list[str]:
    """List a line for each start value of the FMU that differs from the expected one.

    start_values : {variable: start value} of the FMU
    """
    missing, source = "is not an FMU parameter", expected_contents.source_name
    found = {name: f"starts at {_format_start_value(value)}" for name, value in start_values.items()}
    return [
        f"{name} {found.get(name, missing)}, {source} says {_format_start_value(value)}"
        for name, value in expected_contents.start_values.items()
        if name not in start_values or start_values[name] != value
    ]


def _offered_interfaces(model_description: "ModelDescription") -> list[str]:
    """FMI interfaces (co-simulation, model exchange) that an FMU offers."""
    kinds = {CO_SIMULATION: model_description.coSimulation, MODEL_EXCHANGE: model_description.modelExchange}
    return [name for name, kind in kinds.items() if kind is not None]


def _usable_interfaces(experiment: Experiment, common_interfaces: Sequence[str]) -> Sequence[str]:
    """FMI interfaces in which an experiment is executed; [""] if in none.

    common_interfaces : FMI interfaces of both FMU and importer
    """
    usable = (
        []
        if experiment.unsupported_reason
        else [name for name in common_interfaces if name in experiment.fmi_interfaces]
    )
    return usable or [""]


def _run_worker(
    importer_name: str, experiment_tasks: Sequence[Mapping[str, Any]]
) -> Iterator[dict[str, Any]]:
    """Execute experiments in an importer, in a process of its own, and yield its answers as they arrive.

    An answer is {"rows": outputs at the communication points} or {"error": text}. If the process dies, the
    remaining answers are errors.
    """
    if not experiment_tasks:
        return
    command = [sys.executable, "-m", f"{__package__}.worker"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            with suppress(BrokenPipeError):  # the process died: its answers end
                process.stdin.write(
                    json.dumps({"importer": importer_name, "tasks": experiment_tasks}).encode()
                )
                process.stdin.close()
            answered = 0
            for line in process.stdout:
                answered += 1
                yield json.loads(line)
            status = process.wait()
        finally:
            process.kill()
    for _ in experiment_tasks[answered:]:
        yield {"error": f"{importer_name} ended with status {status}; the FMU's library may be broken"}


def _format_start_value(start_value: object) -> str:
    """Format a start value as in modelDescription.xml."""
    return str(start_value).lower() if isinstance(start_value, bool) else repr(start_value)
