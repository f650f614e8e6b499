"""`jointfmu prove`: the experiments that an FMU carries; `jointfmu validate`: the published numbers."""

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
    """Declare the command."""
    text = "run the experiments that an FMU carries (FMI-LS-REF) and compare with its reference results"
    sub = command(commands, "prove", _prove, text)
    argument(sub, "fmu", Path, "path of the FMU", "FMU")
    text = f"what runs the FMU: {', '.join(IMPORTERS)}"
    choices = list(IMPORTERS)
    argument(sub, "--in", str, text, "IMPORTER", dest="importer", choices=choices, default="fmpy")
    text = "if all passes, write the files of the FMI cross-check for lists of exporting tools"
    output(sub, "--listing", FOLDER, text)
    text = "parameter file: this package computes start values and references from it, those that the FMU "
    argument(sub, "--against", Path, text + "carries are not read")


def _prove(args: argparse.Namespace) -> Answer:
    if args.listing and args.against:
        raise ValueError("--listing is of the references that the FMU carries; expected it without --against")
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
    """What the package says of the FMU of a parameter file, without building it.

    Raises ValueError if the FMU has not the inputs and outputs of one of the file's joint.
    """
    from jointfmu_fmu_src.proof.members import proof

    from ..host import unpacked

    file = load(path)
    with unpacked(fmu, exchange=True) as (_, description):
        names = {v.name for v in description.modelVariables}
    for model in KINDS[file.joint].models:
        if {v.name for v in (*model.inputs, *model.outputs)} <= names:
            own = model.of(file.joint, file.values)
            starts = {name: file.flat[name] for name in own.parameter_fields()}
            starts |= {v.name: file.start(v.name) for v in own.inputs}
            return Expected(str(path), starts, proof(own, file))
    known = ", ".join(model.name for model in KINDS[file.joint].models)
    raise ValueError(f"{fmu}: has not the variables of {known}, for which {path} is")


def add_validate(commands: Commands) -> None:
    """Declare the command."""
    sub = command(commands, "validate", _validate, "compare every published number with the computed one")
    sub.add_argument(
        "--frequencies",
        action="store_true",
        help="add the measured natural frequencies, by finite elements (half a minute)",
    )


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
