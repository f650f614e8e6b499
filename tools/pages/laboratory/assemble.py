"""Assembly of the laboratory page from template, style, scripts and packed content.

The content is one gzip stream: the length of a JSON text, the JSON text that describes the WebAssembly
modules, and the modules.
"""

import gzip
import json
import struct
from base64 import b64encode
from pathlib import Path

from jointfmu_fmu_src.joint_parts import chart
from jointfmu_fmu_src.licence import read_webassembly_licences
from jointfmu_fmu_src.templates import load_jinja_template

from jointfmu.contact.roughness import RQ_OVER_RA
from jointfmu.files.writing import write_text
from jointfmu.parameters import RELATIVE_HEIGHT_TOLERANCE, VALUE_ORIGIN_BY_FORMER_NAME, VALUE_ORIGINS
from jointfmu.quantity import units
from jointfmu.version import __version__

from .describe import compile_modules, describe_module, list_modules

_WEB_FOLDER = Path(__file__).with_name("web")
"""Folder with template, style sheet and scripts of the page."""
_SCRIPT_NAMES = (
    *("engine", "sight", "controls"),
    *("curves", "path", "turn", "contact", "body", "files", "main"),
)
"""Scripts of the page in the order of execution, after the script of the charts."""
_COLUMN_UNITS = {
    "rad": ("rad", "mrad", "deg", "arcmin", "arcsec"),
    "m": ("m", "mm", "um", "nm"),
    "N.m": ("N.m", "mN.m", "kN.m"),
    "N": ("N", "kN"),
}
"""{SI unit: units that columns of an opened file may have}."""


def write_laboratory(page_path: Path) -> None:
    """Write the laboratory as a self-contained page; an existing file is replaced atomically.

    Raises ValueError if it cannot be written, ImportError if ziglang is missing, RuntimeError if the
    compiler fails.
    """
    write_text(page_path, render_page())


def render_page() -> str:
    """Render the laboratory page as HTML text."""
    page_modules = list_modules()
    binaries = compile_modules(page_modules)
    sizes = [len(binary) for binary in binaries]
    document = {
        "modules": [
            describe_module(module) | {"size": n} for module, n in zip(page_modules, sizes, strict=True)
        ],
        "origins": [*VALUE_ORIGINS, *VALUE_ORIGIN_BY_FORMER_NAME],
        "roughness": {"factor": RQ_OVER_RA, "close": RELATIVE_HEIGHT_TOLERANCE},
        "units": {base: units.unit_sizes(base, *others) for base, others in _COLUMN_UNITS.items()},
    }
    text = json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    content = gzip.compress(b"".join([struct.pack("<I", len(text)), text, *binaries]), 9, mtime=0)
    return load_jinja_template(_WEB_FOLDER / "page.html").render(
        version=__version__,
        style=chart.read_chart_style() + read_web_file("style.css"),
        script=chart.read_chart_script() + "\n".join(read_web_file(f"{name}.js") for name in _SCRIPT_NAMES),
        content=b64encode(content).decode(),
        licences=read_webassembly_licences(),
    )


def read_web_file(file_name: str) -> str:
    """Read a source file of the page (template, style sheet, script) as text."""
    return (_WEB_FOLDER / file_name).read_text(encoding="utf-8")
