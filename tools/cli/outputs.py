"""Output files of commands: declaration of their options, and checks before the work starts."""

import argparse
from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

from jointfmu.files.outputs import OUTPUT_FOLDER, PICTURE_FILE, FileKind, check_output, is_same_file
from jointfmu.files.writing import is_standard_output

from ..common import plots
from .command import Parser, declare_argument

FORCE_OPTION_HELP = "also replace existing files that jointfmu did not write, or that were edited"
"""Help text of the option `--force`."""


def declare_output(
    parser: Parser,
    argument_name: str,
    file_kind: FileKind,
    help_text: str,
    *,
    allow_overwrite: bool = True,
    **options: Any,
) -> None:
    """Declare an option that names a file or folder to write, and the option `--force`.

    allow_overwrite : whether to declare `--force`; False: a foreign file is never replaced
    options         : keyword arguments of `declare_argument`
    """
    metavar = "DIR" if file_kind is OUTPUT_FOLDER else "FILE"
    declare_argument(parser, argument_name, Path, help_text, metavar, **options)
    parser.output_file_kinds[argument_name.lstrip("-")] = file_kind
    if allow_overwrite and "--force" not in parser._option_string_actions:
        parser.add_argument("--force", action="store_true", help=FORCE_OPTION_HELP)


def check_command_output_paths(output_file_kinds: Mapping[str, FileKind], args: argparse.Namespace) -> None:
    """Raise ValueError before the work starts if a command may not or cannot write one of its outputs.

    output_file_kinds : {argument: kind of file} as declared
    """
    stated = {name: getattr(args, name) for name in output_file_kinds if getattr(args, name) is not None}
    files = {
        f"--{name}": path for name, path in stated.items() if output_file_kinds[name] is not OUTPUT_FOLDER
    }
    check_input_overwrite(files.values(), args, output_file_kinds)
    for (option, path), (other_option, other_path) in combinations(files.items(), 2):
        if is_same_file(path, other_path) and not path.is_char_device():
            raise ValueError(f"{option} {path}: {other_option} writes the same file; state two files")
    for name, path in stated.items():
        if args.json and is_standard_output(path):
            raise ValueError(f"--{name} {path}: --json writes to the same place; state another file")
        if output_file_kinds[name] is PICTURE_FILE:
            plots.check_picture_path(path)
        check_output(path, output_file_kinds[name], getattr(args, "force", False))


def check_input_overwrite(
    output_paths: Iterable[Path], args: argparse.Namespace, output_arguments: Iterable[str]
) -> None:
    """Raise ValueError if a file to be written is also an input of the command.

    Every existing file that the command line names counts as an input, except the outputs.
    """
    stated = (value for name, value in vars(args).items() if name not in output_arguments)
    inputs = [path for value in stated for path in _iterate_named_files(value)]
    for path in output_paths:
        if not path.is_char_device() and any(is_same_file(path, source) for source in inputs):
            raise ValueError(f"{path}: is also an input of this command; state another file")


def _iterate_named_files(argument_value: object) -> Iterator[Path]:
    """Yield the existing files that an argument of the command line names, as FILE or NAME=FILE."""
    if isinstance(argument_value, list | tuple):
        for item in argument_value:
            yield from _iterate_named_files(item)
    elif isinstance(argument_value, str | Path):
        text = str(argument_value)
        for word in {text, text.partition("=")[2]} - {""}:
            path = Path(word)
            if "\0" not in word and path.exists() and not path.is_dir():
                yield path
