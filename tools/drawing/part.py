"""What a joint's part `new` says: NEW, the options of a drawing, the joint that they make, and its
parameters as they are collected, each with where it comes from.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import build, flat_fields

from ..catalogue import Printed
from ..joint_parts import Option

Given = Mapping[str, Any]
"""{name of an option: its text, a list of texts, or whether a flag is there; None where it is left out}."""


@dataclass(frozen=True, slots=True)
class NewJoint:
    """A joint that a drawing makes.

    facts    : {name: (value, unit, meaning)} of what was computed beside its parameters
    warnings : a line each
    """

    file: "ParameterFile"
    facts: Mapping[str, tuple[float, str, str]]
    warnings: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A way to a new joint.

    text    : what it makes, in words
    example : options that make one
    options : what it takes
    run     : a module of the joint's is loaded only then. ValueError: bad input
    """

    text: str
    example: str
    options: Sequence[Option]
    run: Callable[[Given], NewJoint]


@dataclass(slots=True)
class Sheet:
    """{structured name: (value, kind, source)} of a joint, start values of its inputs, ranges of some, and
    {name: (height [m], kind, source)} of its surfaces, as in `ParameterFile.roughness`.
    """

    joint: str
    law: str
    known: dict[str, tuple[object, str, str]] = field(default_factory=dict)
    inputs: dict[str, float] = field(default_factory=dict)
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    roughness: dict[str, tuple[float, str, str]] = field(default_factory=dict)

    def put(self, name: str, value: Any, kind: str, source: str) -> None:
        """A parameter, or with the prefix `inputs.` a start value."""
        if name.startswith("inputs."):
            self.inputs[name.removeprefix("inputs.")] = value
        self.known[name] = (value, kind, source)

    def between(self, name: str, low: float, high: float) -> None:
        """Least and greatest value that a parameter may have, by the source of its value."""
        self.ranges[name] = (low, high)

    def stated(self, name: str, value: object) -> None:
        self.put(name, value, "user", "stated on the drawing")

    def take(self, name: str, known: Printed) -> None:
        self.put(name, known.value, known.kind, known.source)

    def value(self, name: str) -> Any:
        return self.known[name][0]

    def file(self, name: str) -> ParameterFile:
        """The parameter file of that name, with those of the values that the joint's law has.

        Raises ValueError as `quantity.build`.
        """
        cls = KINDS[self.joint].laws[self.law]
        declared = {key for key, _ in flat_fields(cls)}
        own = {key: known for key, known in self.known.items() if key in declared}
        starts = {key: known for key, known in self.known.items() if key.startswith("inputs.")}
        kept = own | starts
        file = ParameterFile(
            self.joint,
            name,
            build(cls, {key: value for key, (value, _, _) in own.items()}),
            {key: kind for key, (_, kind, _) in kept.items()},
            {key: source for key, (_, _, source) in kept.items()},
            self.inputs,
            ranges={name: ends for name, ends in self.ranges.items() if name in own},
        )
        rough = file
        for height, (value, kind, source) in self.roughness.items():
            rough = rough.with_roughness({height: value}, kind, source)
        return replace(
            rough, origins={**rough.origins, **file.origins}, sources={**rough.sources, **file.sources}
        )
