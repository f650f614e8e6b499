"""Kinds of FMU variables, and conversion of values in files to the types of the variables."""

from typing import TYPE_CHECKING, Any

from jointfmu_fmu_src.proof.series import TimeSeries

from jointfmu.quantity import Array

from .manifest import StartSetting
from .task import REAL_TYPES

if TYPE_CHECKING:
    from fmpy.model_description import ScalarVariable


VARIABLE_KINDS = {
    **dict.fromkeys(REAL_TYPES, "real"),
    "Boolean": "boolean",
    **dict.fromkeys(("Integer", "Enumeration", "Int32", "Int64"), "integer"),
}
"""{FMI type: kind} of possible inputs and compared outputs; in CSV files booleans are 0 or 1."""


def variable_kind(variable: "ScalarVariable") -> str:
    """Kind of an FMU variable: "real", "integer" or "boolean"; ValueError for other types and arrays."""
    if variable.type not in VARIABLE_KINDS or variable.dimensions:
        text = "an array" if variable.dimensions else f"of type {variable.type}"
        raise ValueError(f"{variable.name} is {text}; single real, whole and truth values are compared")
    return VARIABLE_KINDS[variable.type]


def convert_start_setting(variable: "ScalarVariable", start_setting: StartSetting) -> object:
    """Convert the start value that an experiment states to the type of its variable.

    Raises ValueError if its unit is not that of the variable, or if it is not a value of this type.
    """
    unit = variable.unit or "1"
    if start_setting.unit and start_setting.unit != unit:
        raise ValueError(f"{variable.name} is given in {start_setting.unit!r}, expected {unit!r}")
    value = start_setting.value
    items = variable.declaredType.items or () if variable.type == "Enumeration" else ()
    value = next((item.value for item in items if item.name == value), value)
    if variable.type == "String":
        return str(value)
    try:
        return convert_value(variable, float(value))
    except ValueError:
        raise ValueError(
            f"{variable.name} = {start_setting.value!r} is not of type {variable.type}"
        ) from None


def convert_value(variable: "ScalarVariable", value: float) -> float | int | bool:
    """Convert a number to the kind of a variable: real, integer or boolean. ValueError if it does not fit."""
    if (kind := variable_kind(variable)) == "real":
        return value
    number = int(value)
    if number != value or (kind == "boolean" and number not in (0, 1)):
        raise ValueError(f"{variable.name} = {value:g} is not of type {variable.type}")
    return bool(number) if kind == "boolean" else number


def input_values(
    variable: "ScalarVariable", stimuli: TimeSeries, times: Array, takes_value_before_jump: bool
) -> list[Any]:
    """Values of an input of an experiment at times (n) [s].

    Real inputs are interpolated linearly, others are held.

    takes_value_before_jump : at a jump, take the value before it instead of the value after it; real inputs
        only
    """
    if variable_kind(variable) != "real":
        return [
            convert_value(variable, value)
            for value in stimuli.interpolate_constant(variable.name, times).tolist()
        ]
    values = (
        stimuli.interpolate_left(variable.name, times)
        if takes_value_before_jump
        else stimuli.interpolate(variable.name, times)
    )
    return list(values.tolist())


def has_start_value(variable: "ScalarVariable") -> bool:
    """Whether a variable is a parameter or input with a start value that can be compared."""
    is_settable = variable.causality in ("parameter", "input") and variable.start is not None
    return is_settable and variable.type in VARIABLE_KINDS and not variable.dimensions


def read_start_value(variable: "ScalarVariable") -> float | int | bool:
    """Read the start value of a variable in modelDescription.xml, converted to its type."""
    text = str(variable.start)
    if variable.type == "Boolean":
        return text in ("true", "1")
    return float(text) if variable.type in REAL_TYPES else int(text)
