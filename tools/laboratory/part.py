"""What a joint's part `laboratory` adds to what its variables say: LABORATORY, {FMU: Bench}."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from jointfmu_fmu_src.joint_parts import RampPanel


class Shown(NamedTuple):
    """Where the FMU shows a published quantity: its output, and a variable for each argument."""

    output: str
    arguments: Mapping[str, str]


class MeasuredCurve(NamedTuple):
    """A measured curve beside a panel.

    over, quantity : variables of the panel
    x, y  : in their SI units, y per unit of the parameter `times`
    """

    label: str
    source: str
    over: str
    quantity: str
    x: Sequence[float]
    y: Sequence[float]
    times: str


class Map(NamedTuple):
    """A quantity over the contact, from `lab_map` of the C file `map.c` in the part's folder.

    shown : the unit in which it is shown
    marks : parameter set -> places (n, 2) [m] that are marked, and what they are; none if it has none
    """

    name: str
    unit: str
    shown: str
    doc: str
    marks: Callable[[Any], tuple[Sequence[Sequence[float]], str]]


class Turn(NamedTuple):
    """A shaft that turns while another follows by a ratio against a load.

    driven, speed             : inputs of the shaft
    follower, follower_speed  : of the other
    torque, load              : outputs: torque on the first shaft, and on the other
    error                     : output by which the other runs ahead
    ratio, rated              : parameters: the first shaft's turns to one of the other, a usual load
    usual                     : a usual speed [rad/s]
    """

    driven: str
    speed: str
    follower: str
    follower_speed: str
    torque: str
    load: str
    error: str
    ratio: str
    rated: str
    usual: float


class Example(NamedTuple):
    """Values beside the default ones that show more of the joint, and what they are."""

    doc: str
    values: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class LaboratoryModel:
    """One model on the page.

    panels   : curves beside those of the FMU's documentation
    spans    : {variable: (from, to) of its slider}, SI, where nothing else says it
    path     : inputs along which the pointer draws; none: the driven one
    points   : {quantity of a reference file: where the FMU shows it}
    measured : curves of other joints
    picture  : a map of the contact
    turn     : two shafts that turn
    example  : values that a button sets
    """

    panels: Sequence[RampPanel] = ()
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    path: Sequence[str] = ()
    points: Mapping[str, Shown] = field(default_factory=dict)
    measured: Sequence[MeasuredCurve] = ()
    picture: Map | None = None
    turn: Turn | None = None
    example: Example | None = None
