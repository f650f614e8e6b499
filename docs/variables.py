"""Tables of the variables of all FMUs for the page variables.md, from the declared variables."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model, Variable
from jointfmu.parameters import load_default


def page() -> str:
    """Page (Markdown): introduction from this folder, then inputs, outputs and parameters of each FMU."""
    text = Path(__file__).with_suffix(".md").read_text(encoding="utf-8")
    return "\n\n".join([text.rstrip(), *(_fmu(model) for model in MODELS.values())]) + "\n"


def _fmu(fmu_model: Model) -> str:
    file = load_default(fmu_model.joint)
    parts = [f"## {fmu_model.name}", f"As shipped, the parameters are those of: {file.name}."]
    parts += ["**Inputs**", _table(_rows(fmu_model.inputs)), "**Outputs**", _table(_rows(fmu_model.outputs))]
    parameters = [
        (name, field.metadata.get("unit", ""), field.metadata["doc"])
        for name, field in fmu_model.parameter_fields().items()
        if name in file.values_by_name
    ]
    return "\n\n".join([*parts, "**Parameters**", _table(parameters)])


def _rows(variables: Sequence[Variable]) -> list[tuple[str, str, str]]:
    return [(v.name, v.unit, v.doc) for v in variables]


def _table(rows: Iterable[tuple[str, str, str]]) -> str:
    lines = [f"| `{name}` | {unit} | {text.replace('|', chr(92) + '|')} |" for name, unit, text in rows]
    return "\n".join(["| name | unit | meaning |", "|---|---|---|", *lines])
