"""What a joint's file `published.py` gives: OBSERVABLES and CALIBRATION."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module

from .kind import Kind


@dataclass(frozen=True, slots=True)
class CalibrationFit:
    """Unknowns with starting values and the calibration points that fix them.

    All unknowns are fitted in logarithms, so they stay positive.
    """

    unknowns: Mapping[str, float]
    points: Sequence[str]


@dataclass(frozen=True, slots=True)
class Published:
    """How published numbers of a joint are computed.

    observables : {quantity of a reference file: function of the parameter set and the point's arguments}
    calibration : fits to calibration points, one after the other
    """

    observables: Mapping[str, Callable[..., float | bool]] = field(default_factory=dict)
    calibration: Sequence[CalibrationFit] = ()


def published(kind: Kind) -> Published:
    """What the joint's module `published` says; nothing if no paper is about it."""
    if not kind.papers:
        return Published()
    own: Published = import_module(f"{kind.package}.published").PUBLISHED
    return own
