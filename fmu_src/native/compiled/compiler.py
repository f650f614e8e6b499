"""C sources to shared libraries for five platforms, on any machine, with the compiler of PyPI's ziglang."""

import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from importlib import import_module
from os import cpu_count
from pathlib import Path

from .cache import COMPILER, check_access, compiler_cache, make_folder

TARGETS = {
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-darwin": "x86_64-macos.11.0-none",
    "aarch64-darwin": "aarch64-macos.11.0-none",
}
"""FMI's names of the platforms, and zig's with the oldest glibc or macOS."""

_COMPILED = (
    "-std=c11", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-sanitize=undefined",
    "-fvisibility=hidden", "-DNDEBUG", "-s", "-ffunction-sections", "-fdata-sections",
)  # fmt: skip
_OPTIONS = (*_COMPILED, "-shared", "-mllvm", "-inline-threshold=100")
"""Fewer copies of functions than the compiler's 225 makes: a fiftieth of the size, at no cost in time."""
_WEB = (
    "-target", "wasm32-wasi", "-mexec-model=reactor", *_COMPILED,
    "-Wl,--export-dynamic", "-Wl,-z,stack-size=131072",
)  # fmt: skip
"""A module that takes nothing from its host but what the sources import: what is visible is exported, and
`_initialize` comes first. No function needs a page of stack; zig would reserve 16 MB."""
_UCRT = ("convert", "heap", "math", "private", "runtime", "stdio", "string", "utility")
"""Parts of the C runtime that belongs to Windows 10 and newer."""


def libraries(
    name: str,
    sources: Mapping[str, str],
    units: Sequence[str],
    platforms: Sequence[str] = tuple(TARGETS),
    stem: str = "",
    linked: Sequence[str] = (),
) -> dict[str, bytes]:
    """{platform: shared library} of the .c files `units`, with FMI's functions exported.

    `sources` are all files by flat name, FMI's headers come from fmpy; `stem` is the libraries' file
    name, `linked` are options for another library that they use. What units of the same sources share is
    compiled once, in this and in later builds. Equal sources give equal bytes.

    Raises ImportError if ziglang is missing, ValueError if its cache cannot be written or others may write to
    it, RuntimeError with the compiler's first error.
    """
    from concurrent.futures import ThreadPoolExecutor

    options = {platform: _options(platform, stem or name) for platform in platforms}
    own = Path(__file__).with_name("windows.c")
    folder = _folder({**_headers(), own.name: own.read_text(encoding="utf-8"), **sources})

    def library(platform: str) -> bytes:
        with tempfile.TemporaryDirectory() as out:
            file = Path(out) / file_name(stem or name, platform)
            _run(f"{name} for {platform}", folder, "cc", *options[platform], *units, *linked, "-o", str(file))
            return file.read_bytes()

    with ThreadPoolExecutor(cpu_count()) as pool:
        return dict(zip(platforms, pool.map(library, platforms), strict=True))


def exported(files: Iterable[str], version: str) -> list[str]:
    """C files of one FMI version."""
    other = {"2": "fmi3.c", "3": "fmi2.c"}[version]
    return [name for name in files if name.endswith(".c") and name != other]


def webassembly(name: str, sources: Mapping[str, str], units: Sequence[str]) -> bytes:
    """A WebAssembly module of the .c files `units`, a reactor; the rest and what is raised as `libraries`."""
    import_module("ziglang")
    folder = _folder({**_headers(), **sources})
    with tempfile.TemporaryDirectory() as out:
        file = Path(out) / f"{name}.wasm"
        _run(f"{name} for WebAssembly", folder, "cc", *_WEB, *units, "-o", str(file))
        return file.read_bytes()


def file_name(name: str, platform: str) -> str:
    """The library's file name on a platform."""
    return name + {"windows": ".dll", "linux": ".so", "darwin": ".dylib"}[platform.split("-")[1]]


def universal(slices: Sequence[bytes]) -> bytes:
    """One macOS file of libraries for several processors; each keeps its signature."""
    page = 1 << 14
    header, body = struct.pack(">II", 0xCAFEBABE, len(slices)), b""
    for library in slices:
        body += bytes(-len(body) % page)
        kind, subtype = struct.unpack_from("<II", library, 4)
        header += struct.pack(">IIIII", kind, subtype, page + len(body), len(library), 14)
        body += library
    return header.ljust(page, b"\0") + body


def _options(platform: str, name: str) -> tuple[str, ...]:
    """Everything that zig is told besides the files."""
    import ziglang

    # In an order that suits processors with vectors of four numbers, on any.
    tuned = ("-mtune=haswell",) if platform.startswith("x86_64") else ()
    common = ("-target", TARGETS[platform], *_OPTIONS, *tuned)
    # The system's libraries alone: zig would compile its own runtime at first, of which nothing is linked.
    # No tables for exceptions, which pass through no C; Windows' ABI asks for them.
    own = ("-nostdlib", "-lc", "-fno-asynchronous-unwind-tables", "-fno-unwind-tables")
    if platform.endswith("-linux"):
        return (*common, *own, "-Wl,--gc-sections", "-Wl,--hash-style=gnu", "-lm")
    if platform.endswith("-darwin"):
        return (*common, *own, f"-Wl,-install_name,@rpath/{file_name(name, platform)}", "-Wl,-dead_strip")
    # Linked with the system's runtime alone: mingw's would take most of a minute to compile at first,
    # and the library needs none of its start-up, nor stack probes, as no function needs a page of stack.
    # Without sin and cos as built-in functions the compiler makes no sincos of both, which only mingw has.
    headers = Path(ziglang.__file__).parent / "lib" / "libc" / "include" / "any-windows-any"
    return (
        *common, "windows.c", "-nostdlib", "-Wl,--no-entry", "-fno-builtin-sin", "-fno-builtin-cos",
        "-D_UCRT", "-isystem", str(headers),
        *(f"-lapi-ms-win-crt-{part}-l1-1-0" for part in _UCRT),
    )  # fmt: skip


def _headers() -> dict[str, str]:
    import fmpy

    folder = Path(fmpy.__file__).parent / "c-code"
    return {p.name: p.read_text(encoding="utf-8") for p in sorted(folder.glob("fmi[23]*.h"))}


def _folder(files: Mapping[str, str]) -> Path:
    """Folder with these files in zig's cache, where zig knows again what it has compiled: by its path."""
    advice = f"set {COMPILER} to a writable folder"
    digest = sha256("\0".join(f"{k}\0{v}" for k, v in sorted(files.items())).encode()).hexdigest()[:32]
    folder = compiler_cache() / "jointfmu" / digest
    try:
        check_access(folder)
        make_folder(folder)
        for name, text in files.items():
            if not (folder / name).exists():
                with tempfile.NamedTemporaryFile("wb", dir=folder, delete=False) as file:
                    file.write(text.encode())
                Path(file.name).replace(folder / name)
    except OSError as error:
        raise ValueError(f"{folder}: cannot be written ({error.strerror}); {advice}") from None
    return folder


def _run(what: str, folder: Path, *arguments: str) -> str:
    """What zig prints, run in a folder; `what` it makes, for the error."""
    done = subprocess.run(
        [sys.executable, "-m", "ziglang", *arguments],
        cwd=folder,
        env={**os.environ, COMPILER: str(compiler_cache())},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    if done.returncode:
        lines = done.stderr.splitlines()
        first = next((line for line in lines if "error" in line), done.stderr.strip() or "no message")
        raise RuntimeError(f"{what}: {first}")
    return done.stdout
