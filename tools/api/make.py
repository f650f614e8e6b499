"""Functions that make joints: from names, parameter files, drawings and measurements."""

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.parameters import load_parameter_file as load_file

from ..common import plots
from ..common.names import find_similar_names
from ..common.options import Option
from ..inputs.drawing.faces import warn_unknown_height_distribution, warn_unusual_friction
from ..inputs.drawing.part import NewJoint, NewJointCommand
from ..inputs.drawing.reading import parse_number
from ..inputs.fitting.outcome import FitResult, draw_fit_plots, fit_figure_size, format_relative_deviation
from ..inputs.fitting.procedure import find_fit_procedures
from ..joints.harmonic_drive.catalogue import find_drive, list_drives
from ..joints.harmonic_drive.new import NEW_JOINT_COMMAND as NEW_DRIVE
from .drive_joint import DriveJoint
from .frame import Table, TableDisplay
from .joint import DerivedResults, Joint

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_JOINT_FUNCTION_DOCSTRING = """Make {}.

    Numbers have the unit stated below; a text may have its own unit: '0.8 um'. Write a size as (200, 100),
    and different values for each side or bolt as [0.8, 1.6]. Lists, tuples and arrays are equivalent.

{}

    Raises ValueError, one line, for a missing or impossible value.

    >>> import jointfmu
    >>> {}
"""
"""Docstring of a function that makes a joint from its drawing, with gaps for its options."""
_COMMAND_LINE_OPTION_PATTERN = re.compile(r"--([A-Za-z][\w-]*)")
"""Pattern of an option of the command line in an error message."""


def create_joint(
    parameter_file: ParameterFile, derived_results: DerivedResults | None = None, notes: Sequence[str] = ()
) -> Joint:
    """Make the public object of a joint from its parameter file.

    derived_results : {name: (value [SI], unit, meaning)} of additional results
    notes           : warnings from making the joint, one line each
    """
    joint_class = DriveJoint if parameter_file.joint == "harmonic_drive" else Joint
    return joint_class(parameter_file, derived_results or {}, tuple(notes))


def load(source: str | Path) -> Joint:
    """Load a joint from a parameter file (TOML), or by name.

    source : path of a file; name of an FMU (`BoltedJoint`) or of a joint (`bolted_joint`), for its shipped
        default; or name of a catalogue entry (`CSG-25-100`)

    Raises ValueError, one line, for a wrong file or an unknown name.

    >>> import jointfmu
    >>> jointfmu.load("BoltedJoint").name
    'box specimen of Zhao 2018'
    """
    name = str(source)
    if name in MODELS or name in KINDS:
        return create_joint(load_default(MODELS[name].joint if name in MODELS else name))
    if Path(source).suffix == ".fmu":
        raise ValueError(
            f"{name}: is a built FMU; expected the parameter file (.toml) that it was built from, or a name "
            f"without folder and suffix: {', '.join(MODELS)}"
        )
    if Path(source).suffix == ".toml" or Path(source).is_file():
        return create_joint(load_file(source))
    try:
        drive_name = find_drive(name).joint_name
    except ValueError:
        similar = find_similar_names(name, (*MODELS, *KINDS, *(item.joint_name for item in list_drives())))
        known = f"allowed are {', '.join((*MODELS, *KINDS))} and names of the catalogue (jointfmu catalogue)"
        if similar:
            known = f"nearest are {', '.join(similar)} (jointfmu catalogue lists all drives)"
        raise ValueError(f"{name!r} is not a parameter file (.toml) or a known name; {known}") from None
    with _rename_options_in_errors():
        return make_joint_from_drawing(NEW_DRIVE, {"catalogue": drive_name})


def make_joint_from_drawing(joint_command: NewJointCommand, option_values: Mapping[str, object]) -> Joint:
    """Make a joint from the values on its drawing, as the command `jointfmu new` does.

    joint_command : the command for this kind of joint: its options, and how they make the joint
    option_values : {option: value}; numbers, texts with a unit, or sequences

    Raises ValueError for an unknown or missing option, or an impossible value. The message names options as
    on the command line.
    """
    options = {option.name: option for option in joint_command.command_options}
    if unknown := [name for name in option_values if name not in options]:
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {', '.join(options)}")
    if missing := [
        o.name for o in joint_command.command_options if o.is_required and option_values.get(o.name) is None
    ]:
        raise ValueError(f"{', '.join(missing)} missing: {options[missing[0]].help_text}")
    texts = {name: _to_command_line_value(o, option_values.get(name)) for name, o in options.items()}
    new: NewJoint = joint_command.make_joint(texts)
    warnings = [*new.warnings, *warn_unknown_height_distribution(texts), *warn_unusual_friction(texts)]
    return create_joint(new.parameter_file, new.facts, warnings)


