"""Result of a proof as text and as one JSON object."""

from collections.abc import Iterator, Mapping

from jointfmu_fmu_src.proof.standard import PURPOSES

from ...common.shown import align_columns
from .outcome import Outcome, Proof, WorstPoint

_POINT_HEADS = ("time [s]", "value", "reference", "off by", "allowed")
_EXPERIMENT_HEADS = ("experiment", "interface", "verdict", "points", "worst output", *_POINT_HEADS)
_OUTPUT_HEADS = ("output", "worst in", "interface", *_POINT_HEADS)


def format_lines(proof: Proof) -> Iterator[str]:
    """Lines of the printed result: table of experiments, table of outputs, failures, summary.

    Both tables state the worst point of each row.
    """
    experiments: list[tuple[str, ...]] = [_EXPERIMENT_HEADS]
    worst: dict[str, tuple[Outcome, WorstPoint]] = {}
    for outcome in proof.outcomes:
        point = outcome.worst
        verdict = _format_verdict(outcome), str(outcome.compared_points or ""), point.output if point else ""
        cells = _format_cells(point) if point else ("",) * len(_POINT_HEADS)
        experiments.append((outcome.experiment.name, outcome.interface, *verdict, *cells))
        for output_point in outcome.points:
            name = output_point.output
            if name not in worst or output_point.error_ratio > worst[name][1].error_ratio:
                worst[name] = outcome, output_point
    yield f"{proof.fmu} in {proof.importer}, {' and '.join(proof.interfaces)}: {format_counts(proof)}"
    if proof.outcomes:
        yield ""
        yield from align_columns(experiments, len(_EXPERIMENT_HEADS) - len(_POINT_HEADS))
    if worst:
        yield ""
        rows = [(n, o.experiment.name, o.interface, *_format_cells(p)) for n, (o, p) in worst.items()]
        yield from align_columns([_OUTPUT_HEADS, *rows], len(_OUTPUT_HEADS) - len(_POINT_HEADS))
    yield ""
    yield from (f"missed: {text}" for text in proof.failures)
    yield format_summary(proof)


def format_counts(proof: Proof) -> str:
    """Number of experiments of each purpose, and number of compared start values, as text."""
    experiments = {id(o.experiment): o.experiment for o in proof.outcomes}.values()
    purposes = [experiment.purpose for experiment in experiments]
    ordered = (*PURPOSES, *sorted({*purposes} - {*PURPOSES}))
    counts = [f"{purposes.count(p)} {p}" for p in ordered if p in purposes]
    return f"{', '.join(counts) or 'no experiment executed'}; {proof.compared_starts} start values"


def format_summary(proof: Proof) -> str:
    """One line: number of experiments that passed, missed, and were not executed; differing start values."""
    excluded = sum(bool(outcome.exclusion_reason) for outcome in proof.outcomes)
    missed = sum(not outcome.has_passed for outcome in proof.outcomes)
    if not proof.outcomes:
        return "it does not start, nothing was executed"
    passed = len(proof.outcomes) - excluded - missed
    words = [f"{passed} passed", f"{missed} missed", *([f"{excluded} not executed"] if excluded else [])]
    if count := len(proof.start_differences):
        words.append(f"{count} start {'value differs' if count == 1 else 'values differ'}")
    return ", ".join(words)


def build_document(proof: Proof) -> dict[str, object]:
    """Result of a proof as one JSON object, with the worst point of each output of each experiment."""
    return {
        "fmu": str(proof.fmu),
        "importer": proof.importer,
        "interfaces": list(proof.interfaces),
        "passed": proof.has_passed,
        "start_values": {"compared": proof.compared_starts, "differing": list(proof.start_differences)},
        "experiments": [_experiment_document(outcome) for outcome in proof.outcomes],
        "misses": proof.failures,
    }


def _experiment_document(outcome: Outcome) -> dict[str, object]:
    """Outcome of an experiment as a JSON object."""
    return {
        "name": outcome.experiment.name,
        "interface": outcome.interface or None,
        "purpose": outcome.experiment.purpose,
        "verdict": _format_verdict(outcome),
        "error": outcome.error or outcome.exclusion_reason or None,
        "points": outcome.compared_points,
        "outputs": [_point_document(point) for point in outcome.points],
    }


def _point_document(point: WorstPoint) -> Mapping[str, object]:
    """Worst point of an output as a JSON object."""
    value = point.value if point.is_finite else None
    return {
        "output": point.output,
        "time": point.time,
        "value": value,
        "reference": point.reference,
        "error": None if value is None else point.error,
        "allowed": point.tolerance,
        "passed": point.is_within_tolerance,
    }


def _format_verdict(outcome: Outcome) -> str:
    """Verdict on an experiment, as text."""
    if outcome.exclusion_reason:
        return f"not executed: {outcome.exclusion_reason}"
    if not outcome.has_passed:
        return "missed"
    return "passed" if outcome.points else "runs, no reference"


def _format_cells(point: WorstPoint) -> tuple[str, ...]:
    """Cells of a table row: time, value, reference, error and tolerance of a point."""
    numbers = (f"{point.time:g}", f"{point.value:.10g}", f"{point.reference:.10g}")
    return (*numbers, f"{point.error:.1e}", f"{point.tolerance:.1e}")
