"""Results of an uncertainty propagation as table, CSV, JSON and plots."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...common import columns, plots
from .problem import UncertaintyProblem
from .propagate import QUANTILES, Bands, Sensitivity

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MAX_TABLE_ROWS = 6
"""Largest number of loads in the printed table [1]."""


def select_table_loads(uncertainty_problem: UncertaintyProblem) -> list[float]:
    """Select the loads above zero of the ramp that the printed table shows."""
    return [
        float(load)
        for load in uncertainty_problem.loads[_select_table_indices(uncertainty_problem.loads)]
        if load > 0.0
    ]


def _select_table_indices(ramp_values: Any) -> Any:
    """Select at most MAX_TABLE_ROWS equally spaced values of a ramp; returns their indices."""
    return np.unique(np.linspace(0, ramp_values.size - 1, MAX_TABLE_ROWS).astype(int))


def format_bands_csv(uncertainty_problem: UncertaintyProblem, bands: Bands) -> str:
    """CSV text of the bands: one row for each load; nominal value, mean, standard deviation, quantiles.

    Numbers are written without rounding.
    """
    load = uncertainty_problem.ramped_input
    heads, values = [(load.name, load.unit)], [bands.loads]
    for name, unit in bands.units.items():
        statistics = (("nominal", bands.nominal), ("mean", bands.mean), ("sd", bands.standard_deviation))
        for statistic, by_output in statistics:
            heads.append((f"{name} {statistic}", unit))
            values.append(by_output[name])
        heads += [(f"{name} {100 * q:g} %", unit) for q in QUANTILES]
        values += list(bands.quantiles[name])
    return columns.format_table(heads, values)


def study_to_json(
    uncertainty_problem: UncertaintyProblem, bands: Bands, sensitivity: Sensitivity | None
) -> dict[str, object]:
    """Results of a study as one JSON object: bands, refused samples and Sobol' indices."""
    outputs = {
        name: {
            "unit": unit,
            "nominal": bands.nominal[name].tolist(),
            "mean": bands.mean[name].tolist(),
            "sd": bands.standard_deviation[name].tolist(),
            "quantiles": {
                f"{q:g}": row.tolist() for q, row in zip(QUANTILES, bands.quantiles[name], strict=True)
            },
        }
        for name, unit in bands.units.items()
    }
    refused, load = bands.refused_samples, uncertainty_problem.ramped_input
    return {
        "fmu" if uncertainty_problem.title.endswith(".fmu") else "joint": uncertainty_problem.title,
        "parameters": {
            parameter.name: parameter.distribution_text
            for parameter in uncertainty_problem.uncertain_parameters
        },
        "load": {"name": load.name, "unit": load.unit, "values": bands.loads.tolist()},
        "samples": bands.sample_count,
        "refused": {
            "count": refused.count,
            "example": dict(refused.first_refused_sample),
            "reason": refused.reason,
        },
        "outputs": outputs,
        "indices": None if sensitivity is None else _indices_json(sensitivity),
    }


def _indices_json(sensitivity: Sensitivity) -> dict[str, object]:
    """JSON object of the Sobol' indices at all loads."""
    fields_by_key = {
        "first": "first_order",
        "first_half": "first_order_half_width",
        "total": "total_order",
        "total_half": "total_half_width",
    }
    return {
        "rows": sensitivity.base_sample_count,
        "loads": sensitivity.loads.tolist(),
        "outputs": {
            output: {
                parameter: {
                    key: getattr(indices, field)[:, i].tolist() for key, field in fields_by_key.items()
                }
                for i, parameter in enumerate(sensitivity.parameter_names)
            }
            for output, indices in sensitivity.outputs.items()
        },
    }


def format_table(
    uncertainty_problem: UncertaintyProblem, bands: Bands, sensitivity: Sensitivity | None
) -> str:
    """Printed table of a study: bands at a few loads, and Sobol' indices at the end of the ramp."""
    lines = []
    load_indices = _select_table_indices(bands.loads)
    quantile_indices = {q: QUANTILES.index(q) for q in (0.05, 0.5, 0.95)}
    for name in bands.nonzero_outputs:
        head = f"{uncertainty_problem.ramped_input.name} [{uncertainty_problem.ramped_input.unit}]"
        lines.append(f"{name} [{bands.units[name]}]")
        lines.append("".join(f"{x:>16}" for x in (head, "parameter file", "5 %", "50 %", "95 %")))
        for j in load_indices:
            row = [bands.loads[j], bands.nominal[name][j]]
            row += [bands.quantiles[name][i, j] for i in quantile_indices.values()]
            lines.append("".join(f"{x:16.5g}" for x in row))
        lines.append("")
    if sensitivity is not None:
        lines += _indices_table(uncertainty_problem, sensitivity, bands.nonzero_outputs)
    varied = ", ".join(
        f"{parameter.name} = {parameter.distribution_text}"
        for parameter in uncertainty_problem.uncertain_parameters
    )
    lines.append(f"over {uncertainty_problem.ramped_input.name}: {uncertainty_problem.ramped_input.doc}")
    lines.append(f"varied: {varied}{'' if bands.has_scatter else ': no output depends on it'}")
    if zero := [name for name in bands.units if name not in bands.nonzero_outputs]:
        lines.append(f"zero at all loads: {', '.join(zero)}")
    lines.append(f"{bands.sample_count} samples, {bands.refused_samples.count} refused by the law")
    if bands.refused_samples.count:
        example = ", ".join(f"{k} = {v:.6g}" for k, v in bands.refused_samples.first_refused_sample.items())
        lines.append(f"the first refused: {example}: {bands.refused_samples.reason}")
    return "\n".join(lines)


