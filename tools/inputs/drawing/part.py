"""Joints from drawings: options of a drawing, collection of parameters with their sources, the new joint.

The module `new` in a joint's folder defines its options and the function that makes it by its
constant NEW_JOINT_COMMAND.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import build_parameter_set, flatten_fields

from ...common.options import Option
from ..catalogue import SourcedNumber
from .quantities import StatedNumber

DrawingOptions = Mapping[str, Any]
"""{option: its text, a list of texts, or a bool for a flag; None if the user does not set the option}."""


@dataclass(frozen=True, slots=True)
class NewJoint:
    """Joint made from a drawing: parameter file, facts and warnings.

    file     : parameter file
    facts    : {name: (value, unit, meaning)} of additional results, which are no parameters
    warnings : one line each
    """

    file: "ParameterFile"
    facts: Mapping[str, tuple[float, str, str]]
    warnings: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True, slots=True, kw_only=True)
class NewJointCommand:
    """Sub-command of `jointfmu new` for a joint: options of the drawing, and function that makes the joint.

    description : the joint in words
    example     : options of an example, as text
    options     : options of the command
    make_joint  : options -> new joint; loads the modules of the joint. Raises ValueError for bad input
    """

    description: str
    example: str
    options: Sequence[Option]
    make_joint: Callable[[DrawingOptions], NewJoint]


@dataclass(slots=True)
class ParameterSheet:
    """Parameters of a new joint while they are collected, each with its origin and source.

    entries   : {structured name: (value, kind, source)}
    inputs    : {input: start value}
    ranges    : {structured name: (lower, upper limit)}, for some of the parameters
    roughness : {name: (height [m], kind, source)} of the surfaces, as in `ParameterFile.roughness`
    """

    joint: str
    law: str
    entries: dict[str, tuple[object, str, str]] = field(default_factory=dict)
    inputs: dict[str, float] = field(default_factory=dict)
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    roughness: dict[str, tuple[float, str, str]] = field(default_factory=dict)

    def add_parameter(self, parameter_name: str, value: Any, origin: str, source: str) -> None:
        """Add a parameter; with the prefix `inputs.`, the start value of an input."""
        if parameter_name.startswith("inputs."):
            self.inputs[parameter_name.removeprefix("inputs.")] = value
        self.entries[parameter_name] = (value, origin, source)

    def set_parameter_range(self, parameter_name: str, low: float, high: float) -> None:
        """Set the lower and upper limit that the source of a parameter states."""
        self.ranges[parameter_name] = (low, high)

    def add_drawing_value(self, parameter_name: str, value: object) -> None:
        """Add a parameter whose value the user states on the drawing."""
        self.add_parameter(parameter_name, value, "user", "stated on the drawing")

    def add_drawing_number(self, parameter_name: str, stated_number: StatedNumber) -> None:
        """Add a number that the user states: one value, or a range, of which the middle is the value."""
        text = f"stated on the drawing: {stated_number.low:g} to {stated_number.high:g}, taken as the middle"
        self.add_parameter(
            parameter_name,
            stated_number.value,
            "user",
            text if stated_number.is_range else "stated on the drawing",
        )
        if stated_number.is_range:
            self.set_parameter_range(parameter_name, stated_number.low, stated_number.high)

    def add_sourced_number(self, parameter_name: str, sourced_number: SourcedNumber) -> None:
        """Add a parameter with the value and source of a tabulated number."""
        self.add_parameter(parameter_name, sourced_number.value, sourced_number.origin, sourced_number.source)

    def get_value(self, parameter_name: str) -> Any:
        """Value of a parameter that was added before."""
        return self.entries[parameter_name][0]

    def build_file(self, parameter_set_name: str) -> ParameterFile:
        """Build the parameter file with a name of the parameter set.

        Parameters that the joint's law does not have are left out.

        Raises ValueError for a missing value, or for a value outside its allowed interval.
        """
        cls = KINDS[self.joint].laws[self.law]
        declared = {key for key, _ in flatten_fields(cls)}
        parameters = {key: entry for key, entry in self.entries.items() if key in declared}
        starts = {key: entry for key, entry in self.entries.items() if key.startswith("inputs.")}
        entries = parameters | starts
        file = ParameterFile(
            self.joint,
            parameter_set_name,
            build_parameter_set(cls, {key: value for key, (value, _, _) in parameters.items()}),
            {key: kind for key, (_, kind, _) in entries.items()},
            {key: source for key, (_, _, source) in entries.items()},
            self.inputs,
            ranges={name: ends for name, ends in self.ranges.items() if name in entries},
        )
        rough = file
        for height, (value, kind, source) in self.roughness.items():
            rough = rough.with_roughness({height: value}, kind, source)
        return replace(
            rough,
            origins={**rough.origins, **file.origins},
            sources={**rough.sources, **file.sources},
            ranges=file.ranges,
        )
