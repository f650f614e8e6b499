"""Build native FMUs (flavours fmi2 and fmi3): C sources and libraries for five platforms."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ..archive import staging_folder, write_archive
from ..partners import PARTNERS
from ..proof.members import make_proof_files
from ..xml_parts import PARAMETER_VARIABILITIES
from .compiled.binary import fill_library_placeholders
from .compiled.compiled_models import get_compiled_model
from .compiled.compiler import join_universal_library, make_library_file_name, select_source_files
from .data import make_fmu_data_struct, make_placeholder_data_struct, split_parameters
from .description import format_build_description, format_fmi2_description, format_fmi3_description
from .page import make_documentation
from .terminals import make_terminal_files


def build_native_fmu(
    fmu_name: str,
    parameter_file: ParameterFile,
    output_folder: Path,
    fmi_version: str,
    parameter_variability: str = PARAMETER_VARIABILITIES[0],
    fmu_alias: str = "",
) -> Path:
    """Write `out/NAME.fmu` for co-simulation and model exchange; an existing file is replaced atomically.

    Equal content gives equal files.

    fmi_version           : version of FMI, "2" or "3"
    parameter_variability : FMI variability of all parameters, one of PARAMETER_VARIABILITIES
    fmu_alias             : name of the FMU instead of `fmu_name`; empty: `fmu_name`

    Raises ValueError if the parameters are of another joint or a folder cannot be written, ImportError
    if a package is missing, RuntimeError if the compiler fails.
    """
    fmu_model = replace(
        (MODELS | PARTNERS)[fmu_name].with_parameters(parameter_file.joint, parameter_file.values),
        alias=fmu_alias,
    )
    target = output_folder / f"{fmu_model.title}.fmu"
    with staging_folder(target) as work:
        write_archive(
            _make_all_archive_members(fmu_model, parameter_file, fmi_version, parameter_variability),
            work / target.name,
        )
    return target


def _make_all_archive_members(
    fmu_model: Model, parameter_file: ParameterFile, fmi_version: str, parameter_variability: str
) -> dict[str, bytes]:
    """Make all files {path in the archive: content} of a native FMU."""
    parameter_split = split_parameters(fmu_model, parameter_file)
    compiled = get_compiled_model(fmu_model, parameter_file, parameter_split)
    data = make_fmu_data_struct(fmu_model, parameter_file, parameter_split, compiled.source_texts)
    placeholder_data = make_placeholder_data_struct(fmu_model, parameter_split)
    files = compiled.source_texts | {
        "data.c": data.make_c_source(f" from the parameters {parameter_file.name!r}")
    }
    filled_libraries = {
        platform: fill_library_placeholders(library, placeholder_data, data, fmu_model.title)
        for platform, library in compiled.libraries_by_fmi_version[fmi_version].items()
    }
    icons = make_terminal_files(fmu_model)
    return (
        make_common_archive_members(
            fmu_model,
            parameter_file,
            fmi_version,
            files,
            data.instantiation_token,
            filled_libraries,
            parameter_variability,
        )
        | ({"model.png": icons["icon.png"]} if fmi_version == "2" else {})
        | _prefix_member_paths("documentation", make_documentation(fmu_model, parameter_file))
        | _prefix_member_paths("terminalsAndIcons", icons)
        | make_proof_files(fmu_model, parameter_file)
    )


def make_common_archive_members(
    fmu_model: Model,
    parameter_file: ParameterFile,
    fmi_version: str,
    source_texts: Mapping[str, str],
    instantiation_token: str,
    library_by_platform: Mapping[str, bytes],
    parameter_variability: str = PARAMETER_VARIABILITIES[0],
) -> dict[str, bytes]:
    """Make the files {path: content} of description, sources and binaries of a native FMU.

    source_texts        : {name: text} of all C sources
    instantiation_token : GUID (FMI 2.0) or instantiation token (FMI 3.0)
    library_by_platform : {platform of FMI 3.0: library}
    """
    units = select_source_files(sorted(source_texts), fmi_version)
    sources = {
        path: text.encode() for path, text in source_texts.items() if path in units or path.endswith(".h")
    }
    members = place_libraries_in_fmu(
        fmu_model.title, library_by_platform, fmi_version
    ) | _prefix_member_paths("sources", sources)
    if fmi_version == "2":
        return members | {
            "modelDescription.xml": format_fmi2_description(
                fmu_model, parameter_file, instantiation_token, units, parameter_variability
            )
        }
    return members | {
        "modelDescription.xml": format_fmi3_description(
            fmu_model, parameter_file, instantiation_token, parameter_variability
        ),
        "sources/buildDescription.xml": format_build_description(fmu_model, units),
    }


_FMI2_PLATFORMS = {"x86_64-windows": "win64", "x86_64-linux": "linux64", "aarch64-linux": "aarch64-linux"}
"""{platform name of FMI 3.0: platform name of FMI 2.0}; for macOS see `place_libraries_in_fmu`."""
_MACOS_PLATFORMS = ("x86_64-darwin", "aarch64-darwin")
"""Names in FMI 3.0 of the macOS platforms, which share one universal file in FMI 2.0."""


def place_libraries_in_fmu(
    library_file_stem: str, library_by_platform: Mapping[str, bytes], fmi_version: str
) -> dict[str, bytes]:
    """Libraries of an FMU as {path in the archive: content}.

    In FMI 2.0 one universal file serves both macOS platforms.

    library_by_platform : {platform of FMI 3.0: content}
    """
    if fmi_version == "3":
        return {
            f"binaries/{p}/{make_library_file_name(library_file_stem, p)}": content
            for p, content in library_by_platform.items()
        }
    members = {
        f"binaries/{_FMI2_PLATFORMS[p]}/{make_library_file_name(library_file_stem, p)}": content
        for p, content in library_by_platform.items()
        if p in _FMI2_PLATFORMS
    }
    if macs := [library_by_platform[p] for p in _MACOS_PLATFORMS if p in library_by_platform]:
        members[f"binaries/darwin64/{library_file_stem}.dylib"] = join_universal_library(macs)
    return members


def _prefix_member_paths(folder_name: str, content_by_path: Mapping[str, bytes]) -> dict[str, bytes]:
    """Add a folder in front of the paths of archive members {path: content}."""
    return {f"{folder_name}/{path}": content for path, content in content_by_path.items()}
