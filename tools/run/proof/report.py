"""Result of a proof (check of an FMU against its references) as text and as one JSON object."""

from collections.abc import Iterator, Mapping

from jointfmu_fmu_src.proof.standard import EXPERIMENT_PURPOSES

from ...common.shown import align_columns
from .outcome import ExperimentOutcome, Proof, WorstPoint

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


def format_lines(proof: Proof) -> Iterator[str]:
    """Lines of the printed result of a proof: table of experiments, table of outputs, failures, summary.

    Both tables state the worst point of each row.
    """
    experiments: list[tuple[str, ...]] = [_EXPERIMENT_TABLE_HEADINGS]
    worst: dict[str, tuple[ExperimentOutcome, WorstPoint]] = {}
    for outcome in proof.outcomes:
        point = outcome.worst_point
        verdict = (
            _format_verdict(outcome),
            str(outcome.compared_time_count or ""),
            point.output if point else "",
        )
        cells = _format_worst_point_cells(point) if point else ("",) * len(_POINT_COLUMN_HEADINGS)
        experiments.append((outcome.experiment.name, outcome.interface, *verdict, *cells))
        for output_point in outcome.worst_points:
            name = output_point.output
            if name not in worst or output_point.error_ratio > worst[name][1].error_ratio:
                worst[name] = outcome, output_point
    yield f"{proof.fmu} in {proof.importer}, {' and '.join(proof.interfaces)}: {format_counts(proof)}"
    if proof.outcomes:
        yield ""
        yield from align_columns(experiments, len(_EXPERIMENT_TABLE_HEADINGS) - len(_POINT_COLUMN_HEADINGS))
    if worst:
        yield ""
        rows = [
            (n, o.experiment.name, o.interface, *_format_worst_point_cells(p)) for n, (o, p) in worst.items()
        ]
        yield from align_columns(
            [_OUTPUT_TABLE_HEADINGS, *rows], len(_OUTPUT_TABLE_HEADINGS) - len(_POINT_COLUMN_HEADINGS)
        )
    yield ""
    yield from (f"missed: {text}" for text in proof.failures)
    yield format_summary(proof)


def format_counts(proof: Proof) -> str:
    """Text with the number of experiments of each purpose, and the number of compared start values."""
    experiments = {id(o.experiment): o.experiment for o in proof.outcomes}.values()
    purposes = [experiment.purpose for experiment in experiments]
    ordered = (*EXPERIMENT_PURPOSES, *sorted({*purposes} - {*EXPERIMENT_PURPOSES}))
    counts = [f"{purposes.count(p)} {p}" for p in ordered if p in purposes]
    return f"{', '.join(counts) or 'no experiment executed'}; {proof.compared_start_value_count} start values"


def format_summary(proof: Proof) -> str:
    """Summary of a proof in one line: experiments that passed, missed, and were not executed.

    The summary also counts start values that differ.
    """
    excluded = sum(bool(outcome.exclusion_reason) for outcome in proof.outcomes)
    missed = sum(not outcome.has_passed for outcome in proof.outcomes)
    if not proof.outcomes:
        return "it does not start, nothing was executed"
    passed = len(proof.outcomes) - excluded - missed
    words = [f"{passed} passed", f"{missed} missed", *([f"{excluded} not executed"] if excluded else [])]
    if count := len(proof.start_value_differences):
        words.append(f"{count} start {'value differs' if count == 1 else 'values differ'}")
    return ", ".join(words)


def proof_to_json(proof: Proof) -> dict[str, object]:
    """Result of a proof as one JSON object.

    A proof repeats the experiments that an FMU contains, and compares each output with its reference. The
    object has the worst point of each output: the point with the largest error over tolerance.
    """
    return {
        "fmu": str(proof.fmu),
        "importer": proof.importer,
        "interfaces": list(proof.interfaces),
        "passed": proof.has_passed,
        "start_values": {
            "compared": proof.compared_start_value_count,
            "differing": list(proof.start_value_differences),
        },
        "experiments": [_experiment_to_json(outcome) for outcome in proof.outcomes],
        "misses": proof.failures,
    }


def _experiment_to_json(outcome: ExperimentOutcome) -> dict[str, object]:
    """Outcome of one experiment of an FMU as a JSON object."""
    return {
        "name": outcome.experiment.name,
        "interface": outcome.interface or None,
        "purpose": outcome.experiment.purpose,
        "verdict": _format_verdict(outcome),
        "error": outcome.error_message or outcome.exclusion_reason or None,
        "points": outcome.compared_time_count,
        "outputs": [_worst_point_to_json(point) for point in outcome.worst_points],
    }


def _worst_point_to_json(worst_point: WorstPoint) -> Mapping[str, object]:
    """Point of an output with the largest error over tolerance, as a JSON object."""
    value = worst_point.computed_value if worst_point.is_finite else None
    return {
        "output": worst_point.output,
        "time": worst_point.time,
        "value": value,
        "reference": worst_point.reference_value,
        "error": None if value is None else worst_point.absolute_error,
        "allowed": worst_point.tolerance,
        "passed": worst_point.is_within_tolerance,
    }


def _format_verdict(outcome: ExperimentOutcome) -> str:
    """Verdict on an experiment, as text: passed, missed, or not executed."""
    if outcome.exclusion_reason:
        return f"not executed: {outcome.exclusion_reason}"
    if not outcome.has_passed:
        return "missed"
    return "passed" if outcome.worst_points else "runs, no reference"


def _format_worst_point_cells(worst_point: WorstPoint) -> tuple[str, ...]:
    """Cells of a table row: time, value, reference, error and tolerance of a point."""
    numbers = (
        f"{worst_point.time:g}",
        f"{worst_point.computed_value:.10g}",
        f"{worst_point.reference_value:.10g}",
    )
    return (*numbers, f"{worst_point.absolute_error:.1e}", f"{worst_point.tolerance:.1e}")
