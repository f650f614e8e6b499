"""Build the FMU of a system, FMI 2.0 and 3.0 on five platforms."""

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
    """Paths of the FMUs of a system below a folder."""
    return [out / f"fmi{version}" / f"{title}.fmu" for version in versions]


def all_sources(assembly: SystemModel) -> tuple[dict[str, str], str]:
    """{file name: text} of all C of a system's FMU with its data, and its instantiation token."""
    model, files = assembly.model(), sources(assembly)
    parameters, given = assembly.parameters(model), Split((), {}, {}, model.parameters, NO_TABLES)
    data = data_of(model, parameters, given, files, of_file=False)
    files |= {"data.h": data.header(), "data.c": data.source(f" from the system {assembly.name!r}")}
    return files, data.token


def build_system(
    assembly: SystemModel,
    out: Path,
    versions: Sequence[str] = ("2", "3"),
    platforms: Sequence[str] = tuple(TARGETS),
    force: bool = False,
) -> list[Path]:
    """Write `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu` with their proof; equal content gives equal files.

    platforms : of its binaries, names of FMI 3.0
    force     : replace FMUs of its name that jointfmu did not write

    Raises ImportError if a package is missing, RuntimeError if the compiler fails, ValueError if a folder
    cannot be written or the system is too large.
    """
    model = assembly.model()
    files_out = fmu_paths(model.title, out, versions)
    check_outputs(files_out, ARCHIVE, force)
    parameters = assembly.parameters(model)
    files, token = all_sources(assembly)
    page = plain_page(model, parameters, Path(__file__).with_name("page.html")).encode()
    pages = {f"documentation/{path}": it for path, it in {"index.html": page, **licences()}.items()}
    written, found = [], None
    for version, target in zip(versions, files_out, strict=True):
        built = libraries(model.name, files, exported(sorted(files), version), platforms)
        members = fmu_members(model, parameters, version, files, token, built) | pages
        with workshop(target) as work:
            if found is None:  # the first FMU computes what both carry
                pack({path: it for path, it in members.items() if is_needed_to_run(path)}, work / target.name)
                found = proof(model, assembly.stop, assembly.own_interval, work / target.name)
            pack(members | found, work / target.name)
        written.append(target)
    return written
