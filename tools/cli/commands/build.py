"""`jointfmu build`: build FMUs from parameters; `jointfmu cache`: show or clear their compiled code."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

from jointfmu.files import archives
from jointfmu.files.outputs import OUTPUT_FOLDER
from jointfmu.joints import MODELS
from jointfmu.parameters import load_default, load_parameter_file
from jointfmu.progress import worker_processes

from ...common.options import require_package
from ...common.pressure import judge_joint_stiffness
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import declare_output

MAX_PRINTED_START_VALUE_CHANGES = 3
"""Largest number of changed start values that are printed of a replaced FMU; `--json` has all."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu build` with its options."""
    make = declare_command(command_parsers, "build", _run_build, "build FMUs from default or user parameters")
    declare_argument(
        make,
        "names",
        str,
        f"FMUs to build: {', '.join(MODELS)} (default: all, or those of the joint of --params)",
        nargs="*",
    )
    make.add_argument(
        "--flavour",
        nargs="+",
        default=["fmi2", "fmi3"],
        metavar="FLAVOUR",
        help="kinds of FMU to build: fmi2, fmi3 (compiled; default: both), python (FMI 2.0, runs Python "
        "code)",
    )
    text = (
        "model name, identifier and file name of one FMU, for example ShoulderDrive; FMUs with different "
        "names can be used in one model"
    )
    declare_argument(make, "--name", str, text)
    declare_argument(
        make, "--params", Path, "parameter file of one joint, in place of its default parameters (TOML)"
    )
    make.add_argument(
        "--parameters",
        choices=("tunable", "fixed"),
        default="tunable",
        help="whether a tool may change parameters during a run (tunable, the default) or only before it "
        "(fixed, which OpenModelica imports without warnings)",
    )
    make.add_argument(
        "--systems",
        action="store_true",
        help="build the shipped systems (SSP archives) with the FMUs that they need",
    )
    declare_output(make, "--out", OUTPUT_FOLDER, "folder to write", default=Path("dist"))


def _run_build(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu build`: build the FMUs, and print what changed in replaced ones."""
    if args.name is not None and args.systems:
        raise ValueError(f"--name {args.name} is for one FMU; leave out --systems")
    file = load_parameter_file(args.params) if args.params else None
    with require_package("build"):
        from jointfmu_fmu_src import building

        before = {
            path: _read_start_values(path) for f in args.flavour for path in (args.out / f).glob("*.fmu")
        }
        built = []
        with worker_processes() as pool:
            if args.names or not args.systems:
                built += building.build_fmus(
                    args.names, args.flavour, file, args.out, args.parameters, args.name, pool, args.force
                )
            if args.systems:
                from ...systems import ssp

                built += ssp.build_system_archives(
                    args.out, None, file, True, args.parameters, pool, args.force
                )
    changed = _find_changed_values(built, before)
    joints = dict.fromkeys(MODELS[name].joint for name in args.names or MODELS)
    judgements = {f.joint: judge_joint_stiffness(f) for f in ([file] if file else map(load_default, joints))}
    judged = {joint: judgement.to_json() for joint, judgement in judgements.items()}
    notes = []
    for path, values in changed.items():
        texts = [
            f"{name} was {old or 'not there'}, is {new or 'gone'}" for name, (old, new) in values.items()
        ]
        more = (
            f" and {len(texts) - MAX_PRINTED_START_VALUE_CHANGES} more"
            if len(texts) > MAX_PRINTED_START_VALUE_CHANGES
            else ""
        )
        notes.append(f"replaced {path}: {', '.join(texts[:MAX_PRINTED_START_VALUE_CHANGES])}{more}")
    levels = [
        f"{joint}: {line}" for joint, judgement in judgements.items() for line in judgement.format_lines()
    ]
    notes += [
        f"warning: {joint}: {text}" for joint, judgement in judgements.items() for text in judgement.warnings
    ]
    return CommandResult(
        json_document={"built": [str(path) for path in built], "replaced": changed, "joints": judged},
        output_lines=[*(f"built {path}" for path in built), *levels],
        stderr_lines=notes,
    )


def _read_start_values(fmu_path: Path) -> dict[str, str]:
    """Read {parameter: start value as text} of an FMU; empty if the file is not an FMU."""
    try:
        with archives.open_archive(fmu_path) as archive:
            description = ElementTree.fromstring(
                archives.read_member(archive, archives.MODEL_DESCRIPTION_NAME)
            )
    except (ValueError, ElementTree.ParseError):
        return {}
    starts = {}
    for variable in description.iterfind("ModelVariables/*"):
        values = {**variable.attrib, **{k: v for child in variable for k, v in child.attrib.items()}}
        if variable.get("causality") == "parameter" and "start" in values:
            starts[variable.attrib["name"]] = values["start"]
    return starts


def _find_changed_values(
    fmu_paths: Sequence[Path], old_start_values: Mapping[Path, Mapping[str, str]]
) -> dict[str, dict[str, list[str | None]]]:
    """Find start values that differ from the start values of replaced FMUs: {file: {parameter: [old, new]}}.

    None stands for a parameter that the FMU does not have.
    """
    changed = {}
    for path in fmu_paths:
        if old := old_start_values.get(path):
            new = _read_start_values(path)
            values = {
                name: [old.get(name), new.get(name)]
                for name in {**old, **new}
                if old.get(name) != new.get(name)
            }
            if values:
                changed[str(path)] = values
    return changed


def add_cache_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu cache` with its options."""
    cache = declare_command(
        command_parsers, "cache", _run_cache, "show or clear the cache of compiled FMU code"
    )
    cache.add_argument(
        "--clear", action="store_true", help="delete all files of the cache; the next build compiles again"
    )


def _run_cache(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu cache`: print the size of the cache, or clear it."""
    with require_package("build"):
        from jointfmu_fmu_src.native.compiled import cache
    if args.clear:
        cache.clear_cache()
    files, size = cache.count_cached_files()
    folder = str(cache.cache_folder())
    return CommandResult(
        json_document={"folder": folder, "files": files, "bytes": size},
        output_lines=[
            f"{folder}: {files} files, {size / 1e6:.1f} MB (another folder: "
            f"{cache.CACHE_ENVIRONMENT_VARIABLE})"
        ],
    )
