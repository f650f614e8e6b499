"""Builder data of a joint: functions for its C code, flanges, charts of its documentation page.

Each folder in `jointfmu_fmu_src.joints` defines one object of `FmuBuildData`, which the builders read.
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

ChartDrawingFunction = Callable[..., Sequence[chart.Panel]]
"""Function (tabulated joint, end of the load ramp) -> panels of a chart, side by side."""


class RampPanel(NamedTuple):
    """Chart of the load ramp on the documentation page: variables of one unit against another variable."""

    abscissa_variable: str
    ordinate_variables: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FmuBuildData:
    """What the builder of FMUs needs of one joint: C code, flanges and charts of the documentation page.

    Fields whose values differ between FMUs of the joint are mappings {FMU: value}.

    joint_folder           : folder with page, icons and C sources of the joint
    load_native_definition : function that loads the definition of the C code; it needs CasADi, so it is
        called only for native FMUs. None: native flavours cannot be built
    data_conversion        : conversion of parameters that are no FMU variables into numbers in data.c
    terminals              : flanges of each FMU; none: signals are connected one by one
    load_ramp_panels       : charts of the load ramp on the documentation page; none: the first output against
        the ramped input
    chart_drawings         : {FMU: {name: function that draws further charts of this page}}
    """

    joint_folder: Path
    load_native_definition: "Callable[[], NativeDefinition] | None" = None
    data_conversion: DataConversion = DataConversion()
    terminals: Mapping[str, tuple[Terminal, ...]] = field(default_factory=dict)
    load_ramp_panels: Mapping[str, tuple[RampPanel, ...]] = field(default_factory=dict)
    chart_drawings: Mapping[str, Mapping[str, ChartDrawingFunction]] = field(default_factory=dict)


def make_native_definition_loader(package_name: str) -> "Callable[[], NativeDefinition]":
    """Make a function that imports the module `native` of a joint and returns its `NATIVE_DEFINITION`."""

    def import_native_definition() -> "NativeDefinition":
        """Import the joint's module `native` and return the definition of its C code."""
        definition: NativeDefinition = import_module(f"{package_name}.native").NATIVE_DEFINITION
        return definition

    return import_native_definition


def load_explicit_equations_definition() -> "NativeDefinition":
    """Import the definition of the C code of joints whose outputs are explicit functions.

    The functions depend on parameters, inputs and states. Such a joint has no C sources of its own.
    """
    from .native import EXPLICIT_EQUATIONS_DEFINITION

    return EXPLICIT_EQUATIONS_DEFINITION
