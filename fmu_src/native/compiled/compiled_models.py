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

from ...folders import find_source_folder
from ...joint_parts.data import ParameterSplit
from ..data import PLACEHOLDER_NAME, make_placeholder
from .cache import check_cache_access, compiled_model_folder, make_cache_folder, stored_result_folder
from .compiler import ZIG_TARGETS, compile_libraries, select_source_files

SHIPPED_MODEL_FOLDER = Path(__file__).parent.with_name("parts")
"""Folder of the compiled models in a wheel."""
FMI_VERSIONS = ("2", "3")
"""Versions of FMI."""
MAX_CACHED_FILES = 200
"""Largest number of files in a cache folder [1]; the oldest are deleted."""
_MODEL_FILE_SUFFIX, _RESULT_FILE_SUFFIX = ".tar.xz", ".kept.xz"
_COMPILER_PACKAGES = ("casadi", "ziglang")
"""Packages that compile models; each set of their versions has its own cache folder."""
_SOURCE_SUFFIXES = (".py", ".c", ".h")
"""Endings of the files whose content determines the generated code."""
_MEMBER_NAME_PATTERN = re.compile(r"sources/\w[\w.-]*|\d/[\w-]+")
"""Pattern of member names in the file of a compiled model: C files, and libraries as FMI version/platform."""


class CompiledModel(NamedTuple):
    """C sources and libraries of all FMUs with the same C code (see `ParameterSplit.code_structure_key`).

    sources   : {file name: text} of all C files but data.c
    libraries : {FMI version: {platform: library}} with placeholders for data and name
    """

    sources: dict[str, str]
    libraries: dict[str, dict[str, bytes]]


def get_compiled_model(
    model: Model, parameters: ParameterFile, parameter_split: ParameterSplit, platform: str | None = None
) -> CompiledModel:
    """Get the compiled model of an FMU from the wheel or the cache, or compile and cache it.

    platform : compile for this platform and the newest FMI version alone; None: for all of them

    Raises ImportError if it must be compiled and a package is missing, ValueError if other users may write
    to the cache, ValueError and RuntimeError as `compiler.compile_libraries`.
    """
    paths = _candidate_paths(compiled_model_name(model, parameter_split))
    if platform:
        name = paths[-1].name.removesuffix(_MODEL_FILE_SUFFIX)
        paths = (*paths, paths[-1].with_name(f"{name}-{platform}{_MODEL_FILE_SUFFIX}"))
    for content in filter(None, map(_read_cache_file, paths)):
        with suppress(lzma.LZMAError, tarfile.TarError, ValueError, EOFError):
            return unpack_model(content)
    targets = ((platform,), FMI_VERSIONS[-1:]) if platform else (tuple(ZIG_TARGETS), FMI_VERSIONS)
    compiled_model = compile_model(model, parameters, parameter_split, *targets)
    with suppress(OSError):  # without cache the next build compiles again
        _write_cache_file(paths[-1], pack_model(compiled_model))
    return compiled_model


def get_cached_result(dependency_text: str, model: Model, compute_bytes: Callable[[], bytes]) -> bytes:
    """Bytes that `compute_bytes` computes from a model, read from the cache if the sources are unchanged.

    dependency_text : text of everything else on which the result depends

    Raises ValueError if other users may write to the cache, and what `compute_bytes` raises.
    """
    name = sha256(f"{dependency_text} {_digest_sources(model)}".encode()).hexdigest()[:32]
    file = _candidate_paths(f"{model.name}-{name}{_RESULT_FILE_SUFFIX}")[-1]
    if content := _read_cache_file(file):
        with suppress(lzma.LZMAError):
            return lzma.decompress(content)
    result = compute_bytes()
    with suppress(OSError):
        _write_cache_file(file, lzma.compress(result))
    return result


def get_stored_result(key: str, compute_result: Callable[[], bytes]) -> bytes:
    """Get the stored result of a long computation of the package `jointfmu`, or compute and store it.

    A stored result is in the user's cache. It is used only if the sources of the package are unchanged.

    key : identifies the computation and its arguments

    An unsafe or unwritable cache is not used. See `jointfmu.files.results`.
    """
    name = sha256(f"{key} {_digest_folders((Path(str(files('jointfmu'))),))}".encode()).hexdigest()[:32]
    file = stored_result_folder() / f"{name}{_RESULT_FILE_SUFFIX}"
    with suppress(ValueError, lzma.LZMAError):
        if content := _read_cache_file(file):
            return lzma.decompress(content)
    result = compute_result()
    with suppress(OSError, ValueError):
        _write_cache_file(file, lzma.compress(result))
    return result


def _read_cache_file(cache_path: Path) -> bytes:
    """Content of a file of the cache; empty if it is missing. Raises ValueError as `check_cache_access`."""
    with suppress(OSError):
        check_cache_access(cache_path)
        return cache_path.read_bytes()
    return b""


