"""Results of an uncertainty propagation as table, CSV, JSON and plots."""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...common import columns, plots
from .problem import UncertaintyStudy
from .propagate import QUANTILES, RampSensitivity, UncertaintyBands

if TYPE_CHECKING:
    from matplotlib.axes import Axes


PLOTS_PER_ROW = 3
"""Largest number of outputs side by side in a plot [1]."""
MAX_PRINTED_LOADS = 6
"""Largest number of loads in the printed table [1]."""


def select_table_loads(uncertainty_study: UncertaintyStudy) -> list[float]:
    """Select the loads above zero of the ramp that the printed table shows.

    If a single load is uncertain, the result also has the upper end of its interval.
    """
    loads = uncertainty_study.loads[_select_table_indices(uncertainty_study.loads)].tolist()
    if len(loads) == 1:
        loads += [
            parameter.support_interval[1]
            for parameter in uncertainty_study.uncertain_parameters
            if parameter.name == uncertainty_study.ramped_input.name
            and np.isfinite(parameter.support_interval[1])
        ]
    return [load for load in loads if load > 0.0]


def _select_table_indices(ramp_values: Any) -> Any:
    """Select at most MAX_TABLE_ROWS equally spaced values of a ramp; returns their indices."""
    return np.unique(np.linspace(0, ramp_values.size - 1, MAX_PRINTED_LOADS).astype(int))


def format_bands_csv(uncertainty_study: UncertaintyStudy, uncertainty_bands: UncertaintyBands) -> str:
    """CSV text of the bands: one row for each load; nominal value, mean, standard deviation, quantiles.

    Numbers are written without rounding.
    """
    load = uncertainty_study.ramped_input
    heads, values = [(load.name, load.unit)], [uncertainty_bands.loads]
    for name, unit in uncertainty_bands.output_units.items():
        statistics = (
            ("nominal", uncertainty_bands.nominal_outputs),
            ("mean", uncertainty_bands.mean),
            ("sd", uncertainty_bands.standard_deviation),
        )
        for statistic, by_output in statistics:
            heads.append((f"{name} {statistic}", unit))
            values.append(by_output[name])
        heads += [(f"{name} {100 * q:g} %", unit) for q in QUANTILES]
        values += list(uncertainty_bands.quantiles[name])
    return columns.format_table(heads, values)


def study_to_json(
    uncertainty_study: UncertaintyStudy,
    uncertainty_bands: UncertaintyBands,
    sensitivity: RampSensitivity | None,
) -> dict[str, object]:
    """Results of a study as one JSON object: bands, refused samples and Sobol' indices."""
    outputs = {
        name: {
            "unit": unit,
            "nominal": uncertainty_bands.nominal_outputs[name].tolist(),
            "mean": uncertainty_bands.mean[name].tolist(),
            "sd": uncertainty_bands.standard_deviation[name].tolist(),
            "quantiles": {
                f"{q:g}": row.tolist()
                for q, row in zip(QUANTILES, uncertainty_bands.quantiles[name], strict=True)
            },
        }
        for name, unit in uncertainty_bands.output_units.items()
    }
    refused, load = uncertainty_bands.refused_samples, uncertainty_study.ramped_input
    return {
        "fmu"
        if uncertainty_study.study_subject.endswith(".fmu")
        else "joint": uncertainty_study.study_subject,
        "parameters": {
            parameter.name: parameter.distribution_text
            for parameter in uncertainty_study.uncertain_parameters
        },
        "load": {"name": load.name, "unit": load.unit, "values": uncertainty_bands.loads.tolist()},
        "samples": uncertainty_bands.sample_count,
        "refused": {
            "count": refused.refused_count,
            "example": dict(refused.first_refused_sample),
            "reason": refused.refusal_message,
        },
        "outputs": outputs,
        "indices": None if sensitivity is None else _sobol_indices_to_json(sensitivity),
    }


def _sobol_indices_to_json(sensitivity: RampSensitivity) -> dict[str, object]:
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
            for output, indices in sensitivity.indices_by_output.items()
        },
    }


