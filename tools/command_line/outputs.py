"""Outputs of commands: how an option declares one, and what is refused before the work."""

import argparse
from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

from jointfmu.files.outputs import FOLDER, PICTURE, FileKind, check_output, is_same_file
from jointfmu.files.writing import is_standard_output

from .. import plots
from .common import Parser, argument

FORCE = "replace files that jointfmu did not write, or that were edited"


def output(sub: Parser, name: str, kind: FileKind, text: str, *, forcible: bool = True, **more: Any) -> None:
    """Declare an option that names a file or folder to write, and `--force` beside it.

    forcible : False: what is there and is foreign is never replaced
    more     : as `argument` takes it
    """
    metavar = "DIR" if kind is FOLDER else "FILE"
    argument(sub, name, Path, text, metavar, **more)
    sub.outputs[name.lstrip("-")] = kind
    if forcible and "--force" not in sub._option_string_actions:
        sub.add_argument("--force", action="store_true", help=FORCE)


def check(outputs: Mapping[str, FileKind], args: argparse.Namespace) -> None:
    """Raise ValueError, before the work, if an output of a command may not or cannot be written.

    outputs : {argument: kind of file} as declared
    """
    stated = {name: getattr(args, name) for name in outputs if getattr(args, name) is not None}
    files = {f"--{name}": path for name, path in stated.items() if outputs[name] is not FOLDER}
    check_inputs(files.values(), args, outputs)
    for (one, path), (other, same) in combinations(files.items(), 2):
        if is_same_file(path, same) and not path.is_char_device():
            raise ValueError(f"{one} {path}: is the file of {other} too; expected two files")
    for name, path in stated.items():
        if args.json and is_standard_output(path):
            raise ValueError(f"--{name} {path}: is the place of --json's object; expected another file")
        if outputs[name] is PICTURE:
            plots.check(path)
        check_output(path, outputs[name], getattr(args, "force", False))


def check_inputs(files: Iterable[Path], args: argparse.Namespace, outputs: Iterable[str]) -> None:
    """Raise ValueError if the command reads one of the files to write.

    Every file that the command line names and that is no output counts as an input.
    """
    stated = (value for name, value in vars(args).items() if name not in outputs)
    inputs = [path for value in stated for path in _paths(value)]
    for path in files:
        if not path.is_char_device() and any(is_same_file(path, one) for one in inputs):
            raise ValueError(f"{path}: is an input of this command too; expected another file")


def _paths(value: object) -> Iterator[Path]:
    """Files that a value of the command line names, also as NAME=FILE."""
    if isinstance(value, list | tuple):
        for one in value:
            yield from _paths(one)
    elif isinstance(value, str | Path):
        text = str(value)
        for word in {text, text.partition("=")[2]} - {""}:
            path = Path(word)
            if "\0" not in word and path.exists() and not path.is_dir():
                yield path
