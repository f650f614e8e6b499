"""Functions that compute the published numbers of a joint.

The module `published` in a joint's folder defines them by its constant PUBLISHED_NUMBERS.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from jointfmu.joints.kind import JointKind

from ...common.joint_parts import load_tool_module


@dataclass(frozen=True, slots=True)
class CalibrationFit:
    """Fit to calibration points: parameters that a paper does not state are fitted to its published numbers.

    unknowns  : {parameter: start value > 0}; their logarithms are fitted, so they stay positive
    point_ids : ids of the calibration points, as many as unknowns
    """

    unknowns: Mapping[str, float]
    point_ids: Sequence[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedNumbers:
    """Published numbers of a joint, and functions that compute them.

    papers               : names of the papers' files in models/reference/
    observable_functions : {quantity of a reference file: function of the parameter set and the point's
                           arguments}
    calibration          : fits to calibration points, in the order of execution
    """

    papers: Sequence[str] = ()
    observable_functions: Mapping[str, Callable[..., float | bool]] = field(default_factory=dict)
    calibration: Sequence[CalibrationFit] = ()


def load_published_numbers(joint_kind: JointKind) -> PublishedNumbers:
    """Import the published numbers that a joint defines; the result has no papers if it defines none."""
    own: PublishedNumbers = getattr(
        load_tool_module(joint_kind, "published"), "PUBLISHED_NUMBERS", PublishedNumbers()
    )
    return own
