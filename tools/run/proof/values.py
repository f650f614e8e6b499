"""Kinds of FMU variables, and conversion of values in files to the types of the variables."""

from typing import TYPE_CHECKING, Any

from jointfmu_fmu_src.proof.series import TimeSeries

from jointfmu.quantity import Array

from .manifest import StartSetting
from .task import FMI_REAL_TYPES

if TYPE_CHECKING:
    from fmpy.model_description import ScalarVariable


DATA_TYPE_BY_FMI_TYPE = {
    **dict.fromkeys(FMI_REAL_TYPES, "real"),
    "Boolean": "boolean",
    **dict.fromkeys(("Integer", "Enumeration", "Int32", "Int64"), "integer"),
}
"""{FMI type: data type} of possible inputs and compared outputs; in CSV files booleans are 0 or 1."""


def variable_data_type(fmu_variable: "ScalarVariable") -> str:
    """Data type of an FMU variable: "real", "integer" or "boolean"; ValueError for other types and arrays."""
    if fmu_variable.type not in DATA_TYPE_BY_FMI_TYPE or fmu_variable.dimensions:
        text = "an array" if fmu_variable.dimensions else f"of type {fmu_variable.type}"
        raise ValueError(
            f"{fmu_variable.name} is {text}; only single real, integer and Boolean variables can be compared"
        )
    return DATA_TYPE_BY_FMI_TYPE[fmu_variable.type]


def convert_start_setting(fmu_variable: "ScalarVariable", start_setting: StartSetting) -> object:
    """Convert the start value that an experiment states to the type of its variable.

    Raises ValueError if its unit is not that of the variable, or if it is not a value of this type.
    """
    unit = fmu_variable.unit or "1"
    if start_setting.value_unit and start_setting.value_unit != unit:
        raise ValueError(
            f"start value of {fmu_variable.name}: unit {start_setting.value_unit!r}, expected {unit!r}"
        )
    value = start_setting.start_value
    items = fmu_variable.declaredType.items or () if fmu_variable.type == "Enumeration" else ()
    value = next((item.value for item in items if item.name == value), value)
    if fmu_variable.type == "String":
        return str(value)
    try:
        return convert_value(fmu_variable, float(value))
    except ValueError:
        raise ValueError(
            f"{fmu_variable.name} = {start_setting.start_value!r} is not of type {fmu_variable.type}"
        ) from None


def convert_value(fmu_variable: "ScalarVariable", numeric_value: float) -> float | int | bool:
    """Convert a number to the data type of an FMU variable; ValueError if it does not fit."""
    if (kind := variable_data_type(fmu_variable)) == "real":
        return numeric_value
    number = int(numeric_value)
    if number != numeric_value or (kind == "boolean" and number not in (0, 1)):
        raise ValueError(f"{fmu_variable.name} = {numeric_value:g} is not of type {fmu_variable.type}")
    return bool(number) if kind == "boolean" else number


def evaluate_stimulus(
    fmu_variable: "ScalarVariable",
    stimuli: TimeSeries,
    communication_points: Array,
    takes_value_before_jump: bool,
) -> list[Any]:
    """Values of an input of an experiment at communication points (n) [s].

    Real inputs are interpolated linearly; integer and boolean inputs are constant between two points.
    takes_value_before_jump : at a jump, take the value before it instead of the value after it; real inputs
        only
    """
    if variable_data_type(fmu_variable) != "real":
        return [
            convert_value(fmu_variable, value)
            for value in stimuli.interpolate_stepwise(fmu_variable.name, communication_points).tolist()
        ]
    values = (
        stimuli.interpolate_before_jumps(fmu_variable.name, communication_points)
        if takes_value_before_jump
        else stimuli.interpolate_linearly(fmu_variable.name, communication_points)
    )
    return list(values.tolist())


def has_start_value(fmu_variable: "ScalarVariable") -> bool:
    """Whether a variable is a parameter or input with a start value that can be compared."""
    is_settable = fmu_variable.causality in ("parameter", "input") and fmu_variable.start is not None
    return is_settable and fmu_variable.type in DATA_TYPE_BY_FMI_TYPE and not fmu_variable.dimensions


def read_start_value(fmu_variable: "ScalarVariable") -> float | int | bool:
    """Read the start value of a variable in modelDescription.xml, converted to its type."""
    text = str(fmu_variable.start)
    if fmu_variable.type == "Boolean":
        return text in ("true", "1")
    return float(text) if fmu_variable.type in FMI_REAL_TYPES else int(text)