@contextmanager
def _rename_options_in_errors() -> Iterator[None]:
    """Context that replaces option names of the command line in errors by argument names of Python."""
    try:
        yield
    except ValueError as error:
        raise ValueError(
            _COMMAND_LINE_OPTION_PATTERN.sub(lambda m: m[1].replace("-", "_"), str(error))
        ) from None


def _to_command_line_value(option: Option, option_value: Any) -> object:
    """Convert the value of an option to its form on the command line: text, list of texts, bool for a flag.

    A size becomes one text such as 200x100. Raises ValueError for too many values, or an unknown choice.
    """
    if option.is_flag:
        return bool(option_value)
    if option_value is None or (option.lone_value and option_value is False):
        return None
    if option.lone_value and option_value is True:
        return option.lone_value
    values = option_value.tolist() if isinstance(option_value, np.ndarray) else option_value
    texts = [_format_option_value(v) for v in (values if isinstance(values, list | tuple) else [values])]
    if option.separator and not (
        option.is_list and any(sign in text for text in texts for sign in (",", option.separator))
    ):
        texts = [option.separator.join(texts)]
    if not texts or (len(texts) > 1 and not option.is_list):
        raise ValueError(f"{option.name} = {option_value!r} are {len(texts)} values, expected one")
    if option.is_list:
        return texts
    if option.choices and texts[0] not in option.choices:
        raise ValueError(f"{option.name} = {texts[0]!r}, allowed are {', '.join(option.choices)}")
    return texts[0]


def _format_option_value(option_value: Any) -> str:
    """Format a number or a text as on the command line; two numbers become a position X,Y."""
    if isinstance(option_value, list | tuple | np.ndarray):
        return ",".join(map(_format_option_value, option_value))
    return repr(float(option_value)) if isinstance(option_value, float) else str(option_value)


def create_drawing_function(
    function_name: str,
    joint_command: NewJointCommand,
    doctest_example: str,
    positional_option: str | None = None,
) -> Callable[..., Joint]:
    """Create a public function such as `jointfmu.bolted_joint`, which makes a joint from its drawing.

    The function has the options of the command `jointfmu new` as arguments, listed in its docstring.

    function_name     : name of the function
    joint_command     : the command for this kind of joint: its options, and how they make the joint
    doctest_example   : call of the function and its result, as in a doctest
    positional_option : option that may be passed as the first positional argument
    """
    positional, keyword = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY

    def make_joint(*args: object, **options: object) -> Joint:
        """Make the joint of the drawing from keyword arguments."""
        arguments = signature.bind(*args, **options).arguments
        with _rename_options_in_errors():
            return make_joint_from_drawing(joint_command, arguments)

    ordered = sorted(joint_command.command_options, key=lambda option: option.name != positional_option)
    parameters = [
        inspect.Parameter(
            option.name,
            positional if option.name == positional_option else keyword,
            default=inspect.Parameter.empty if option.is_required else False if option.is_flag else None,
        )
        for option in ordered
    ]
    signature = inspect.Signature(parameters, return_annotation=Joint)
    make_joint.__name__ = make_joint.__qualname__ = function_name
    make_joint.__module__ = "jointfmu"
    make_joint.__signature__ = signature  # type: ignore[attr-defined]
    meanings = "\n".join(f"    {option.name} : {_format_option_help(option)}" for option in ordered)
    make_joint.__doc__ = _JOINT_FUNCTION_DOCSTRING.format(
        joint_command.joint_description, meanings, doctest_example.replace("\n", "\n    ")
    )
    return make_joint


def _format_option_help(option: Option) -> str:
    """Meaning and choices of an option of `jointfmu new`, for the docstring of the function."""
    return f"{option.help_text}{': ' + ', '.join(option.choices) if option.choices else ''}"


def make_fit_table(fit_result: FitResult) -> Table:
    """Make a table of the result of a fit: each parameter with its uncertainty; warnings and notes."""
    rows = [
        (
            row["name"],
            f"{row['value']:.6g}",
            row["unit"],
            "unknown"
            if row["relative_deviation"] is None
            else format_relative_deviation(row["relative_deviation"]),
            "yes" if row["determined"] else "no",
        )
        for row in fit_result.list_fitted_parameters()
    ]
    doubt = fit_result.rejection_reason()
    subject = "joint" if fit_result.parameters.joint in KINDS else "system"
    lines = [f"warning: the fit does not determine the {subject}: {doubt}"] if doubt else []
    lines += [f"note: {line}" for line in fit_result.warnings()]
    return Table("fit", ("name", "value", "unit", "spread", "determined"), rows, lines)


@plots.apply_plot_style()
def plot_fit(fit_result: FitResult) -> "Figure":
    """Draw measured data, fitted curve and residuals of a fit; returns a matplotlib figure."""
    figure = plots.create_figure(fit_figure_size(fit_result))
    draw_fit_plots(figure, fit_result)
    return figure


