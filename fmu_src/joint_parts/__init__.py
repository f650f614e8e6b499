"""What a joint gives the builders: how it becomes C, its flanges, what its page shows.

A joint's folder of `jointfmu_fmu_src.joints` fills in `Parts`; the builders above read them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from . import chart
from .data import DataPart
from .terminals import Terminal

if TYPE_CHECKING:
    from .native import NativePart

Drawing = Callable[..., Sequence[chart.Panel]]
"""(spring, end of the ramp) -> panels side by side."""


class RampPanel(NamedTuple):
    """One chart of the page's ramp: quantities of one unit over an input or output."""

    over: str
    quantities: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Parts:
    """The parts of one joint; {FMU: ...} where its FMUs differ.

    folder    : with its page, icons and C
    native    : gives how it becomes C; called only then, as it needs CasADi. None: the native flavours refuse
    data      : which of its parameters are data
    terminals : flanges; none: signals are connected one by one
    panels    : of the page's charts of the ramp; none: the first output over the ramped input
    drawings  : {name: further charts} of the page
    """

    folder: Path
    native: "Callable[[], NativePart] | None" = None
    data: DataPart = DataPart()
    terminals: Mapping[str, tuple[Terminal, ...]] = field(default_factory=dict)
    panels: Mapping[str, tuple[RampPanel, ...]] = field(default_factory=dict)
    drawings: Mapping[str, Mapping[str, Drawing]] = field(default_factory=dict)


def native_of(package: str) -> "Callable[[], NativePart]":
    """Gives `PART` of the module `native` in a joint's folder."""

    def load() -> "NativePart":
        part: NativePart = import_module(f"{package}.native").PART
        return part

    return load


def equations() -> "NativePart":
    """That of a joint whose outputs are closed functions of inputs and parameters: there is no C to write."""
    from .native import EQUATIONS

    return EQUATIONS
