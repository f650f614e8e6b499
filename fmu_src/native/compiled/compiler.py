"""Compile C to shared libraries for five platforms on any machine, with zig (package ziglang of PyPI)."""

import os
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from importlib import import_module
from os import cpu_count
from pathlib import Path

from .cache import (
    COMPILER_CACHE_ENVIRONMENT_VARIABLE,
    check_cache_access,
    compiler_cache_folder,
    make_cache_folder,
)

ZIG_TARGETS = {
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-darwin": "x86_64-macos.11.0-none",
    "aarch64-darwin": "aarch64-macos.11.0-none",
}
"""{platform name of FMI: target of zig}, with the oldest supported glibc or macOS."""

_COMMON_ZIG_OPTIONS = (
    "-std=c11", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-sanitize=undefined",
    "-fvisibility=hidden", "-DNDEBUG", "-s", "-ffunction-sections", "-fdata-sections",
)  # fmt: skip
"""Options of zig for all libraries: reproducible numbers and bytes."""
_SHARED_LIBRARY_ZIG_OPTIONS = (
    *_COMMON_ZIG_OPTIONS, "-shared", "-mllvm", "-inline-threshold=100", "-mllvm", "-dag-maps-huge-region=300",
)  # fmt: skip
"""Options for shared libraries. The inline threshold of 100 (default 225) saves 2 % of size. The last option
limits the time of scheduling in long functions: the equations of a robot compile in 2.0 s, not in 3.3 s."""
_WEBASSEMBLY_ZIG_OPTIONS = (
    "-target", "wasm32-wasi", "-mexec-model=reactor", *_COMMON_ZIG_OPTIONS,
    "-Wl,--export-dynamic", "-Wl,-z,stack-size=131072",
)  # fmt: skip
"""Options for WebAssembly: a reactor module that needs only the imports declared in the sources. Visible
functions are exported; the host calls `_initialize` first. Stack of 128 kB, by default zig reserves 16 MB."""
_C_INCLUDE_PATTERN = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
"""Pattern of a line of C that includes a file of the same folder; its group is the name."""
_UCRT_LIBRARIES = ("convert", "heap", "math", "private", "runtime", "stdio", "string", "utility")
"""Libraries of the Universal C Runtime, which is part of Windows 10 and newer."""


def compile_libraries(
    fmu_name: str,
    source_texts: Mapping[str, str],
    source_names: Sequence[str],
    platforms: Sequence[str] = tuple(ZIG_TARGETS),
    library_file_stem: str = "",
    linker_options: Sequence[str] = (),
) -> dict[str, bytes]:
    """Compile C sources of an FMU with zig to shared libraries {platform: content}.

    source_texts      : {file name: text} of all C files and headers; the FMI headers come from fmpy
    source_names      : names of the .c files to compile
    library_file_stem : file name of the libraries without extension; empty: `fmu_name`
    linker_options    : additional compiler options, for linking a further library

    zig caches each compiled C file, also for other libraries and later builds. Equal sources give equal
    bytes.

    Raises ImportError if ziglang is missing, ValueError if its cache cannot be written or others may write to
    it, RuntimeError with the compiler's first error.
    """
    from concurrent.futures import ThreadPoolExecutor

    options = {
        platform: _make_compiler_options(platform, library_file_stem or fmu_name) for platform in platforms
    }
    windows = Path(__file__).with_name("windows.c")
    folder = _write_source_folder({windows.name: windows.read_text(encoding="utf-8")})
    paths = _write_source_files({**_read_fmi_headers(), **source_texts}, source_names)

    def compile_library(platform_name: str) -> bytes:
        """Compile the library of one platform and return its bytes."""
        with tempfile.TemporaryDirectory() as out:
            file = Path(out) / make_library_file_name(library_file_stem or fmu_name, platform_name)
            _run_zig(
                f"{fmu_name} for {platform_name}",
                folder,
                "cc",
                *options[platform_name],
                *paths,
                *linker_options,
                "-o",
                str(file),
            )
            return file.read_bytes()

    with ThreadPoolExecutor(cpu_count()) as pool:
        return dict(zip(platforms, pool.map(compile_library, platforms), strict=True))


def select_source_files(source_names: Iterable[str], fmi_version: str) -> list[str]:
    """Select the C files to compile for one FMI version, "2" or "3"."""
    excluded = {"2": "fmi3.c", "3": "fmi2.c"}[fmi_version]
    return [name for name in source_names if name.endswith(".c") and name != excluded]


def compile_webassembly(
    module_name: str, source_texts: Mapping[str, str], source_names: Sequence[str]
) -> bytes:
    """Compile C files to a WebAssembly reactor module; errors as `compile_libraries`."""
    import_module("ziglang")
    paths = _write_source_files({**_read_fmi_headers(), **source_texts}, source_names)
    with tempfile.TemporaryDirectory() as out:
        file = Path(out) / f"{module_name}.wasm"
        _run_zig(
            f"{module_name} for WebAssembly",
            Path(out),
            "cc",
            *_WEBASSEMBLY_ZIG_OPTIONS,
            *paths,
            "-o",
            str(file),
        )
        return file.read_bytes()