@dataclass(frozen=True, repr=False)
class Fit(TableDisplay):
    """Result of a fit. `joint` has the fitted parameters; the printed table has each with its uncertainty.

    outcome : fitted parameters, their uncertainty, and facts about the fit

    >>> import jointfmu
    >>> fit = jointfmu.fit("catalogue", K1=4700.0, K2=6100.0, K3=7100.0, T1=2.0, T2=6.9)
    >>> fit.joint.build("dist", "python", fmu="HarmonicDriveCompliance")[0].name
    'HarmonicDriveCompliance.fmu'
    """

    outcome: FitResult

    @property
    def joint(self) -> Joint:
        """The joint with the fitted parameters."""
        return create_joint(self.outcome.parameters, self.outcome.facts, self.outcome.warnings())

    def _build_table(self) -> Table:
        """Build the table that is printed for the fit: each parameter with its uncertainty."""
        return make_fit_table(self.outcome)

    def plot(self) -> "Figure":
        """Draw data, fitted law and residuals; returns a matplotlib figure."""
        return plot_fit(self.outcome)


def _to_file_argument(
    procedure_name: str, takes_several_files: bool, stated_files: str | Path | Sequence[str | Path]
) -> Path | list[Path]:
    """Convert the argument `file` of `fit` to what the fit function takes: one path, or a list of paths."""
    if isinstance(stated_files, str | Path):
        return [Path(stated_files)] if takes_several_files else Path(stated_files)
    if not takes_several_files:
        raise ValueError(f"procedure {procedure_name!r} takes one file, not several")
    return [Path(path) for path in stated_files]


def _to_fit_option_value(option: Option, option_value: Any) -> object:
    """Convert an option of a fit to the form that its fit function takes; numbers are in SI units."""
    if option_value is None or not (option.is_number or option.default_unit):
        return _to_command_line_value(option, option_value)
    if option.default_unit and isinstance(option_value, str):
        return parse_number(option.name, option_value, option.default_unit, option.default_unit, None)
    if not isinstance(option_value, int | float | np.number):
        raise ValueError(f"{option.name} = {option_value!r} is not a number: {option.help_text}")
    return float(option_value)


def fit(
    procedure: str,
    file: str | Path | Sequence[str | Path] | None = None,
    *,
    joint: str | None = None,
    start: Joint | None = None,
    free: str | Sequence[str] | None = None,
    **options: object,
) -> Fit:
    """Fit a joint's parameters to a measurement or to catalogue values, as `jointfmu fit PROCEDURE` does.

    procedure : catalogue, torque-angle, log, loop or preload
    file      : measured data (CSV; the heading names columns and units), if the procedure needs data; a list
                if it takes several files
    joint     : name of the joint, as `bolted_joint`, if several joints have the procedure
    start     : joint whose parameters are the start of the fit
    free      : names of the parameters to fit, or one name
    options   : options of the procedure, numbers in SI units

    Raises ValueError for bad input, RuntimeError if the fit does not converge.

    >>> import jointfmu
    >>> drive = jointfmu.fit("catalogue", K1=4700.0, K2=6100.0, K3=7100.0, T1=2.0, T2=6.9).joint
    >>> drive.values["K1"]
    4700.0
    """
    requested, available = joint or (start.file.joint if start else None), find_fit_procedures()
    allowed = {
        name: [other for other in choices if requested in (None, other)]
        for name, choices in available.items()
        if requested is None or requested in choices
    }
    if procedure not in allowed:
        raise ValueError(f"procedure = {procedure!r}, allowed are {', '.join(allowed)}")
    if len(joints := allowed[procedure]) > 1:
        raise ValueError(f"procedure {procedure!r} exists for several joints; state joint = one of {joints}")
    chosen = available[procedure][joints[0]]
    if chosen.takes_file == (file is None):
        raise ValueError(f"procedure {procedure!r} {'needs a' if chosen.takes_file else 'takes no'} file")
    units = {
        option.unit_option for option in chosen.procedure_options
    }  # for text without a unit; numbers here are SI
    declared = {option.name: option for option in chosen.procedure_options if option.name not in units}
    if unknown := [name for name in options if name not in declared]:
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {', '.join(declared)}")
    if missing := [name for name, option in declared.items() if option.is_required and name not in options]:
        raise ValueError(f"{', '.join(missing)} missing: {declared[missing[0]].help_text}")
    data = () if file is None else (_to_file_argument(procedure, chosen.takes_several_files, file),)
    names = [free] if isinstance(free, str) else free
    with _rename_options_in_errors():
        values = {
            n: _to_fit_option_value(option, options.get(n, option.default)) for n, option in declared.items()
        }
        return Fit(chosen.run_fit(*data, start and start.file, names, **values))
