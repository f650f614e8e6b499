"""Licence texts inside an FMU: of the package, and of third-party code in the binaries.

No library of the compiler is linked (`compiled/compiler.py`). Binaries for Linux and macOS use the libraries
of the system; those for Windows use its C runtime through import stubs of mingw-w64. So the only third-party
code in a binary is what the headers of FMI and of mingw-w64 declare.
"""

from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

_THIRD_PARTY_LICENCE_FOLDER = Path(__file__).with_name("licenses")
"""Folder of the third-party licence texts, unchanged; the wheel lists them as licence files too."""


def read_licence() -> str:
    """Read the licence text of the installed package jointfmu.

    Raises ValueError if the file is missing.
    """
    try:
        texts = [f for f in files("jointfmu") or () if f.name == "LICENSE"]
        return texts[0].read_text(encoding="utf-8")
    except (PackageNotFoundError, IndexError, OSError):
        raise ValueError("LICENSE: missing in the installed package jointfmu; install it again") from None


def read_licence_files() -> dict[str, bytes]:
    """Read the licence texts of an FMU: {path in its folder documentation: content}.

    Raises ValueError as `read_licence`.
    """
    return {"licenses/license.txt": read_licence().encode()} | dict(_read_third_party_licences())


_WASI_LIBC_LICENCE_FILES = (
    "LICENSE",
    "LICENSE-MIT",
    "libc-top-half/musl/COPYRIGHT",
    "libc-bottom-half/cloudlibc/LICENSE",
)
"""Licence files of wasi-libc, the C library that is linked into WebAssembly modules."""


def read_webassembly_licences() -> str:
    """Read the licence texts of a WebAssembly module: of the package and of wasi-libc.

    Raises ImportError if ziglang is missing, ValueError as `read_licence`.
    """
    folder = Path(str(import_module("ziglang").__file__)).parent / "lib" / "libc" / "wasi"
    texts = (
        f"wasi-libc, {name}\n\n{(folder / name).read_text(encoding='utf-8')}"
        for name in _WASI_LIBC_LICENCE_FILES
    )
    return "\n\n".join([f"jointfmu\n\n{read_licence()}", *texts])


def _read_third_party_licences() -> Iterator[tuple[str, bytes]]:
    """Yield (path in the FMU's folder documentation, content) of each third-party licence text."""
    for path in sorted(_THIRD_PARTY_LICENCE_FOLDER.glob("*.txt")):
        yield f"licenses/{path.name}", path.read_bytes()


def find_copyright_line() -> str:
    """Copyright line of the licence text of the package jointfmu."""
    return next(line for line in read_licence().splitlines() if line.startswith("Copyright"))
