"""What commands share: the parser, `--json`, `--set`, numbers as JSON."""

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

from jointfmu.files.outputs import FileKind

from ..judgement import Judgement
from .examples import BEFORE, EXAMPLES


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a command found.

    document  : for `--json`
    lines     : for people
    notes     : for people, on standard error
    judgement : told after both, and part of the document
    written   : files, told last; None is none
    status    : of the process
    """

    document: Any
    lines: Iterable[str] = ()
    notes: Iterable[str] = ()
    judgement: Judgement | None = None
    written: Iterable[object] = ()
    status: int = 0

    def tell(self, as_json: bool) -> int:
        """Print it, as one JSON object and nothing else or for people; the status."""
        if as_json:
            own = {} if self.judgement is None else self.judgement.document()
            print(json.dumps({**self.document, **own} if own else self.document))
            return self.status
        found = self.judgement or Judgement(None, ())
        for line in (*self.lines, *found.lines()):
            print(line)
        for note in (*self.notes, *(f"warning: {text}" for text in found.warnings)):
            print(note, file=sys.stderr)
        for path in filter(None, self.written):
            print(f"wrote {path}")
        return self.status


Run = Callable[[argparse.Namespace], Answer]
Commands: TypeAlias = "argparse._SubParsersAction[Parser]"
"""Where commands are declared."""
IMPLIED = {"surface": ("identify", "synthesize")}
"""{command: its sub-commands}, of which the first runs where none is named."""


_CHOICE = re.compile(r"invalid choice: '?([^' ]*)'? \(choose from (.*)\)")
"""What argparse says of a wrong choice."""


def nearest(word: str, known: Iterable[str]) -> str:
    """What to add to a refusal: the known word that is most like it, if any is."""
    found = get_close_matches(word, [*known], 1)
    return f"; did you mean {found[0]}?" if found else ""


class Parser(argparse.ArgumentParser):
    """argparse with one line for an error, negative numbers in any notation, and an example in the help.

    example : words after `jointfmu`; None: that of `EXAMPLES`
    outputs : {argument: kind of the file} of what the command writes
    """

    example: str | None = None
    outputs: dict[str, FileKind]

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.outputs = {}
        self._negative_number_matcher = re.compile(r"^-(\d|\.\d|inf|nan)", re.IGNORECASE)

    def format_help(self) -> str:
        """As argparse does, and an example in one line, to be copied."""
        name = self.prog.partition(" ")[2]
        example = self.example or EXAMPLES.get(name)
        if example is None:
            return super().format_help()
        before = f", {BEFORE[name]}" if name in BEFORE else ""
        return f"{super().format_help()}\nexample{before}:\n  jointfmu {example}\n"

    def error(self, message: str) -> NoReturn:
        """Print one line, with the nearest of the choices where one is wrong, and exit with 2."""
        if match := _CHOICE.search(message):
            message += nearest(match[1], re.findall(r"[\w.-]+", match[2]))
        print(f"{self.prog}: {message}", file=sys.stderr)
        raise SystemExit(2)


_METAVARS: dict[type, str] = {float: "VALUE", int: "N", Path: "FILE", str: "NAME"}


def argument(
    sub: "argparse._ActionsContainer",
    name: str,
    kind: type,
    text: str,
    metavar: str = "",
    second: str | None = None,
    **more: Any,
) -> None:
    """Declare what takes values of a type; a default that is stated is told. `second`: another name."""
    if "default" in more:
        default = more["default"]
        text += f" (default: {f'{default:g}' if kind is float else default})"
    names = [name, second] if second else [name]
    sub.add_argument(*names, type=kind, metavar=metavar or _METAVARS[kind], help=text, **more)


def command(commands: Commands, name: str, run: Run, text: str) -> Parser:
    """Declare a command with `--json`."""
    sub: Parser = commands.add_parser(name, help=text, description=text)
    sub.set_defaults(run=run, outputs=sub.outputs)
    sub.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    return sub


def flag(name: str) -> str:
    """The option that sets an argument: `--rated-torque` of `rated_torque`."""
    return "--" + name.replace("_", "-")


def option(args: argparse.Namespace, setting: str) -> str:
    """The option for what a refusal calls `setting`: of that name, or as the command states in `options`."""
    return flag(getattr(args, "options", {}).get(setting, setting))


def joint_name(text: str) -> str:
    """A joint as `new` and as a parameter file name it."""
    return text.replace("-", "_")


@contextmanager
def needing(purpose: str, extra: str = "build") -> Iterator[None]:
    """ValueError, one line, where a package is missing inside, with the extra that brings it."""
    try:
        yield
    except ImportError as error:
        raise ValueError(
            f"the package {error.name or error} is missing, needed to {purpose}; "
            f"install it with: pip install 'jointfmu[{extra}]'"
        ) from None


def settings(sub: argparse.ArgumentParser) -> None:
    """Declare `--set NAME=VALUE ...`."""
    sub.add_argument(
        "--set",
        dest="settings",
        nargs="+",
        action="extend",
        type=_setting,
        default=[],
        metavar="NAME=VALUE",
        help="set parameters (SI units)",
    )
    sub.set_defaults(options={"settings": "set"})


def parse_setting(text: str) -> tuple[str, Any]:
    """`NAME=VALUE` of the command line: a number, true, false or a word.

    Raises ValueError if there is no `=` or no name.
    """
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise ValueError(f"{text!r} is no setting; expected NAME=VALUE")
    value = value.strip()
    if value.lower() in ("true", "false"):
        return name.strip(), value.lower() == "true"
    try:
        return name.strip(), float(value)
    except ValueError:
        return name.strip(), value


def _setting(text: str) -> tuple[str, object]:
    try:
        return parse_setting(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
