"""`jointfmu modelica`: write the Modelica library from parameters."""

import argparse
from pathlib import Path

from jointfmu.files.outputs import FOLDER
from jointfmu.joints import KINDS
from jointfmu.joints.kind import Kind
from jointfmu.parameters import ParameterFile, load

from ..command_line.common import Answer, Commands, argument, command, flag, needing
from ..command_line.outputs import output
from ..judgement import Judgement
from ..pressure import judge_file, without_members


def add(commands: Commands) -> None:
    """Declare the command `jointfmu modelica` with its options."""
    make = command(commands, "modelica", _modelica, "write the Modelica library JointStiffness")
    argument(make, "--params", Path, "parameter file of one joint, in place of its default (TOML)")
    for name, kinds in _inputs().items():
        first = any(name == kind.working_point[0] for kind in kinds)
        text = "; ".join(f"{kind.title}: {_meaning(kind, name)}" for kind in kinds)
        text += "" if first else " (default: 0)"
        argument(make, flag(name), float, text, nargs="+" if first else None)
    output(make, "--out", FOLDER, "folder to write", default=Path("dist"))


def _modelica(args: argparse.Namespace) -> Answer:
    file = load(args.params) if args.params else None
    points = {kind.name: _points(kind, args) for kind in KINDS.values() if kind.working_point}
    with needing("write the library"):
        from ..modelica import library

        written = library.write(args.out, file, points, force=args.force)
    return Answer(
        document={"written": [str(path) for path in written]},
        lines=[f"wrote {args.out / library.NAME}: {len(written)} files"],
        judgement=_judged(file, points) if file else None,
    )


def _judged(file: ParameterFile, points: dict[str, list[tuple[float, ...]]]) -> Judgement:
    """Judge the stiffness of the user's joint at its working points."""
    judgement = judge_file(file, [point[0] for point in points.get(file.joint, [])] or None)
    return judgement.with_warnings(without_members(file))


def _inputs() -> dict[str, list[Kind]]:
    """Inputs that define working points: {input: joints that have it}."""
    names = dict.fromkeys(name for kind in KINDS.values() for name in kind.working_point)
    return {name: [kind for kind in KINDS.values() if name in kind.working_point] for name in names}


def _meaning(kind: Kind, name: str) -> str:
    variable = kind.variables[name]
    return f"{variable.doc} [{variable.unit}]"


def _points(kind: Kind, args: argparse.Namespace) -> list[tuple[float, ...]]:
    """Read the working points of a joint: one for each value of its first input.

    Each point has the same values of the other inputs; an input that is not set is zero. Raises ValueError
    if another input is set but not the first.
    """
    first, *others = kind.working_point
    stated = {name: getattr(args, name) for name in others if getattr(args, name) is not None}
    values: list[float] = getattr(args, first) or []
    if stated and not values:
        needed = f"{flag(first)}, the {_meaning(kind, first)}"
        raise ValueError(f"{flag(next(iter(stated)))} needs {needed}")
    return [(value, *(stated.get(name, 0.0) for name in others)) for value in values]
