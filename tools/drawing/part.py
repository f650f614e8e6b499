"""What a joint's part `new` says: NEW, the options of a drawing, and the joint that they make."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jointfmu.parameters import ParameterFile

Given = Mapping[str, Any]
"""{name of an option: its text, a list of texts, or whether a flag is there; None where it is left out}."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Option:
    """Something on a drawing.

    name     : on the command line with hyphens
    text     : meaning, a number's with the unit that it has without one
    metavar  : what stands for its value in the help
    many     : it takes several texts
    flag     : it takes none
    choices  : words that are allowed; none: any
    required : it must be stated
    """

    name: str
    text: str
    metavar: str = "VALUE"
    many: bool = False
    flag: bool = False
    choices: Sequence[str] = ()
    required: bool = False


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
