"""Result of a proof (check of an FMU against its references) as text and as one JSON object."""

from collections.abc import Iterator, Mapping

from jointfmu_fmu_src.proof.standard import EXPERIMENT_PURPOSES

from ...common.shown import align_columns
from .outcome import ExperimentOutcome, ProofResult, WorstPoint

MAX_PRINTED_FAILURES = 8
"""Largest number of failures that are printed one by one [1]; the tables have all experiments."""
_POINT_COLUMN_HEADINGS = ("time [s]", "value", "reference", "off by", "allowed")
"""Headings of the columns that describe the worst point."""
_EXPERIMENT_TABLE_HEADINGS = (
    "experiment",
    "interface",
    "verdict",
    "points",
    "worst output",
    *_POINT_COLUMN_HEADINGS,
)
"""Headings of the table of experiments."""
_OUTPUT_TABLE_HEADINGS = ("output", "worst in", "interface", *_POINT_COLUMN_HEADINGS)
"""Headings of the table of outputs."""


def format_proof_lines(proof_result: ProofResult) -> Iterator[str]:
    """Lines of the printed result of a proof: table of experiments, table of outputs, failures, summary.

    Each row of both tables has its worst point: that with the largest ratio of error to tolerance.
    """
    experiments: list[tuple[str, ...]] = [_EXPERIMENT_TABLE_HEADINGS]
    worst: dict[str, tuple[ExperimentOutcome, WorstPoint]] = {}
    for outcome in proof_result.experiment_outcomes:
        point = outcome.worst_point
        verdict = (
            _format_verdict(outcome),
            str(outcome.compared_time_count or ""),
            point.output_name if point else "",
        )
        cells = _format_worst_point_cells(point) if point else ("",) * len(_POINT_COLUMN_HEADINGS)
        experiments.append((outcome.experiment.experiment_name, outcome.fmi_interface, *verdict, *cells))
        for output_point in outcome.worst_points:
            name = output_point.output_name
            if name not in worst or output_point.error_over_tolerance > worst[name][1].error_over_tolerance:
                worst[name] = outcome, output_point
    interfaces = " and ".join(proof_result.executed_interfaces)
    counts = format_experiment_counts(proof_result)
    yield f"{proof_result.fmu_path} in {proof_result.importer_name}, {interfaces}: {counts}"
    if proof_result.experiment_outcomes:
        yield ""
        yield from align_columns(experiments, len(_EXPERIMENT_TABLE_HEADINGS) - len(_POINT_COLUMN_HEADINGS))
    if worst:
        yield ""
        rows = [
            (n, o.experiment.experiment_name, o.fmi_interface, *_format_worst_point_cells(p))
            for n, (o, p) in worst.items()
        ]
        yield from align_columns(
            [_OUTPUT_TABLE_HEADINGS, *rows], len(_OUTPUT_TABLE_HEADINGS) - len(_POINT_COLUMN_HEADINGS)
        )
    yield ""
    messages = proof_result.failure_messages
    yield from (f"missed: {text}" for text in messages[:MAX_PRINTED_FAILURES])
    if len(messages) > MAX_PRINTED_FAILURES:
        yield f"missed: {len(messages) - MAX_PRINTED_FAILURES} more; --json prints all"
    yield format_proof_summary(proof_result)


def format_experiment_counts(proof_result: ProofResult) -> str:
    """Text with the number of experiments of each purpose, and the number of compared start values."""
    experiments = {id(o.experiment): o.experiment for o in proof_result.experiment_outcomes}.values()
    purposes = [experiment.experiment_purpose for experiment in experiments]
    ordered = (*EXPERIMENT_PURPOSES, *sorted({*purposes} - {*EXPERIMENT_PURPOSES}))
    counts = [f"{purposes.count(p)} {p}" for p in ordered if p in purposes]
    text = ", ".join(counts) or "no experiment executed"
    return f"{text}; {proof_result.compared_start_value_count} start values"


def format_proof_summary(proof_result: ProofResult) -> str:
    """Summary of a proof in one line: numbers of experiments that passed, failed, and were not executed.

    It also has the number of start values that differ from the expected ones.
    """
    excluded = sum(bool(outcome.exclusion_reason) for outcome in proof_result.experiment_outcomes)
    missed = sum(not outcome.has_passed for outcome in proof_result.experiment_outcomes)
    if not proof_result.experiment_outcomes:
        return "the FMU does not start, nothing was executed"
    passed = len(proof_result.experiment_outcomes) - excluded - missed
    words = [f"{passed} passed", f"{missed} missed", *([f"{excluded} not executed"] if excluded else [])]
    if count := len(proof_result.start_value_differences):
        words.append(f"{count} start {'value differs' if count == 1 else 'values differ'}")
    return ", ".join(words)


def proof_to_json(proof_result: ProofResult) -> dict[str, object]:
    """Result of a proof as one JSON object.

    A proof repeats the experiments that an FMU contains, and compares each output with its reference. The
    object has the worst point of each output: the point with the largest ratio of error to tolerance.
    """
    return {
        "fmu": str(proof_result.fmu_path),
        "importer": proof_result.importer_name,
        "interfaces": list(proof_result.executed_interfaces),
        "passed": proof_result.has_passed,
        "start_values": {
            "compared": proof_result.compared_start_value_count,
            "differing": list(proof_result.start_value_differences),
        },
        "experiments": [_experiment_to_json(outcome) for outcome in proof_result.experiment_outcomes],
        "misses": proof_result.failure_messages,
    }


def _experiment_to_json(experiment_outcome: ExperimentOutcome) -> dict[str, object]:
    """Outcome of one experiment of an FMU as a JSON object."""
    return {
        "name": experiment_outcome.experiment.experiment_name,
        "interface": experiment_outcome.fmi_interface or None,
        "purpose": experiment_outcome.experiment.experiment_purpose,
        "verdict": _format_verdict(experiment_outcome),
        "error": experiment_outcome.error_message or experiment_outcome.exclusion_reason or None,
        "points": experiment_outcome.compared_time_count,
        "outputs": [_worst_point_to_json(point) for point in experiment_outcome.worst_points],
    }


def _worst_point_to_json(worst_point: WorstPoint) -> Mapping[str, object]:
    """Point of an output with the largest ratio of error to tolerance, as a JSON object."""
    value = worst_point.computed_value if worst_point.is_finite else None
    return {
        "output": worst_point.output_name,
        "time": worst_point.time_of_point,
        "value": value,
        "reference": worst_point.reference_value,
        "error": None if value is None else worst_point.absolute_error,
        "allowed": worst_point.absolute_tolerance,
        "passed": worst_point.is_within_tolerance,
    }


def _format_verdict(experiment_outcome: ExperimentOutcome) -> str:
    """Verdict on an experiment, as text: passed, missed, or not executed."""
    if experiment_outcome.exclusion_reason:
        return f"not executed: {experiment_outcome.exclusion_reason}"
    if not experiment_outcome.has_passed:
        return "missed"
    return "passed" if experiment_outcome.worst_points else "runs, no reference"


def _format_worst_point_cells(worst_point: WorstPoint) -> tuple[str, ...]:
    """Cells of a table row on an output's worst point: time, value, reference, error and tolerance."""
    numbers = (
        f"{worst_point.time_of_point:g}",
        f"{worst_point.computed_value:.10g}",
        f"{worst_point.reference_value:.10g}",
    )
    return (*numbers, f"{worst_point.absolute_error:.1e}", f"{worst_point.absolute_tolerance:.1e}")
