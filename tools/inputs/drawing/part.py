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
    """Joint made from a drawing: parameter file, derived values and warnings.

    parameter_file : parameter file of the joint
    facts          : {name: (value, unit, meaning)} of values computed from the parameters, for the user
    warnings       : one line each
    """

    parameter_file: "ParameterFile"
    facts: Mapping[str, tuple[float, str, str]]
    warnings: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True, slots=True, kw_only=True)
class NewJointCommand:
    """Sub-command of `jointfmu new` for a joint: options of the drawing, and function that makes the joint.

    joint_description : the joint in words
    example_options   : options of an example, as text
    command_options   : options of the command
    make_joint        : options -> new joint; loads the modules of the joint. Raises ValueError for bad input
    """

    joint_description: str
    example_options: str
    command_options: Sequence[Option]
    make_joint: Callable[[DrawingOptions], NewJoint]


@dataclass(slots=True)
class ParameterSheet:
    """Parameters of a new joint while they are collected, each with its origin and source.

    parameter_entries  : {parameter name: (value, origin, source)}
    input_start_values : {input: start value}
    parameter_ranges   : {parameter name: (lower, upper limit)}, for some of the parameters
    roughness_heights  : {name: (height [m], origin, source)} of the surfaces, as in `ParameterFile.roughness`
    """

    joint_kind: str
    interface_law: str
    parameter_entries: dict[str, tuple[object, str, str]] = field(default_factory=dict)
    input_start_values: dict[str, float] = field(default_factory=dict)
    parameter_ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    roughness_heights: dict[str, tuple[float, str, str]] = field(default_factory=dict)

    def add_parameter(
        self, parameter_name: str, parameter_value: Any, value_origin: str, value_source: str
    ) -> None:
        """Add a parameter; `inputs.NAME` is the start value of the input NAME."""
        if parameter_name.startswith("inputs."):
            self.input_start_values[parameter_name.removeprefix("inputs.")] = parameter_value
        self.parameter_entries[parameter_name] = (parameter_value, value_origin, value_source)

    def set_parameter_range(self, parameter_name: str, lower_limit: float, upper_limit: float) -> None:
        """Set the lower and upper limit of a parameter, as its source states them."""
        self.parameter_ranges[parameter_name] = (lower_limit, upper_limit)

    def add_drawing_value(self, parameter_name: str, parameter_value: object) -> None:
        """Add a parameter whose value the user states on the drawing."""
        self.add_parameter(parameter_name, parameter_value, "user", "stated on the drawing")

    def add_drawing_number(self, parameter_name: str, stated_number: StatedNumber) -> None:
        """Add a parameter that the user states as a number, or as a range: the middle is the value."""
        text = (
            f"stated on the drawing: {stated_number.lower_limit:g} to {stated_number.upper_limit:g}, "
            "taken as the middle"
        )
        self.add_parameter(
            parameter_name,
            stated_number.stated_value,
            "user",
            text if stated_number.is_range else "stated on the drawing",
        )
        if stated_number.is_range:
            self.set_parameter_range(parameter_name, stated_number.lower_limit, stated_number.upper_limit)

    def add_sourced_number(self, parameter_name: str, sourced_number: SourcedNumber) -> None:
        """Add a parameter whose number, origin and source come from a table or a catalogue."""
        self.add_parameter(
            parameter_name, sourced_number.si_value, sourced_number.value_origin, sourced_number.value_source
        )

    def get_parameter_value(self, parameter_name: str) -> Any:
        """Value of a parameter that is already in the sheet."""
        return self.parameter_entries[parameter_name][0]

    def build_parameter_file(self, parameter_set_name: str) -> ParameterFile:
        """Build the parameter file; the parameter set gets the name `parameter_set_name`.

        Parameters that the joint's law does not have are left out.

        Raises ValueError for a missing value, or for a value outside its allowed interval.
        """
        cls = KINDS[self.joint_kind].laws[self.interface_law]
        declared = {key for key, _ in flatten_fields(cls)}
        parameters = {key: entry for key, entry in self.parameter_entries.items() if key in declared}
        starts = {key: entry for key, entry in self.parameter_entries.items() if key.startswith("inputs.")}
        entries = parameters | starts
        file = ParameterFile(
            self.joint_kind,
            parameter_set_name,
            build_parameter_set(cls, {key: value for key, (value, _, _) in parameters.items()}),
            {key: kind for key, (_, kind, _) in entries.items()},
            {key: source for key, (_, _, source) in entries.items()},
            self.input_start_values,
            ranges={name: ends for name, ends in self.parameter_ranges.items() if name in entries},
        )
        rough = file
        for height, (value, kind, source) in self.roughness_heights.items():
            rough = rough.with_roughness({height: value}, kind, source)
        return replace(
            rough,
            origins={**rough.origins, **file.origins},
            sources={**rough.sources, **file.sources},
            ranges=file.ranges,
        )
