"""How the published numbers of a joint are computed: `PUBLISHED` of its part `published`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from jointfmu.joints.kind import JointKind

from ..joint_parts import load_tool_module


@dataclass(frozen=True, slots=True)
class CalibrationFit:
    """Unknowns with starting values and the calibration points that fix them.

    All unknowns are fitted in logarithms, so they stay positive.
    """

    unknowns: Mapping[str, float]
    points: Sequence[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedNumbers:
    """The published numbers that a joint is compared with, and how they are computed.

    papers      : files of them in models/reference/
    observables : {quantity of a reference file: function of the parameter set and the point's arguments}
    calibration : fits to calibration points, one after the other
    """

    papers: Sequence[str] = ()
    observables: Mapping[str, Callable[..., float | bool]] = field(default_factory=dict)
    calibration: Sequence[CalibrationFit] = ()


def published_numbers(kind: JointKind) -> PublishedNumbers:
    """What the joint's part says; nothing if no paper is about it."""
    own: PublishedNumbers = getattr(load_tool_module(kind, "published"), "PUBLISHED", PublishedNumbers())
    return own
