"""`jointfmu build`: FMUs from parameters; `jointfmu cache`: where their compiled parts are kept."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

from jointfmu.files import archives
from jointfmu.files.outputs import FOLDER
from jointfmu.joints import MODELS
from jointfmu.parameters import default, load
from jointfmu.progress import processes

from ..command_line.common import Answer, Commands, argument, command, needing
from ..command_line.outputs import output
from ..pressure import judge_file

SHOWN = 3
"""Values of a replaced FMU that are printed; `--json` has all."""


def add(commands: Commands) -> None:
    """Declare the command."""
    make = command(commands, "build", _build, "build FMUs")
    argument(make, "names", str, f"FMUs to build: {', '.join(MODELS)} (default: all)", nargs="*")
    make.add_argument(
        "--flavour",
        nargs="+",
        default=["fmi2", "fmi3"],
        metavar="FLAVOUR",
        help="flavours to build: fmi2, fmi3 (default: both), python",
    )
    text = "model name, identifier and file name of one FMU, for example ShoulderDrive; builds with other "
    argument(make, "--name", str, text + "names stand side by side in one model")
    argument(make, "--params", Path, "parameter file with other defaults (TOML)")
    make.add_argument(
        "--parameters",
        choices=("tunable", "fixed"),
        default="tunable",
        help="whether a tool may change parameters during a run (tunable, the default) or only before it "
        "(fixed, which OpenModelica imports without warnings); fmi2 and fmi3",
    )
    make.add_argument(
        "--systems", action="store_true", help="build the example systems (SSP) with the FMUs that they need"
    )
    output(make, "--out", FOLDER, "folder", default=Path("dist"))


def _build(args: argparse.Namespace) -> Answer:
    if args.name is not None and args.systems:
        raise ValueError(f"--name {args.name} is for one FMU; expected no --systems beside it")
    file = load(args.params) if args.params else None
    with needing("build"):
        from jointfmu_fmu_src import building

        before = {path: _starts(path) for f in args.flavour for path in (args.out / f).glob("*.fmu")}
        built = []
        with processes() as pool:
            if args.names or not args.systems:
                built += building.build(
                    args.names, args.flavour, file, args.out, args.parameters, args.name, pool, args.force
                )
            if args.systems:
                from ..systems import ssp

                built += ssp.build_systems(args.out, None, file, True, args.parameters, pool, args.force)
    changed = _replaced(built, before)
    joints = dict.fromkeys(MODELS[name].joint for name in args.names or MODELS)
    found = {f.joint: judge_file(f) for f in ([file] if file else map(default, joints))}
    judged = {joint: judgement.document() for joint, judgement in found.items()}
    notes = []
    for path, values in changed.items():
        said = [f"{name} was {old or 'not there'}, is {new or 'gone'}" for name, (old, new) in values.items()]
        more = f" and {len(said) - SHOWN} more" if len(said) > SHOWN else ""
        notes.append(f"replaced {path}: {', '.join(said[:SHOWN])}{more}")
    levels = [f"{joint}: {line}" for joint, one in found.items() for line in one.lines()]
    return Answer(
        document={"built": [str(path) for path in built], "replaced": changed, "joints": judged},
        lines=[*(f"built {path}" for path in built), *levels],
        notes=[*notes, *(f"warning: {joint}: {x}" for joint, one in found.items() for x in one.warnings)],
    )


def _starts(path: Path) -> dict[str, str]:
    """{parameter: start value as written} of an FMU; empty for a file that is none."""
    try:
        with archives.open_archive(path) as archive:
            description = ElementTree.fromstring(archives.read_member(archive, archives.DESCRIPTION))
    except (ValueError, ElementTree.ParseError):
        return {}
    found = {}
    for variable in description.iterfind("ModelVariables/*"):
        values = {**variable.attrib, **{k: v for child in variable for k, v in child.attrib.items()}}
        if variable.get("causality") == "parameter" and "start" in values:
            found[variable.attrib["name"]] = values["start"]
    return found


def _replaced(
    built: Sequence[Path], before: Mapping[Path, Mapping[str, str]]
) -> dict[str, dict[str, list[str | None]]]:
    """{file: {parameter: [value before, now]}} of FMUs that were there with others; None: without."""
    found = {}
    for path in built:
        if old := before.get(path):
            new = _starts(path)
            values = {
                name: [old.get(name), new.get(name)]
                for name in {**old, **new}
                if old.get(name) != new.get(name)
            }
            if values:
                found[str(path)] = values
    return found


def add_cache(commands: Commands) -> None:
    """Declare the command."""
    cache = command(commands, "cache", _cache, "say where compiled parts of FMUs are kept, or remove them")
    cache.add_argument("--clear", action="store_true", help="remove them; the next build compiles again")


def _cache(args: argparse.Namespace) -> Answer:
    with needing("build"):
        from jointfmu_fmu_src.native.compiled import cache
    if args.clear:
        cache.clear()
    files, size = cache.content()
    folder = str(cache.cache_folder())
    return Answer(
        document={"folder": folder, "files": files, "bytes": size},
        lines=[f"{folder}: {files} files, {size / 1e6:.1f} MB (another folder: {cache.CACHE})"],
    )
