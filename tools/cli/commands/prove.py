"""`jointfmu prove`: run the experiments stored in an FMU, and compare with their reference results.

`jointfmu validate`: compare the laws with quadrature, and results with published numbers.
"""

import argparse
from dataclasses import asdict
from pathlib import Path

from jointfmu.files.outputs import OUTPUT_FOLDER
from jointfmu.joints import KINDS
from jointfmu.parameters import load_parameter_file

from ...fem import require_fem_packages
from ...joints.bolted_joint.frequencies import compare_natural_frequencies
from ...run.proof import listing, report
from ...run.proof.importers import IMPORTERS, SUPPORTED_FMI_VERSIONS
from ...run.proof.run import ExpectedFmuContents, prove
from ...studies.published import law_reference, validation
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import declare_output


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu prove` with its options."""
    text = "run the experiments stored in an FMU (FMI-LS-REF) and compare with its reference results"
    sub = declare_command(command_parsers, "prove", _run_prove, text)
    declare_argument(sub, "fmu", Path, "path of the FMU (.fmu)", "FMU")
    programs = (
        f"{name} (FMI {' and '.join(f'{digit}.0' for digit in SUPPORTED_FMI_VERSIONS[name])})"
        for name in IMPORTERS
    )
    text = f"program that imports and runs the FMU: {', '.join(programs)}"
    choices = list(IMPORTERS)
    declare_argument(sub, "--in", str, text, "IMPORTER", dest="importer", choices=choices, default="fmpy")
    text = "folder to write for the FMI cross-check, if all experiments pass"
    declare_output(sub, "--listing", OUTPUT_FOLDER, text)
    text = (
        "check the FMU against start values and results computed from this parameter file (TOML), not "
        "against those in the FMU"
    )
    declare_argument(sub, "--against", Path, text)


def _run_prove(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu prove`: repeat the experiments of an FMU in an importer."""
    if args.listing and args.against:
        raise ValueError("--listing needs the reference results stored in the FMU; leave out --against")
    proof = prove(
        args.fmu, args.importer, _compute_expected_contents(args.fmu, args.against) if args.against else None
    )
    folders = (
        listing.write_fmi_tools_listing(proof, args.listing, args.force)
        if args.listing and proof.has_passed
        else []
    )
    listed = {"listing": [str(folder) for folder in folders]} if args.listing else {}
    return CommandResult(
        json_document=report.proof_to_json(proof) | listed,
        output_lines=report.format_proof_lines(proof),
        stderr_lines=["the listing is not written: not all experiments passed"]
        if args.listing and not folders
        else (),
        written_files=folders,
        exit_status=int(not proof.has_passed),
    )


def _compute_expected_contents(fmu_path: Path, parameter_path: Path) -> ExpectedFmuContents:
    """Compute the start values and reference results that an FMU should contain, from a parameter file.

    The FMU is not built.

    Raises ValueError if the FMU does not have the inputs and outputs of an FMU of the file's joint.
    """
    from jointfmu_fmu_src.proof.members import make_proof_files

    from ...run.host import unpack_fmu

    file = load_parameter_file(parameter_path)
    with unpack_fmu(fmu_path, accepts_model_exchange=True) as (_, description):
        names = {v.name for v in description.modelVariables}
    for model in KINDS[file.joint].models:
        if {v.name for v in (*model.inputs, *model.outputs)} <= names:
            described = model.with_parameters(file.joint, file.values)
            starts = {name: file.values_by_name[name] for name in described.parameter_fields()}
            starts |= {v.name: file.start_value(v.name) for v in described.inputs}
            return ExpectedFmuContents(str(parameter_path), starts, make_proof_files(described, file))
    models = ", ".join(model.name for model in KINDS[file.joint].models)
    raise ValueError(
        f"{fmu_path}: does not have the inputs and outputs of {models}; expected an FMU of the joint of "
        f"{parameter_path}"
    )


def add_validate_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu validate` with its options."""
    text = (
        "compare the laws with numerical integration of their equations, and results with published numbers"
    )
    sub = declare_command(command_parsers, "validate", _run_validate, text)
    text = (
        "also compare computed with measured natural frequencies of bolted joints, by finite elements (half "
        "a minute)"
    )
    sub.add_argument("--frequencies", action="store_true", help=text)


def _run_validate(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu validate`: compare laws and published numbers with computed ones."""
    rows = validation.validate_published_numbers()
    if args.frequencies:
        with require_fem_packages("the finite-element analysis"):
            rows += compare_natural_frequencies()
    laws = law_reference.compare_laws()
    counts = asdict(validation.count_points(rows))
    missed_laws = law_reference.list_missed_quantities(laws)
    misses = [*missed_laws, *counts["missed"]]
    return CommandResult(
        json_document={
            "laws": [law.to_json() for law in laws],
            "rows": [row.to_json() for row in rows],
            "counts": counts,
            "missed": len(misses),
        },
        output_lines=[
            law_reference.format_law_table(laws),
            law_reference.format_law_summary(laws),
            "",
            validation.format_validation_table(rows),
            validation.format_validation_summary(rows),
            *([f"missed in both tables: {', '.join(misses)}"] if missed_laws else []),
        ],
        exit_status=int(bool(misses)),
    )
