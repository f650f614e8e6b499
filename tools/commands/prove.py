"""`jointfmu prove`: run the experiments stored in an FMU.

`jointfmu validate`: compare with published numbers.
"""

import argparse
from dataclasses import asdict
from pathlib import Path

from jointfmu.files.outputs import FOLDER
from jointfmu.joints import KINDS
from jointfmu.parameters import load

from ..command_line.common import Answer, Commands, argument, command
from ..command_line.outputs import output
from ..fem import installed
from ..fem.validation import natural_frequencies
from ..proof import listing, report
from ..proof.importers import IMPORTERS
from ..proof.run import Expected, prove
from ..published import validation


def add(commands: Commands) -> None:
    """Declare the command `jointfmu prove` with its options."""
    text = "run the experiments stored in an FMU (FMI-LS-REF) and compare with its reference results"
    sub = command(commands, "prove", _prove, text)
    argument(sub, "fmu", Path, "path of the FMU", "FMU")
    text = f"simulator that runs the FMU: {', '.join(IMPORTERS)}"
    choices = list(IMPORTERS)
    argument(sub, "--in", str, text, "IMPORTER", dest="importer", choices=choices, default="fmpy")
    text = "folder for the files of the FMI cross-check, written if all experiments pass"
    output(sub, "--listing", FOLDER, text)
    text = "parameter file from which start values and reference results are computed, in place of those in "
    argument(sub, "--against", Path, text + "the FMU")


def _prove(args: argparse.Namespace) -> Answer:
    if args.listing and args.against:
        raise ValueError("--listing needs the reference results stored in the FMU; expected no --against")
    proof = prove(args.fmu, args.importer, _expected(args.fmu, args.against) if args.against else None)
    folders = listing.write(proof, args.listing, args.force) if args.listing and proof.passed else []
    listed = {"listing": [str(folder) for folder in folders]} if args.listing else {}
    return Answer(
        document=report.document(proof) | listed,
        lines=report.lines(proof),
        notes=["no listing is written: not all passed"] if args.listing and not folders else (),
        written=folders,
        status=int(not proof.passed),
    )


def _expected(fmu: Path, path: Path) -> Expected:
    """Compute start values and reference results from a parameter file, without building its FMU.

    Raises ValueError if the FMU does not have the inputs and outputs of an FMU of the file's joint.
    """
    from jointfmu_fmu_src.proof.members import proof

    from ..host import unpacked

    file = load(path)
    with unpacked(fmu, exchange=True) as (_, description):
        names = {v.name for v in description.modelVariables}
    for model in KINDS[file.joint].models:
        if {v.name for v in (*model.inputs, *model.outputs)} <= names:
            described = model.of(file.joint, file.values)
            starts = {name: file.flat[name] for name in described.parameter_fields()}
            starts |= {v.name: file.start(v.name) for v in described.inputs}
            return Expected(str(path), starts, proof(described, file))
    models = ", ".join(model.name for model in KINDS[file.joint].models)
    raise ValueError(f"{fmu}: does not have the variables of {models}, the FMUs of {path}")


def add_validate(commands: Commands) -> None:
    """Declare the command `jointfmu validate` with its options."""
    sub = command(commands, "validate", _validate, "compare computed results with all published numbers")
    text = "also compare the measured natural frequencies, by finite elements (half a minute)"
    sub.add_argument("--frequencies", action="store_true", help=text)


def _validate(args: argparse.Namespace) -> Answer:
    rows = validation.validate()
    if args.frequencies:
        with installed("the finite-element analysis"):
            rows += natural_frequencies()
    misses = validation.missed(rows)
    counts = asdict(validation.counts(rows))
    return Answer(
        document={"rows": [row.as_dict() for row in rows], "counts": counts, "missed": len(misses)},
        lines=[validation.table(rows), validation.summary(rows)],
        status=int(bool(misses)),
    )
