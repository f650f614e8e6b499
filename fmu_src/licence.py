"""The licences that every FMU carries: that of the package, and those of others' work in its binaries.

No library of the compiler is linked in (`compiled/compiler.py`): Linux and macOS bind the system's libraries,
Windows the system's runtime by import stubs of mingw-w64. Of others the binaries have what the headers
of FMI and of mingw-w64 declare.
"""

from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

_OTHERS = Path(__file__).with_name("licenses")
"""Folder of licence texts as their owners wrote them; the wheel lists them as its licence files too."""


def licence() -> str:
    """The licence text, from what is installed.

    Raises ValueError if it is missing.
    """
    try:
        texts = [f for f in files("jointfmu") or () if f.name == "LICENSE"]
        return texts[0].read_text(encoding="utf-8")
    except (PackageNotFoundError, IndexError, OSError):
        raise ValueError("LICENSE: missing in the installed package jointfmu; install it again") from None


def licences() -> dict[str, bytes]:
    """{path in the folder documentation of an FMU: content} of all licence texts. ValueError as `licence`."""
    return {"licenses/license.txt": licence().encode()} | dict(_others())


_WASI = ("LICENSE", "LICENSE-MIT", "libc-top-half/musl/COPYRIGHT", "libc-bottom-half/cloudlibc/LICENSE")
"""Licence files of the C library that the compiler links into WebAssembly modules."""


def webassembly_licences() -> str:
    """Licence texts of a WebAssembly module: the package's, and those of the C library linked in.

    Raises ImportError if ziglang is missing, ValueError as `licence`.
    """
    folder = Path(str(import_module("ziglang").__file__)).parent / "lib" / "libc" / "wasi"
    texts = (f"wasi-libc, {name}\n\n{(folder / name).read_text(encoding='utf-8')}" for name in _WASI)
    return "\n\n".join([f"jointfmu\n\n{licence()}", *texts])


def _others() -> Iterator[tuple[str, bytes]]:
    for path in sorted(_OTHERS.glob("*.txt")):
        yield f"licenses/{path.name}", path.read_bytes()


def copyright_line() -> str:
    """The line that names the copyright holder."""
    return next(line for line in licence().splitlines() if line.startswith("Copyright"))
