"""`jointfmu surface`: identify D and G of measured heights, or synthesize a rough surface."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu.contact.laws import ROUGHNESS_LAW_NAME, TABLE_LAW_NAME
from jointfmu.contact.surface import ElasticConstants
from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE, write_parameter_text
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default, load_parameter_file
from jointfmu.quantity.refusal import InputRefusal

from ....common.judgement import find_rms_height
from ....inputs.drawing.reading import expand_to_sides
from ....inputs.drawing.tables import find_table_row
from ....inputs.surfaces.heights import FORM_NAMES, ArealMap, ScanHeights
from ....inputs.surfaces.reading import MAX_PLAUSIBLE_RMS_HEIGHT, read_heights
from ....inputs.surfaces.scan_text import parse_spacing
from ....inputs.surfaces.spectrum import CONTACT_SIDES, SERIES_METHODS
from ....inputs.surfaces.stiffness_table import (
    INTERFACE_TABLE_FILE_KIND,
    InterfacePoints,
    MaterialPair,
    has_table_law,
    interface_points_from_solution,
    interface_points_from_tail,
    set_interface_points,
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
    from ....inputs.surfaces.results import SurfaceIdentification

SURFACE_SUBCOMMANDS = DEFAULT_SUBCOMMANDS["surface"]
"""Sub-commands of `surface`; the first one runs if the user names none."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu surface` with its sub-commands."""
    text = "identify fractal dimension D and roughness G of a measured surface or of a pair"
    top = command_parsers.add_parser(
        "surface", help=text, description=f"{format_sentence(text)} Synthesize a surface."
    )
    steps = top.add_subparsers(dest="step", metavar="STEP", parser_class=Parser)
    top.usage = f"{top.prog} [-h] [{'|'.join(SURFACE_SUBCOMMANDS)}] ..."
    top.epilog = f"{top.prog} FILE ... is short for {top.prog} {SURFACE_SUBCOMMANDS[0]} FILE ..."
    find = declare_command(steps, SURFACE_SUBCOMMANDS[0], _run_identify, text)
    declare_argument(
        find,
        "files",
        Path,
        "file of measured heights (profile or map) of one surface, or one file for each surface of a pair",
        nargs="+",
    )
    declare_argument(find, "--unit", str, "length unit of files that state none: m, mm, um, nm", "UNIT")
    declare_argument(
        find,
        "--unit-x",
        str,
        "length unit of x and y in files with columns x, y, z (default: --unit)",
        "UNIT",
    )
    declare_argument(find, "--unit-z", str, "length unit of the heights z (default: --unit)", "UNIT")
    text = "spacing of the points of files that state none, with its unit as in 5um; or two values, x and y"
    declare_argument(find, "--spacing", str, text, "LENGTH", nargs="+")
    text = "number that marks missing points in the file, as in -99999.9999"
    declare_argument(find, "--missing", float, text, "VALUE")
    find.add_argument(
        "--form",
        choices=FORM_NAMES,
        default=FORM_NAMES[0],
        help=(
            "polynomial to subtract from the heights: mean (constant), tilt (plane), curvature (second "
            "degree) (default: tilt)"
        ),
    )
    text = "treat spikes as heights, not as missing points"
    find.add_argument("--keep-spikes", action="store_true", help=text)
    text = (
        "shortest and longest wavelength [m] between which D and G are fitted (default: the longest range "
        "with a power law)"
    )
    find.add_argument("--range", dest="span", nargs=2, type=float, metavar=("LOW", "HIGH"), help=text)
    text = (
        "longest wavelength that counts for the rms height h [m] (default: the length of a profile, the "
        "shorter side of a map)"
    )
    declare_argument(find, "--longest-wave", float, text, "L")
    text = (
        "side of the contact that a single file describes: 1 or 2 (the other side is smooth), or both "
        "(equal sides)"
    )
    find.add_argument("--side", choices=CONTACT_SIDES, help=text)
    text = (
        "source of D and G for the joint: structure function or power spectral density (default: the one "
        "with the smaller uncertainty)"
    )
    find.add_argument("--method", choices=SERIES_METHODS, help=text)
    text = (
        "compute stiffness over pressure from the measured heights by a boundary-element contact solution, "
        f"for the law {TABLE_LAW_NAME}"
    )
    find.add_argument("--solve", action="store_true", help=text)
    text = "material of both sides, or of each side (list: jointfmu new materials)"
    declare_argument(find, "--material", str, text, "NAME", nargs="+", default=["steel"])
    text = (
        "frequency ratio of neighbouring waves in Eq. 30 of Zhao 2018; only the printed G_eq30 depends on "
        "it [1]"
    )
    declare_argument(find, "--gamma", float, text, "GAMMA", default=1.5)
    find.add_argument(
        "--joint",
        type=parse_joint_name,
        choices=list(KINDS),
        metavar="JOINT",
        help=f"joint of the parameter file to write, one of {', '.join(KINDS)}",
    )
    laws = dict.fromkeys(law for kind in KINDS.values() if kind.surfaces for law in kind.laws)
    text = (
        f"interface law of the joint: {ROUGHNESS_LAW_NAME}, which uses the rms height h (default for "
        f"Gaussian heights); {TABLE_LAW_NAME} (default for other heights and for --solve); or a law that "
        "uses D and G: "
    )
    text += ", ".join(law for law in laws if law not in (ROUGHNESS_LAW_NAME, TABLE_LAW_NAME))
    declare_argument(find, "--law", str, text, "LAW", choices=[*laws])
    declare_argument(find, "--params", Path, "parameter file to start from, in place of --joint (TOML)")
    text = (
        f"{FORCE_OPTION_HELP}; accept implausible sizes and heights of scans; write D and G even if the "
        "scan does not determine them"
    )
    find.add_argument("--force", action="store_true", help=text)
    declare_output(
        find, "--out", PARAMETER_FILE, "write the parameter file of the joint (TOML)", alias="--write"
    )
    text = "write stiffness over pressure as a table for jointfmu new --interface-table (.csv)"
    declare_output(find, "--table", INTERFACE_TABLE_FILE_KIND, text)
    declare_output(
        find,
        "--plot",
        PICTURE_FILE,
        "draw structure function and spectrum with the fitted power laws (.png, .svg)",
    )
    synthesize.add_command(steps, SURFACE_SUBCOMMANDS[1])


