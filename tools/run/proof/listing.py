"""Files by which a tool enters the list of FMI tools: an FMU with inputs and reference results.

The files follow the FMI cross-check rules, version 4.1.

The folder fmus/VERSION/cs/PLATFORM/TOOL/RELEASE/MODEL contains MODEL.fmu, MODEL_in.csv, MODEL_ref.csv,
MODEL_ref.opt and README.md. The files describe one experiment that needs no parameter set: the first
validation, or if there is none the first experiment of another purpose.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu_fmu_src.proof.series import TimeSeries, format_time_series_csv
from jointfmu_fmu_src.proof.standard import CO_SIMULATION, REFERENCE_FILE_FOLDER

from jointfmu.files import archives
from jointfmu.files.outputs import PROGRAM_MARK, FileKind, check_outputs
from jointfmu.files.writing import ensure_folder, write_bytes

from .. import host
from .manifest import Experiment
from .outcome import ExperimentOutcome, ProofResult
from .plan import DEFAULT_RELATIVE_TOLERANCE

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

README_FILE_NAME = "README.md"
"""Name of the text file in each folder."""
LISTED_FMU_README_KIND = FileKind("listing", (".md",))
"""Kind of the text file README.md in the folder of a listed FMU."""
FMI2_PLATFORMS = ("c-code", "darwin64", "linux32", "linux64", "win32", "win64")
"""Platform names of the cross-check rules for FMI 2.0. For FMI 3.0 the names in the FMU are used."""


def write_fmi_tools_listing(
    proof_result: ProofResult, output_folder: Path, overwrite: bool = False
) -> list[Path]:
    """Write the folders by which a tool enters the list of FMI tools, from a passed proof of an FMU.

    A passed proof is a check of the FMU in which all outputs agree with their references. There is one folder
    for each platform of the FMU, with FMU, inputs, reference results and README.md. Returns the folders.

    overwrite : overwrite files also in a folder whose README.md was not written by jointfmu

    Raises ValueError if no experiment is suitable, or if a file must not or cannot be written.
    """
    described = host.read_description(proof_result.fmu_path)
    files = _make_listing_files(proof_result, _select_listed_outcome(proof_result), described)
    tool, _, version = (described.generationTool or "unknown").rpartition(" ")
    subfolders = [
        _safe_file_name(tool or version),
        _safe_file_name(version),
        _safe_file_name(described.modelName),
    ]
    version = described.fmiVersion[:3]
    folders = [
        output_folder.joinpath("fmus", version, "cs", p, *subfolders)
        for p in _list_platforms(proof_result.fmu_path, version)
    ]
    check_outputs((folder / README_FILE_NAME for folder in folders), LISTED_FMU_README_KIND, overwrite)
    for folder in folders:
        with ensure_folder(folder):
            for name, content in files.items():
                write_bytes(folder / name, content)
    return folders


def _select_listed_outcome(proof_result: ProofResult) -> ExperimentOutcome:
    """Select the experiment of an FMU for the list of FMI tools: the first validation, else the first one.

    Raises ValueError if no experiment can enter the list.
    """
    listable = [
        o
        for o in proof_result.experiment_outcomes
        if o.fmi_interface == CO_SIMULATION and _is_listable_experiment(o.experiment)
    ]
    if not listable:
        raise ValueError(
            f"{proof_result.fmu_path}: has no experiment to list; expected one for co-simulation that sets "
            "no parameters, with reference results from its start to its stop time"
        )
    validations = (outcome for outcome in listable if outcome.experiment.experiment_purpose == "validation")
    return next(validations, listable[0])


def _is_listable_experiment(experiment: Experiment) -> bool:
    """Whether an experiment of an FMU can enter the list of FMI tools.

    Its reference results cover the time from start to stop, and it sets no variables but its inputs.
    """
    if (
        experiment.unsupported_reason
        or experiment.reference_results is None
        or not experiment.start_settings.keys() <= set(_driven_input_names(experiment))
    ):
        return False
    start, stop = _experiment_time_range(experiment)
    return bool(
        experiment.reference_results.time[0] <= start and experiment.reference_results.time[-1] >= stop
    )


def _driven_input_names(experiment: Experiment) -> list[str]:
    """Names of the inputs that an experiment drives."""
    return list(experiment.stimuli.columns) if experiment.stimuli else []


def _experiment_time_range(experiment: Experiment) -> tuple[float, float]:
    """Start and stop time [s] of an experiment; if not stated: zero, and the end of the reference results."""
    assert experiment.reference_results is not None
    stop = (
        float(experiment.reference_results.time[-1]) if experiment.stop_time is None else experiment.stop_time
    )
    return experiment.start_time or 0.0, stop


def _make_listing_files(
    proof_result: ProofResult, experiment_outcome: ExperimentOutcome, model_description: "ModelDescription"
) -> dict[str, bytes]:
    """Make {name: content} of the files that describe one experiment in the list of FMI tools."""
    experiment, name = experiment_outcome.experiment, _safe_file_name(model_description.modelName)
    assert experiment.reference_results is not None
    start, stop = _experiment_time_range(experiment)
    tolerance = (
        DEFAULT_RELATIVE_TOLERANCE if experiment.relative_tolerance is None else experiment.relative_tolerance
    )
    options = {
        "StartTime": start,
        "StopTime": stop,
        "StepSize": experiment.step_size or 0.0,
        "RelTol": tolerance,
    }
    series: dict[str, TimeSeries] = {
        "ref": experiment.reference_results,
        **({"in": experiment.stimuli} if experiment.stimuli else {}),
    }
    return {
        f"{name}.fmu": proof_result.fmu_path.read_bytes(),
        **{f"{name}_{key}.csv": format_time_series_csv(values).encode() for key, values in series.items()},
        f"{name}_ref.opt": "".join(f"{key}, {value!r}\n" for key, value in options.items()).encode(),
        README_FILE_NAME: _format_readme(proof_result, experiment_outcome, model_description).encode(),
    }


def _format_readme(
    proof_result: ProofResult, experiment_outcome: ExperimentOutcome, model_description: "ModelDescription"
) -> str:
    """Text of README.md on a listed experiment: FMU, importer, deviations."""
    experiment, worst, name = (
        experiment_outcome.experiment,
        experiment_outcome.worst_point,
        _safe_file_name(model_description.modelName),
    )
    assert worst is not None
    tool = model_description.generationTool or "an unknown tool"
    inputs = ", ".join(f"`{n}`" for n in _driven_input_names(experiment))
    driven = f"`{name}_in.csv` drives {inputs}; " if experiment.stimuli else ""
    text = f"{model_description.description or model_description.modelName}."
    output_count = len(experiment_outcome.worst_points)
    return f"""# {model_description.modelName}

