"""Builder data of a joint: functions for its C code, flanges, charts of its documentation page.

Each folder in `jointfmu_fmu_src.joints` defines one object of `FmuParts`, which the builders read.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from . import chart
from .data import DataConversion
from .terminals import Terminal

if TYPE_CHECKING:
    from .native import NativeDefinition

ChartDrawing = Callable[..., Sequence[chart.Panel]]
"""Function (tabulated joint, end of the load ramp) -> panels of a chart, side by side."""


class RampPanel(NamedTuple):
    """Chart of the load ramp on the page: quantities of one unit against an input or output (`abscissa`)."""

    abscissa: str
    quantities: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FmuParts:
    """Builder data of one joint: what its FMUs have beyond the model.

    Fields that differ between FMUs of the joint are {FMU: ...}.

    folder          : folder with page, icons and C sources of the joint
    native          : function that loads the definition of the C code; it needs CasADi, so it is called only
        for native FMUs. None: native flavours cannot be built
    data_conversion : which hidden parameters are stored as data
    terminals       : flanges of each FMU; none: signals are connected one by one
    ramp_panels     : charts of the load ramp on the page; none: the first output against the ramped input
    chart_drawings  : {FMU: {name: function that draws further charts of the page}}
    """

    folder: Path
    native: "Callable[[], NativeDefinition] | None" = None
    data_conversion: DataConversion = DataConversion()
    terminals: Mapping[str, tuple[Terminal, ...]] = field(default_factory=dict)
    ramp_panels: Mapping[str, tuple[RampPanel, ...]] = field(default_factory=dict)
    chart_drawings: Mapping[str, Mapping[str, ChartDrawing]] = field(default_factory=dict)


def make_native_definition_loader(package_name: str) -> "Callable[[], NativeDefinition]":
    """Make a function that imports the module `native` of a joint and returns its `NATIVE_PART`."""

    def load_definition() -> "NativeDefinition":
        """Import the joint's module `native` and return the definition of its C code."""
        part: NativeDefinition = import_module(f"{package_name}.native").NATIVE_PART
        return part

    return load_definition


def load_equations_definition() -> "NativeDefinition":
    """Import and return the C definition of a joint whose outputs are explicit functions.

    The functions depend on parameters, inputs and states. Such a joint has no C sources of its own.
    """
    from .native import EXPLICIT_EQUATIONS_DEFINITION

    return EXPLICIT_EQUATIONS_DEFINITION
