"""Shared library of a joint for this machine, for programs that evaluate the joint without an FMU."""

import platform
import sys
from typing import NamedTuple

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from .compiled.binary import fill_library_placeholders
from .compiled.compiled_models import FMI_VERSIONS, get_compiled_model
from .compiled.compiler import ZIG_TARGETS
from .data import make_fmu_data_struct, make_placeholder_data_struct, split_parameters


class JointLibrary(NamedTuple):
    """Shared library of a joint's FMU with the data of a parameter file.

    library_bytes       : content of the library file
    instantiation_token : token that instantiation of the FMU needs
    """

    library_bytes: bytes
    instantiation_token: str


def find_machine_platform() -> str:
    """Name in FMI 3.0 of the platform of this process, for example x86_64-linux.

    Raises RuntimeError if jointfmu compiles no libraries for this platform.
    """
    system = {"win32": "windows", "linux": "linux", "darwin": "darwin"}.get(sys.platform, sys.platform)
    processor = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine())
    name = f"{processor.lower()}-{system}"
    if name not in ZIG_TARGETS:
        raise RuntimeError(
            f"platform {name}: no library is compiled for it; expected {', '.join(ZIG_TARGETS)}"
        )
    return name


def make_joint_library(fmu_model: Model, parameter_file: ParameterFile) -> JointLibrary:
    """Make the shared library that the native FMU of a joint contains for this machine.

    The library is compiled for this machine alone, unless a build has compiled it already.

    Raises ImportError if the library must be compiled and a package is missing, RuntimeError for a platform
    without libraries and if the compiler fails.
    """
    split = split_parameters(fmu_model, parameter_file)
    target = find_machine_platform()
    compiled = get_compiled_model(fmu_model, parameter_file, split, target)
    data = make_fmu_data_struct(fmu_model, parameter_file, split, compiled.source_texts)
    library = compiled.libraries_by_fmi_version[FMI_VERSIONS[-1]][target]
    return JointLibrary(
        fill_library_placeholders(
            library, make_placeholder_data_struct(fmu_model, split), data, fmu_model.title
        ),
        data.instantiation_token,
    )