def _run_identify(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu surface`: identify surface parameters of scans, and write them into a parameter file."""
    base = _load_start_file(args)
    _check_arguments(args)
    spacing = parse_spacing(args.spacing) if args.spacing else None
    heights = [
        read_heights(path, args.unit, args.force, args.unit_x, args.unit_z, spacing, args.missing)
        for path in args.files
    ]
    from ....inputs.surfaces.identify import identify_surface  # needs scipy: loaded after the quick checks
    from ....inputs.surfaces.joint_parameters import set_surface_parameters
    from . import results

    span = tuple(args.span) if args.span else None
    identified = identify_surface(heights, args.form, span, args.longest_wave, args.side, args.keep_spikes)
    _check_rms_heights(identified, args.force)
    points = None
    if args.solve or base or args.table:
        points = _find_table_points(identified, heights, args)
    if args.joint and _needs_table_law(identified, args) and has_table_law(args.joint):
        base = _load_default_table_file(args.joint, args.files)
    file = set_surface_parameters(base, identified, args.method, args.force) if base else None
    if file and points and file.law == TABLE_LAW_NAME and has_table_law(file.joint):
        file = set_interface_points(file, points)
    if args.out and file:
        write_parameter_text(args.out, format_parameter_file(file))
    if args.table and points:
        write_text(args.table, points.to_csv())
    if args.plot:
        from ....inputs.surfaces.results import draw_identification

        draw_identification(identified, args.plot)
    return results.build_surface_result(identified, heights, file, points, args)


def _load_default_table_file(joint_name: str, surface_scans: list[Path]) -> ParameterFile:
    """Read the default file of a joint with the law `table`, and name it after the scans."""
    name = (
        f"{load_default(joint_name).name}, interface of {' and '.join(path.name for path in surface_scans)}"
    )
    return replace(load_default(joint_name, TABLE_LAW_NAME), roughness={}, name=name)


def _needs_table_law(identified_surface: "SurfaceIdentification", args: argparse.Namespace) -> bool:
    """Whether the joint gets the law `table`: by `--law`, else with `--solve` or for non-Gaussian heights."""
    if args.params:
        return False
    is_default = args.solve or not identified_surface.is_gaussian
    return args.law == TABLE_LAW_NAME or (args.law is None and is_default)


def _find_table_points(
    identified_surface: "SurfaceIdentification", surface_heights: list[ScanHeights], args: argparse.Namespace
) -> InterfacePoints:
    """Points of the interface law `table`: stiffness of the scanned surfaces at several pressures.

    With `--solve`, boundary elements give the stiffness; without, the tail of the height distribution.
    """
    names = expand_to_sides("material", args.material)
    assert names is not None  # the option has a default
    rows = [find_table_row("materials", name) for name in names]
    sides = [
        ElasticConstants(**{name: row.sourced_numbers[name].si_value for name in ("E", "nu")}) for row in rows
    ]
    hardness = min(row.sourced_numbers["H"].si_value for row in rows)
    materials = MaterialPair.from_sides(sides, hardness, [row.display_title for row in rows])
    files = " and ".join(Path(name).name for name in identified_surface.file_names)
    if not args.solve:
        return interface_points_from_tail(identified_surface.bearing_curve, materials, files)
    maps = []
    for surface, scan in zip(surface_heights, identified_surface.scan_roughnesses, strict=True):
        if not isinstance(surface, ArealMap):
            raise InputRefusal(
                f"{surface.scan_name}: is a profile; a boundary-element solution needs an areal map", "solve"
            )
        maps.append(surface.replace_heights(scan.height_sample.heights.reshape(surface.z.shape)))
    return interface_points_from_solution(maps, args.side == "both", materials, files)


def _check_rms_heights(identified_surface: "SurfaceIdentification", accept_implausible_heights: bool) -> None:
    """Raise ValueError for rms heights that no machined surface has; most often the unit is wrong.

    accept_implausible_heights : no check, as the user has confirmed the heights
    """
    for name, scan in zip(identified_surface.file_names, identified_surface.scan_roughnesses, strict=True):
        if scan.rms_height > MAX_PLAUSIBLE_RMS_HEIGHT and not accept_implausible_heights:
            raise InputRefusal(
                f"{name}: the rms height is {1e6 * scan.rms_height:.4g} um, surfaces in contact have up to "
                f"{1e6 * MAX_PLAUSIBLE_RMS_HEIGHT:g} um; state the right unit of z, or confirm the height",
                "force",
            )


def _check_arguments(args: argparse.Namespace) -> None:
    """Raise ValueError before any file is read if an option is out of range or missing."""
    if args.solve and (args.law or TABLE_LAW_NAME) != TABLE_LAW_NAME:
        raise InputRefusal(
            f"law {args.law} cannot use the computed stiffness; expected --law {TABLE_LAW_NAME} or none",
            "solve",
        )
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
            raise InputRefusal(
                f"{args.params}: has law = {file.law!r}, not {args.law!r}; leave the option out", "law"
            )
        if args.side in ("1", "2") and find_rms_height(file) and not file.roughness.keys() - {"h"}:
            other = 3 - int(args.side)
            raise ValueError(
                f"{args.params}: states h = {find_rms_height(file):g} m of both sides together; state "
                f"Ra{other} or Rq{other} of the other side in its section [{file.heights_prefix[:-1]}], or "
                "use --side both"
            )
        return file
    if args.joint:
        law = args.law or ROUGHNESS_LAW_NAME
        if law not in KINDS[args.joint].laws:
            raise InputRefusal(
                f"{args.joint} has no law {law!r}, allowed are {', '.join(KINDS[args.joint].laws)}", "law"
            )
        return replace(load_default(args.joint, law), roughness={})  # the default file is of another surface
    if args.law:
        raise InputRefusal(f"law {args.law} needs --joint, one of {', '.join(KINDS)}", "law")
    if args.out:
        raise ValueError(f"--out {args.out} needs --joint, one of {', '.join(KINDS)}, or --params")
    return None
