"""Compare FMUs with those of an earlier build: run all experiments of both, in every interface.

    python .ci/same_fmus.py OLD NEW      # two folders `dist`

The table has the output of each FMU with the largest difference, over the largest value of the output in the
run. The exit status is 1 if a difference is above 1e-12 or an FMU is missing.
"""

import sys
from pathlib import Path

import numpy as np
from jointfmu_tools.run.host import unpack_fmu
from jointfmu_tools.run.proof.manifest import RelatedFileReader
from jointfmu_tools.run.proof.plan import ExperimentPlan
from jointfmu_tools.run.proof.run import _offered_interfaces, _run_worker, _usable_interfaces

TOLERANCE = 1e-12
"""Largest difference over the largest value of an output [1]."""


def runs(fmu, experiments):
    """Run the experiments: {(experiment, interface): {output: values over time}, or an error message}."""
    with unpack_fmu(fmu, accepts_model_exchange=True) as (folder, description):
        plans = [
            ExperimentPlan.plan_experiment(fmu, folder, one, interface, description)
            for one in experiments
            for interface in _usable_interfaces(one, _offered_interfaces(description))
            if interface
        ]
        answers = _run_worker(
            "fmpy", [plan.experiment_task_fields for plan in plans if plan.experiment_task_fields]
        )
        found = {}
        for plan in plans:
            answer = next(answers) if plan.experiment_task_fields else {"error": plan.refusal_reason}
            rows = [line for line in answer.get("rows", []) if line is not None]
            outputs = dict(
                zip(plan.experiment_task_fields.get("output_names", []), np.array(rows).T, strict=False)
            )
            found[plan.experiment.experiment_name, plan.fmi_interface] = answer.get("error") or outputs
    return found


def differences(old, new):
    """Yield each difference over the scale of the output, and a description."""
    for name, outputs in old.items():
        other = new.get(name, "is not run")
        if isinstance(outputs, str) or isinstance(other, str):
            if outputs != other:
                yield np.inf, f"{' '.join(name)}: {outputs if isinstance(outputs, str) else other}"
            continue
        for output, values in outputs.items():
            change = np.abs(other[output] - values).max() if other[output].shape == values.shape else np.inf
            yield change and change / np.abs(values).max(), f"{' '.join(name)}: {output}"


def main(old, new):
    """Print the table."""
    print("| FMU | runs | largest difference | of |\n|---|---|---|---|")
    worst = 0.0
    for path in sorted(old.glob("*/*.fmu")):
        other = new / path.relative_to(old)
        experiments = RelatedFileReader(path).read_experiments()
        before = runs(path, experiments)
        after = runs(other, experiments) if other.exists() else {}
        share, what = max(differences(before, after), default=(0.0, ""))
        print(
            f"| {path.relative_to(old)} | {len(before)} | {share:.1e} | {what if share else ''} |", flush=True
        )
        worst = max(worst, share)
    return int(not worst <= TOLERANCE)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
