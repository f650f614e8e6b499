"""`jointfmu surface`: identify D and G of measured heights, or synthesize a rough surface."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu.contact.laws import ROUGHNESS_LAW, TABLE_LAW
from jointfmu.contact.surface import ElasticConstants
from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE, write_parameter_text
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default, load_parameter_file
from jointfmu.quantity.refusal import InputRefusal

from ....common.judgement import find_rms_height
from ....inputs.drawing.reading import expand_to_sides
from ....inputs.drawing.tables import find_row
from ....inputs.surfaces.heights import FORM_NAMES, ArealMap, Heights
from ....inputs.surfaces.reading import MAX_RMS_HEIGHT, read_heights
from ....inputs.surfaces.scan_text import parse_spacing
from ....inputs.surfaces.spectrum import SCAN_SIDES, SERIES_METHODS
from ....inputs.surfaces.stiffness_table import (
    INTERFACE_TABLE_FILE,
    InterfacePoints,
    MaterialPair,
    has_table_law,
    points_from_solution,
    points_from_tail,
    with_points,
)
from ...command import (
    DEFAULT_SUBCOMMANDS,
    CommandResult,
    Parser,
    SubParsers,
    declare_argument,
    declare_command,
    format_sentence,
    parse_joint_name,
)
from ...outputs import FORCE_OPTION_HELP, declare_output
from . import synthesize

if TYPE_CHECKING:
    from ....inputs.surfaces.results import Identification

SUBCOMMANDS = DEFAULT_SUBCOMMANDS["surface"]
"""Sub-commands of `surface`; the first one runs if the user names none."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu surface` with its sub-commands."""
    text = "identify fractal dimension D and roughness G of a measured surface or of a pair"
    top = command_parsers.add_parser(
        "surface", help=text, description=f"{format_sentence(text)} Synthesize a surface."
    )
    steps = top.add_subparsers(dest="step", metavar="STEP", parser_class=Parser)
    top.usage = f"{top.prog} [-h] [{'|'.join(SUBCOMMANDS)}] ..."
    top.epilog = f"{top.prog} FILE ... is {top.prog} {SUBCOMMANDS[0]} FILE ..."
    find = declare_command(steps, SUBCOMMANDS[0], _run_identify, text)
    declare_argument(
        find, "files", Path, "scan of one surface, or scans of both surfaces of a pair", nargs="+"
    )
    declare_argument(find, "--unit", str, "length unit of files that state none: m, mm, um, nm", "UNIT")
    declare_argument(find, "--unit-x", str, "length unit of x and y only, for files of columns", "UNIT")
    declare_argument(find, "--unit-z", str, "length unit of z only", "UNIT")
    text = "spacing of the points along x and y, or one for both, in files that state none, e.g. 5um"
    declare_argument(find, "--spacing", str, text, "LENGTH", nargs="+")
    text = "number that marks a missing point, in the unit of the heights, e.g. -99999.9999"
    declare_argument(find, "--missing", float, text, "VALUE")
    find.add_argument(
        "--form", choices=FORM_NAMES, default=FORM_NAMES[0], help="form to remove (default: tilt)"
    )
    text = "treat spikes as heights, not as missing points"
    find.add_argument("--keep-spikes", action="store_true", help=text)
    text = "scaling range: lags and wavelengths [m] (default: the longest range with a power law)"
    find.add_argument("--range", dest="span", nargs=2, type=float, metavar=("LOW", "HIGH"), help=text)
    text = "longest wavelength that counts for the rms height h [m] (default: the length of a profile, the "
    declare_argument(find, "--longest-wave", float, text + "shorter side of a map)", "L")
    text = (
        "side of the contact that a single file describes: 1 or 2 (the other side is "
        "smooth), or both (equal sides)"
    )
    find.add_argument("--side", choices=SCAN_SIDES, help=text)
    text = "method whose result the joint gets (default: the one with the smaller uncertainty)"
    find.add_argument("--method", choices=SERIES_METHODS, help=text)
    text = "press the heights together by boundary elements: stiffness over pressure for the law table"
    find.add_argument("--solve", action="store_true", help=text)
    text = "material of both sides, or of each side (jointfmu new materials; default: steel)"
    declare_argument(find, "--material", str, text, "NAME", nargs="+", default=["steel"])
    text = "frequency ratio in Eq. 30 of Zhao 2018; only G_eq30 depends on it"
    declare_argument(find, "--gamma", float, text, "GAMMA", default=1.5)
    find.add_argument(
        "--joint",
        type=parse_joint_name,
        choices=list(KINDS),
        metavar="JOINT",
        help=f"one of {', '.join(KINDS)}",
    )
    laws = dict.fromkeys(law for kind in KINDS.values() if kind.surfaces for law in kind.laws)
    text = f"law of the joint: {ROUGHNESS_LAW} (default of Gaussian heights), which uses h, {TABLE_LAW} "
    text += "(default of other heights and of --solve), or a law that uses D and G: "
    text += ", ".join(law for law in laws if law not in (ROUGHNESS_LAW, TABLE_LAW))
    declare_argument(find, "--law", str, text, "LAW", choices=[*laws])
    declare_argument(find, "--params", Path, "parameter file to start from (TOML)")
    text = (
        f"{FORCE_OPTION_HELP}; accept any size of scan and any height; write D and G even if they are not "
        "determined"
    )
    find.add_argument("--force", action="store_true", help=text)
    declare_output(find, "--out", PARAMETER_FILE, "write the parameter file (TOML)", alias="--write")
    text = "write stiffness over pressure for `jointfmu new --interface-table` (.csv)"
    declare_output(find, "--table", INTERFACE_TABLE_FILE, text)
    declare_output(find, "--plot", PICTURE_FILE, "draw data, law and scaling range (.png, .svg)")
    synthesize.add_command(steps, SUBCOMMANDS[1])


