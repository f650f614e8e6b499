"""Bands and indices as table, CSV and JSON."""

from typing import Any

import numpy as np

from .. import columns
from .problem import Problem
from .propagate import QUANTILES, Bands
from .sensitivity import Sensitivity

SHOWN = 6
"""Loads that the table on the screen shows."""


def loads(task: Problem) -> list[float]:
    """Loads above zero that the table on the screen shows."""
    return [float(load) for load in task.loads[_shown(task.loads)] if load > 0.0]


def _shown(values: Any) -> Any:
    return np.unique(np.linspace(0, values.size - 1, SHOWN).astype(int))


def bands_csv(task: Problem, bands: Bands) -> str:
    """One row per load: nominal, mean, standard deviation and quantiles of every output, exact numbers."""
    load = task.reduced.load
    heads, values = [(load.name, load.unit)], [bands.loads]
    for name, unit in bands.units.items():
        statistics = (("nominal", bands.nominal), ("mean", bands.mean), ("sd", bands.sd))
        for statistic, by_output in statistics:
            heads.append((f"{name} {statistic}", unit))
            values.append(by_output[name])
        heads += [(f"{name} {100 * q:g} %", unit) for q in QUANTILES]
        values += list(bands.quantiles[name])
    return columns.text(heads, values)


def as_json(task: Problem, bands: Bands, sensitivity: Sensitivity | None) -> dict[str, object]:
    """Everything as one JSON object."""
    outputs = {
        name: {
            "unit": unit,
            "nominal": bands.nominal[name].tolist(),
            "mean": bands.mean[name].tolist(),
            "sd": bands.sd[name].tolist(),
            "quantiles": {
                f"{q:g}": row.tolist() for q, row in zip(QUANTILES, bands.quantiles[name], strict=True)
            },
        }
        for name, unit in bands.units.items()
    }
    refused, load = bands.refused, task.reduced.load
    return {
        "joint": task.joint,
        "parameters": {parameter.name: parameter.text for parameter in task.uncertain},
        "load": {"name": load.name, "unit": load.unit, "values": bands.loads.tolist()},
        "samples": bands.samples,
        "refused": {
            "count": refused.count,
            "example": dict(refused.example),
            "reason": refused.reason,
        },
        "reduction_error": bands.error,
        "outputs": outputs,
        "indices": None if sensitivity is None else _indices_json(sensitivity),
    }


def _indices_json(sensitivity: Sensitivity) -> dict[str, object]:
    numbers = ("first", "first_half", "total", "total_half")
    return {
        "rows": sensitivity.rows,
        "loads": sensitivity.loads.tolist(),
        "outputs": {
            output: {
                parameter: {number: getattr(indices, number)[:, i].tolist() for number in numbers}
                for i, parameter in enumerate(sensitivity.names)
            }
            for output, indices in sensitivity.outputs.items()
        },
    }


def table(task: Problem, bands: Bands, sensitivity: Sensitivity | None) -> str:
    """Bands at a few loads, and the indices at the end of the ramp."""
    lines = []
    picked = _shown(bands.loads)
    at = {q: QUANTILES.index(q) for q in (0.05, 0.5, 0.95)}
    for name, unit in bands.units.items():
        head = f"{task.reduced.load.name} [{task.reduced.load.unit}]"
        lines.append(f"{name} [{unit}]")
        lines.append("".join(f"{x:>16}" for x in (head, "parameter file", "5 %", "50 %", "95 %")))
        for j in picked:
            row = [bands.loads[j], bands.nominal[name][j]]
            row += [bands.quantiles[name][i, j] for i in at.values()]
            lines.append("".join(f"{x:16.5g}" for x in row))
        lines.append("")
    if sensitivity is not None:
        lines += _indices_table(task, sensitivity)
    lines.append(f"{bands.samples} samples, {bands.refused.count} refused by the law")
    if bands.refused.count:
        example = ", ".join(f"{k} = {v:.6g}" for k, v in bands.refused.example.items())
        lines.append(f"the first refused: {example}: {bands.refused.reason}")
    lines.append(
        f"reduced evaluation beside the exported spring: largest relative difference {bands.error:.1e}"
    )
    return "\n".join(lines)


def _indices_table(task: Problem, sensitivity: Sensitivity) -> list[str]:
    load = f"{task.reduced.load.name} = {sensitivity.loads[-1]:g} {task.reduced.load.unit}"
    lines = [f"Sobol' indices at {load}, first order / total, +- 95 % interval"]
    width = max(len(name) for name in sensitivity.names) + 2
    lines.append(" " * width + "".join(f"{name:>32}" for name in sensitivity.outputs))
    for i, parameter in enumerate(sensitivity.names):
        cells = []
        for indices in sensitivity.outputs.values():
            first = f"{indices.first[-1, i]:.3f} +- {indices.first_half[-1, i]:.3f}"
            total = f"{indices.total[-1, i]:.3f} +- {indices.total_half[-1, i]:.3f}"
            cells.append(f"{first} / {total}")
        lines.append(f"{parameter:<{width}}" + "".join(f"{cell:>32}" for cell in cells))
    return [*lines, ""]
