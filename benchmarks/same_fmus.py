"""Do FMUs give the same numbers as those of an earlier build?

    python benchmarks/same_fmus.py OLD NEW      # two folders `dist`

All experiments that the old FMUs carry are run with both, in every interface; a row for each FMU with the
output that differs most, over its largest value in the run. Exit status 1 if one differs by more than 1e-12
or is missing.
"""

import sys
from pathlib import Path

import numpy as np
from jointfmu_tools.run.host import unpack_fmu
from jointfmu_tools.run.proof.manifest import RelatedFiles
from jointfmu_tools.run.proof.plan import ExperimentPlan
from jointfmu_tools.run.proof.run import _offered_interfaces, _run_worker, _usable_interfaces
from validity_tables import heading, row

SAME = 1e-12
"""Largest difference, of an output's scale [1]."""


def runs(fmu, experiments):
    """{(experiment, interface): {output: course}, or what is wrong} of an FMU."""
    with unpack_fmu(fmu, model_exchange=True) as (folder, description):
        plans = [
            ExperimentPlan.create(fmu, folder, one, interface, description)
            for one in experiments
            for interface in _usable_interfaces(one, _offered_interfaces(description))
            if interface
        ]
        answers = _run_worker("fmpy", [plan.task for plan in plans if plan.task])
        found = {}
        for plan in plans:
            answer = next(answers) if plan.task else {"error": plan.refusal_reason}
            rows = [line for line in answer.get("rows", []) if line is not None]
            courses = dict(zip(plan.task.get("outputs", []), np.array(rows).T, strict=False))
            found[plan.experiment.name, plan.interface] = answer.get("error") or courses
    return found


def differences(old, new):
    """(share of the scale, what) of all that differs."""
    for name, courses in old.items():
        other = new.get(name, "is not run")
        if isinstance(courses, str) or isinstance(other, str):
            if courses != other:
                yield np.inf, f"{' '.join(name)}: {courses if isinstance(courses, str) else other}"
            continue
        for output, course in courses.items():
            change = np.abs(other[output] - course).max() if other[output].shape == course.shape else np.inf
            yield change and change / np.abs(course).max(), f"{' '.join(name)}: {output}"


def main(old, new):
    """Print the table."""
    heading("FMUs beside those of before", "FMU", "runs", "largest difference", "of")
    worst = 0.0
    for path in sorted(old.glob("*/*.fmu")):
        other = new / path.relative_to(old)
        experiments = RelatedFiles(path).read_experiments()
        before = runs(path, experiments)
        after = runs(other, experiments) if other.exists() else {}
        share, what = max(differences(before, after), default=(0.0, ""))
        row(path.relative_to(old), len(before), f"{share:.1e}", what if share else "")
        worst = max(worst, share)
    return int(not worst <= SAME)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
