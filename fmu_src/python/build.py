"""Build the python flavour: pythonfmu's wrapper around a private copy of the package."""

import re
import sys
import zipfile
from hashlib import sha256
from pathlib import Path

from jointfmu_fmus.archive import pack, workshop
from jointfmu_fmus.variables import MODELS

import jointfmu
from jointfmu.parameters import ParameterFile, dump

_RUNTIME = (
    "__init__", "quantity", "surface", "powerlaw", "interface", "curve", "table", "parameters", "stamp",
    "units", "asperity", "footprint", "joints",
)  # fmt: skip
_PRIVATE = "PRIVATE_PACKAGE"
"""Stands for the name that the digest of all sources gives."""
_ENTRY = '''"""Entry point of {name} for pythonfmu; the code is in the package beside it."""

import atexit
import ctypes
import sys
from pathlib import Path

# At exit pythonfmu 0.7 reads what it has freed, unless it is asked to tidy up before.
for library in Path(__file__).resolve().parent.parent.glob("binaries/*/{name}.so"):
    try:
        atexit.register(ctypes.CDLL(str(library)).finalizePythonInterpreter)
    except (OSError, AttributeError):
        pass
# pythonfmu 0.7 runs this file once per instance and gives back one reference to its globals too many
# each time: without this one the second instance would find them freed.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

try:
    import numpy  # noqa: F401
except ImportError as error:
    raise ImportError(
        f"{name} needs the Python package numpy, which {{sys.executable}} lacks ({{error}}); "
        f"install it with: {{sys.executable}} -m pip install numpy"
    ) from None

import {package}.fmus.python.slave as slave


class {name}(slave.JointSlave):
    fmu = "{name}"
    content = "{digest}"
'''


def runtime_sources() -> dict[str, str]:
    """{path inside the private package: text} of all that runs inside the FMU; numpy is its only need.

    Imports of the public package names are rewritten to a private one, so FMUs of different builds
    live side by side in one process.
    """
    core, fmus = Path(jointfmu.__file__).parent, Path(__file__).parent.parent
    files = {p: p.relative_to(core) for p in sorted(core.rglob("*.py"))}
    chosen = {p: str(r) for p, r in files.items() if r.parts[0].removesuffix(".py") in _RUNTIME}
    shared = ("__init__.py", "variables.py", "xml_parts.py")
    chosen |= {fmus / p: f"fmus/{p}" for p in shared}
    chosen |= {fmus / "python" / p: f"fmus/python/{p}" for p in ("__init__.py", "slave.py")}
    return {inside: _private(p.read_text(encoding="utf-8")) for p, inside in sorted(chosen.items())}


def _private(text: str) -> str:
    text = re.sub(r"^from jointfmu_fmus\b", f"from {_PRIVATE}.fmus", text, flags=re.MULTILINE)
    return re.sub(r"^from jointfmu\b", f"from {_PRIVATE}", text, flags=re.MULTILINE)


def build(name: str, parameters: ParameterFile, out: Path) -> Path:
    """Write `out/name.fmu`; an existing file is replaced in one go.

    Raises ValueError if the parameters are of another joint or the folder cannot be written,
    ImportError if pythonfmu is missing.
    """
    from pythonfmu import FmuBuilder

    MODELS[name].check_joint(parameters.joint)
    sources = runtime_sources() | {"parameters.toml": dump(parameters)}
    digest = sha256("\0".join(f"{k}\0{v}" for k, v in sources.items()).encode()).hexdigest()[:16]
    package = f"jointfmu_{digest}"
    target = out / f"{name}.fmu"
    with workshop(target) as work:
        script = work / "src" / f"{name}_{digest}.py"
        _write(script, _ENTRY.format(name=name, package=package, digest=digest))
        for inside, text in sources.items():
            root = work / "src" if inside == "parameters.toml" else work / "src" / package
            _write(root / inside, text.replace(_PRIVATE, package) if inside.endswith(".py") else text)
        built = _pythonfmu(FmuBuilder, script, package, work / "out")
        with zipfile.ZipFile(built) as made:
            members = {n: made.read(n) for n in made.namelist() if "__pycache__" not in n}
        pack(members, work / target.name)
    return target


def _pythonfmu(builder: type, script: Path, package: str, out: Path) -> Path:
    """Run pythonfmu and leave the process as it was: its sys.path and modules are taken back."""
    path, modules = list(sys.path), set(sys.modules)
    try:
        built: Path = builder.build_FMU(  # type: ignore[attr-defined]
            script,
            dest=out,
            project_files=[script.parent / package, script.parent / "parameters.toml"],
            needsExecutionTool=False,
            canGetAndSetFMUstate=True,
            canSerializeFMUstate=True,
        )
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - modules:
            if name.split(".")[0] in (package, script.stem):
                del sys.modules[name]
    return built


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
