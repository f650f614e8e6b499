"""The WebAssembly component of an FMU after the draft of FMI-LS-WASM.

interface.py has what the draft says, the C files are the layer between its functions and those of FMI 3.0,
wrap.py puts the component around the compiled module.
"""

from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element

from jointfmu.proof.manifest import ATTRIBUTES

from ...xml_parts import serialized
from ..compiler import exported, webassembly
from .interface import PLATFORM, STANDARD, VERSION
from .wrap import component

__all__ = ["members", "module"]


def module(name: str, sources: Mapping[str, str]) -> bytes:
    """The module of an FMU's C sources with the layer.

    Raises ImportError if ziglang is missing, RuntimeError with the compiler's first error.
    """
    files = sorted(path for path in Path(__file__).parent.iterdir() if path.suffix in (".c", ".h"))
    every = {**sources, **{path.name: path.read_text(encoding="utf-8") for path in files}}
    return webassembly(name, every, exported(sorted(every), "3"), defined=["FMI3_Export="])


def members(name: str, inner: bytes) -> dict[str, bytes]:
    """{path in the FMU: content} of an FMU whose module this is, with its data.

    The manifest lies under the draft's name, and under the one that FMI 3.0.1 gives to all layered standards.
    """
    given = {"name": STANDARD, "version": VERSION, "description": "FMI Layered Standard for WebAssembly"}
    root = Element("fmiLayeredStandardManifest", {"xmlns:fmi-ls": ATTRIBUTES})
    root.attrib |= {f"fmi-ls:fmi-ls-{key}": value for key, value in given.items()}
    manifest = serialized(root)
    return {
        f"binaries/{PLATFORM}/{name}.wasm": component(inner),
        f"extra/{STANDARD}/manifest.xml": manifest,
        f"extra/{STANDARD}/fmi-ls-manifest.xml": manifest,
    }
