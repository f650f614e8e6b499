"""`jointfmu export`: the joint for finite elements, Modelica tables and CSV."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import TEXT
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, default, load

from ..command_line.common import Answer, Commands, argument, command, flag, joint_name, needing
from ..command_line.outputs import output
from ..export import exports
from ..export.exports import ERROR, FORMS, ROBOTS, WHAT
from ..export.placing import AXES, SI, UNITS, Placing
from ..judgement import Judgement, judge, known_height
from ..pressure import judge_file, nominal_pressure, without_members

if TYPE_CHECKING:
    from ..export.writing import Written

_NUMBERED = {"first": ("ansys", "calculix", "abaqus"), "first_set": ("ansys",)}
_ABOVE = {
    "first": "a number above all elements of your model",
    "first_set": "a number above all element types and sets of real constants of your model",
}
_SI = {"K_": "N/m", "C_": "N.s/m"}


def add(commands: Commands) -> None:
    """Declare the command."""
    export = command(commands, "export", _export, "write the joint for another solver")
    with_springs = exports.able("springs")
    forms = [*FORMS, *ROBOTS]
    export.add_argument("form", choices=forms, metavar="FORMAT", help=f"one of {', '.join(forms)}")
    export.add_argument(
        "what",
        metavar="WHAT",
        help="springs: springs and dashpots between node pairs "
        f"({', '.join(KINDS[joint].title for joint in with_springs)}); contact: pressure over overclosure; "
        "curve: load over displacement of the whole joint; "
        f"{', '.join(ROBOTS)}: a drive's parameter file or its name in the catalogue",
    )
    joint = export.add_mutually_exclusive_group()
    argument(joint, "--params", Path, "parameter file of the joint (TOML)")
    joint.add_argument(
        "--joint",
        type=joint_name,
        choices=list(KINDS),
        default=with_springs[0],
        help=f"a default joint ({with_springs[0]})",
    )
    for name, texts in _working_points().items():
        argument(export, flag(name), float, "; ".join(texts))
    text = "springs: your node pairs: node_1 [1], node_2 [1], x [mm], y [mm], area [mm2], and with "
    argument(export, "--nodes", Path, text + "pressure [MPa] instead of a working point", "CSV")
    argument(export, "--first", int, "springs: first number free for elements and nodes (1)")
    text = "ansys: first number free for element types and sets of real constants (1)"
    argument(export, "--first-set", int, text)
    export.add_argument("--normal", choices=list(AXES), help="springs: axis along the joint's normal (z)")
    export.add_argument(
        "--units", choices=list(UNITS), default=SI.name, help=f"units of the file ({SI.name})"
    )
    argument(export, "--error", float, f"tables: largest error by straight lines ({ERROR:g})", "E")
    text = f"{', '.join(ROBOTS)}: largest torque of the fit [N.m] (rated torque)"
    argument(export, "--torque", float, text, "T")
    output(export, "--out", TEXT, "file to write", required=True)


def _working_points() -> dict[str, list[str]]:
    """{name: what it is for each joint} of all that working points are made of."""
    texts: dict[str, list[str]] = {}
    for joint, kind in KINDS.items():
        for i, (name, text) in enumerate(exports.of(joint).working_point.items()):
            texts.setdefault(name, []).append(f"{kind.title}: {text}{' (0)' if i else ''}")
    return texts


def _export(args: argparse.Namespace) -> Answer:
    if args.form in ROBOTS:
        return _robots(args)
    if args.what not in WHAT:
        choices = ", ".join(map(repr, WHAT))
        raise ValueError(f"argument WHAT: invalid choice: {args.what!r} (choose from {choices})")
    _refuse(args, {"torque": f"{args.form}; it is for {', '.join(ROBOTS)}"})
    if args.what not in FORMS[args.form]:
        raise ValueError(
            f"{args.form} {args.what} cannot be written; {args.form} has {', '.join(FORMS[args.form])}"
        )
    file = load(args.params) if args.params else default(args.joint)
    _refuse_idle(args, file)
    written = _written(args, file)
    write_text(args.out, written.text)
    facts = {"written": str(args.out), "format": args.form, "what": args.what, "units": args.units}
    lines = [f"wrote {args.out}: {args.what} for {args.form}, {args.units}"]
    for name, value in written.facts.items():
        number = f"{value:.6g}" if isinstance(value, float) else value
        lines.append(f"  {name:<24}  {number} {_SI.get(name[:2], '')}".rstrip())
    found = _judged(args, file).with_warnings([*written.warnings, *without_members(file)])
    return Answer(document={**facts, **written.facts}, lines=lines, judgement=found)


def _robots(args: argparse.Namespace) -> Answer:
    """Write a drive for a robot's simulator, and say what it misses."""
    idle = ("params", "nodes", "first", "first_set", "normal", "error", *_working_points())
    _refuse(args, dict.fromkeys(idle, args.form))
    if args.units != SI.name:
        raise ValueError(f"--units = {args.units}: {args.form} is in {SI.name}")
    from ..robots.writing import written

    with needing("measure the file", "mujoco"):
        text, lines, facts = written(args.form, args.what, args.torque)
    write_text(args.out, text)
    return Answer(
        document={"written": str(args.out), "format": args.form, **facts},
        lines=[f"wrote {args.out}: {facts['drive']} for {args.form}", *(f"  {line}" for line in lines)],
    )


