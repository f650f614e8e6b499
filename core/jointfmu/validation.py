"""Every published number beside the computed one."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

from .joints import KINDS
from .joints.clamped import clamping
from .joints.frequencies import MeasuredFrequencies
from .joints.published import published
from .parameters import ParameterFile, default
from .reference import Point, points


@dataclass(frozen=True, slots=True)
class Row:
    """A published point, the computed value, and the verdict.

    error : relative to the published value, or in its unit where the tolerance is absolute; 0 or 1
        for a claim
    """

    point: Point
    computed: float | bool
    error: float
    passed: bool

    def as_dict(self) -> dict[str, Any]:
        """JSON-ready, with the verdict as a word."""
        row = asdict(self.point) | {"where": dict(self.point.where)}
        return row | {
            "computed": self.computed if isfinite(self.computed) else None,
            "error": self.error if isfinite(self.error) else None,
            "verdict": "pass" if self.passed else "miss",
        }


def compare(point: Point, computed: float | bool) -> Row:
    """Judge one computed value."""
    if isinstance(point.value, bool):
        error = float(computed is not point.value)
        return Row(point, computed, error, error == 0.0)
    error = computed - point.value
    if not point.absolute:
        error /= abs(point.value)
    return Row(point, computed, error, abs(error) <= point.tolerance)


def validate(sets: Mapping[str, ParameterFile] | None = None) -> list[Row]:
    """Compute every published point with the default parameter sets, or those given by joint."""
    given, rows = sets or {}, []
    for kind in KINDS.values():
        for paper in kind.papers:
            values = (given.get(kind.name) or default(kind.name)).values
            observables = published(kind).observables
            rows += [compare(p, observables[p.quantity](values, **p.where)) for p in points(paper)]
    return rows


def natural_frequencies() -> list[Row]:
    """Measured frequencies of assemblies beside those of finite elements: half a minute each.

    Raises ImportError without the extra `fem`.
    """
    parts = {name: kind.part("frequencies") for name, kind in KINDS.items()}
    return [row for name, part in parts.items() if part for row in _frequencies(name, part.FREQUENCIES)]


def _frequencies(joint: str, measured: MeasuredFrequencies) -> list[Row]:
    from .fem import assembly, assembly_modes

    published, values = points(measured.points), default(joint).values
    states = list(dict.fromkeys((p.where["preload"], p.where["moment"]) for p in published))
    shear = float(clamping(joint).shear_ratio(values))
    computed = assembly_modes.frequencies(assembly.load(measured.path), values, shear, states)
    at = dict(zip(states, computed.tolist(), strict=True))
    return [compare(p, at[p.where["preload"], p.where["moment"]][p.where["mode"] - 1]) for p in published]


def missed(rows: list[Row]) -> list[Row]:
    """Rows with the role validation that miss."""
    return [row for row in rows if row.point.role == "validation" and not row.passed]


def table(rows: list[Row]) -> str:
    """The comparison as text."""
    head = ("paper", "point", "unit", "published", "computed", "error", "tolerance", "role", "verdict")
    lines = [head, *(_cells(row) for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )


def _cells(row: Row) -> tuple[str, ...]:
    p = row.point
    if isinstance(p.value, bool):
        shown = (shown_claim(row), str(row.computed).lower(), "-", "-")
    else:
        unit = f" {p.unit}" if p.absolute else ""
        scale, mark = (1.0, unit) if p.absolute else (100.0, " %")
        shown = (
            f"{p.value:.6g}",
            f"{row.computed:.6g}",
            f"{scale * row.error:+.3g}{mark}",
            f"{scale * p.tolerance:.3g}{mark}",
        )
    return (p.paper, p.id, p.unit, *shown, p.role, "pass" if row.passed else "MISS")


def shown_claim(row: Row) -> str:
    """A claim as text, with the text's own where its equations give the opposite."""
    p = row.point
    return str(p.value).lower() + ("" if p.text is None else f" (text: {str(p.text).lower()})")


def summary(rows: list[Row]) -> str:
    """One line: how many points were fitted, checked, predicted, missed, contradict themselves."""
    fitted = [row for row in rows if row.point.role == "calibration"]
    checked = [row for row in rows if row.point.role == "validation"]
    predicted = [row for row in checked if row.point.prediction]
    against = [row.point.id for row in rows if row.point.text is not None]
    names = ", ".join(row.point.id for row in missed(rows)) or "none"
    return (
        f"{len(rows)} published points: {len(fitted)} calibrate ({sum(r.passed for r in fitted)} met), "
        f"{len(checked)} validate ({sum(r.passed for r in checked)} met), "
        f"{len(predicted)} of them predictions ({sum(r.passed for r in predicted)} met); "
        f"text against its own equations: {', '.join(against) or 'none'}; "
        f"missed: {names}"
    )