def compile_model(
    model: Model,
    parameters: ParameterFile,
    parameter_split: ParameterSplit,
    platforms: Sequence[str],
    fmi_versions: Sequence[str],
) -> CompiledModel:
    """Compile the model of an FMU for platforms and FMI versions."""
    set_status_text(f"compile {model.name}")
    from ..code.generate import generate_code

    with defer_interrupt():  # CasADi ignores the interrupt
        sources = generate_code(model, parameters, parameter_split)
    all_sources = sources | {"data.c": make_placeholder(model, parameter_split).make_source()}
    libraries_by_version = {
        fmi: compile_libraries(
            model.name,
            all_sources,
            select_source_files(all_sources, fmi),
            platforms,
            library_stem=PLACEHOLDER_NAME,
        )
        for fmi in fmi_versions
    }
    return CompiledModel(sources, libraries_by_version)


def compiled_model_name(model: Model, parameter_split: ParameterSplit) -> str:
    """File name of a compiled model, with a digest of structure and sources."""
    law = model.parameter_class
    text = (
        f"{model.name} {law.__module__}.{law.__qualname__} {parameter_split.code_structure_key} "
        f"{_digest_sources(model)}"
    )
    return f"{model.name}-{sha256(text.encode()).hexdigest()[:32]}{_MODEL_FILE_SUFFIX}"


def _candidate_paths(file_name: str) -> tuple[Path, ...]:
    """Paths of a file in the wheel and in the cache, which has one folder per set of compiler versions."""
    compilers = []
    for package in _COMPILER_PACKAGES:
        with suppress(PackageNotFoundError):
            compilers.append(f"{package}-{version(package)}")
    return SHIPPED_MODEL_FOLDER / file_name, compiled_model_folder() / "_".join(
        compilers or ["none"]
    ) / file_name


def _digest_sources(model: Model) -> str:
    """Digest of all files that affect the generated code: packages, this builder, folder of the joint."""
    kind = KINDS.get(model.joint)
    packages = {"jointfmu", kind.package if kind else "jointfmu"}
    roots = [Path(str(files(package))) for package in sorted(packages)]
    here = Path(__file__).parent.parent
    return _digest_folders((*roots, here, here.with_name("joint_parts"), find_source_folder(model)))


@cache
def _digest_folders(source_folders: tuple[Path, ...]) -> str:
    """SHA-256 digest of all source files in folders."""
    digest = sha256()
    for folder in source_folders:
        for name, content in _read_source_files(folder):
            digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _read_source_files(source_folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield path and content of all source files below a folder, sorted by path."""
    paths = {
        path.relative_to(source_folder).as_posix(): path
        for path in source_folder.rglob("*")
        if path.suffix in _SOURCE_SUFFIXES
    }
    for name in sorted(paths):
        yield name, paths[name].read_bytes()


def pack_model(model: CompiledModel) -> bytes:
    """Encode a compiled model as an archive; equal models give equal bytes."""
    members = {f"sources/{name}": text.encode() for name, text in model.sources.items()}
    for platform in next(iter(model.libraries.values())):  # similar content is adjacent: it compresses better
        members |= {f"{v}/{platform}": libraries[platform] for v, libraries in model.libraries.items()}
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz", preset=9) as archive:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return buffer.getvalue()


def unpack_model(archive_content: bytes) -> CompiledModel:
    """Decode a compiled model from an archive.

    Raises ValueError, LZMAError or TarError if the archive is invalid or has a member of another name.
    """
    sources: dict[str, str] = {}
    libraries_by_version: dict[str, dict[str, bytes]] = {}
    with tarfile.open(fileobj=io.BytesIO(lzma.decompress(archive_content))) as archive:
        for info in archive:
            folder, _, name = info.name.partition("/")
            if not _MEMBER_NAME_PATTERN.fullmatch(info.name):
                raise ValueError(f"no part: it has a member {info.name!r}")
            stream = archive.extractfile(info)
            member = stream.read() if stream else b""
            if folder == "sources":
                sources[name] = member.decode()
            else:
                libraries_by_version.setdefault(folder, {})[name] = member
    if not sources or not libraries_by_version:
        raise ValueError("no part")
    return CompiledModel(sources, libraries_by_version)


def _write_cache_file(cache_path: Path, file_content: bytes) -> None:
    """Write a cache file atomically, and delete the oldest files of its folder beyond MAX_CACHED_FILES.

    While other processes write into the folder, its listing can contain a file twice.
    """
    make_cache_folder(cache_path.parent)
    with tempfile.NamedTemporaryFile("wb", dir=cache_path.parent, delete=False) as new:
        new.write(file_content)
    Path(new.name).replace(cache_path)
    times = {
        other: _modification_time(other) for other in cache_path.parent.glob("*.xz") if other != cache_path
    }
    dated_files = sorted((time, other) for other, time in times.items() if time is not None)
    for _, old_file in dated_files[: max(len(dated_files) + 1 - MAX_CACHED_FILES, 0)]:
        old_file.unlink(missing_ok=True)


def _modification_time(cache_path: Path) -> float | None:
    """Modification time of a file [s]; None if another process has just deleted it."""
    with suppress(FileNotFoundError):
        return cache_path.stat().st_mtime
    return None
