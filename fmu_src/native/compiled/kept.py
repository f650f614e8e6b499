"""Compiled parts of FMUs, which all parameter files of one structure share: shipped, kept or compiled now.

A part is found by what went into it: the structure, and the content of every source that it is made of.
Wheels carry parts in `native/parts`; what is compiled here is kept in the user's cache.
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
from jointfmu.progress import step

from ...folders import own_folder
from ...joint_parts.data import Split
from ..data import PLACEHOLDER, placeholder
from .cache import check_access, make_folder, parts
from .compiler import exported, libraries

SHIPPED = Path(__file__).parent.with_name("parts")
"""Where wheels have theirs."""
VERSIONS = ("2", "3")
MOST_KEPT = 200
"""Files that are kept [1]; older ones go."""
_SUFFIX, _KEPT = ".tar.xz", ".kept.xz"
_COMPILERS = ("casadi", "ziglang")
_SOURCES = (".py", ".c", ".h")
_MEMBER = re.compile(r"sources/\w[\w.-]*|\d/[\w-]+")
"""Names of members of a part: C files, and libraries by version of FMI and platform."""


class Part(NamedTuple):
    """What is the same for all FMUs of a structure.

    sources   : {file name: text} of all C files but the data
    libraries : {FMI version: {platform: library}} with placeholders of data and name
    """

    sources: dict[str, str]
    libraries: dict[str, dict[str, bytes]]


def part_of(model: Model, parameters: ParameterFile, given: Split) -> Part:
    """The part of an FMU.

    Raises ImportError if it has to be compiled and a package is missing, ValueError if others may write to
    the cache, ValueError and RuntimeError as `compiler.libraries`.
    """
    places = _places(shipped_name(model, given))
    for content in filter(None, map(_content, places)):
        with suppress(lzma.LZMAError, tarfile.TarError, ValueError, EOFError):
            return read(content)
    made = compiled(model, parameters, given)
    with suppress(OSError):  # nothing is lost but time
        _keep(places[-1], written(made))
    return made


def keeping(what: str, model: Model, make: Callable[[], bytes]) -> bytes:
    """What is made of a model, from the cache if it was made before of equal sources.

    what : what else it depends on

    Raises ValueError if others may write to the cache, and what `make` raises.
    """
    name = sha256(f"{what} {_sources_of(model)}".encode()).hexdigest()[:32]
    file = _places(f"{model.name}-{name}{_KEPT}")[-1]
    if content := _content(file):
        with suppress(lzma.LZMAError):
            return lzma.decompress(content)
    made = make()
    with suppress(OSError):
        _keep(file, lzma.compress(made))
    return made


def _content(file: Path) -> bytes:
    """Content of a kept file; empty if there is none. Raises ValueError as `check_access`."""
    with suppress(OSError):
        check_access(file)
        return file.read_bytes()
    return b""


@contextmanager
def _interrupt_after() -> Iterator[None]:
    """Ctrl-C during the body, a second or two, raises KeyboardInterrupt at its end: CasADi swallows it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if heard:
        raise KeyboardInterrupt


def compiled(model: Model, parameters: ParameterFile, given: Split) -> Part:
    """The same, compiled now."""
    step(f"compile {model.name}")
    from ..code.generate import code

    with _interrupt_after():
        sources = code(model, parameters, given)
    every = sources | {"data.c": placeholder(model, given).source()}
    built = {v: libraries(model.name, every, exported(every, v), stem=PLACEHOLDER) for v in VERSIONS}
    return Part(sources, built)


def shipped_name(model: Model, given: Split) -> str:
    """File name of a part in a wheel."""
    law = model.parameters
    text = f"{model.name} {law.__module__}.{law.__qualname__} {given.structure} {_sources_of(model)}"
    return f"{model.name}-{sha256(text.encode()).hexdigest()[:32]}{_SUFFIX}"


def _places(name: str) -> tuple[Path, Path]:
    """Where a file may lie: in the wheel, and in the cache, there for each version of the compilers."""
    used = []
    for package in _COMPILERS:
        with suppress(PackageNotFoundError):
            used.append(f"{package}-{version(package)}")
    return SHIPPED / name, parts() / "_".join(used or ["none"]) / name


def _sources_of(model: Model) -> str:
    """Digest of every file that code is generated of: the package, this builder, the joint's folders."""
    own = KINDS.get(model.joint)
    packages = {"jointfmu", own.package if own else "jointfmu"}
    roots = [Path(str(files(package))) for package in sorted(packages)]
    here = Path(__file__).parent.parent
    return _digest((*roots, here, here.with_name("joint_parts"), own_folder(model)))


@cache
def _digest(folders: tuple[Path, ...]) -> str:
    digest = sha256()
    for folder in folders:
        for name, content in _files(folder):
            digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _files(folder: Path) -> Iterator[tuple[str, bytes]]:
    found = {
        path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.suffix in _SOURCES
    }
    for name in sorted(found):
        yield name, found[name].read_bytes()


def written(made: Part) -> bytes:
    """A part as a file; equal parts give equal bytes."""
    members = {f"sources/{name}": text.encode() for name, text in made.sources.items()}
    for platform in made.libraries[VERSIONS[0]]:  # what is alike lies side by side
        members |= {f"{v}/{platform}": made.libraries[v][platform] for v in VERSIONS}
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz", preset=9) as archive:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return buffer.getvalue()


def read(content: bytes) -> Part:
    """A part of a file.

    Raises ValueError, LZMAError or TarError if it is none, or has a member that would leave the FMU.
    """
    sources: dict[str, str] = {}
    built: dict[str, dict[str, bytes]] = {}
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
                built.setdefault(folder, {})[name] = member
    if not sources or not built.keys() >= {*VERSIONS}:
        raise ValueError("no part")
    return Part(sources, built)


def _keep(file: Path, content: bytes) -> None:
    """Put a file in place in one go, and remove the oldest beside it.

    A folder that others write in may list a file more than once.
    """
    make_folder(file.parent)
    with tempfile.NamedTemporaryFile("wb", dir=file.parent, delete=False) as new:
        new.write(content)
    Path(new.name).replace(file)
    others = {other: _written_at(other) for other in file.parent.glob("*.xz") if other != file}
    there = sorted((at, other) for other, at in others.items() if at is not None)
    for _, old in there[: max(len(there) + 1 - MOST_KEPT, 0)]:
        old.unlink(missing_ok=True)


def _written_at(file: Path) -> float | None:
    """Time of a file; None if another process has just removed it."""
    with suppress(FileNotFoundError):
        return file.stat().st_mtime
    return None