{text} FMI {model_description.fmiVersion} for co-simulation, exported by {tool}.

These are the files of the experiment "{experiment.experiment_name}" in `{REFERENCE_FILE_FOLDER}` of the FMU.
{driven}`{name}_ref.csv` has the reference results that the FMU carries, `{name}_ref.opt` times, step
and relative tolerance. Nothing else is set.

Run in {proof_result.importer_name} by `jointfmu prove {name}.fmu`: of {output_count} outputs at
{experiment_outcome.compared_time_count} times `{worst.output_name}` is furthest off, by
{worst.absolute_error:.1e}; allowed is {worst.absolute_tolerance:.1e}.

<!-- {PROGRAM_MARK} -->
"""


def _list_platforms(fmu_path: Path, fmi_version: str) -> list[str]:
    """Names of the platforms for which an FMU contains a binary; for FMI 2.0 only those of FMI2_PLATFORMS."""
    with archives.open_archive(fmu_path) as archive:
        names = archive.namelist()
        platforms = {match[1] for name in names if (match := re.match(r"binaries/([^/]+)/.", name))}
    return sorted(platforms & set(FMI2_PLATFORMS) if fmi_version.startswith("2") else platforms)


def _safe_file_name(proposed_name: str) -> str:
    """Replace the characters of a name that are not safe in a file name."""
    return re.sub(r"[^\w.+-]+", "_", proposed_name) or "unknown"
