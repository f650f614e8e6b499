"""Build the FMU of a whole system, for FMI 2.0 and 3.0 and five platforms."""

from collections.abc import Sequence
from pathlib import Path

from jointfmu_fmu_src.archive import pack, workshop
from jointfmu_fmu_src.joint_parts.data import NO_TABLES, Split
from jointfmu_fmu_src.licence import licences
from jointfmu_fmu_src.native.build import fmu_members
from jointfmu_fmu_src.native.compiled.compiler import TARGETS, exported, libraries
from jointfmu_fmu_src.native.data import data_of
from jointfmu_fmu_src.native.page import plain_page

from jointfmu.files.outputs import ARCHIVE, check_outputs

from ...host import is_needed_to_run
from .code import sources
from .model import SystemModel
from .proof import proof


def fmu_paths(title: str, out: Path, versions: Sequence[str] = ("2", "3")) -> list[Path]:
    """Paths of the FMUs of a system below the folder `out`."""
    return [out / f"fmi{version}" / f"{title}.fmu" for version in versions]


def all_sources(assembly: SystemModel) -> tuple[dict[str, str], str]:
    """{file name: text} of all C sources of a system's FMU, with its data, and the instantiation token."""
    model, files = assembly.model(), sources(assembly)
    parameters, parameter_split = assembly.parameters(model), Split((), {}, {}, model.parameters, NO_TABLES)
    data = data_of(model, parameters, parameter_split, files, of_file=False)
    files |= {"data.h": data.header(), "data.c": data.source(f" from the system {assembly.name!r}")}
    return files, data.token


def build_system(
    assembly: SystemModel,
    out: Path,
    versions: Sequence[str] = ("2", "3"),
    platforms: Sequence[str] = tuple(TARGETS),
    force: bool = False,
) -> list[Path]:
    """Write `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu` with reference results.

    Equal content gives equal files.

    versions  : of FMI, "2" and "3"
    platforms : of the binaries, names of FMI 3.0
    force     : also replace files that jointfmu did not write

    Raises ImportError if a package is missing, RuntimeError if the compiler fails, ValueError if a folder
    cannot be written or the system is too large.
    """
    model = assembly.model()
    files_out = fmu_paths(model.title, out, versions)
    check_outputs(files_out, ARCHIVE, force)
    parameters = assembly.parameters(model)
    files, token = all_sources(assembly)
    page = plain_page(model, parameters, Path(__file__).with_name("page.html")).encode()
    documents = {"index.html": page, **licences()}
    pages = {f"documentation/{path}": content for path, content in documents.items()}
    written_files, proof_files = [], None
    for version, target in zip(versions, files_out, strict=True):
        binaries = libraries(model.name, files, exported(sorted(files), version), platforms)
        members = fmu_members(model, parameters, version, files, token, binaries) | pages
        with workshop(target) as work:
            if proof_files is None:  # the first FMU computes the reference results of both
                runnable = {path: content for path, content in members.items() if is_needed_to_run(path)}
                pack(runnable, work / target.name)
                proof_files = proof(model, assembly.stop, assembly.own_interval, work / target.name)
            pack(members | proof_files, work / target.name)
        written_files.append(target)
    return written_files
