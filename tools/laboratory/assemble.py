"""The page: template, style, scripts, and its content, packed.

The content is one gzip stream: the length of a JSON text, the text that describes the modules, the modules.
"""

import gzip
import json
import struct
from base64 import b64encode
from pathlib import Path

from jointfmu_fmu_src.joint_parts import chart
from jointfmu_fmu_src.native.licence import webassembly_licences
from jointfmu_fmu_src.templates import template

from jointfmu import __version__
from jointfmu.contact.roughness import FACTOR
from jointfmu.files.writing import write_text
from jointfmu.parameters import ORIGINS, SAME_HEIGHT
from jointfmu.quantity import units

from .describe import compiled, described, modules

_FOLDER = Path(__file__).with_name("web")
_SCRIPTS = (*("engine", "sight", "controls"), *("curves", "path", "turn", "contact", "body", "files", "main"))
"""Files of the page, in the order in which they are run, after the charts."""
_FILE_UNITS = {
    "rad": ("rad", "mrad", "deg", "arcmin", "arcsec"),
    "m": ("m", "mm", "um", "nm"),
    "N.m": ("N.m", "mN.m", "kN.m"),
    "N": ("N", "kN"),
}
"""Units of the columns that the page reads."""


def write_laboratory(path: Path) -> None:
    """Write the page, self-contained; an existing file is replaced in one go.

    Raises ValueError if it cannot be written, ImportError if ziglang is missing, RuntimeError if the
    compiler fails.
    """
    write_text(path, page())


def page() -> str:
    """The page as text."""
    every = modules()
    binaries = compiled(every)
    sizes = [len(binary) for binary in binaries]
    known = {
        "modules": [described(module) | {"size": n} for module, n in zip(every, sizes, strict=True)],
        "origins": ORIGINS,
        "roughness": {"factor": FACTOR, "close": SAME_HEIGHT},
        "units": {base: units.sizes(base, *others) for base, others in _FILE_UNITS.items()},
    }
    text = json.dumps(known, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    content = gzip.compress(b"".join([struct.pack("<I", len(text)), text, *binaries]), 9, mtime=0)
    return template(_FOLDER / "page.html").render(
        version=__version__,
        style=chart.style() + web_file("style.css"),
        script=chart.script() + "\n".join(web_file(f"{name}.js") for name in _SCRIPTS),
        content=b64encode(content).decode(),
        licences=webassembly_licences(),
    )


def web_file(name: str) -> str:
    """A file of the page as text; the report takes the style from here."""
    return (_FOLDER / name).read_text(encoding="utf-8")