def _indices_table(
    uncertainty_problem: UncertaintyProblem, sensitivity: Sensitivity, outputs: Sequence[str]
) -> list[str]:
    """Lines of a table: Sobol' indices at the end of the load ramp."""
    ramped = uncertainty_problem.ramped_input
    load = f"{ramped.name} = {sensitivity.loads[-1]:g} {ramped.unit}"
    lines = [f"Sobol' indices at {load}, first order / total, +- 95 % interval"]
    width = max(len(name) for name in sensitivity.parameter_names) + 2
    lines.append(" " * width + "".join(f"{name:>32}" for name in outputs))
    for i, parameter in enumerate(sensitivity.parameter_names):
        cells = []
        for indices in (sensitivity.outputs[name] for name in outputs):
            first = f"{indices.first_order[-1, i]:.3f} +- {indices.first_order_half_width[-1, i]:.3f}"
            total = f"{indices.total_order[-1, i]:.3f} +- {indices.total_half_width[-1, i]:.3f}"
            cells.append(f"{first} / {total}")
        lines.append(f"{parameter:<{width}}" + "".join(f"{cell:>32}" for cell in cells))
    return [*lines, ""]


_COLOURS = (plots.BLUE, plots.RED, plots.GREEN, "#b8860b", "#7b4fa3", "#3a9ca6", plots.GREY, "#a65628")
"""Colours of the parameters in plots."""


def draw_bands_and_indices(path: Path, bands: Bands, sensitivity: Sensitivity | None, load: str) -> None:
    """Draw bands and Sobol' indices over the load, one column of plots for each output that is not zero.

    Solid lines are total indices, dashed lines first-order indices.
    """
    names = bands.nonzero_outputs
    rows = 1 if sensitivity is None or bands.loads.size == 1 else 2
    with plots.open_figure(path, (4.2 * len(names), 3.6 * rows)) as figure:
        grid = figure.subplots(rows, len(names), squeeze=False)
        for column, name in enumerate(names):
            label = f"{name} [{bands.units[name]}]"
            if bands.loads.size == 1:
                _draw_distribution(grid[0, column], bands, name, label)
                continue
            _draw_bands(grid[0, column], bands, name, label, load)
            if sensitivity is not None:
                _draw_indices(grid[1, column], sensitivity, name, load, legend=column == 0)


def _draw_bands(axes: "Axes", bands: Bands, output_name: str, label: str, load: str) -> None:
    """Draw median and quantile bands of an output over the load."""
    q = dict(zip(QUANTILES, bands.quantiles[output_name], strict=True))
    for low, high, shade in ((0.01, 0.99, 0.12), (0.05, 0.95, 0.2), (0.25, 0.75, 0.3)):
        text = f"{100 * low:g} to {100 * high:g} %"
        axes.fill_between(
            bands.loads, q[low], q[high], color=plots.BLUE, alpha=shade, linewidth=0, label=text
        )
    axes.plot(bands.loads, q[0.5], color=plots.BLUE, label="median")
    axes.plot(
        bands.loads, bands.nominal[output_name], color=plots.RED, linestyle="--", label="parameter file"
    )
    axes.set(xlabel=load, ylabel=label, xlim=(0.0, bands.loads[-1]), ylim=(0.0, None))
    axes.legend(fontsize=8)


def _draw_distribution(axes: "Axes", bands: Bands, output_name: str, label: str) -> None:
    """Draw the cumulative distribution of an output at a single load."""
    axes.plot(bands.quantiles[output_name][:, 0], 100.0 * np.array(QUANTILES), "o-", color=plots.BLUE)
    axes.axvline(bands.nominal[output_name][0], color=plots.RED, linestyle="--", label="parameter file")
    axes.set(xlabel=label, ylabel="samples below [%]", ylim=(0.0, 100.0))
    axes.legend(fontsize=8)


def _draw_indices(axes: "Axes", sensitivity: Sensitivity, output_name: str, load: str, legend: bool) -> None:
    """Draw the Sobol' indices of an output over the load.

    legend : whether to draw the names of the parameters
    """
    indices = sensitivity.outputs[output_name]
    for i, parameter in enumerate(sensitivity.parameter_names):
        colour = _COLOURS[i % len(_COLOURS)]
        low = indices.total_order[:, i] - indices.total_half_width[:, i]
        high = indices.total_order[:, i] + indices.total_half_width[:, i]
        axes.fill_between(sensitivity.loads, low, high, color=colour, alpha=0.2, linewidth=0)
        axes.plot(sensitivity.loads, indices.total_order[:, i], color=colour, label=parameter)
        axes.plot(sensitivity.loads, indices.first_order[:, i], color=colour, linestyle="--")
    axes.set(xlabel=load, ylabel=f"Sobol' indices of {output_name}", xlim=(0.0, None), ylim=(0.0, 1.05))
    if legend:
        axes.plot([], [], color=plots.GREY, label="total")
        axes.plot([], [], color=plots.GREY, linestyle="--", label="first order")
        axes.legend(fontsize=8)
