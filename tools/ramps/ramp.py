"""Load ramps: any of the FMUs driven through fmpy from zero, every output read at every point."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .. import columns
from ..host import open_instance, unpack_fmu

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


@dataclass(frozen=True, slots=True)
class RampResult:
    """Result of a ramp: `columns` (n) by name, the driven input first; messages the FMU logged."""

    columns: dict[str, Array]
    units: dict[str, str]
    messages: tuple[str, ...]

    def csv(self) -> str:
        """The ramp as CSV text, header `name [unit]`, numbers exact."""
        heads = [(name, self.units[name]) for name in self.columns]
        return columns.format_table(heads, list(self.columns.values()))


MAX_END = 1e12
"""Largest end of a ramp [SI]: a meganewton a million times over."""


def ramp_points(to: float, step: float) -> Array:
    """Points 0, step, 2 step ... to; the last step may be shorter.

    Raises ValueError if a value is not finite, `to` beyond LARGEST, the step zero, or leads away from `to`.
    """
    for name, value in (("to", to), ("step", step)):
        if not np.isfinite(value):
            raise ValueError(f"{name} = {value:g} is outside (-inf, inf): must be finite")
    if abs(to) > MAX_END:
        raise ValueError(
            f"to = {to:g} is outside [-{MAX_END:g}, {MAX_END:g}] (SI): limit for loads and motions"
        )
    if step == 0.0 or to / step < 0.0:
        allowed = "(-inf, 0)" if to < 0.0 else "(0, inf)"
        raise ValueError(f"step = {step:g} is outside {allowed}: steps must lead from 0 to {to:g}")
    count = to / step
    if count > 1e7:
        raise ValueError(f"step = {step:g} makes {count:.3g} points, allowed are 1e7")
    whole = np.arange(int(np.floor(count * (1.0 + 1e-12))) + 1) * step + 0.0
    reached = bool(np.isclose(whole[-1], to, rtol=1e-12, atol=0.0))
    return np.asarray(whole if reached else np.append(whole, to), dtype=np.float64)


def run_ramp(
    fmu: str | Path,
    input_name: str,
    to: float,
    step: float,
    settings: Mapping[str, object] | None = None,
) -> RampResult:
    """Drive one input from zero along a ramp, one step of one second each; all else stays.

    Parameters
    ----------
    fmu        : path of a co-simulation FMU, FMI 2.0 or 3.0
    input_name : the input that is driven
    to, step   : [unit of the input] end and step of the ramp
    settings   : start values of parameters and other inputs

    Raises
    ------
    ValueError   : the path is no FMU that can be driven (`unpacked`, `opened` of `host`), a name is unknown,
        a value is impossible, or the FMU refuses a value (the message is the FMU's own)
    RuntimeError : the FMU does not instantiate
    """
    return run_path(fmu, input_name, ramp_points(to, step), settings)


def run_path(
    fmu: str | Path, input_name: str, points: Array, settings: Mapping[str, object] | None = None
) -> RampResult:
    """Drive one input along points (n), one step of one second each; all else stays. Raises as `run`."""
    return drive(fmu, {input_name: points}, None, settings)


def drive(
    fmu: str | Path,
    inputs: Mapping[str, Array],
    time: Array | None = None,
    settings: Mapping[str, object] | None = None,
) -> RampResult:
    """Drive inputs along points, each (n) or (1), over time (n) [s] from zero: whole seconds by default.

    Raises as `run`, and ValueError for inputs of different lengths or a time that does not rise from 0.
    """
    rows, count = broadcast({**inputs} if time is None else {**inputs, "time": time}, str(fmu))
    clock = rows.pop("time", np.arange(float(count)))
    if not (clock[0] == 0.0 and np.all(np.diff(clock) > 0.0) and np.all(np.isfinite(clock))):
        raise ValueError(f"{fmu}: the times must start at 0 s and increase")
    with unpack_fmu(fmu) as (folder, description):
        return _drive(folder, description, rows, clock, dict(settings or {}), str(fmu))


def broadcast(columns: Mapping[str, Array], source: str) -> tuple[dict[str, Array], int]:
    """Columns, each (n) or (1), all of them as (n), and n. Raises ValueError for different lengths."""
    sizes = {name: column.size for name, column in columns.items() if column.size != 1}
    if len(set(sizes.values())) > 1:
        told = ", ".join(f"{name} {size}" for name, size in sizes.items())
        raise ValueError(f"{source}: inputs of different lengths ({told}), allowed are 1 and one other")
    count = max(sizes.values(), default=1)
    return {name: np.broadcast_to(column, count) for name, column in columns.items()}, count


def variable_units(fmu: str | Path) -> dict[str, str]:
    """{variable: its unit} of an FMU; ValueError as `host.unpacked`."""
    with unpack_fmu(fmu) as (_, description):
        return {v.name: v.unit or "1" for v in description.modelVariables}


def _drive(
    folder: str,
    md: "ModelDescription",
    inputs: Mapping[str, Array],
    time: Array,
    settings: dict[str, object],
    source: str,
) -> RampResult:
    variables = {v.name: v for v in md.modelVariables}
    allowed = [v.name for v in md.modelVariables if v.causality == "input"]
    outputs = [v for v in md.modelVariables if v.causality == "output"]
    for name in inputs:
        if name not in allowed:
            raise ValueError(f"{source}: unknown input {name!r}, allowed are {', '.join(allowed)}")
        if name in settings:
            raise ValueError(f"{source}: {name} is the input of the ramp; do not set it too")
    settable = [v.name for v in md.modelVariables if v.causality in ("input", "parameter")]
    for name, value in settings.items():
        if name not in settable:
            raise ValueError(f"{source}: unknown name {name!r}, allowed are {', '.join(settable)}")
        wanted = bool if variables[name].type == "Boolean" else float
        if not isinstance(value, wanted):
            expected = "true or false" if wanted is bool else "a number"
            raise ValueError(f"{source}: {name} = {value!r} is not {expected}")
    messages: list[str] = []
    rows: list[list[float]] = []
    points = np.stack([*inputs.values()], axis=-1) if inputs else np.empty((time.size, 0))
    with open_instance(folder, md, source, messages) as fmu:
        try:
            fmu.enter_initialization()
            fmu.set_values({**settings, **dict(zip(inputs, points[0].tolist(), strict=True))})
            fmu.fmu.exitInitializationMode()
            driven, read = fmu.group_reals([*inputs]), fmu.group_reals([v.name for v in outputs])
            for i, values in enumerate(track_progress(points.tolist(), Path(source).stem, len(points))):
                driven.set_values(*values)
                if i:
                    fmu.do_step(float(time[i - 1]), float(time[i] - time[i - 1]))
                rows.append(read.get_values())
        except Exception as error:
            raise ValueError(f"{source}: {messages[0] if messages else error}") from None
    table = np.asarray(rows).reshape(len(points), len(outputs))
    columns = dict(inputs) | {v.name: table[:, i] for i, v in enumerate(outputs)}
    units = {name: variables[name].unit or "1" for name in columns}
    return RampResult(columns, units, tuple(messages))
