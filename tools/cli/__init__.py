"""The command line `jointfmu COMMAND`.

Exit status 0: success; 1: a check failed; 2: bad input, with one line on standard error; 130: interrupted.
"""

import os
import sys
from collections.abc import Sequence
from typing import Any


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status.

    All imports of the package are inside this function. They take a second, and Ctrl-C must work meanwhile.
    """
    name = "jointfmu"
    try:
        from .parser import build_parser

        words = list(sys.argv[1:] if argv is None else argv)
        args = build_parser(words).parse_args(words)
        name = f"jointfmu {args.command}"
        return _run_command(args, name)
    except (KeyboardInterrupt, ImportError) as error:
        if not _is_interrupted(error):
            raise
        hint = f"; {error}" if isinstance(error, KeyboardInterrupt) and error.args else ""
        print(f"{name}: interrupted{hint}", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # Discard buffered output: otherwise the interpreter reports the broken pipe when it exits.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _is_interrupted(error: BaseException | None) -> bool:
    """Return whether Ctrl-C caused an error. Some packages turn KeyboardInterrupt into ImportError."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def _run_command(args: Any, command_name: str) -> int:
    """Run a parsed command; returns the exit status. Errors of the command are printed on one line."""
    from jointfmu.progress import show_status
    from jointfmu.quantity.refusal import InputRefusal

    from . import outputs
    from .command import find_option_of_argument

    try:
        os.getcwd()
    except FileNotFoundError:
        print(f"{command_name}: the current folder was deleted; change to another one", file=sys.stderr)
        return 2
    try:
        with show_status(command_name):
            outputs.check_command_output_paths(args.outputs, args)
            status = int(args.run(args).print_result(args.json))
        print(end="", flush=True)
        return status
    except (ValueError, RuntimeError) as error:
        hint = (
            [f"({find_option_of_argument(args, error.setting)})"] if isinstance(error, InputRefusal) else []
        )
        print(f"{command_name}:", *str(error).splitlines(), *hint, file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except OverflowError:
        print(
            f"{command_name}: a result exceeds 1.8e308; check the units of parameters and loads",
            file=sys.stderr,
        )
        return 2
