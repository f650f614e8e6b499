"""Shared library of a joint for this machine, for programs that evaluate the joint without an FMU."""

import platform
import sys
from typing import NamedTuple

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from .compiled.binary import fill_library
from .compiled.compiled_models import FMI_VERSIONS, get_compiled_model
from .compiled.compiler import ZIG_TARGETS
from .data import make_fmu_data, make_placeholder, split_parameters


class JointLibrary(NamedTuple):
    """Shared library of a joint with its data.

    content : bytes of the file
    token   : instantiation token
    """

    content: bytes
    token: str


def machine_platform() -> str:
    """Platform of this process, by its name in FMI 3.0.

    Raises RuntimeError if libraries are not compiled for it.
    """
    system = {"win32": "windows", "linux": "linux", "darwin": "darwin"}.get(sys.platform, sys.platform)
    processor = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine())
    name = f"{processor.lower()}-{system}"
    if name not in ZIG_TARGETS:
        raise RuntimeError(
            f"platform {name}: no library is compiled for it; expected {', '.join(ZIG_TARGETS)}"
        )
    return name


def make_joint_library(model: Model, parameters: ParameterFile) -> JointLibrary:
    """Make the shared library that the native FMU of a model contains for this machine.

    The library is compiled for this machine alone, unless a build has compiled it already.

    Raises ImportError if it must be compiled and a package is missing, RuntimeError for a platform without
    libraries and if the compiler fails.
    """
    split = split_parameters(model, parameters)
    target = machine_platform()
    compiled = get_compiled_model(model, parameters, split, target)
    data = make_fmu_data(model, parameters, split, compiled.sources)
    library = compiled.libraries[FMI_VERSIONS[-1]][target]
    return JointLibrary(fill_library(library, make_placeholder(model, split), data, model.title), data.token)
