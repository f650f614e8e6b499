"""Compiled models, shared by all FMUs with the same C code: from the wheel, the cache or the compiler.

The values on which the C code depends are called structure. The file name of a compiled model contains a
digest of the structure and of all sources. Wheels contain compiled models in `native/parts`; models compiled
on this machine are stored in the user's cache.
"""

import io
import lzma
import re
import tarfile
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.progress import defer_interrupt, set_status_text

from ...folders import find_joint_folder
from ...joint_parts.data import ParameterSplit
from ..data import PLACEHOLDER_FMU_NAME, make_placeholder_data_struct
from .cache import check_cache_access, compiled_model_folder, make_cache_folder, stored_result_folder
from .compiler import ZIG_TARGETS, compile_libraries, select_source_files

SHIPPED_MODEL_FOLDER = Path(__file__).parent.with_name("parts")
"""Folder of the compiled models in a wheel."""
FMI_VERSIONS = ("2", "3")
"""Versions of FMI."""
MAX_FILES_PER_CACHE_FOLDER = 200
"""Largest number of files in a cache folder [1]; the oldest are deleted."""
_COMPILED_MODEL_FILE_SUFFIX, _STORED_RESULT_FILE_SUFFIX = ".tar.xz", ".kept.xz"
_COMPILER_PACKAGES = ("casadi", "ziglang")
"""Packages that compile models; each set of their versions has its own cache folder."""
_SOURCE_SUFFIXES = (".py", ".c", ".h")
"""Endings of the files whose content determines the generated code."""
_ARCHIVE_MEMBER_NAME_PATTERN = re.compile(r"sources/\w[\w.-]*|\d/[\w-]+")
"""Pattern of member names in the file of a compiled model: C files, and libraries as FMI version/platform."""


class CompiledModel(NamedTuple):
    """C sources and compiled libraries of all FMUs with the same C code.

    source_texts             : {file name: text} of all C files but data.c
    libraries_by_fmi_version : {FMI version: {platform: library}} with placeholders for data and name
    """

    source_texts: dict[str, str]
    libraries_by_fmi_version: dict[str, dict[str, bytes]]


def get_compiled_model(
    fmu_model: Model,
    parameter_file: ParameterFile,
    parameter_split: ParameterSplit,
    single_platform: str | None = None,
) -> CompiledModel:
    """Get the compiled model of an FMU from the wheel or the cache, or compile and cache it.

    single_platform : platform for which to compile, with the newest FMI version alone; None: all platforms
        and FMI versions

    Raises ImportError if the model must be compiled and a package is missing, ValueError if other users may
    write to the cache, ValueError and RuntimeError as `compiler.compile_libraries`.
    """
    paths = _list_candidate_cache_paths(make_compiled_model_file_name(fmu_model, parameter_split))
    if single_platform:
        name = paths[-1].name.removesuffix(_COMPILED_MODEL_FILE_SUFFIX)
        paths = (*paths, paths[-1].with_name(f"{name}-{single_platform}{_COMPILED_MODEL_FILE_SUFFIX}"))
    for content in filter(None, map(_read_cache_file, paths)):
        with suppress(lzma.LZMAError, tarfile.TarError, ValueError, EOFError):
            return unpack_compiled_model(content)
    targets = (
        ((single_platform,), FMI_VERSIONS[-1:]) if single_platform else (tuple(ZIG_TARGETS), FMI_VERSIONS)
    )
    compiled_model = compile_model(fmu_model, parameter_file, parameter_split, *targets)
    with suppress(OSError):  # without cache the next build compiles again
        _write_cache_file(paths[-1], pack_compiled_model(compiled_model))
    return compiled_model


def get_cached_result(dependency_text: str, fmu_model: Model, compute_bytes: Callable[[], bytes]) -> bytes:
    """Get the cached result of a computation with an FMU's model, or compute and cache it.

    A cached result is used only if the sources of model and builder, and `dependency_text`, are unchanged.

    dependency_text : text of everything else on which the result depends
    compute_bytes   : function that computes the result

    Raises ValueError if other users may write to the cache, and the errors of `compute_bytes`.
    """
    name = sha256(f"{dependency_text} {_digest_code_sources(fmu_model)}".encode()).hexdigest()[:32]
    file = _list_candidate_cache_paths(f"{fmu_model.name}-{name}{_STORED_RESULT_FILE_SUFFIX}")[-1]
    if content := _read_cache_file(file):
        with suppress(lzma.LZMAError):
            return lzma.decompress(content)
    result = compute_bytes()
    with suppress(OSError):
        _write_cache_file(file, lzma.compress(result))
    return result


def get_stored_result(computation_key: str, compute_result: Callable[[], bytes]) -> bytes:
    """Get the stored result of a long computation of the package `jointfmu`, or compute and store it.

    A stored result is a file in the user's cache. It is used only if the sources of the package are
    unchanged. A cache that other users can write to is not used.

    computation_key : text that identifies the computation and its arguments
    compute_result  : function that computes the result
    """
    name = sha256(
        f"{computation_key} {_digest_folders((Path(str(files('jointfmu'))),))}".encode()
    ).hexdigest()[:32]
    file = stored_result_folder() / f"{name}{_STORED_RESULT_FILE_SUFFIX}"
    with suppress(ValueError, lzma.LZMAError):
        if content := _read_cache_file(file):
            return lzma.decompress(content)
    result = compute_result()
    with suppress(OSError, ValueError):
        _write_cache_file(file, lzma.compress(result))
    return result


def _read_cache_file(cache_path: Path) -> bytes:
    """Read a file of the cache; empty bytes if it is missing. Raises ValueError as `check_cache_access`."""
    with suppress(OSError):
        check_cache_access(cache_path)
        return cache_path.read_bytes()
    return b""


