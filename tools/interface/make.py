"""Joints from names, files, drawings and measurements."""

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.kind import Kind
from jointfmu.parameters import ParameterFile, default
from jointfmu.parameters import load as load_file

from .. import plots
from ..drawing.part import Drawing, NewJoint
from ..drawing.reading import number
from ..fitting.outcome import FitResult, draw, percent, size
from ..fitting.procedure import procedures
from ..joint_parts import Option, part
from .frame import Table, Tabled
from .joint import Facts, Joint

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HELP = """Make {}.

    Numbers have the unit of the drawing, stated below; a text may carry one: '0.8 um'. A size is (200, 100),
    what is stated of each side or bolt [0.8, 1.6]; lists, tuples and arrays are the same.

{}

    Raises ValueError, one line, for what is missing or cannot be.

    >>> import jointfmu
    >>> {}
"""
_FLAG = re.compile(r"--([A-Za-z][\w-]*)")


def joint_of(file: ParameterFile, facts: Facts | None = None, notes: Sequence[str] = ()) -> Joint:
    """The object of a parameter file, of the joint's own class if it has one."""
    own = part(KINDS[file.joint], "interface")
    return (own.CLASS if own else Joint)(file, facts or {}, tuple(notes))


def load(source: str | Path) -> Joint:
    """A joint from a parameter file (TOML), or by name.

    source : path of a file; an FMU (`BoltedJoint`), a joint (`bolted_joint`): the shipped default; or a
        name of a catalogue (`CSG-25-100`)

    Raises ValueError, one line, for a file that is wrong or a name that is unknown.

    >>> import jointfmu
    >>> jointfmu.load("BoltedJoint").name
    'box specimen of Zhao 2018'
    """
    name = str(source)
    if name in MODELS or name in KINDS:
        return joint_of(default(MODELS[name].joint if name in MODELS else name))
    if Path(source).suffix == ".toml" or Path(source).is_file():
        return joint_of(load_file(source))
    for kind in KINDS.values():
        own = part(kind, "catalogue")
        if own and any(item.name.lower() == name.lower() for item in own.CATALOGUE.items()):
            with _named_as_in_python():
                return made(part(kind, "new").NEW, {"catalogue": name})  # type: ignore[union-attr]
    raise ValueError(
        f"{name!r} is no parameter file (.toml) and no known name; allowed are "
        f"{', '.join((*MODELS, *KINDS))} and names of the catalogue (jointfmu catalogue)"
    )


def made(drawing: Drawing, stated: Mapping[str, object]) -> Joint:
    """The joint of a drawing. ValueError for an unknown or missing name, or a value that cannot be; it names
    options as on the command line."""
    options = {option.name: option for option in drawing.options}
    if unknown := [name for name in stated if name not in options]:
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {', '.join(options)}")
    if missing := [o.name for o in drawing.options if o.required and stated.get(o.name) is None]:
        raise ValueError(f"{', '.join(missing)} missing: {options[missing[0]].text}")
    new: NewJoint = drawing.run({name: _given(o, stated.get(name)) for name, o in options.items()})
    return joint_of(new.file, new.facts, new.warnings)


@contextmanager
def _named_as_in_python() -> Iterator[None]:
    """Refusals of the command line with the names that arguments have in Python."""
    try:
        yield
    except ValueError as error:
        raise ValueError(_FLAG.sub(lambda m: m[1].replace("-", "_"), str(error))) from None


def _given(option: Option, value: Any) -> object:
    """A value as the command line has it, numbers as text: a size as 200x100, else several as several."""
    if option.flag:
        return bool(value)
    if value is None:
        return None
    each = value.tolist() if isinstance(value, np.ndarray) else value
    texts = [_text(v) for v in (each if isinstance(each, list | tuple) else [each])]
    if option.by and not (option.many and any(sign in text for text in texts for sign in (",", option.by))):
        texts = [option.by.join(texts)]
    if not texts or (len(texts) > 1 and not option.many):
        raise ValueError(f"{option.name} = {value!r} are {len(texts)} values, expected one")
    if option.many:
        return texts
    if option.choices and texts[0] not in option.choices:
        raise ValueError(f"{option.name} = {texts[0]!r}, allowed are {', '.join(option.choices)}")
    return texts[0]


def _text(value: Any) -> str:
    """A number, a text, or the place X,Y of two numbers."""
    if isinstance(value, list | tuple | np.ndarray):
        return ",".join(map(_text, value))
    return repr(float(value)) if isinstance(value, float) else str(value)


def maker(name: str, kind: Kind, example: str, first: str | None = None) -> Callable[..., Joint]:
    """The function that makes a joint of its drawing; its signature and help are the drawing's options.

    name    : of the function
    example : a call of it, and what it gives, as in a doctest
    first   : option that may be given without its name
    """
    drawing: Drawing = part(kind, "new").NEW  # type: ignore[union-attr]
    positional, keyword = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY

    def make(*args: object, **stated: object) -> Joint:
        bound = signature.bind(*args, **stated).arguments
        with _named_as_in_python():
            return made(drawing, bound)

    ordered = sorted(drawing.options, key=lambda option: option.name != first)
    parameters = [
        inspect.Parameter(
            option.name,
            positional if option.name == first else keyword,
            default=inspect.Parameter.empty if option.required else False if option.flag else None,
        )
        for option in ordered
    ]
    signature = inspect.Signature(parameters, return_annotation=Joint)
    make.__name__ = make.__qualname__ = name
    make.__module__ = "jointfmu"
    make.__signature__ = signature  # type: ignore[attr-defined]
    options = "\n".join(f"    {option.name} : {_meaning(option)}" for option in ordered)
    make.__doc__ = _HELP.format(drawing.text, options, example.replace("\n", "\n    "))
    return make