def _judged(args: argparse.Namespace, file: ParameterFile) -> Judgement:
    """The judgement at the working point, at the pressures of the user's nodes, or at the usual load."""
    how = nominal_pressure(KINDS[file.joint])
    load = getattr(args, how.load, None) if how else None
    if load is None and args.nodes:
        from ..export.mesh import read_pairs

        mesh = read_pairs(args.nodes)
        if mesh.pressure is not None:
            mean = float(mesh.pressure @ mesh.area / mesh.area.sum())
            return judge(
                KINDS[file.joint].law_of(file.values), [mean], known_height(file), float(mesh.pressure.max())
            )
    return judge_file(file, None if load is None else [load])


def _written(args: argparse.Namespace, file: ParameterFile) -> "Written":
    from ..export import writing
    from ..export.mesh import read_pairs

    units = UNITS[args.units]
    error = ERROR if args.error is None else args.error
    if args.what == "contact":
        return writing.contact(args.form, file, units, error)
    state = _state(args, file.joint)
    if args.what == "curve":
        return writing.curve(args.form, file, state, units, error)
    mesh = read_pairs(args.nodes) if args.nodes else None
    first, text = next(iter(exports.of(file.joint).working_point.items()), ("", ""))
    if mesh is not None and mesh.pressure is not None and state is not None:
        raise ValueError(
            f"{mesh.path} states the pressures; leave out {flag(first)}, or its column 'pressure'"
        )
    if (mesh is None or mesh.pressure is None) and state is None and first:
        raise ValueError(f"springs need {flag(first)}, {text}, or --nodes with a pressure")
    placing = Placing(units, args.normal or "z", args.first or 1, args.first_set or 1, own=mesh is None)
    return writing.springs(args.form, file, state, mesh, placing)


def _state(args: argparse.Namespace, joint: str) -> Any:
    """The joint's working point, None where none is stated."""
    offered = exports.of(joint)
    values = {name: getattr(args, name) for name in offered.working_point}
    if offered.state is None or all(value is None for value in values.values()):
        return None
    return offered.state(**{name: value or 0.0 for name, value in values.items()})


def _refuse(args: argparse.Namespace, idle: Mapping[str, str]) -> None:
    """Refuse what is stated of these: {name: for what it has no meaning}."""
    for name, what in idle.items():
        if getattr(args, name) is not None:
            raise ValueError(f"{flag(name)} has no meaning for {what}")


def _refuse_working_point(args: argparse.Namespace, joint: str) -> None:
    """Refuse a working point that would do nothing, or is missing."""
    wanted = {} if args.what == "contact" else exports.of(joint).working_point
    _refuse(args, {name: f"the {args.what} of a {joint}" for name in _working_points() if name not in wanted})
    stated = [name for name in wanted if getattr(args, name) is not None]
    first, text = next(iter(wanted.items()), ("", ""))
    if stated and first not in stated:
        raise ValueError(f"{flag(stated[0])} needs {flag(first)}, {text}")
    if args.what == "curve" and first and not stated:
        raise ValueError(f"the curve of a {joint} needs {flag(first)}, {text}")


def _refuse_idle(args: argparse.Namespace, file: ParameterFile) -> None:
    """Refuse options that would do nothing, or are missing."""
    exports.required(file.joint, args.what)
    _refuse_working_point(args, file.joint)
    if args.what == "springs":
        idle = {"error": "springs; it is for tables"}
    else:
        idle = dict.fromkeys(("nodes", "first", "normal"), f"a {args.what}; it is for springs")
    if args.form != "ansys":
        idle["first_set"] = f"{args.form}; it is for ansys"
    _refuse(args, idle)
    for name, highest in (("first", 10_000_000), ("first_set", 100_000)):
        value, option = getattr(args, name), flag(name)
        if value is not None and not 1 <= value <= highest:
            raise ValueError(f"{option} = {value} is outside [1, {highest}]")
        if value is None and args.nodes is not None and args.form in _NUMBERED[name]:
            raise ValueError(f"--nodes needs {option}, {_ABOVE[name]}")
    if args.form == "modelica" and args.units != SI.name:
        raise ValueError(f"--units = {args.units}: a Modelica table is in {SI.name}")
