"""Load ramps: run an FMU in fmpy along a ramp of one input from zero; all outputs at all points."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from ...common import columns
from ..host import open_instance, unpack_fmu

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


@dataclass(frozen=True, slots=True)
class RampResult:
    """Result of an FMU's run along a ramp or path of its inputs.

    variable_columns : {variable: values (n)} at n points, the varied inputs first, then all outputs
    variable_units   : {variable: unit}
    log_messages     : log messages of the FMU
    """

    variable_columns: dict[str, Array]
    variable_units: dict[str, str]
    log_messages: tuple[str, ...]

    def format_time_series_csv(self) -> str:
        """Format the columns as CSV text with headings `name [unit]`; numbers are exact."""
        heads = [(name, self.variable_units[name]) for name in self.variable_columns]
        return columns.format_table(heads, list(self.variable_columns.values()))


MAX_RAMP_END = 1e12
"""Largest magnitude of the input at the end of a ramp [SI]."""


def ramp_points(end_value: float, value_step: float, start_value: float = 0.0) -> Array:
    """Values of the input on a load ramp: start, start + step, ..., end; the last step may be shorter.

    Raises ValueError if a value is not finite, if |end| is above MAX_RAMP_END, or if the step is zero or has
    the other sign than the way from start to end.
    """
    for name, value in (("to", end_value), ("step", value_step), ("start of the ramp", start_value)):
        if not np.isfinite(value):
            raise ValueError(f"{name} = {value:g} is outside (-inf, inf): must be finite")
    if abs(end_value) > MAX_RAMP_END:
        raise ValueError(
            f"to = {end_value:g} is outside [-{MAX_RAMP_END:g}, {MAX_RAMP_END:g}] (SI): "
            "limit for loads and motions"
        )
    length = end_value - start_value
    if value_step == 0.0 or length / value_step < 0.0:
        allowed = "(-inf, 0)" if length < 0.0 else "(0, inf)"
        raise ValueError(
            f"step = {value_step:g} is outside {allowed}: steps must lead from {start_value:g} to "
            f"{end_value:g}"
        )
    count = length / value_step
    if count > 1e7:
        raise ValueError(
            f"step = {value_step:g} makes {count:.3g} points, allowed are at most 1e7; increase step"
        )
    whole = start_value + np.arange(int(np.floor(count * (1.0 + 1e-12))) + 1) * value_step + 0.0
    reached = bool(np.isclose(whole[-1], end_value, rtol=1e-12, atol=0.0))
    return np.asarray(whole if reached else np.append(whole, end_value), dtype=np.float64)


def run_ramp(
    fmu_path: str | Path,
    input_name: str,
    end_value: float,
    value_step: float,
    start_values: Mapping[str, object] | None = None,
) -> RampResult:
    """Run an FMU along a ramp of one input, with one step of one second for each point.

    The ramp starts at the start value of the input, if the caller states one, else at zero.

    All other inputs are constant.

    Parameters
    ----------
    fmu_path              : path of a co-simulation FMU, FMI 2.0 or 3.0
    input_name            : name of the varied input
    end_value, value_step : [unit of the input] end and step of the ramp
    start_values          : start values of parameters and inputs

    Raises
    ------
    ValueError   : the FMU cannot run here (see `host.unpack_fmu`, `host.open_instance`), a name is unknown, a
        value is impossible, or the FMU rejects a value (with the message of the FMU)
    RuntimeError : the FMU does not instantiate
    """
    others = dict(start_values or {})
    start = others.pop(input_name, 0.0)
    if not isinstance(start, float):
        raise ValueError(f"{fmu_path}: {input_name} = {start!r} is not a number")
    return run_path(fmu_path, input_name, ramp_points(end_value, value_step, start), others)


def run_path(
    fmu_path: str | Path,
    input_name: str,
    input_values: Array,
    start_values: Mapping[str, object] | None = None,
) -> RampResult:
    """Run an FMU along points (n) of one input, with one step of one second each. Raises as `run_ramp`."""
    return run_paths(fmu_path, {input_name: input_values}, None, start_values)


def run_paths(
    fmu_path: str | Path,
    inputs: Mapping[str, Array],
    times: Array | None = None,
    start_values: Mapping[str, object] | None = None,
) -> RampResult:
    """Run an FMU along points of several inputs.

    inputs : {input: values (n) or (1)}
    times  : (n) [s] increasing from zero; None: one second for each point

    Raises as `run_ramp`, and ValueError for inputs of different lengths, or a time that does not increase
    from 0.
    """
    rows, count = broadcast_columns({**inputs} if times is None else {**inputs, "time": times}, str(fmu_path))
    clock = rows.pop("time", np.arange(float(count)))
    if not (clock[0] == 0.0 and np.all(np.diff(clock) > 0.0) and np.all(np.isfinite(clock))):
        raise ValueError(f"{fmu_path}: the times must start at 0 s and increase")
    with unpack_fmu(fmu_path) as (folder, description):
        return _simulate_paths(folder, description, rows, clock, dict(start_values or {}), str(fmu_path))


def broadcast_columns(input_columns: Mapping[str, Array], fmu_label: str) -> tuple[dict[str, Array], int]:
    """Broadcast input columns {name: values (n) or (1)} to the same length n; returns the columns and n.

    Raises ValueError for different lengths.
    """
    sizes = {name: column.size for name, column in input_columns.items() if column.size != 1}
    if len(set(sizes.values())) > 1:
        counts = ", ".join(f"{name}: {size}" for name, size in sizes.items())
        raise ValueError(
            f"{fmu_label}: inputs of different lengths ({counts}); expected one value, or the same number of "
            "values for all"
        )
    count = max(sizes.values(), default=1)
    return {name: np.broadcast_to(column, count) for name, column in input_columns.items()}, count


def _simulate_paths(
    fmu_folder: str,
    model_description: "ModelDescription",
    input_columns: Mapping[str, Array],
    times: Array,
    start_values: dict[str, object],
    fmu_label: str,
) -> RampResult:
    """Run an unpacked FMU along points of several inputs; returns inputs and outputs at all points."""
    variables = {v.name: v for v in model_description.modelVariables}
    allowed = [v.name for v in model_description.modelVariables if v.causality == "input"]
    outputs = [v for v in model_description.modelVariables if v.causality == "output"]
    for name in input_columns:
        if name not in allowed:
            raise ValueError(f"{fmu_label}: unknown input {name!r}, allowed are {', '.join(allowed)}")
        if name in start_values:
            raise ValueError(f"{fmu_label}: {name} is the input of the ramp; do not set it too")
    settable = [v.name for v in model_description.modelVariables if v.causality in ("input", "parameter")]
    for name, value in start_values.items():
        if name not in settable:
            raise ValueError(f"{fmu_label}: unknown name {name!r}, allowed are {', '.join(settable)}")
        wanted = bool if variables[name].type == "Boolean" else float
        if not isinstance(value, wanted):
            expected = (
                "true or false"
                if wanted is bool
                else f"a number; expected a number in {variables[name].unit or '1'} with a decimal point, "
                "without its unit"
            )
            raise ValueError(f"{fmu_label}: {name} = {value!r} is not {expected}")
    messages: list[str] = []
    rows: list[list[float]] = []
    points = np.stack([*input_columns.values()], axis=-1) if input_columns else np.empty((times.size, 0))
    with open_instance(fmu_folder, model_description, fmu_label, messages) as fmu:
        try:
            fmu.enter_initialization()
            fmu.set_values({**start_values, **dict(zip(input_columns, points[0].tolist(), strict=True))})
            fmu.fmu.exitInitializationMode()
            driven, read = (
                fmu.group_real_variables([*input_columns]),
                fmu.group_real_variables([v.name for v in outputs]),
            )
            for i, values in enumerate(track_progress(points.tolist(), Path(fmu_label).stem, len(points))):
                driven.set_values(*values)
                if i:
                    fmu.do_step(float(times[i - 1]), float(times[i] - times[i - 1]))
                rows.append(read.get_values())
        except Exception as error:
            raise ValueError(f"{fmu_label}: {fmu.explain_failure(error)}") from None
    table = np.asarray(rows).reshape(len(points), len(outputs))
    columns = dict(input_columns) | {v.name: table[:, i] for i, v in enumerate(outputs)}
    units = {name: variables[name].unit or "1" for name in columns}
    return RampResult(columns, units, tuple(messages))
