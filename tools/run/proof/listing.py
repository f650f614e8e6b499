"""Files by which a tool enters the list of FMI tools: an FMU with inputs and reference results.

The files follow the FMI cross-check rules, version 4.1.

The folder fmus/VERSION/cs/PLATFORM/TOOL/RELEASE/MODEL contains MODEL.fmu, MODEL_in.csv, MODEL_ref.csv,
MODEL_ref.opt and README.md. The files describe one experiment that needs no parameter set: the first
validation, or if there is none the first experiment of another purpose.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu_fmu_src.proof.series import TimeSeries, format_csv
from jointfmu_fmu_src.proof.standard import CO_SIMULATION, REFERENCE_FOLDER

from jointfmu.files import archives
from jointfmu.files.outputs import PROGRAM_MARK, FileKind, check_outputs
from jointfmu.files.writing import ensure_folder, write_bytes

from .. import host
from .manifest import Experiment
from .outcome import ExperimentOutcome, Proof
from .plan import DEFAULT_TOLERANCE

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

README_NAME = "README.md"
"""Name of the text file in each folder."""
LISTING_FILE_KIND = FileKind("listing", (".md",))
"""Kind of the text file README.md in the folder of a listed FMU."""
FMI2_PLATFORMS = ("c-code", "darwin64", "linux32", "linux64", "win32", "win64")
"""Platform names of the cross-check rules for FMI 2.0. For FMI 3.0 the names in the FMU are used."""


def write_listing(proof: Proof, output_folder: Path, overwrite: bool = False) -> list[Path]:
    """Write the folders by which a tool enters the list of FMI tools, from a passed proof of an FMU.

    A passed proof is a check of the FMU in which all outputs agree with their references. There is one folder
    for each platform of the FMU, with FMU, inputs, reference results and README.md. Returns the folders.

    overwrite : overwrite files also in a folder whose README.md was not written by jointfmu

    Raises ValueError if no experiment is suitable, or if a file must not or cannot be written.
    """
    described = host.read_description(proof.fmu)
    files = _make_listing_files(proof, _select_listed_outcome(proof), described)
    tool, _, version = (described.generationTool or "unknown").rpartition(" ")
    subfolders = [
        _safe_file_name(tool or version),
        _safe_file_name(version),
        _safe_file_name(described.modelName),
    ]
    version = described.fmiVersion[:3]
    folders = [
        output_folder.joinpath("fmus", version, "cs", p, *subfolders)
        for p in _list_platforms(proof.fmu, version)
    ]
    check_outputs((folder / README_NAME for folder in folders), LISTING_FILE_KIND, overwrite)
    for folder in folders:
        with ensure_folder(folder):
            for name, content in files.items():
                write_bytes(folder / name, content)
    return folders


def _select_listed_outcome(proof: Proof) -> ExperimentOutcome:
    """Select the experiment of an FMU to be listed: the first validation, else the first listable one.

    Raises ValueError if no experiment is listable.
    """
    listable = [o for o in proof.outcomes if o.interface == CO_SIMULATION and _is_listable(o.experiment)]
    if not listable:
        raise ValueError(
            f"{proof.fmu}: no experiment without parameters has results from start to end to list"
        )
    validations = (outcome for outcome in listable if outcome.experiment.purpose == "validation")
    return next(validations, listable[0])


def _is_listable(experiment: Experiment) -> bool:
    """Whether an experiment of an FMU can enter the list of FMI tools.

    Its reference results cover the time from start to stop, and it sets no variables but its inputs.
    """
    if (
        experiment.unsupported_reason
        or experiment.references is None
        or not experiment.settings.keys() <= set(_input_names(experiment))
    ):
        return False
    start, stop = _time_range(experiment)
    return bool(experiment.references.time[0] <= start and experiment.references.time[-1] >= stop)


def _input_names(experiment: Experiment) -> list[str]:
    """Names of the inputs that an experiment drives."""
    return list(experiment.stimuli.columns) if experiment.stimuli else []


def _time_range(experiment: Experiment) -> tuple[float, float]:
    """Start and stop time [s] of an experiment; if not stated: zero, and the end of the reference results."""
    assert experiment.references is not None
    stop = float(experiment.references.time[-1]) if experiment.stop is None else experiment.stop
    return experiment.start or 0.0, stop


def _make_listing_files(
    proof: Proof, outcome: ExperimentOutcome, description: "ModelDescription"
) -> dict[str, bytes]:
    """Make {name: content} of the files that describe one experiment in the list of FMI tools."""
    experiment, name = outcome.experiment, _safe_file_name(description.modelName)
    assert experiment.references is not None
    start, stop = _time_range(experiment)
    tolerance = DEFAULT_TOLERANCE if experiment.tolerance is None else experiment.tolerance
    options = {
        "StartTime": start,
        "StopTime": stop,
        "StepSize": experiment.step or 0.0,
        "RelTol": tolerance,
    }
    series: dict[str, TimeSeries] = {
        "ref": experiment.references,
        **({"in": experiment.stimuli} if experiment.stimuli else {}),
    }
    return {
        f"{name}.fmu": proof.fmu.read_bytes(),
        **{f"{name}_{key}.csv": format_csv(values).encode() for key, values in series.items()},
        f"{name}_ref.opt": "".join(f"{key}, {value!r}\n" for key, value in options.items()).encode(),
        README_NAME: _format_readme(proof, outcome, description).encode(),
    }


def _format_readme(proof: Proof, outcome: ExperimentOutcome, description: "ModelDescription") -> str:
    """Text of README.md on a listed experiment: FMU, importer, deviations."""
    experiment, worst, name = outcome.experiment, outcome.worst_point, _safe_file_name(description.modelName)
    assert worst is not None
    tool = description.generationTool or "an unknown tool"
    inputs = ", ".join(f"`{n}`" for n in _input_names(experiment))
    driven = f"`{name}_in.csv` drives {inputs}; " if experiment.stimuli else ""
    text = f"{description.description or description.modelName}."
    return f"""# {description.modelName}

{text} FMI {description.fmiVersion} for co-simulation, exported by {tool}.

These are the files of the experiment "{experiment.name}" in `{REFERENCE_FOLDER}` of the FMU.
{driven}`{name}_ref.csv` has the reference results that the FMU carries, `{name}_ref.opt` times, step
and relative tolerance. Nothing else is set.

Run in {proof.importer} by `jointfmu prove {name}.fmu`: of {len(outcome.worst_points)} outputs at
{outcome.compared_time_count} times `{worst.output}` is furthest off, by
{worst.absolute_error:.1e}; allowed is {worst.tolerance:.1e}.

<!-- {PROGRAM_MARK} -->
"""


def _list_platforms(fmu: Path, fmi_version: str) -> list[str]:
    """Platforms for which an FMU contains a binary; for FMI 2.0 only platforms of FMI2_PLATFORMS."""
    with archives.open_archive(fmu) as archive:
        names = archive.namelist()
        platforms = {match[1] for name in names if (match := re.match(r"binaries/([^/]+)/.", name))}
    return sorted(platforms & set(FMI2_PLATFORMS) if fmi_version.startswith("2") else platforms)


def _safe_file_name(name: str) -> str:
    """Replace the characters of a name that are not safe in a file name."""
    return re.sub(r"[^\w.+-]+", "_", name) or "unknown"