def format_study_table(
    uncertainty_study: UncertaintyStudy,
    uncertainty_bands: UncertaintyBands,
    sensitivity: RampSensitivity | None,
) -> str:
    """Printed table of a study: bands at a few loads, and Sobol' indices at the end of the ramp."""
    lines = []
    load_indices = _select_table_indices(uncertainty_bands.loads)
    quantile_indices = {q: QUANTILES.index(q) for q in (0.05, 0.5, 0.95)}
    for name in uncertainty_bands.nonzero_outputs:
        head = f"{uncertainty_study.ramped_input.name} [{uncertainty_study.ramped_input.unit}]"
        lines.append(f"{name} [{uncertainty_bands.output_units[name]}]")
        is_scattered = name in uncertainty_bands.scattered_outputs
        heads = (
            ("5 %", "50 %", "95 %")
            if is_scattered
            else ("  no band: the varied parameters do not change it",)
        )
        lines.append("".join(f"{x:>16}" for x in (head, "parameter file", *heads)))
        for j in load_indices:
            row = [uncertainty_bands.loads[j], uncertainty_bands.nominal_outputs[name][j]]
            if is_scattered:
                row += [uncertainty_bands.quantiles[name][i, j] for i in quantile_indices.values()]
            lines.append("".join(f"{x + 0.0:16.5g}" for x in row))  # + 0.0: no -0
        lines.append("")
    if sensitivity is not None:
        lines += _format_sobol_table(uncertainty_study, sensitivity, uncertainty_bands.nonzero_outputs)
    varied = ", ".join(
        f"{parameter.name} = {_round_numbers(parameter.distribution_text)}"
        for parameter in uncertainty_study.uncertain_parameters
    )
    lines.append(f"over {uncertainty_study.ramped_input.name}: {uncertainty_study.ramped_input.doc}")
    lines += [
        f"{name}: {meaning}"
        for name, meaning in uncertainty_study.derived_meanings.items()
        if name in uncertainty_bands.nonzero_outputs
    ]
    lines.append(
        f"varied: {varied}{'' if uncertainty_bands.scattered_outputs else ': no output depends on it'}"
    )
    if zero := [
        name for name in uncertainty_bands.output_units if name not in uncertainty_bands.nonzero_outputs
    ]:
        lines.append(f"zero at all loads: {', '.join(zero)}")
    lines.append(
        f"{uncertainty_bands.sample_count} samples, {uncertainty_bands.refused_samples.refused_count} "
        "refused by the law"
    )
    if uncertainty_bands.refused_samples.refused_count:
        example = ", ".join(
            f"{k} = {v:.6g}" for k, v in uncertainty_bands.refused_samples.first_refused_sample.items()
        )
        lines.append(f"the first refused: {example}: {uncertainty_bands.refused_samples.refusal_message}")
    return "\n".join(lines)


def _round_numbers(distribution_text: str) -> str:
    """Text of a distribution with its long decimal numbers rounded to six digits."""
    return re.sub(r"\d+\.\d{6,}(?:e[-+]?\d+)?", lambda number: f"{float(number[0]):.6g}", distribution_text)


def _format_sobol_table(
    uncertainty_study: UncertaintyStudy, sensitivity: RampSensitivity, output_names: Sequence[str]
) -> list[str]:
    """Lines of a table: Sobol' indices at the end of the load ramp."""
    ramped = uncertainty_study.ramped_input
    load = f"{ramped.name} = {sensitivity.loads[-1]:g} {ramped.unit}"
    lines = [f"Sobol' indices at {load}, first order / total, +- 95 % interval"]
    width = max(len(name) for name in sensitivity.parameter_names) + 2
    lines.append(" " * width + "".join(f"{name:>32}" for name in output_names))
    for i, parameter in enumerate(sensitivity.parameter_names):
        cells = []
        for indices in (sensitivity.indices_by_output[name] for name in output_names):
            first = f"{indices.first_order[-1, i]:.3f} +- {indices.first_order_half_width[-1, i]:.3f}"
            total = f"{indices.total_order[-1, i]:.3f} +- {indices.total_half_width[-1, i]:.3f}"
            cells.append(f"{first} / {total}")
        lines.append(f"{parameter:<{width}}" + "".join(f"{cell:>32}" for cell in cells))
    return [*lines, ""]


_PARAMETER_COLOURS = (
    plots.BLUE,
    plots.RED,
    plots.GREEN,
    "#b8860b",
    "#7b4fa3",
    "#3a9ca6",
    plots.GREY,
    "#a65628",
)
"""Colours of the parameters in plots."""


