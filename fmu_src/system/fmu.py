"""Build the FMU of a system, FMI 2.0 and 3.0 on five platforms."""

from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from uuid import NAMESPACE_URL, uuid5

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ..archive import pack, workshop
from ..native.build import binaries
from ..native.compiler import TARGETS, exported, libraries
from ..native.data import Data, block
from ..native.description import build_description, fmi2_xml, fmi3_xml
from ..native.licence import licence
from ..native.page import plain_page
from .assembly import SystemModel
from .code import sources
from .proof import proof


def build_system(
    assembly: SystemModel,
    out: Path,
    versions: Sequence[str] = ("2", "3"),
    platforms: Sequence[str] = tuple(TARGETS),
) -> list[Path]:
    """Write `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu` with their proof; equal content gives equal files.

    platforms : of its binaries, names of FMI 3.0

    Raises ImportError if a package is missing, RuntimeError if the compiler fails, ValueError if a folder
    cannot be written or the system is too large.
    """
    model = assembly.model()
    parameters = assembly.parameters(model)
    files = sources(assembly)
    data = _data(model, parameters, files)
    files |= {"data.h": data.header(), "data.c": data.source(f" from the system {assembly.name!r}")}
    page = plain_page(model, parameters, Path(__file__).with_name("page.html")).encode()
    written, found = [], None
    for version in versions:
        units = exported(files, version)
        built = libraries(model.name, files, units, platforms)
        own = {path: text for path, text in files.items() if path in units or path.endswith(".h")}
        members = {f"sources/{path}": text.encode() for path, text in own.items()}
        members |= {
            "documentation/index.html": page,
            "documentation/licenses/license.txt": licence().encode(),
        }
        members |= binaries(model.title, built, version)
        if version == "2":
            members["modelDescription.xml"] = fmi2_xml(model, parameters, data.token, units)
        else:
            members["modelDescription.xml"] = fmi3_xml(model, parameters, data.token)
            members["sources/buildDescription.xml"] = build_description(model, units)
        target = out / f"fmi{version}" / f"{model.title}.fmu"
        with workshop(target) as work:
            if found is None:  # the first FMU computes what both carry
                pack(members, work / target.name)
                found = proof(model, assembly.stop, assembly.own_interval, work / target.name)
            pack(members | found, work / target.name)
        written.append(target)
    return written


def _data(model: Model, parameters: ParameterFile, files: Mapping[str, str]) -> Data:
    """Name, token and start values."""
    inputs = [parameters.start(v.name) for v in model.inputs]
    values = [float(parameters.flat[name]) for name in model.parameter_fields()]
    start = [0.0, *inputs, *(0.0 for _ in model.outputs), *values]
    content = sha256("\0".join(f"{k}\0{v}" for k, v in sorted(files.items())).encode())
    content.update(block(model.title, "", start).content)
    uuid = uuid5(NAMESPACE_URL, f"jointfmu/{model.title}/{content.hexdigest()}")
    return block(model.title, f"{{{uuid}}}", start)
