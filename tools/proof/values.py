"""Variables of an FMU: their kind, and values of files as theirs."""

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
"""{type: kind} of variables that are driven and compared; in a series a truth value is 0 or 1."""


def kind(variable: "ScalarVariable") -> str:
    """Kind of a variable. Raises ValueError if it is none of KINDS."""
    if variable.type not in KINDS or variable.dimensions:
        what = "an array" if variable.dimensions else f"of type {variable.type}"
        raise ValueError(f"{variable.name} is {what}; single real, whole and truth values are compared")
    return KINDS[variable.type]


def setting(variable: "ScalarVariable", given: Setting) -> object:
    """A start value as the variable takes it. Raises ValueError for a foreign unit, or if it does not fit."""
    own = variable.unit or "1"
    if given.unit and given.unit != own:
        raise ValueError(f"{variable.name} is given in {given.unit!r}, expected {own!r}")
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
    """A number as a value of the kind of a variable. Raises ValueError if it is none."""
    if (own := kind(variable)) == "real":
        return value
    number = int(value)
    if number != value or (own == "boolean" and number not in (0, 1)):
        raise ValueError(f"{variable.name} = {value:g} is no {variable.type}")
    return bool(number) if own == "boolean" else number


def course(variable: "ScalarVariable", stimuli: TimeSeries, times: Array, before: bool) -> list[Any]:
    """An input at times: straight between rows if it is real, else held; see `Series.at`."""
    if kind(variable) != "real":
        return [typed(variable, value) for value in stimuli.held(variable.name, times).tolist()]
    found = stimuli.before(variable.name, times) if before else stimuli.at(variable.name, times)
    return list(found.tolist())


def has_start(variable: "ScalarVariable") -> bool:
    """Whether the start value is one that can be compared."""
    set_from_outside = variable.causality in ("parameter", "input") and variable.start is not None
    return set_from_outside and variable.type in KINDS and not variable.dimensions


def start(variable: "ScalarVariable") -> float | int | bool:
    """The start value of modelDescription.xml."""
    text = str(variable.start)
    if variable.type == "Boolean":
        return text in ("true", "1")
    return float(text) if variable.type in REAL else int(text)
