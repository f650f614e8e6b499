"""Shared parts of all commands: argument parser, result of a command, the options `--json` and `--set`."""

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

from jointfmu.files.outputs import FileKind
from jointfmu.quantity.units import conversion_factor, unit_size

from ..common.judgement import Plausibility
from ..common.names import suggest_names
from ..common.options import format_option_flag
from ..inputs.drawing.reading import NUMBER_WITH_UNIT_PATTERN, check_no_comma
from .examples import EXAMPLE_PREREQUISITES, EXAMPLES


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandResult:
    """Result of a command, to be printed.

    json_document       : JSON object for `--json`
    output_lines        : lines of text for standard output
    stderr_lines        : lines of text for standard error: notes and warnings
    stiffness_judgement : whether the stiffness of the joint is plausible; its lines and warnings are printed
                          too, and are added to the JSON object
    written_files       : paths of the files that the command wrote, printed last; None entries are ignored
    exit_status         : exit status of the process
    """

    json_document: Any
    output_lines: Iterable[str] = ()
    stderr_lines: Iterable[str] = ()
    stiffness_judgement: Plausibility | None = None
    written_files: Iterable[object] = ()
    exit_status: int = 0

    def print_result(self, as_json: bool) -> int:
        """Print the result, as one JSON object or as text; returns the exit status."""
        if as_json:
            validity = {} if self.stiffness_judgement is None else self.stiffness_judgement.to_json()
            print(json.dumps({**self.json_document, **validity} if validity else self.json_document))
            return self.exit_status
        judgement = self.stiffness_judgement or Plausibility(None, ())
        for line in (*self.output_lines, *judgement.format_lines()):
            print(line)
        for note in (*self.stderr_lines, *(f"warning: {text}" for text in judgement.warnings)):
            print(note, file=sys.stderr)
        for path in filter(None, self.written_files):
            print(f"wrote {path}")
        return self.exit_status


CommandFunction = Callable[[argparse.Namespace], CommandResult]
"""Function that runs a command with its parsed arguments."""
SubParsers: TypeAlias = "argparse._SubParsersAction[Parser]"
"""Group of sub-parsers to which commands are added."""
DEFAULT_SUBCOMMANDS = {"surface": ("identify", "synthesize")}
"""{command: its sub-commands}. If the user names no sub-command, the first one runs."""


_INVALID_CHOICE_PATTERN = re.compile(r"invalid choice: '?([^' ]*)'? \(choose from (.*)\)")
"""Error message of argparse for an invalid choice."""


class Parser(argparse.ArgumentParser):
    """Argument parser with one-line errors, negative numbers in any notation, and an example in the help.

    example_arguments : words after `jointfmu`; None: the entry of `EXAMPLES`
    output_file_kinds : {argument: kind of file} of the files that the command writes
    """

    example_arguments: str | None = None
    output_file_kinds: dict[str, FileKind]

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.output_file_kinds = {}
        self._negative_number_matcher = re.compile(r"^-(\d|\.\d|inf|nan)", re.IGNORECASE)

    def format_help(self) -> str:
        """Format the help of argparse, followed by a one-line example to copy."""
        name = self.prog.partition(" ")[2]
        example = self.example_arguments or EXAMPLES.get(name)
        if example is None:
            return super().format_help()
        before = f", {EXAMPLE_PREREQUISITES[name]}" if name in EXAMPLE_PREREQUISITES else ""
        return f"{super().format_help()}\nexample{before}:\n  jointfmu {example}\n"

    def _describe_number(self, option_name: str, number_text: str) -> str:
        """Describe what is wrong with the number of an option: comma, or a unit; and what to write."""
        try:
            check_no_comma(option_name.lstrip("-"), number_text)
        except ValueError as error:
            return str(error)
        help_texts = [action.help or "" for action in self._actions if option_name in action.option_strings]
        unit = next((match[1] for match in map(_HELP_UNIT_PATTERN.search, help_texts) if match), None)
        expected = "a number" if unit in (None, "1") else f"a number in {unit}"
        text = f"{option_name} = {number_text!r} is not a number; expected {expected}, without its unit"
        if written := NUMBER_WITH_UNIT_PATTERN.fullmatch(number_text.strip()):
            with suppress(ValueError):
                if written[2] == "%" and expected == "a number":
                    size = 0.01
                else:
                    size = conversion_factor(written[2], unit) if unit else unit_size(written[2])
                return f"{text}: write {float(written[1]) * size:.12g}"
        return text

    def error(self, message: str) -> NoReturn:
        """Print the error on one line, with a suggestion for an invalid choice, and exit with status 2."""
        if match := _INVALID_CHOICE_PATTERN.search(message):
            message += suggest_names(match[1], re.findall(r"[\w.-]+", match[2]))
        elif match := _INVALID_NUMBER_PATTERN.fullmatch(message):
            message = (
                self._describe_number(match[1], match[3])
                if match[2] == "float"
                else f"{match[1]} = {match[3]!r} is not a whole number"
            )
        print(f"{self.prog}: {message}", file=sys.stderr)
        raise SystemExit(2)