def _run_identify(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu surface`: identify surface parameters of scans, and write them into a parameter file."""
    base = _load_start_file(args)
    _check_arguments(args)
    spacing = parse_spacing(args.spacing) if args.spacing else None
    heights = [
        read_heights(path, args.unit, args.force, args.unit_x, args.unit_z, spacing, args.missing)
        for path in args.files
    ]
    from ....inputs.surfaces.identify import identify  # needs scipy: loaded after the quick checks
    from ....inputs.surfaces.joint_parameters import with_surface
    from . import results

    span = tuple(args.span) if args.span else None
    identified = identify(heights, args.form, span, args.longest_wave, args.side, args.keep_spikes)
    _check_rms_heights(identified, args.force)
    points = None
    if args.solve or base or args.table:
        points = _find_points(identified, heights, args)
    if args.joint and _needs_table(identified, args) and has_table_law(args.joint):
        base = _load_table_default(args.joint, args.files)
    file = with_surface(base, identified, args.method, args.force) if base else None
    if file and points and file.law == TABLE_LAW and has_table_law(file.joint):
        file = with_points(file, points)
    if args.out and file:
        write_parameter_text(args.out, format_parameter_file(file))
    if args.table and points:
        write_text(args.table, points.to_csv())
    if args.plot:
        from ....inputs.surfaces.results import draw_identification

        draw_identification(identified, args.plot)
    return results.build_result(identified, heights, file, points, args)


def _load_table_default(joint: str, scans: list[Path]) -> ParameterFile:
    """Read the default file of a joint with the law `table`, and name it after the scans."""
    name = f"{load_default(joint).name}, interface of {' and '.join(path.name for path in scans)}"
    return replace(load_default(joint, TABLE_LAW), roughness={}, name=name)


def _needs_table(identified_surface: "Identification", args: argparse.Namespace) -> bool:
    """Whether the joint gets the interface law `table`, because `--law` says so, or by default."""
    if args.params:
        return False
    is_default = args.solve or not identified_surface.is_gaussian
    return args.law == TABLE_LAW or (args.law is None and is_default)


def _find_points(
    identified_surface: "Identification", heights: list[Heights], args: argparse.Namespace
) -> InterfacePoints:
    """Points of the interface law `table`: stiffness over pressure of the scanned surfaces.

    With `--solve`, boundary elements give the stiffness; without, the tail of the height distribution.
    """
    names = expand_to_sides("material", args.material)
    assert names is not None  # the option has a default
    rows = [find_row("materials", name) for name in names]
    sides = [ElasticConstants(**{name: row.numbers[name].value for name in ("E", "nu")}) for row in rows]
    hardness = min(row.numbers["H"].value for row in rows)
    materials = MaterialPair.from_sides(sides, hardness, [row.title for row in rows])
    files = " and ".join(Path(name).name for name in identified_surface.file_names)
    if not args.solve:
        return points_from_tail(identified_surface.bearing_curve, materials, files)
    maps = []
    for surface, scan in zip(heights, identified_surface.scans, strict=True):
        if not isinstance(surface, ArealMap):
            raise InputRefusal(f"{surface.name}: is a profile; boundary elements need an areal map", "solve")
        maps.append(surface.with_heights(scan.sample.heights.reshape(surface.z.shape)))
    return points_from_solution(maps, args.side == "both", materials, files)


def _check_rms_heights(identified_surface: "Identification", accept_any_height: bool) -> None:
    """Raise ValueError for rms heights that no machined surface has; most often the unit is wrong."""
    for name, scan in zip(identified_surface.file_names, identified_surface.scans, strict=True):
        if scan.rms_height > MAX_RMS_HEIGHT and not accept_any_height:
            raise InputRefusal(
                f"{name}: the rms height is {1e6 * scan.rms_height:.4g} um, surfaces in contact have up to "
                f"{1e6 * MAX_RMS_HEIGHT:g} um; state the right unit of z, or confirm the height",
                "force",
            )


def _check_arguments(args: argparse.Namespace) -> None:
    """Raise ValueError before any file is read if an option is out of range or missing."""
    if args.solve and (args.law or TABLE_LAW) != TABLE_LAW:
        raise InputRefusal(f"law {args.law} has no points of the stiffness; leave --law out", "solve")
    if not 1.0 < args.gamma < float("inf"):
        raise ValueError(f"gamma = {args.gamma:g} is outside (1, inf)")
    if args.span and not 0.0 < args.span[0] < args.span[1] < float("inf"):
        raise ValueError(f"range {args.span[0]:g} {args.span[1]:g} m, expected 0 < LOW < HIGH")
    if args.longest_wave is not None and not 0.0 < args.longest_wave < float("inf"):
        raise ValueError(f"longest wave = {args.longest_wave:g} m is outside (0, inf)")
    if args.out and len(args.files) == 1 and args.side is None:
        raise InputRefusal(
            f"{args.files[0]} is one side of the contact; state which, 1, 2 or both (alike), or give the "
            "scans of both sides",
            "side",
        )


def _load_start_file(args: argparse.Namespace) -> ParameterFile | None:
    """Load the parameter file to start from: `--params`, or the default of `--joint`; None: no file.

    The roughness of a default file is removed. Its law is `roughness`, which uses the measured heights,
    unless `--law` names another one. Raises ValueError for options that contradict each other.
    """
    if args.params:
        file = load_parameter_file(args.params, args.joint)
        if args.law not in (None, file.law):
            raise InputRefusal(f"{args.params}: has law = {file.law!r}; expected that or none", "law")
        if args.side in ("1", "2") and find_rms_height(file) and not file.roughness.keys() - {"h"}:
            other = 3 - int(args.side)
            raise ValueError(
                f"{args.params}: states h = {find_rms_height(file):g} m of both sides together; "
                "expected of the "
                f"other side Ra{other} or Rq{other} in its section [{file.heights_prefix[:-1]}], or "
                "--side both"
            )
        return file
    if args.joint:
        law = args.law or ROUGHNESS_LAW
        if law not in KINDS[args.joint].laws:
            raise InputRefusal(
                f"{args.joint} has no law {law!r}, but {', '.join(KINDS[args.joint].laws)}", "law"
            )
        return replace(load_default(args.joint, law), roughness={})  # the default file is of another surface
    if args.law:
        raise InputRefusal(f"law {args.law} needs --joint, one of {', '.join(KINDS)}", "law")
    if args.out:
        raise ValueError(f"--out {args.out} needs --joint, one of {', '.join(KINDS)}, or --params")
    return None
