"""Licence texts inside an FMU: of the package, and of third-party code in the binaries.

No library of the compiler is linked (`compiled/compiler.py`). Binaries for Linux and macOS use the libraries
of the system; those for Windows use its C runtime through import stubs of mingw-w64. So the only third-party
code in a binary is what the headers of FMI and of mingw-w64 declare.
"""

from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

_THIRD_PARTY_FOLDER = Path(__file__).with_name("licenses")
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


def licence_files() -> dict[str, bytes]:
    """{path in the folder documentation: content} of an FMU's licence texts; raises as `read_licence`."""
    return {"licenses/license.txt": read_licence().encode()} | dict(_third_party_licences())


_WASI_LICENCES = (
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
    texts = (f"wasi-libc, {name}\n\n{(folder / name).read_text(encoding='utf-8')}" for name in _WASI_LICENCES)
    return "\n\n".join([f"jointfmu\n\n{read_licence()}", *texts])


def _third_party_licences() -> Iterator[tuple[str, bytes]]:
    """Yield path in an FMU and content of each third-party licence text."""
    for path in sorted(_THIRD_PARTY_FOLDER.glob("*.txt")):
        yield f"licenses/{path.name}", path.read_bytes()


def find_copyright_line() -> str:
    """Copyright line of the licence text."""
    return next(line for line in read_licence().splitlines() if line.startswith("Copyright"))
