"""What a joint's part `fit` says: FITS, its procedures, each of them data and options to parameters."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from jointfmu.joints import KINDS

from ..joint_parts import Option, part

if TYPE_CHECKING:
    from .outcome import FitResult


@dataclass(frozen=True, slots=True, kw_only=True)
class Procedure:
    """A way to fit a joint's parameters.

    name    : what is fitted, with hyphens
    text    : what is fitted to which joint, in words
    file    : whether the data are a measured file
    many    : whether they may be several, which `run` gets as a list
    column  : one that all its files have, and those of other joints' procedures of this name have not
    options : what it takes beside
    run     : ([path of the file, or paths,] ParameterFile to start from or None, names to fit or None,
              **options by name) -> Outcome; a module of the joint's is loaded only then.
              ValueError: bad input, RuntimeError: the fit finds no end
    """

    name: str
    text: str
    file: bool
    many: bool = False
    column: str = ""
    options: Sequence[Option] = ()
    run: "Callable[..., FitResult]"


def fit_of(module: str) -> "Callable[..., FitResult]":
    """The function `fit` of a module, which is loaded when it is called."""

    def run(*given: object, **options: object) -> "FitResult":
        found: FitResult = import_module(module).fit(*given, **options)
        return found

    return run


def procedures() -> dict[str, dict[str, Procedure]]:
    """{name: {joint: procedure}}; procedures of several joints may share a name."""
    found: dict[str, dict[str, Procedure]] = {}
    for kind in KINDS.values():
        own = part(kind, "fit")
        for procedure in own.FITS if own else ():
            found.setdefault(procedure.name, {})[kind.name] = procedure
    return found


DAMPING_RATIO = Option(
    "damping_ratio",
    "of the structure, beside the joint [1]; to fit it, free damping_ratio",
    default=0.0,
    number=True,
)
"""What procedures with a vibration take beside."""