_INVALID_NUMBER_PATTERN = re.compile(r"argument (\S+): invalid (float|int) value: '(.*)'")
"""Error message of argparse for text that is not a number."""
_HELP_UNIT_PATTERN = re.compile(r"\[([^\[\]]+)\]")
"""Pattern of the unit in the help text of an option."""


_METAVAR_BY_TYPE: dict[type, str] = {float: "VALUE", int: "N", Path: "FILE", str: "NAME"}
"""{type of a value: placeholder of the value in the help}."""


def declare_argument(
    parser: "argparse._ActionsContainer",
    argument_name: str,
    value_type: type,
    help_text: str,
    metavar: str = "",
    alias: str | None = None,
    **options: Any,
) -> None:
    """Declare an argument of a command that takes values of a type. The help text names its default.

    alias : second name of the option
    """
    help_text += format_default(options.get("default"))
    names = [argument_name, alias] if alias else [argument_name]
    parser.add_argument(
        *names, type=value_type, metavar=metavar or _METAVAR_BY_TYPE[value_type], help=help_text, **options
    )


def format_default(default: object) -> str:
    """Format the end of a help text that names a default value; empty if there is none."""
    if default in (None, []):
        return ""
    values = default if isinstance(default, list) else [default]
    texts = (f"{value:g}" if isinstance(value, float) else str(value) for value in values)
    return f" (default: {' '.join(texts)})"


def declare_command(
    command_parsers: SubParsers, command_name: str, command_function: CommandFunction, help_text: str
) -> Parser:
    """Declare a command that has the option `--json`."""
    sub: Parser = command_parsers.add_parser(
        command_name, help=help_text, description=format_sentence(help_text)
    )
    sub.set_defaults(run=command_function, outputs=sub.output_file_kinds)
    sub.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    return sub


def format_sentence(help_text: str) -> str:
    """Format a help text as a sentence: first letter capital, full stop at the end."""
    return f"{help_text[0].upper()}{help_text[1:]}{'' if help_text.endswith('.') else '.'}"


def find_option_of_argument(args: argparse.Namespace, argument_name: str) -> str:
    """Command-line option that sets a function argument named in an error message.

    `args.options` maps an argument name to its option, if the two names differ.
    """
    return format_option_flag(getattr(args, "options", {}).get(argument_name, argument_name))


def parse_joint_name(joint_name_text: str) -> str:
    """Parse the name of a joint: `bolted-joint` as `jointfmu new` has it, or `bolted_joint`."""
    return joint_name_text.replace("-", "_")


def declare_set_option(parser: argparse.ArgumentParser, help_text: str) -> None:
    """Declare the option `--set NAME=VALUE ...`."""
    parser.add_argument(
        "--set",
        dest="settings",
        nargs="+",
        action="extend",
        type=_parse_setting_argument,
        default=[],
        metavar="NAME=VALUE",
        help=help_text,
    )
    parser.set_defaults(options={"settings": "set"})


def parse_setting(setting_text: str) -> tuple[str, Any]:
    """Parse `NAME=VALUE` of the command line; the value is a number, true, false or a word.

    Raises ValueError if there is no `=` or no name.
    """
    name, equals, value = setting_text.partition("=")
    if not equals or not name.strip():
        raise ValueError(f"{setting_text!r} is not a setting; expected NAME=VALUE")
    value = value.strip()
    if value.lower() in ("true", "false"):
        return name.strip(), value.lower() == "true"
    try:
        return name.strip(), float(value)
    except ValueError:
        return name.strip(), value


def _parse_setting_argument(setting_text: str) -> tuple[str, object]:
    """Parse `NAME=VALUE` for argparse, which needs its own error class."""
    try:
        return parse_setting(setting_text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
