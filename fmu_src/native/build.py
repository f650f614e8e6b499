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
from ..xml_parts import VARIABILITIES
from .compiled.binary import fill_library
from .compiled.compiled_models import get_compiled_model
from .compiled.compiler import join_universal_library, library_file_name, select_source_files
from .data import make_fmu_data, make_placeholder, split_parameters
from .description import format_build_description, format_fmi2_description, format_fmi3_description
from .page import make_documentation
from .terminals import terminal_files


def build_native_fmu(
    fmu_name: str,
    parameters: ParameterFile,
    output_folder: Path,
    fmi_version: str,
    variability: str = VARIABILITIES[0],
    alias: str = "",
) -> Path:
    """Write `out/NAME.fmu` for co-simulation and model exchange; an existing file is replaced atomically.

    Equal content gives equal files.

    fmi_version : version of FMI, "2" or "3"
    variability : FMI variability of all parameters, one of VARIABILITIES
    alias       : name of the FMU instead of `fmu_name`; empty: `fmu_name`

    Raises ValueError if the parameters are of another joint or a folder cannot be written, ImportError
    if a package is missing, RuntimeError if the compiler fails.
    """
    model = replace(
        (MODELS | PARTNERS)[fmu_name].with_parameters(parameters.joint, parameters.values), alias=alias
    )
    target = output_folder / f"{model.title}.fmu"
    with staging_folder(target) as work:
        write_archive(_make_all_members(model, parameters, fmi_version, variability), work / target.name)
    return target


def _make_all_members(
    model: Model, parameters: ParameterFile, fmi_version: str, variability: str
) -> dict[str, bytes]:
    """Make {path: content} of all files of a native FMU."""
    parameter_split = split_parameters(model, parameters)
    compiled = get_compiled_model(model, parameters, parameter_split)
    data = make_fmu_data(model, parameters, parameter_split, compiled.sources)
    placeholder_data = make_placeholder(model, parameter_split)
    files = compiled.sources | {"data.c": data.make_source(f" from the parameters {parameters.name!r}")}
    filled_libraries = {
        platform: fill_library(library, placeholder_data, data, model.title)
        for platform, library in compiled.libraries[fmi_version].items()
    }
    icons = terminal_files(model)
    return (
        make_common_members(model, parameters, fmi_version, files, data.token, filled_libraries, variability)
        | ({"model.png": icons["icon.png"]} if fmi_version == "2" else {})
        | _prefix_paths("documentation", make_documentation(model, parameters))
        | _prefix_paths("terminalsAndIcons", icons)
        | make_proof_files(model, parameters)
    )


def make_common_members(
    model: Model,
    parameters: ParameterFile,
    fmi_version: str,
    source_texts: Mapping[str, str],
    instantiation_token: str,
    libraries: Mapping[str, bytes],
    variability: str = VARIABILITIES[0],
) -> dict[str, bytes]:
    """Make {path: content} of the files that every native FMU has: description, sources, binaries.

    source_texts        : {name: text} of all C sources
    instantiation_token : GUID (FMI 2.0) or instantiation token (FMI 3.0)
    libraries           : {platform of FMI 3.0: library}
    """
    units = select_source_files(sorted(source_texts), fmi_version)
    sources = {
        path: text.encode() for path, text in source_texts.items() if path in units or path.endswith(".h")
    }
    members = place_libraries(model.title, libraries, fmi_version) | _prefix_paths("sources", sources)
    if fmi_version == "2":
        return members | {
            "modelDescription.xml": format_fmi2_description(
                model, parameters, instantiation_token, units, variability
            )
        }
    return members | {
        "modelDescription.xml": format_fmi3_description(model, parameters, instantiation_token, variability),
        "sources/buildDescription.xml": format_build_description(model, units),
    }


_FMI2_PLATFORMS = {"x86_64-windows": "win64", "x86_64-linux": "linux64", "aarch64-linux": "aarch64-linux"}
"""{platform name of FMI 3.0: platform name of FMI 2.0}; for macOS see `place_libraries`."""
_MACOS_PLATFORMS = ("x86_64-darwin", "aarch64-darwin")
"""Names in FMI 3.0 of the macOS platforms, which share one universal file in FMI 2.0."""


def place_libraries(library_name: str, libraries: Mapping[str, bytes], fmi_version: str) -> dict[str, bytes]:
    """{path in an FMU: content} of its libraries; in FMI 2.0 one universal file serves both macOS platforms.

    libraries : {platform of FMI 3.0: content}
    """
    if fmi_version == "3":
        return {
            f"binaries/{p}/{library_file_name(library_name, p)}": content for p, content in libraries.items()
        }
    members = {
        f"binaries/{_FMI2_PLATFORMS[p]}/{library_file_name(library_name, p)}": content
        for p, content in libraries.items()
        if p in _FMI2_PLATFORMS
    }
    if macs := [libraries[p] for p in _MACOS_PLATFORMS if p in libraries]:
        members[f"binaries/darwin64/{library_name}.dylib"] = join_universal_library(macs)
    return members


def _prefix_paths(folder_name: str, content_by_path: Mapping[str, bytes]) -> dict[str, bytes]:
    """Prefix the paths of {path: content} with a folder."""
    return {f"{folder_name}/{path}": content for path, content in content_by_path.items()}
