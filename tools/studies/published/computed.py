"""Functions that compute the published numbers of a joint.

The module `published` in a joint's folder defines them by its constant PUBLISHED_NUMBERS.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from jointfmu.joints.kind import JointKind

from ...common.joint_parts import load_tool_module


@dataclass(frozen=True, slots=True)
class CalibrationFit:
    """Fit of parameters that a paper does not state to numbers that the paper publishes.

    start_value_by_parameter : {fitted parameter: start value > 0}; the fit varies the logarithms of the
        parameters, so they stay positive
    point_ids                : ids of the published numbers, as many as parameters
    """

    start_value_by_parameter: Mapping[str, float]
    point_ids: Sequence[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedNumbers:
    """Papers with published numbers of one kind of joint, and the functions that compute these numbers.

    paper_names          : names of the papers' files in models/reference/
    observable_functions : {quantity in such a file: function that computes the quantity from the parameter
        set and the arguments of the published number}
    calibration_fits     : fits of parameters to published numbers, in the order of execution
    """

    paper_names: Sequence[str] = ()
    observable_functions: Mapping[str, Callable[..., float | bool]] = field(default_factory=dict)
    calibration_fits: Sequence[CalibrationFit] = ()


def load_published_numbers(joint_kind: JointKind) -> PublishedNumbers:
    """Import the published numbers that a kind of joint defines; without papers if it defines none."""
    own: PublishedNumbers = getattr(
        load_tool_module(joint_kind, "published"), "PUBLISHED_NUMBERS", PublishedNumbers()
    )
    return own
