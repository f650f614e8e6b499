"""What a joint's file `reduced.py` gives: its curves for many samples at once, and exact for a single one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jointfmu.joints.kind import Kind
from jointfmu.joints.model import Variable
from jointfmu.quantity import Array

from ..joint_parts import part

Evaluate = Callable[[type[Any], Mapping[str, Any], Array, Array], dict[str, Array]]


@dataclass(frozen=True, slots=True)
class Reduced:
    """A joint's curves over a ramp of load.

    load     : the ramped input
    outputs  : what is computed along the ramp
    to       : default end of the ramp, of the parameter set
    most     : where the tabulated law ends, of the parameter set (numbers or samples)
    evaluate : (class of the parameter set, values or samples (n), loads (m), factor (n, 1)) -> outputs
        (n, m) at factor times loads
    exact    : (parameter set, loads (m)) -> outputs (m), by the exported spring itself
    """

    load: Variable
    outputs: Sequence[Variable]
    to: Callable[[Any], float]
    most: Callable[[Any], Any]
    evaluate: Evaluate
    exact: Callable[[Any, Array], dict[str, Array]]

    @property
    def units(self) -> dict[str, str]:
        """{output: unit}."""
        return {v.name: v.unit for v in self.outputs}


def reduced(kind: Kind) -> Reduced:
    """What the joint's folder says.

    Raises ValueError if it has no reduced evaluation.
    """
    found = part(kind, "reduced")
    if found is None:
        raise ValueError(f"joint = {kind.name!r} has no evaluation for many samples at once")
    curves: Reduced = found.REDUCED
    return curves
