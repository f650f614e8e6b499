"""Fit procedures of the joints: constant FIT_PROCEDURES in the module `fit` of each joint in tools/joints."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from jointfmu.joints import KINDS

from ...common.joint_parts import load_tool_module
from ...common.options import Option

if TYPE_CHECKING:
    from .outcome import FitResult


@dataclass(frozen=True, slots=True, kw_only=True)
class FitProcedure:
    """Procedure that fits parameters of a joint to data.

    procedure_name        : name of the procedure, with hyphens
    procedure_description : which parameters, which joint
    default_start_text    : parameters to start from if the user states no file, as text
    takes_file            : whether the data are a measurement file
    takes_several_files   : whether `run_fit` takes a list of paths instead of one path
    identifying_column    : a column that all files of this procedure have; files of procedures with the same
                            name for other joints do not have it
    procedure_options     : further options of the command
    run_fit               : function ([path or paths,] parameter file with the start values or None, names of
                            the parameters to be fitted or None, **options) -> FitResult; it loads the module
                            of the joint only when called. Raises ValueError for bad input, RuntimeError if
                            the fit does not converge.
    """

    procedure_name: str
    procedure_description: str
    default_start_text: str
    takes_file: bool
    takes_several_files: bool = False
    identifying_column: str = ""
    procedure_options: Sequence[Option] = ()
    run_fit: "Callable[..., FitResult]"


def make_lazy_fit(module_name: str) -> "Callable[..., FitResult]":
    """Make the function that loads a module when called, and calls the function `fit` of this module."""

    def call_fit(*arguments: object, **options: object) -> "FitResult":
        """Import the fit module of the joint, and call its function `fit`."""
        result: FitResult = import_module(module_name).fit(*arguments, **options)
        return result

    return call_fit


def find_fit_procedures() -> dict[str, dict[str, FitProcedure]]:
    """Find the fit procedures of all joints: {procedure name: {joint: procedure}}."""
    result: dict[str, dict[str, FitProcedure]] = {}
    for kind in KINDS.values():
        module = load_tool_module(kind, "fit")
        for procedure in module.FIT_PROCEDURES if module else ():
            result.setdefault(procedure.procedure_name, {})[kind.name] = procedure
    return result


DAMPING_RATIO_OPTION = Option(
    "damping_ratio",
    "damping ratio of the structure without the joint [1]; --free damping_ratio fits it",
    default=0.0,
    is_number=True,
)
"""Option of fit procedures for vibrations: damping ratio of the structure [1]."""
