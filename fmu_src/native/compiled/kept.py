"""Compiled models, shared by all FMUs with the same C code: from the wheel, the cache or the compiler.

The values on which the C code depends are called structure. The file name of a compiled model contains a
digest of the structure and of all sources. Wheels contain compiled models in `native/parts`; models compiled
on this machine are stored in the user's cache.
"""

import io
import lzma
import re
import signal
import tarfile
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.progress import set_step

from ...folders import own_folder
from ...joint_parts.data import Split
from ..data import PLACEHOLDER, placeholder
from .cache import check_access, make_folder, parts_folder
from .compiler import exported, libraries

SHIPPED = Path(__file__).parent.with_name("parts")
"""Folder of the compiled models in a wheel."""
VERSIONS = ("2", "3")
"""Versions of FMI."""
MOST_KEPT = 200
"""Largest number of files in a cache folder [1]; the oldest are deleted."""
_SUFFIX, _RESULT_SUFFIX = ".tar.xz", ".kept.xz"
_COMPILERS = ("casadi", "ziglang")
_SOURCES = (".py", ".c", ".h")
_MEMBER = re.compile(r"sources/\w[\w.-]*|\d/[\w-]+")
"""Pattern of member names in the file of a compiled model: C files, and libraries as FMI version/platform."""


class CompiledModel(NamedTuple):
    """C sources and libraries shared by all FMUs with the same C code (see `ParameterSplit.structure_key`).

    sources   : {file name: text} of all C files but data.c
    libraries : {FMI version: {platform: library}} with placeholders for data and name
    """

    sources: dict[str, str]
    libraries: dict[str, dict[str, bytes]]


def compiled_model(model: Model, parameters: ParameterFile, split: Split) -> CompiledModel:
    """Get the compiled model of an FMU from the wheel or the cache, or compile and cache it.

    Raises ImportError if it must be compiled and a package is missing, ValueError if other users may write
    to the cache, ValueError and RuntimeError as `compiler.compile_libraries`.
    """
    paths = _places(shipped_name(model, split))
    for content in filter(None, map(_content, paths)):
        with suppress(lzma.LZMAError, tarfile.TarError, ValueError, EOFError):
            return unpack_model(content)
    compiled_model = compile_model(model, parameters, split)
    with suppress(OSError):  # without cache the next build compiles again
        _keep(paths[-1], pack_model(compiled_model))
    return compiled_model


def cached_result(dependency: str, model: Model, make: Callable[[], bytes]) -> bytes:
    """Bytes that `compute_result` computes from a model, read from the cache if the sources are unchanged.

    dependency : text of everything else on which the result depends

    Raises ValueError if other users may write to the cache, and what `compute_result` raises.
    """
    name = sha256(f"{dependency} {_sources_of(model)}".encode()).hexdigest()[:32]
    file = _places(f"{model.name}-{name}{_RESULT_SUFFIX}")[-1]
    if content := _content(file):
        with suppress(lzma.LZMAError):
            return lzma.decompress(content)
    result = make()
    with suppress(OSError):
        _keep(file, lzma.compress(result))
    return result


def _content(file: Path) -> bytes:
    """Content of a cached file; empty if it is missing. Raises ValueError as `check_access`."""
    with suppress(OSError):
        check_access(file)
        return file.read_bytes()
    return b""


