"""Forms in which tests/joints/KIND/cases.py describes a joint to the shared tests."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

Inputs = dict[str, float]


class Beyond(NamedTuple):
    """Input far beyond the end of the table: its output, its stiffness and the warning.

    inverse : the stiffness is input over output (input: force), not output over input
    lever   : lever arm of the input: slope of the output over the stiffness
    """

    driven: str
    far: float
    answer: str
    stiffness: str
    text: str
    inverse: bool = False
    lever: float = 1.0


class Refused(NamedTuple):
    """Parameter value outside its interval, and how the refusal shows value and interval."""

    parameter: str
    value: float
    shown: str
    allowed: str


class Study(NamedTuple):
    """Uncertainty study: distributions of parameters and inputs, number of samples that are checked."""

    given: Mapping[str, str]
    samples: int


@dataclass(frozen=True, kw_only=True)
class Description:
    """Expected content of an FMU's model description.

    inputs, results, parameters : the contract, {variable: unit}; the FMU may have more
    calibration : some of the parameters that are marked as calibrated
    shown       : {variable: display unit}
    flanges     : {terminal: its variables}
    domain      : domain or domains of its terminals
    steps       : number of steps of the default experiment; None if they are no whole number to the last bit
    linear      : an output is linear in an input, with a factor that FMI may call constant or tunable
    others      : parameters that leave such a constant factor unchanged
    """

    inputs: Mapping[str, str]
    results: Mapping[str, str]
    parameters: Mapping[str, str]
    calibration: frozenset[str] = frozenset()
    shown: Mapping[str, str]
    flanges: Mapping[str, str]
    domain: str
    steps: int | None = None
    linear: bool = False
    others: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """States in which the outputs of an FMU are compared, and smoothness of the outputs.

    outputs : (spring, inputs) -> outputs, by the spring's own function
    ranges  : inputs of random states, all inside the tables
    place   : function that makes inputs from random numbers in `ranges`, if the inputs depend on each other
    span    : inputs over the range of the tables, for the benchmark
    state   : inputs of a state in which no output is zero
    sizes   : {input: typical size} for difference quotients, if `state` does not give it
    good    : inputs of an ordinary state; the other inputs are zero
    rest    : inputs that are not zero at rest
    jumps   : outputs that depend on the third derivative of a table, which jumps at its nodes
    kinks   : outputs that have kinks or jumps themselves, as friction does
    """

    outputs: Callable[[Any, Inputs], Mapping[str, Any]]
    ranges: Mapping[str, tuple[float, float]]
    place: Callable[[Inputs], Inputs] = dict
    span: Mapping[str, tuple[float, float]]
    state: Inputs
    sizes: Inputs = field(default_factory=dict)
    good: Inputs
    rest: Inputs = field(default_factory=dict)
    jumps: frozenset[str] = frozenset()
    kinks: frozenset[str] = frozenset()


@dataclass(frozen=True, kw_only=True)
class Tuning:
    """Parameters that act in an FMU, and how far the tests change them.

    base           : parameter values at which every other parameter has an effect
    also           : further values, at which outputs depend on more inputs than with `base`
    moved          : {parameter: changed value}, if a change by 0.1 % is not possible
    counted        : {parameter: (smallest, largest value)} of random whole numbers
    without_effect : parameters that no output shows
    tuned          : other parameters, each of which changes an output
    baked          : sets of changes of compiled parameters, each for a parameter file of its own
    """

    base: Mapping[str, Any] = field(default_factory=dict)
    also: Mapping[str, Any] = field(default_factory=dict)
    moved: Mapping[str, float] = field(default_factory=dict)
    counted: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    without_effect: frozenset[str] = frozenset()
    tuned: dict[str, Any]
    baked: Sequence[dict[str, Any]]


@dataclass(frozen=True, kw_only=True)
class Refusals:
    """Expected refusals and warnings of an FMU.

    beyond    : ends of tables
    refused   : parameters outside their intervals
    unfit     : parameters that contradict each other, and words of the refusal
    forbidden : further settings that are refused
    absurd    : values inside their intervals that are refused by name or give numbers
    """

    beyond: Sequence[Beyond]
    refused: Sequence[Refused]
    unfit: Sequence[tuple[dict[str, Any], tuple[str, ...]]] = ()
    forbidden: Sequence[dict[str, Any]] = ()
    absurd: Sequence[tuple[str, float]] = ()


@dataclass(frozen=True, kw_only=True)
class Case:
    """Properties of an FMU that the shared tests need, by kind of test."""

    name: str
    description: Description
    numbers: Numbers
    tuning: Tuning
    refusals: Refusals


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Properties of a joint that the shared tests need.

    cases   : test cases of its FMUs
    varied  : a parameter of its surface that may be changed by a small amount
    scaled  : another parameter that may be multiplied by a factor near 1
    studies : studies of its uncertainty
    unloaded : outputs that are not zero without load
    """

    cases: Sequence[Case]
    varied: str
    scaled: str
    studies: Mapping[str, Study]
    unloaded: frozenset[str] = frozenset()
