"""What a joint's file `pressing.py` gives: how its load presses on its interface."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from jointfmu.joints.kind import Kind

from .parts import part


@dataclass(frozen=True, slots=True, kw_only=True)
class Pressing:
    """PRESSING of the file pressing.py in a joint's folder.

    load  : the input or output of the joint whose value a working point is
    usual : parameter set -> load where none is asked for
    mean  : (parameter set, load) -> nominal pressure [Pa] at which the interface's stiffness is judged
    peak  : (parameter set, load) -> greatest nominal pressure [Pa]
    scale : (parameter set, load) -> the joint's stiffness over that of its interface law at the mean [1]
    borne : parameter set -> (most that what carries the load bears, what that is), or None if not known
    """

    load: str
    usual: Callable[[Any], float]
    mean: Callable[[Any, float], float]
    peak: Callable[[Any, float], float]
    scale: Callable[[Any, float], float] = lambda parameters, load: 1.0
    borne: Callable[[Any], tuple[float, str] | None] = lambda parameters: None


def pressing(kind: Kind) -> Pressing | None:
    """What the joint's folder says; None if it says nothing."""
    found = part(kind, "pressing")
    return found.PRESSING if found else None
