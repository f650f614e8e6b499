"""Comparison of all laws with their frozen reference values: models/reference/laws.toml."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.resources import files
from typing import Any

import numpy as np

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.contact.laws import LAWS
from jointfmu.joints.harmonic_drive.spring import torque_curve
from jointfmu.parameters import load_default
from jointfmu.quantity import Array, build_parameter_set, replace_values

from ...common.shown import align_columns

REFERENCE_TOLERANCE = 1e-8
"""Relative tolerance [1]: the quadrature is accurate to 1e-11, the inversion of the load to 1e-12."""
_TABLE_HEADINGS = ("law", "quantity", "values", "largest deviation", "allowed", "at", "verdict")
"""Headings of the printed table."""


@dataclass(frozen=True, slots=True)
class LawComparison:
    """Largest deviation of one quantity of a law from its reference values.

    value_count         : number of reference values
    error               : relative deviation [1] with the largest magnitude
    argument            : name and value [SI] of the law's argument at the largest deviation
    reference, computed : values [SI] at this argument
    """

    law: str
    quantity: str
    value_count: int
    error: float
    argument: tuple[str, float]
    reference: float
    computed: float

    @property
    def has_passed(self) -> bool:
        """Whether the deviation is within REFERENCE_TOLERANCE; not if it is NaN."""
        return abs(self.error) <= REFERENCE_TOLERANCE

    def to_json(self) -> dict[str, Any]:
        """JSON object of the largest deviation of a law's quantity, with the verdict as a word."""
        return asdict(self) | {
            "error": self.error if np.isfinite(self.error) else None,
            "computed": self.computed if np.isfinite(self.computed) else None,
            "argument": dict([self.argument]),
            "tolerance": REFERENCE_TOLERANCE,
            "verdict": "pass" if self.has_passed else "miss",
        }


def read_reference_cases() -> list[dict[str, Any]]:
    """Read the reference values of all laws, one dictionary for each parameter set.

    Keys: `law`, `parameters` {name: value}, `values` {quantity: (n) [SI]}, first the argument of the law.
    """
    text = (files("jointfmu_models") / "reference" / "laws.toml").read_text(encoding="utf-8")
    cases: list[dict[str, Any]] = tomllib.loads(text)["case"]
    return cases


def compare_laws() -> list[LawComparison]:
    """Evaluate each law at the arguments of its reference values: one comparison per quantity."""
    found: dict[tuple[str, str], list[LawComparison]] = {}
    for case in read_reference_cases():
        law, (argument, *_) = case["law"], case["values"]
        at = np.array(case["values"].pop(argument))
        parameters = {n: tuple(v) if isinstance(v, list) else v for n, v in case["parameters"].items()}
        is_interface = argument == "pressure"
        computed = (_evaluate_interface_law if is_interface else _evaluate_drive_midline)(law, parameters, at)
        for quantity, reference in case["values"].items():
            values = np.broadcast_to(computed[quantity], at.shape)
            for x, known, value in zip(at.tolist(), reference, values.tolist(), strict=True):
                error = (value - known) / abs(known) if known else value
                one = LawComparison(law, quantity, 1, error, (argument, x), known, value)
                found.setdefault((law, quantity), []).append(one)
    return [_find_largest_deviation(comparisons) for comparisons in found.values()]


def _evaluate_interface_law(
    law_name: str, parameters: Mapping[str, Any], pressure: Array
) -> Mapping[str, Any]:
    """Quantities of an interface law at pressures (n) [Pa]."""
    return evaluate_at_pressure(build_parameter_set(LAWS[law_name], parameters), pressure)


def _evaluate_drive_midline(
    law_name: str, parameters: Mapping[str, Any], wind_up: Array
) -> Mapping[str, Any]:
    """Torque and stiffness of the prescribed midline of a drive at wind-ups (n) [rad]."""
    drive: Any = replace_values(
        load_default("harmonic_drive", law_name).values, {**parameters, "lost_motion": 0.0}
    )
    torque, stiffness = torque_curve(drive).derivatives(wind_up)
    return {"tau": torque, "K_WTS": stiffness}


def _find_largest_deviation(law_comparisons: Sequence[LawComparison]) -> LawComparison:
    """Find the comparison with the largest relative deviation, among those of one quantity of a law."""
    errors = np.abs([c.error for c in law_comparisons])
    worst = law_comparisons[int(np.argmax(np.where(np.isnan(errors), np.inf, errors)))]
    return LawComparison(**asdict(worst) | {"value_count": len(law_comparisons)})


def list_missed_quantities(law_comparisons: Sequence[LawComparison]) -> list[str]:
    """Names LAW.QUANTITY whose deviation from the reference value is outside the tolerance."""
    return [f"{c.law}.{c.quantity}" for c in law_comparisons if not c.has_passed]


def format_law_table(law_comparisons: Sequence[LawComparison]) -> str:
    """Format the comparison of laws with reference values as a table in text."""
    rows = [
        (
            *(c.law, c.quantity, str(c.value_count), f"{c.error:+.1e}", f"{REFERENCE_TOLERANCE:.0e}"),
            f"{c.argument[0]} = {c.argument[1]:.4g}",
            "pass" if c.has_passed else "MISS",
        )
        for c in law_comparisons
    ]
    return "\n".join(align_columns([_TABLE_HEADINGS, *rows]))


def format_law_summary(law_comparisons: Sequence[LawComparison]) -> str:
    """Summary of the comparison in one line: number of laws and values, missed quantities."""
    laws = dict.fromkeys(c.law for c in law_comparisons)
    values = sum(c.value_count for c in law_comparisons)
    return (
        f"{values} values of the laws {', '.join(laws)} against quadrature of their equations "
        "(models/reference/laws.toml): missed: "
        f"{', '.join(list_missed_quantities(law_comparisons)) or 'none'}"
    )