def compile_model(
    fmu_model: Model,
    parameter_file: ParameterFile,
    parameter_split: ParameterSplit,
    platforms: Sequence[str],
    fmi_versions: Sequence[str],
) -> CompiledModel:
    """Generate the C sources of an FMU, and compile them for platforms and FMI versions."""
    set_status_text(f"compile {fmu_model.name}")
    from ..code.generate import generate_sources_without_data

    with defer_interrupt():  # CasADi ignores the interrupt
        sources = generate_sources_without_data(fmu_model, parameter_file, parameter_split)
    all_sources = sources | {
        "data.c": make_placeholder_data_struct(fmu_model, parameter_split).make_c_source()
    }
    libraries_by_version = {
        fmi: compile_libraries(
            fmu_model.name,
            all_sources,
            select_source_files(all_sources, fmi),
            platforms,
            library_file_stem=PLACEHOLDER_FMU_NAME,
        )
        for fmi in fmi_versions
    }
    return CompiledModel(sources, libraries_by_version)


def make_compiled_model_file_name(fmu_model: Model, parameter_split: ParameterSplit) -> str:
    """File name of a compiled model: name of the FMU, and a digest of all sources of its C code."""
    law = fmu_model.parameter_class
    text = (
        f"{fmu_model.name} {law.__module__}.{law.__qualname__} {parameter_split.code_structure_key} "
        f"{_digest_code_sources(fmu_model)}"
    )
    return f"{fmu_model.name}-{sha256(text.encode()).hexdigest()[:32]}{_COMPILED_MODEL_FILE_SUFFIX}"


def _list_candidate_cache_paths(cache_file_name: str) -> tuple[Path, ...]:
    """Paths at which a file may be: in the wheel, and in the cache for the installed compiler versions."""
    compilers = []
    for package in _COMPILER_PACKAGES:
        with suppress(PackageNotFoundError):
            compilers.append(f"{package}-{version(package)}")
    return SHIPPED_MODEL_FOLDER / cache_file_name, compiled_model_folder() / "_".join(
        compilers or ["none"]
    ) / cache_file_name


def _digest_code_sources(fmu_model: Model) -> str:
    """Digest of all source files that affect the generated C code of an FMU's model."""
    kind = KINDS.get(fmu_model.joint)
    packages = {"jointfmu", kind.package if kind else "jointfmu"}
    roots = [Path(str(files(package))) for package in sorted(packages)]
    here = Path(__file__).parent.parent
    return _digest_folders((*roots, here, here.with_name("joint_parts"), find_joint_folder(fmu_model)))


@cache
def _digest_folders(source_folders: tuple[Path, ...]) -> str:
    """SHA-256 digest of all source files in folders."""
    digest = sha256()
    for folder in source_folders:
        for name, content in _read_source_files(folder):
            digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _read_source_files(source_folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield (relative path, content) of all Python and C files below a folder, sorted by path."""
    paths = {
        path.relative_to(source_folder).as_posix(): path
        for path in source_folder.rglob("*")
        if path.suffix in _SOURCE_SUFFIXES
    }
    for name in sorted(paths):
        yield name, paths[name].read_bytes()


def pack_compiled_model(compiled_model: CompiledModel) -> bytes:
    """Encode a compiled model as an archive; equal models give equal bytes."""
    members = {f"sources/{name}": text.encode() for name, text in compiled_model.source_texts.items()}
    for platform in next(
        iter(compiled_model.libraries_by_fmi_version.values())
    ):  # similar content is adjacent: it compresses better
        members |= {
            f"{v}/{platform}": libraries[platform]
            for v, libraries in compiled_model.libraries_by_fmi_version.items()
        }
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz", preset=9) as archive:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return buffer.getvalue()


def unpack_compiled_model(archive_content: bytes) -> CompiledModel:
    """Decode a compiled model from an archive.

    Raises ValueError, LZMAError or TarError if the archive is invalid or has a member of another name.
    """
    sources: dict[str, str] = {}
    libraries_by_version: dict[str, dict[str, bytes]] = {}
    with tarfile.open(fileobj=io.BytesIO(lzma.decompress(archive_content))) as archive:
        for info in archive:
            folder, _, name = info.name.partition("/")
            if not _ARCHIVE_MEMBER_NAME_PATTERN.fullmatch(info.name):
                raise ValueError(f"no compiled model: it has a member {info.name!r}")
            stream = archive.extractfile(info)
            member = stream.read() if stream else b""
            if folder == "sources":
                sources[name] = member.decode()
            else:
                libraries_by_version.setdefault(folder, {})[name] = member
    if not sources or not libraries_by_version:
        raise ValueError("no compiled model: sources or libraries are missing")
    return CompiledModel(sources, libraries_by_version)


def _write_cache_file(cache_path: Path, file_content: bytes) -> None:
    """Write a file of the cache atomically, and delete the oldest files if the folder has too many.

    While other processes write into the folder, its listing can contain a file twice.
    """
    make_cache_folder(cache_path.parent)
    with tempfile.NamedTemporaryFile("wb", dir=cache_path.parent, delete=False) as new:
        new.write(file_content)
    Path(new.name).replace(cache_path)
    times = {
        other: _read_modification_time(other)
        for other in cache_path.parent.glob("*.xz")
        if other != cache_path
    }
    dated_files = sorted((time, other) for other, time in times.items() if time is not None)
    for _, old_file in dated_files[: max(len(dated_files) + 1 - MAX_FILES_PER_CACHE_FOLDER, 0)]:
        old_file.unlink(missing_ok=True)


def _read_modification_time(cache_path: Path) -> float | None:
    """Modification time of a file [s]; None if another process has just deleted it."""
    with suppress(FileNotFoundError):
        return cache_path.stat().st_mtime
    return None
