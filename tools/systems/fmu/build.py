"""Build the FMU of a whole system, for FMI 2.0 and 3.0 and five platforms."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from jointfmu_fmu_src.archive import staging_folder, write_archive
from jointfmu_fmu_src.joint_parts.data import NO_DATA_TABLES, ParameterSplit
from jointfmu_fmu_src.licence import read_licence_files
from jointfmu_fmu_src.native.build import make_common_archive_members
from jointfmu_fmu_src.native.compiled.compiler import ZIG_TARGETS, compile_libraries, select_source_files
from jointfmu_fmu_src.native.data import make_fmu_data_struct
from jointfmu_fmu_src.native.page import render_variables_page
from jointfmu_fmu_src.proof.standard import CO_SIMULATION

from jointfmu.files.outputs import ARCHIVE_FILE, check_outputs
from jointfmu.joints.model import Model

from ...run.host import is_member_needed_to_run
from ...run.proof.run import prove
from .code import generate_sources
from .model import SystemModel
from .proof import make_proof_files

MIN_STEP_TOLERANCE, STEP_TOLERANCE_DIVISOR = 1e-9, 10.0
"""Smallest tolerance of a step [1], and divisor [1] by which the tolerance is reduced while the FMU misses
its reference results."""


def list_system_fmu_paths(
    fmu_name: str, out_folder: Path, fmi_versions: Sequence[str] = ("2", "3")
) -> list[Path]:
    """Paths of the FMUs of a system below the folder `out_folder`."""
    return [out_folder / f"fmi{version}" / f"{fmu_name}.fmu" for version in fmi_versions]


def make_c_sources(system_model: SystemModel) -> tuple[dict[str, str], str]:
    """{file name: text} of all C sources of a system's FMU, with its data, and the instantiation token."""
    model, files = system_model.make_fmu_model(), generate_sources(system_model)
    parameters = system_model.make_system_parameter_file(model)
    parameter_split = ParameterSplit((), {}, {}, model.parameter_class, NO_DATA_TABLES)
    data = make_fmu_data_struct(model, parameters, parameter_split, files, has_parameter_file=False)
    files |= {
        "data.h": data.make_c_header(),
        "data.c": data.make_c_source(f" from the system {system_model.name!r}"),
    }
    return files, data.instantiation_token


def build_system_fmus(
    system_model: SystemModel,
    out_folder: Path,
    fmi_versions: Sequence[str] = ("2", "3"),
    platforms: Sequence[str] = tuple(ZIG_TARGETS),
    overwrite: bool = False,
) -> list[Path]:
    """Write `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu` with reference results.

    Equal content gives equal files.

    fmi_versions : versions of FMI, "2" and "3"
    platforms    : platforms of the binaries, names of FMI 3.0
    overwrite    : also replace files that jointfmu did not write

    Raises ImportError if a package is missing, RuntimeError if the compiler fails, ValueError if a folder
    cannot be written or the system is too large.
    """
    model = system_model.make_fmu_model()
    files_out = list_system_fmu_paths(model.title, out_folder, fmi_versions)
    check_outputs(files_out, ARCHIVE_FILE, overwrite)
    written_files, proof_files = [], None
    for version, target in zip(fmi_versions, files_out, strict=True):
        members = _make_archive_members(system_model, model, version, platforms)
        with staging_folder(target) as work:
            path = work / target.name
            if proof_files is None:  # the first FMU computes the reference results of both
                runnable = {
                    member: content for member, content in members.items() if is_member_needed_to_run(member)
                }
                write_archive(runnable, path)
                proof_files = make_proof_files(
                    model, system_model.stop_time, system_model.separate_fmu_step, path
                )
                write_archive(members | proof_files, path)
                while system_model.step_tolerance > MIN_STEP_TOLERANCE and _misses_references(path):
                    system_model = replace(
                        system_model, step_tolerance=system_model.step_tolerance / STEP_TOLERANCE_DIVISOR
                    )
                    members = _make_archive_members(system_model, model, version, platforms)
                    write_archive(members | proof_files, path)
            else:
                write_archive(members | proof_files, path)
        written_files.append(target)
    return written_files


def _make_archive_members(
    system_model: SystemModel, fmu_model: Model, fmi_version: str, platforms: Sequence[str]
) -> dict[str, bytes]:
    """{path: content} of a system's FMU without its proof, with compiled binaries."""
    parameters = system_model.make_system_parameter_file(fmu_model)
    files, token = make_c_sources(system_model)
    page = render_variables_page(fmu_model, parameters, Path(__file__).with_name("page.html")).encode()
    documents = {"index.html": page, **read_licence_files()}
    binaries = compile_libraries(
        fmu_model.name, files, select_source_files(sorted(files), fmi_version), platforms
    )
    members = make_common_archive_members(fmu_model, parameters, fmi_version, files, token, binaries)
    return members | {f"documentation/{path}": content for path, content in documents.items()}


def _misses_references(fmu_path: Path) -> bool:
    """Whether co-simulation of a system's FMU misses the reference results that it contains."""
    try:
        outcomes = prove(fmu_path).experiment_outcomes
    except ValueError:  # no reference results, or no binary for this platform
        return False
    return any(not outcome.has_passed for outcome in outcomes if outcome.fmi_interface == CO_SIMULATION)
