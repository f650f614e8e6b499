"""Argument parser of the command line: all commands, grouped by task."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from jointfmu.version import __version__

from ..common.names import suggest_names
from .command import DEFAULT_SUBCOMMANDS, Parser

COMMAND_GROUPS = {
    "make a parameter file": ("new", "catalogue", "surface", "fit", "footprint", "parameters"),
    "build": ("build", "system", "robot", "modelica", "export", "report", "cache"),
    "run": ("law", "ramp", "ring", "modes"),
    "check": ("prove", "validate"),
    "study": ("uncertainty", "sweep"),
}
"""{heading: commands}. The function `add_command` of the module `commands.COMMAND` declares each command."""
COMMANDS = tuple(name for names in COMMAND_GROUPS.values() for name in names)
"""Names of all commands."""
COMPLETION_SHELLS = ("bash", "zsh")
"""Shells for which a completion script can be printed."""
COMMAND_MODULES = {
    "cache": "build",
    "catalogue": "new",
    "footprint": "assembly.footprint",
    "modes": "assembly.modes",
    "sweep": "uncertainty",
    "validate": "prove",
}
"""{command: module whose function `add_COMMAND_command` declares it}, if no module has the command's name."""


class CommandLineParser(Parser):
    """Top-level parser. It accepts a command without its sub-command if a default sub-command exists."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse arguments. Insert the default sub-command, suggest an option similar to an unknown one."""
        words = _insert_subcommand(list(sys.argv[1:] if args is None else args))
        parsed, unknown = super().parse_known_args(words, namespace)
        if unknown:
            hint = suggest_names(unknown[0].partition("=")[0], _list_option_names(self, words))
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        return parsed

    def format_help(self) -> str:
        """Format the help with the commands under their headings."""
        formatter = self._get_formatter()
        formatter.add_usage(self.usage, self._actions, self._mutually_exclusive_groups)
        formatter.add_text(self.description)
        actions = {action.dest: action for sub in _subparser_actions(self) for action in sub._choices_actions}
        for title, names in COMMAND_GROUPS.items():
            formatter.start_section(title)
            formatter.add_arguments([actions[name] for name in names if name in actions])
            formatter.end_section()
        formatter.start_section("options")
        formatter.add_arguments([a for a in self._actions if a.option_strings])
        formatter.end_section()
        formatter.add_text("jointfmu COMMAND --help lists the options of a command and shows an example")
        return formatter.format_help()


class PrintCompletionScript(argparse.Action):
    """Print a script for command completion in a shell, and exit."""

    def __call__(self, parser: argparse.ArgumentParser, _: Any, shell: Any, option: Any = None) -> None:
        """Print the script, or an error on one line if the package shtab is missing."""
        try:
            import shtab
        except ImportError:
            parser.error(f"{option}: the package shtab is missing; install it with: pip install shtab")
        for command in _iterate_parsers(parser):
            for action in command._actions:
                if action.type is Path:
                    action.complete = shtab.FILE  # type: ignore[attr-defined]
        print(shtab.complete(parser, shell))
        parser.exit()


def _subparser_actions(parser: argparse.ArgumentParser) -> "list[argparse._SubParsersAction[Any]]":
    """Actions of argparse that hold the sub-commands of a parser."""
    return [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]


def _iterate_parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """Yield a parser and, recursively, the parsers of all its sub-commands."""
    yield parser
    for action in _subparser_actions(parser):
        for sub in action.choices.values():
            yield from _iterate_parsers(sub)


def _list_option_names(parser: argparse.ArgumentParser, command_line_words: Sequence[str]) -> list[str]:
    """Long options of the command (and sub-command) at the start of the words of a command line."""
    for word in command_line_words:
        subs = [sub for sub in _subparser_actions(parser) if word in sub.choices]
        if not subs:
            break
        parser = subs[0].choices[word]
    return [name for action in parser._actions for name in action.option_strings if name.startswith("--")]


def _insert_subcommand(command_line_words: list[str]) -> list[str]:
    """Insert the default sub-command into the words of a command line if they name none."""
    names = DEFAULT_SUBCOMMANDS.get(command_line_words[0]) if command_line_words else None
    if names is None or (command_line_words[1:2] and command_line_words[1] in (*names, "-h", "--help")):
        return command_line_words
    return [command_line_words[0], names[0], *command_line_words[1:]]


def build_parser(command_line_words: Sequence[str] = ()) -> CommandLineParser:
    """Build the parser of the command that the words begin with.

    If the words name no command, the parser has all commands; building it takes longer.
    """
    top = CommandLineParser(
        prog="jointfmu",
        description="Make and run FMUs of the stiffness and friction of joints, from the roughness of their "
        "surfaces.",
    )
    top.add_argument("--version", action="version", version=f"jointfmu {__version__}")
    text = f"print a script that completes commands and options in a shell: {', '.join(COMPLETION_SHELLS)}"
    top.add_argument(
        "--completion", action=PrintCompletionScript, choices=COMPLETION_SHELLS, metavar="SHELL", help=text
    )
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    for name in command_line_words[:1] if {*command_line_words[:1]} & {*COMMANDS} else COMMANDS:
        module = import_module(f"jointfmu_tools.cli.commands.{COMMAND_MODULES.get(name, name)}")
        (getattr(module, f"add_{name}_command") if name in COMMAND_MODULES else module.add_command)(commands)
    return top