def _meaning(option: Option) -> str:
    return f"{option.text}{': ' + ', '.join(option.choices) if option.choices else ''}"


@dataclass(frozen=True, repr=False)
class Fit(Tabled):
    """A fit: `joint` has the fitted parameters; prints each of them with its spread.

    >>> import jointfmu
    >>> fit = jointfmu.fit("catalogue", K1=4700.0, K2=6100.0, K3=7100.0, T1=2.0, T2=6.9)
    >>> fit.joint.build("dist", "python", fmu="HarmonicDriveCompliance")[0].name
    'HarmonicDriveCompliance.fmu'
    """

    outcome: FitResult

    @property
    def joint(self) -> Joint:
        """The joint with the fitted parameters."""
        return joint_of(self.outcome.parameters, self.outcome.facts, self.outcome.warnings())

    def _table(self) -> Table:
        rows = [
            (
                row["name"],
                f"{row['value']:.6g}",
                row["unit"],
                "unknown" if row["relative_deviation"] is None else percent(row["relative_deviation"]),
                "yes" if row["determined"] else "no",
            )
            for row in self.outcome.rows()
        ]
        doubt = self.outcome.doubt()
        lines = [f"warning: the fit says nothing of the joint: {doubt}"] if doubt else []
        lines += [f"note: {line}" for line in self.outcome.warnings()]
        return Table("fit", ("name", "value", "unit", "spread", "determined"), rows, lines)

    @plots.style()
    def plot(self) -> "Figure":
        """Draw data, fitted law and residuals: a matplotlib figure."""
        figure = plots.figure(size(self.outcome))
        draw(figure, self.outcome)
        return figure


def _paths(procedure: str, many: bool, file: str | Path | Sequence[str | Path]) -> Path | list[Path]:
    """What a procedure takes: one path, or a list of them."""
    if isinstance(file, str | Path):
        return [Path(file)] if many else Path(file)
    if not many:
        raise ValueError(f"procedure {procedure!r} takes one file")
    return [Path(each) for each in file]


def _taken(option: Option, value: Any) -> object:
    """An option of a procedure as its function takes it."""
    if value is None or not (option.number or option.unit):
        return _given(option, value)
    if option.unit and isinstance(value, str):
        return number(option.name, value, option.unit, option.unit, None)
    if not isinstance(value, int | float | np.number):
        raise ValueError(f"{option.name} = {value!r} is no number: {option.text}")
    return float(value)


def fit(
    procedure: str,
    file: str | Path | Sequence[str | Path] | None = None,
    *,
    joint: str | None = None,
    start: Joint | None = None,
    free: str | Sequence[str] | None = None,
    **options: object,
) -> Fit:
    """Fit a joint's parameters to a measurement or a catalogue row, as `jointfmu fit PROCEDURE` does.

    procedure : catalogue, torque-angle, log, loop or preload
    file      : measured data (CSV; the heading names columns and units), where the procedure has some;
                several files where it takes them
    joint     : `bolted_joint`, ... where procedures of several joints have the name
    start     : joint to start from
    free      : names of the parameters to fit, or one name
    options   : of the procedure, numbers in SI units

    Raises ValueError for bad input, RuntimeError if the fit finds no end.

    >>> import jointfmu
    >>> drive = jointfmu.fit("catalogue", K1=4700.0, K2=6100.0, K3=7100.0, T1=2.0, T2=6.9).joint
    >>> drive.values["K1"]
    4700.0
    """
    wanted, every = joint or (start.file.joint if start else None), procedures()
    known = {
        name: [of for of in choices if wanted in (None, of)]
        for name, choices in every.items()
        if wanted is None or wanted in choices
    }
    if procedure not in known:
        raise ValueError(f"procedure = {procedure!r}, allowed are {', '.join(known)}")
    if len(joints := known[procedure]) > 1:
        raise ValueError(f"procedure {procedure!r} is of several joints; expected joint = one of {joints}")
    chosen = every[procedure][joints[0]]
    if chosen.file == (file is None):
        raise ValueError(f"procedure {procedure!r} takes {'a' if chosen.file else 'no'} file")
    by = {option.unit_by for option in chosen.options}  # units of texts; numbers here are SI
    own = {option.name: option for option in chosen.options if option.name not in by}
    if unknown := [name for name in options if name not in own]:
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {', '.join(own)}")
    if missing := [name for name, option in own.items() if option.required and name not in options]:
        raise ValueError(f"{', '.join(missing)} missing: {own[missing[0]].text}")
    data = () if file is None else (_paths(procedure, chosen.many, file),)
    names = [free] if isinstance(free, str) else free
    with _named_as_in_python():
        taken = {name: _taken(option, options.get(name, option.default)) for name, option in own.items()}
        return Fit(chosen.run(*data, start and start.file, names, **taken))
