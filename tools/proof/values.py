"""Kinds of FMU variables, and conversion of values in files to the types of the variables."""

from typing import TYPE_CHECKING, Any

from jointfmu_fmu_src.proof.series import TimeSeries

from jointfmu.quantity import Array

from .manifest import Setting
from .task import REAL

if TYPE_CHECKING:
    from fmpy.model_description import ScalarVariable


KINDS = {
    **dict.fromkeys(REAL, "real"),
    "Boolean": "boolean",
    **dict.fromkeys(("Integer", "Enumeration", "Int32", "Int64"), "integer"),
}
"""{FMI type: kind} of possible inputs and compared outputs; in CSV files booleans are 0 or 1."""


def kind(variable: "ScalarVariable") -> str:
    """Kind of a variable: "real", "integer" or "boolean"; ValueError for other types and arrays."""
    if variable.type not in KINDS or variable.dimensions:
        text = "an array" if variable.dimensions else f"of type {variable.type}"
        raise ValueError(f"{variable.name} is {text}; single real, whole and truth values are compared")
    return KINDS[variable.type]


def setting(variable: "ScalarVariable", given: Setting) -> object:
    """Convert a stated start value to the type of its variable.

    Raises ValueError if its unit is not that of the variable, or if it is no value of this type.
    """
    unit = variable.unit or "1"
    if given.unit and given.unit != unit:
        raise ValueError(f"{variable.name} is given in {given.unit!r}, expected {unit!r}")
    value = given.value
    items = variable.declaredType.items or () if variable.type == "Enumeration" else ()
    value = next((item.value for item in items if item.name == value), value)
    if variable.type == "String":
        return str(value)
    try:
        return typed(variable, float(value))
    except ValueError:
        raise ValueError(f"{variable.name} = {given.value!r} is no {variable.type}") from None


def typed(variable: "ScalarVariable", value: float) -> float | int | bool:
    """Convert a number to the kind of a variable (real, integer, boolean); ValueError if it is none."""
    if (variable_kind := kind(variable)) == "real":
        return value
    number = int(value)
    if number != value or (variable_kind == "boolean" and number not in (0, 1)):
        raise ValueError(f"{variable.name} = {value:g} is no {variable.type}")
    return bool(number) if variable_kind == "boolean" else number


def course(variable: "ScalarVariable", stimuli: TimeSeries, times: Array, before: bool) -> list[Any]:
    """Values of an input at times (n) [s]: real inputs are interpolated linearly, others are held.

    left_limit : at a jump, take the value before it instead of the value after it; real inputs only
    """
    if kind(variable) != "real":
        return [typed(variable, value) for value in stimuli.held(variable.name, times).tolist()]
    values = stimuli.before(variable.name, times) if before else stimuli.at(variable.name, times)
    return list(values.tolist())


def has_start(variable: "ScalarVariable") -> bool:
    """Whether a variable is a parameter or input with a start value that can be compared."""
    is_settable = variable.causality in ("parameter", "input") and variable.start is not None
    return is_settable and variable.type in KINDS and not variable.dimensions


def start(variable: "ScalarVariable") -> float | int | bool:
    """Start value of a variable in modelDescription.xml, converted to its type."""
    text = str(variable.start)
    if variable.type == "Boolean":
        return text in ("true", "1")
    return float(text) if variable.type in REAL else int(text)