@contextmanager
def _interrupt_after() -> Iterator[None]:
    """Context that defers Ctrl-C to its end, a second or two: CasADi ignores the interrupt."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    signals: list[int] = []
    previous_handler = signal.signal(signal.SIGINT, lambda number, frame: signals.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous_handler)
    if signals:
        raise KeyboardInterrupt


def compile_model(model: Model, parameters: ParameterFile, split: Split) -> CompiledModel:
    """Compile the model of an FMU for all platforms and FMI versions."""
    set_step(f"compile {model.name}")
    from ..code.generate import code

    with _interrupt_after():
        sources = code(model, parameters, split)
    all_sources = sources | {"data.c": placeholder(model, split).source()}
    libraries_by_version = {
        fmi: libraries(model.name, all_sources, exported(all_sources, fmi), stem=PLACEHOLDER)
        for fmi in VERSIONS
    }
    return CompiledModel(sources, libraries_by_version)


def shipped_name(model: Model, split: Split) -> str:
    """File name of a compiled model, with a digest of structure and sources."""
    law = model.parameters
    text = f"{model.name} {law.__module__}.{law.__qualname__} {split.structure} {_sources_of(model)}"
    return f"{model.name}-{sha256(text.encode()).hexdigest()[:32]}{_SUFFIX}"


def _places(name: str) -> tuple[Path, Path]:
    """Paths of a file in the wheel and in the cache, which has one folder per set of compiler versions."""
    compilers = []
    for package in _COMPILERS:
        with suppress(PackageNotFoundError):
            compilers.append(f"{package}-{version(package)}")
    return SHIPPED / name, parts_folder() / "_".join(compilers or ["none"]) / name


def _sources_of(model: Model) -> str:
    """Digest of all files that affect the generated code: packages, this builder, folder of the joint."""
    kind = KINDS.get(model.joint)
    packages = {"jointfmu", kind.package if kind else "jointfmu"}
    roots = [Path(str(files(package))) for package in sorted(packages)]
    here = Path(__file__).parent.parent
    return _digest((*roots, here, here.with_name("joint_parts"), own_folder(model)))


@cache
def _digest(folders: tuple[Path, ...]) -> str:
    """SHA-256 of all source files in folders."""
    digest = sha256()
    for folder in folders:
        for name, content in _files(folder):
            digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _files(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield path and content of all source files below a folder, sorted by path."""
    paths = {
        path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.suffix in _SOURCES
    }
    for name in sorted(paths):
        yield name, paths[name].read_bytes()


def pack_model(model: CompiledModel) -> bytes:
    """Encode a compiled model as an archive; equal models give equal bytes."""
    members = {f"sources/{name}": text.encode() for name, text in model.sources.items()}
    for platform in model.libraries[VERSIONS[0]]:  # similar content is adjacent, for better compression
        members |= {f"{v}/{platform}": model.libraries[v][platform] for v in VERSIONS}
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz", preset=9) as archive:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return buffer.getvalue()


def unpack_model(content: bytes) -> CompiledModel:
    """Decode a compiled model from an archive.

    Raises ValueError, LZMAError or TarError if the archive is invalid or has a member of another name.
    """
    sources: dict[str, str] = {}
    libraries_by_version: dict[str, dict[str, bytes]] = {}
    with tarfile.open(fileobj=io.BytesIO(lzma.decompress(content))) as archive:
        for info in archive:
            folder, _, name = info.name.partition("/")
            if not _MEMBER.fullmatch(info.name):
                raise ValueError(f"no part: it has a member {info.name!r}")
            stream = archive.extractfile(info)
            member = stream.read() if stream else b""
            if folder == "sources":
                sources[name] = member.decode()
            else:
                libraries_by_version.setdefault(folder, {})[name] = member
    if not sources or not libraries_by_version.keys() >= {*VERSIONS}:
        raise ValueError("no part")
    return CompiledModel(sources, libraries_by_version)


def _keep(file: Path, content: bytes) -> None:
    """Write a cache file atomically, and delete the oldest files of its folder beyond MAX_CACHED_FILES.

    While other processes write into the folder, its listing can contain a file twice.
    """
    make_folder(file.parent)
    with tempfile.NamedTemporaryFile("wb", dir=file.parent, delete=False) as new:
        new.write(content)
    Path(new.name).replace(file)
    times = {other: _written_at(other) for other in file.parent.glob("*.xz") if other != file}
    dated_files = sorted((time, other) for other, time in times.items() if time is not None)
    for _, old_file in dated_files[: max(len(dated_files) + 1 - MOST_KEPT, 0)]:
        old_file.unlink(missing_ok=True)


def _written_at(file: Path) -> float | None:
    """Modification time of a file [s]; None if another process has just deleted it."""
    with suppress(FileNotFoundError):
        return file.stat().st_mtime
    return None
