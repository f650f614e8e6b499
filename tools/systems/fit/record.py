"""Measured time series of a system: a table whose columns are named as variables of the system."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.joints.model import Model
from jointfmu.quantity import Array
from jointfmu.quantity.units import CELSIUS_UNIT, CELSIUS_ZERO_IN_KELVIN, UNITS, UnitSizes, unit_sizes

from ...common import columns
from ...common.names import find_similar_names

MIN_RECORD_ROW_COUNT = 8
"""Smallest number of rows of a record [1]."""


@dataclass(frozen=True, slots=True)
class MeasuredRecord:
    """Measured time series, in SI units.

    time            : (n) [s], increasing
    inputs          : {input of the system: values (n)}, prescribed in the simulation; if the speed of a
        prescribed angle has no column, it is the derivative of this angle
    outputs         : {output of the system: values (n)}, compared with the simulation
    unused_headings : headings of other columns
    """

    record_path: Path
    time: Array
    inputs: Mapping[str, Array]
    outputs: Mapping[str, Array]
    unused_headings: Sequence[str]


def read_record(
    record_path: Path, system_model: Model, stated_headings: Sequence[str] = ()
) -> MeasuredRecord:
    """Read a measured record of a system from a CSV file.

    system_model    : model of the system's FMU, with the names and units of its variables
    stated_headings : `NAME=HEADING` or `NAME=HEADING [UNIT]`, for columns with other headings

    Raises ValueError, one line, for a bad file, unit or value, for a heading COMPONENT.VARIABLE that the
    system does not have, for time that does not increase, and for a record without an output.
    """
    units = {"time": "s"} | {v.name: v.unit for v in (*system_model.inputs, *system_model.outputs)}
    names = {name.lower(): name for name in units}
    known = {lower: _list_accepted_units(units[name]) for lower, name in names.items()}
    stated = columns.parse_stated_headings(stated_headings, units)
    used = {*known, *(heading.lower() for heading, _ in stated.values())}
    unused = [
        heading
        for heading in columns.read_column_names(record_path)
        if heading not in used and not any(heading.startswith(f"{name}_") for name in known)
    ]
    for heading in unused:
        if "." in heading:
            raise ValueError(
                f"{record_path}: column {heading!r} is no variable of the system, "
                f"{list_similar_names(heading, units)}"
            )
    table = columns.read_columns(record_path, known, MIN_RECORD_ROW_COUNT, stated_headings=stated)
    time = table.require_column("time", known)
    if np.any(backward := np.diff(time) <= 0.0):
        row = int(np.argmax(backward))
        raise ValueError(
            f"{record_path}: line {table.line_numbers[row + 1]}: time = {time[row + 1]:g} s is not after "
            f"{time[row]:g} s of line {table.line_numbers[row]}; expected increasing times"
        )
    values = {
        names[lower]: column + (CELSIUS_ZERO_IN_KELVIN if table.heading_units[lower] == CELSIUS_UNIT else 0.0)
        for lower, column in table.values_by_name.items()
    }
    inputs = {v.name: values[v.name] for v in system_model.inputs if v.name in values}
    outputs = {v.name: values[v.name] for v in system_model.outputs if v.name in values}
    for name in [*inputs]:
        speed = f"{name.removesuffix('.phi_in')}.w_in"
        if name.endswith(".phi_in") and speed not in inputs:  # prescribed motion
            inputs[speed] = np.gradient(inputs[name], time)
    if not outputs:
        present = ", ".join(inputs) or "time alone"
        bodies = ", ".join(v.name for v in system_model.outputs[: system_model.state_count])
        raise ValueError(
            f"{record_path}: has no column to compare ({present}); expected an output, such as {bodies}"
        )
    for name, column in outputs.items():
        if np.ptp(column) == 0.0:
            raise ValueError(
                f"{record_path}: {name} is {column[0]:g} in every row; expected a column that changes"
            )
    return MeasuredRecord(record_path, time, inputs, outputs, unused)


def list_similar_names(unknown_name: str, known_names: Iterable[str]) -> str:
    """Known names that are similar to a name, for an error message; all of them if none is similar."""
    similar = find_similar_names(unknown_name, known_names)
    return f"{'nearest' if similar else 'allowed'} are {', '.join(similar or known_names)}"


def _list_accepted_units(si_unit: str) -> UnitSizes:
    """{unit: size in SI} of a column: the SI unit, and the units in which it is displayed."""
    sizes = unit_sizes(si_unit, *UNITS[si_unit].display_factors)
    return {**sizes, CELSIUS_UNIT: 1.0} if si_unit == "K" else sizes