def draw_bands_and_indices(
    plot_path: Path, uncertainty_bands: UncertaintyBands, sensitivity: RampSensitivity | None, load_label: str
) -> None:
    """Draw bands and Sobol' indices over the load, for each output that the varied parameters change.

    A row has at most PLOTS_PER_ROW outputs; the indices are below the bands. Solid lines are total indices,
    dashed lines first-order indices.
    """
    names = uncertainty_bands.scattered_outputs or uncertainty_bands.nonzero_outputs
    height = 1 if sensitivity is None or uncertainty_bands.loads.size == 1 else 2
    columns = min(len(names), PLOTS_PER_ROW)
    rows = height * math.ceil(len(names) / PLOTS_PER_ROW)
    with plots.open_figure(plot_path, (4.2 * columns, 3.6 * rows)) as figure:
        grid = figure.subplots(rows, columns, squeeze=False)
        for empty in grid[rows - height :, len(names) - columns * (rows // height - 1) :].flat:
            empty.remove()
        for i, name in enumerate(names):
            row, column = height * (i // columns), i % columns
            label = f"{name} [{uncertainty_bands.output_units[name]}]"
            if uncertainty_bands.loads.size == 1:
                _draw_distribution(grid[row, column], uncertainty_bands, name, label)
                continue
            _draw_bands(grid[row, column], uncertainty_bands, name, label, load_label)
            if sensitivity is not None:
                _draw_indices(grid[row + 1, column], sensitivity, name, load_label, has_legend=i == 0)


def _draw_bands(
    plot_axes: "Axes",
    uncertainty_bands: UncertaintyBands,
    output_name: str,
    output_label: str,
    load_label: str,
) -> None:
    """Draw median and quantile bands of an output over the load."""
    q = dict(zip(QUANTILES, uncertainty_bands.quantiles[output_name], strict=True))
    for low, high, shade in ((0.01, 0.99, 0.12), (0.05, 0.95, 0.2), (0.25, 0.75, 0.3)):
        text = f"{100 * low:g} to {100 * high:g} %"
        plot_axes.fill_between(
            uncertainty_bands.loads, q[low], q[high], color=plots.BLUE, alpha=shade, linewidth=0, label=text
        )
    plot_axes.plot(uncertainty_bands.loads, q[0.5], color=plots.BLUE, label="median")
    plot_axes.plot(
        uncertainty_bands.loads,
        uncertainty_bands.nominal_outputs[output_name],
        color=plots.RED,
        linestyle="--",
        label="parameter file",
    )
    plot_axes.set(
        xlabel=load_label, ylabel=output_label, xlim=(0.0, uncertainty_bands.loads[-1]), ylim=(0.0, None)
    )
    plot_axes.legend(fontsize=8)


def _draw_distribution(
    plot_axes: "Axes", uncertainty_bands: UncertaintyBands, output_name: str, output_label: str
) -> None:
    """Draw the cumulative distribution of an output at a single load."""
    plot_axes.plot(
        uncertainty_bands.quantiles[output_name][:, 0], 100.0 * np.array(QUANTILES), "o-", color=plots.BLUE
    )
    plot_axes.axvline(
        uncertainty_bands.nominal_outputs[output_name][0],
        color=plots.RED,
        linestyle="--",
        label="parameter file",
    )
    plot_axes.set(xlabel=output_label, ylabel="samples below [%]", ylim=(0.0, 100.0))
    plot_axes.locator_params(axis="x", nbins=6)  # more labels touch each other
    plot_axes.legend(fontsize=8)


def _draw_indices(
    plot_axes: "Axes", sensitivity: RampSensitivity, output_name: str, load_label: str, has_legend: bool
) -> None:
    """Draw the Sobol' indices of an output over the load.

    has_legend : whether to draw the names of the parameters
    """
    indices = sensitivity.indices_by_output[output_name]
    for i, parameter in enumerate(sensitivity.parameter_names):
        colour = _PARAMETER_COLOURS[i % len(_PARAMETER_COLOURS)]
        low = indices.total_order[:, i] - indices.total_half_width[:, i]
        high = indices.total_order[:, i] + indices.total_half_width[:, i]
        plot_axes.fill_between(sensitivity.loads, low, high, color=colour, alpha=0.2, linewidth=0)
        plot_axes.plot(sensitivity.loads, indices.total_order[:, i], color=colour, label=parameter)
        plot_axes.plot(sensitivity.loads, indices.first_order[:, i], color=colour, linestyle="--")
    plot_axes.set(
        xlabel=load_label, ylabel=f"Sobol' indices of {output_name}", xlim=(0.0, None), ylim=(0.0, 1.05)
    )
    if has_legend:
        plot_axes.plot([], [], color=plots.GREY, label="total")
        plot_axes.plot([], [], color=plots.GREY, linestyle="--", label="first order")
        plot_axes.legend(fontsize=8)