def make_library_file_name(library_file_stem: str, platform_name: str) -> str:
    """File name of a shared library on a platform, with .so, .dll or .dylib."""
    return (
        library_file_stem
        + {"windows": ".dll", "linux": ".so", "darwin": ".dylib"}[platform_name.split("-")[1]]
    )


def join_universal_library(macos_libraries: Sequence[bytes]) -> bytes:
    """Join macOS libraries for several processors into one universal file; their signatures stay valid."""
    page = 1 << 14
    header, body = struct.pack(">II", 0xCAFEBABE, len(macos_libraries)), b""
    for library in macos_libraries:
        body += bytes(-len(body) % page)
        kind, subtype = struct.unpack_from("<II", library, 4)
        header += struct.pack(">IIIII", kind, subtype, page + len(body), len(library), 14)
        body += library
    return header.ljust(page, b"\0") + body


def _make_compiler_options(platform_name: str, library_file_stem: str) -> tuple[str, ...]:
    """Options of zig for compiling a shared library on a platform.

    library_file_stem : file name of the library without extension
    """
    import ziglang

    common = ("-target", ZIG_TARGETS[platform_name], *_SHARED_LIBRARY_ZIG_OPTIONS)
    # Only libraries of the system: otherwise zig first compiles its own runtime, of which nothing is linked.
    # No unwind tables: no C++ exception passes through this C; only the Windows ABI requires them.
    unix = ("-nostdlib", "-lc", "-fno-asynchronous-unwind-tables", "-fno-unwind-tables")
    if platform_name.endswith("-linux"):
        return (*common, *unix, "-Wl,--gc-sections", "-Wl,--hash-style=gnu", "-lm")
    if platform_name.endswith("-darwin"):
        return (
            *common,
            *unix,
            f"-Wl,-install_name,@rpath/{make_library_file_name(library_file_stem, platform_name)}",
            "-Wl,-dead_strip",
        )
    # Only the C runtime of Windows is linked: compiling mingw's would take most of a minute, and the library
    # needs neither its start-up code nor stack probes, as no function uses a page of stack.
    # With built-in sin and cos the compiler would call sincos, which only mingw has.
    headers = Path(ziglang.__file__).parent / "lib" / "libc" / "include" / "any-windows-any"
    return (
        *common, "windows.c", "-nostdlib", "-Wl,--no-entry", "-fno-builtin-sin", "-fno-builtin-cos",
        "-D_UCRT", "-isystem", str(headers),
        *(f"-lapi-ms-win-crt-{library}-l1-1-0" for library in _UCRT_LIBRARIES),
    )  # fmt: skip


def _read_fmi_headers() -> dict[str, str]:
    """Read {file name: text} of the FMI headers, from fmpy."""
    import fmpy

    folder = Path(fmpy.__file__).parent / "c-code"
    return {p.name: p.read_text(encoding="utf-8") for p in sorted(folder.glob("fmi[23]*.h"))}


def _write_source_files(source_texts: Mapping[str, str], source_names: Sequence[str]) -> list[str]:
    """Write each C file with the files that it includes into a cache folder; returns the paths.

    Libraries with equal C files share these folders. So zig compiles a C file only if the file itself, or a
    file that it includes, has changed.
    """
    folders = [_write_source_folder(_select_included_files(source_texts, name)) for name in source_names]
    return [str(folder / name) for folder, name in zip(folders, source_names, strict=True)]


def _select_included_files(source_texts: Mapping[str, str], source_name: str) -> dict[str, str]:
    """Select a C file and all files that it includes, directly or through others: {name: text}."""
    selected: dict[str, str] = {}
    pending = [source_name]
    while pending:
        name = pending.pop()
        if name in source_texts and name not in selected:
            selected[name] = source_texts[name]
            pending += _C_INCLUDE_PATTERN.findall(source_texts[name])
    return selected


def _write_source_folder(source_texts: Mapping[str, str]) -> Path:
    """Write C files into a cache folder named by their digest; zig caches its results by path."""
    advice = f"set {COMPILER_CACHE_ENVIRONMENT_VARIABLE} to a writable folder"
    digest = sha256("\0".join(f"{k}\0{v}" for k, v in sorted(source_texts.items())).encode()).hexdigest()[:32]
    folder = compiler_cache_folder() / "jointfmu" / digest
    try:
        check_cache_access(folder)
        make_cache_folder(folder)
        for name, text in source_texts.items():
            if not (folder / name).exists():
                with tempfile.NamedTemporaryFile("wb", dir=folder, delete=False) as file:
                    file.write(text.encode())
                Path(file.name).replace(folder / name)
    except OSError as error:
        raise ValueError(f"{folder}: cannot be written ({error.strerror}); {advice}") from None
    return folder


def _run_zig(result_name: str, working_folder: Path, *zig_arguments: str) -> str:
    """Run the compiler zig in a folder and return its standard output.

    result_name : name of the compiled file in error messages
    """
    process = subprocess.run(
        [sys.executable, "-m", "ziglang", *zig_arguments],
        cwd=working_folder,
        env={**os.environ, COMPILER_CACHE_ENVIRONMENT_VARIABLE: str(compiler_cache_folder())},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    if process.returncode:
        lines = process.stderr.splitlines()
        first = next((line for line in lines if "error" in line), process.stderr.strip() or "no message")
        raise RuntimeError(f"{result_name}: the C compiler failed: {first}")
    return process.stdout
