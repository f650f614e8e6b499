"""Build native FMUs (flavours fmi2 and fmi3): C sources and libraries for five platforms."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ..archive import pack, workshop
from ..partners import PARTNERS
from ..proof.members import proof
from ..xml_parts import VARIABILITIES
from .compiled.binary import fill_library
from .compiled.compiler import exported, file_name, universal
from .compiled.kept import compiled_model
from .data import data_of, placeholder, split
from .description import build_description, fmi2_xml, fmi3_xml
from .page import documentation
from .terminals import terminals_and_icons


def build(
    name: str,
    parameters: ParameterFile,
    out: Path,
    version: str,
    variability: str = VARIABILITIES[0],
    alias: str = "",
) -> Path:
    """Write `out/NAME.fmu` for co-simulation and model exchange; an existing file is replaced atomically.

    Equal content gives equal files.

    fmi_version : of FMI, "2" or "3"
    variability : of all parameters, one of VARIABILITIES
    alias       : name of the FMU instead of `name`; empty: `name`

    Raises ValueError if the parameters are of another joint or a folder cannot be written, ImportError
    if a package is missing, RuntimeError if the compiler fails.
    """
    model = replace(
        (MODELS | PARTNERS)[name].with_parameters(parameters.joint, parameters.values), alias=alias
    )
    target = out / f"{model.title}.fmu"
    with workshop(target) as work:
        pack(_members(model, parameters, version, variability), work / target.name)
    return target


def _members(model: Model, parameters: ParameterFile, version: str, variability: str) -> dict[str, bytes]:
    """{path: content} of all files of a native FMU."""
    parameter_split = split(model, parameters)
    compiled = compiled_model(model, parameters, parameter_split)
    data = data_of(model, parameters, parameter_split, compiled.sources)
    placeholder_data = placeholder(model, parameter_split)
    files = compiled.sources | {"data.c": data.source(f" from the parameters {parameters.name!r}")}
    filled_libraries = {
        platform: fill_library(library, placeholder_data, data, model.title)
        for platform, library in compiled.libraries[version].items()
    }
    icons = terminals_and_icons(model)
    return (
        fmu_members(model, parameters, version, files, data.token, filled_libraries, variability)
        | ({"model.png": icons["icon.png"]} if version == "2" else {})
        | _in_folder("documentation", documentation(model, parameters))
        | _in_folder("terminalsAndIcons", icons)
        | proof(model, parameters)
    )


def fmu_members(
    model: Model,
    parameters: ParameterFile,
    version: str,
    files: Mapping[str, str],
    token: str,
    libraries: Mapping[str, bytes],
    variability: str = VARIABILITIES[0],
) -> dict[str, bytes]:
    """{path: content} of the files that every native FMU has: description, sources, binaries.

    files     : {name: text} of all C sources
    token     : GUID (FMI 2.0) or instantiation token (FMI 3.0)
    libraries : {platform of FMI 3.0: library}
    """
    units = exported(sorted(files), version)
    sources = {path: text.encode() for path, text in files.items() if path in units or path.endswith(".h")}
    members = binaries(model.title, libraries, version) | _in_folder("sources", sources)
    if version == "2":
        return members | {"modelDescription.xml": fmi2_xml(model, parameters, token, units, variability)}
    return members | {
        "modelDescription.xml": fmi3_xml(model, parameters, token, variability),
        "sources/buildDescription.xml": build_description(model, units),
    }


_FMI2 = {"x86_64-windows": "win64", "x86_64-linux": "linux64", "aarch64-linux": "aarch64-linux"}
"""{platform name of FMI 3.0: platform name of FMI 2.0}; for macOS see `place_libraries`."""
_MACS = ("x86_64-darwin", "aarch64-darwin")


def binaries(name: str, libraries: Mapping[str, bytes], version: str) -> dict[str, bytes]:
    """{path in an FMU: content} of its libraries; in FMI 2.0 one universal file serves both macOS platforms.

    libraries : {platform of FMI 3.0: content}
    """
    if version == "3":
        return {f"binaries/{p}/{file_name(name, p)}": content for p, content in libraries.items()}
    members = {
        f"binaries/{_FMI2[p]}/{file_name(name, p)}": content for p, content in libraries.items() if p in _FMI2
    }
    if macs := [libraries[p] for p in _MACS if p in libraries]:
        members[f"binaries/darwin64/{name}.dylib"] = universal(macs)
    return members


def _in_folder(folder: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    return {f"{folder}/{path}": content for path, content in files.items()}
