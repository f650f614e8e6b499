"""Build FMUs of the flavour python: pythonfmu with a private copy of the package."""

import re
import sys
import zipfile
from collections.abc import Collection
from dataclasses import replace
from hashlib import sha256
from importlib.metadata import distribution
from pathlib import Path
from types import ModuleType

from jointfmu_fmu_src.archive import staging_folder, write_archive
from jointfmu_fmu_src.licence import read_licence
from jointfmu_fmu_src.proof.members import make_proof_files
from jointfmu_fmu_src.python.imports import find_imported_modules
from jointfmu_fmu_src.xml_parts import VARIABILITIES

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.kind import JointKind
from jointfmu.parameters import ParameterFile, format_parameter_file

_PACKAGE_PLACEHOLDER = "PRIVATE_PACKAGE"
"""Placeholder for the name of the private package, which contains a digest of all sources."""
_ENTRY_SCRIPT_TEMPLATE_PATH = Path(__file__).with_name("entry.txt")
"""Template of the Python module that pythonfmu loads."""


def collect_runtime_sources(joint_kind: JointKind) -> dict[str, str]:
    """Collect the Python code inside an FMU: {path inside the private package: text}; it requires only numpy.

    The code is the slave, the joints and all modules that they import. Imports of the public packages are
    rewritten to the private package, so FMUs of different builds can run in one process.
    """
    builtin_packages = [joint.package for joint in KINDS.values() if joint.is_builtin]
    roots = {"jointfmu", "jointfmu_fmu_src", joint_kind.package.partition(".")[0]}
    files = find_imported_modules(
        ["jointfmu_fmu_src.python.slave", *builtin_packages, joint_kind.package], roots
    )
    sources = {}
    for name, path in files.items():
        path_inside = _private_module_name(name).replace(".", "/")
        file = (
            "/".join(filter(None, (path_inside, "__init__.py")))
            if path.name == "__init__.py"
            else f"{path_inside}.py"
        )
        sources[file] = _rewrite_imports(path.read_text(encoding="utf-8"), roots)
    return dict(sorted(sources.items()))


def _private_module_name(module: str) -> str:
    """Name of a public module inside the private package; empty for the package `jointfmu` itself."""
    return re.sub(r"^jointfmu\b\.?", "", re.sub(r"^jointfmu_fmu_src\b", "fmus", module))


def _rewrite_imports(module_text: str, root_packages: Collection[str]) -> str:
    """Rewrite the imports of public packages in a module text to the private package."""
    for root in root_packages:
        package = f"{_PACKAGE_PLACEHOLDER}.{_private_module_name(root)}".rstrip(".")
        module_text = re.sub(rf"^from {root}\b", f"from {package}", module_text, flags=re.MULTILINE)
    return module_text


def build_python_fmu(
    fmu_name: str,
    parameters: ParameterFile,
    output_folder: Path,
    variability: str = VARIABILITIES[0],
    alias: str = "",
) -> Path:
    """Write `out/NAME.fmu`, or `out/ALIAS.fmu` if an alias is given; an existing file is replaced atomically.

    variability : FMI variability of all parameters, one of VARIABILITIES

    Raises ValueError if the parameters are of another joint or the folder cannot be written,
    ImportError if pythonfmu is missing, RuntimeError if its libraries are missing.
    """
    import pythonfmu  # noqa: F401  (fails before anything is written)

    kind = KINDS[MODELS[fmu_name].joint]
    model = MODELS[fmu_name].with_parameters(parameters.joint, parameters.values)
    title = replace(model, alias=alias).title
    sources = collect_runtime_sources(kind) | {"parameters.toml": format_parameter_file(parameters)}
    content = [f"{k}\0{v}" for k, v in sources.items()] + [variability]
    digest = sha256("\0".join(content).encode()).hexdigest()[:16]
    package = f"jointfmu_{digest}"
    target = output_folder / f"{title}.fmu"
    with staging_folder(target) as work:
        script = work / "src" / f"{title}_{digest}.py"
        entry = {"package": package, "kind": _private_module_name(kind.package), "digest": digest}
        entry["variability"] = variability
        _write_text(
            script,
            _ENTRY_SCRIPT_TEMPLATE_PATH.read_text(encoding="utf-8").format(name=title, fmu=fmu_name, **entry),
        )
        for path, text in sources.items():
            root = work / "src" if path == "parameters.toml" else work / "src" / package
            _write_text(
                root / path, text.replace(_PACKAGE_PLACEHOLDER, package) if path.endswith(".py") else text
            )
        built = _run_pythonfmu(script, package, work / "out")
        with zipfile.ZipFile(built) as archive:
            members = {n: archive.read(n) for n in archive.namelist() if "__pycache__" not in n}
        if not any(name.startswith("binaries/") for name in members):
            raise RuntimeError(
                f"{title}: pythonfmu in {_find_pythonfmu_folder()} has no libraries for an FMU; "
                "expected them below "
                "pythonfmu/resources/binaries: install it again"
            )
        licences = {"license.txt": read_licence().encode(), "pythonfmu.txt": _pythonfmu_licence()}
        members |= {f"documentation/licenses/{file}": text for file, text in licences.items()}
        write_archive(members | make_proof_files(model, parameters, is_native=False), work / target.name)
    return target


def _run_pythonfmu(script: Path, package: str, output_folder: Path) -> Path:
    """Build an FMU with the installed pythonfmu, and restore sys.path and sys.modules afterwards.

    An FMU that runs in this process may have imported its own copy of pythonfmu, which has no libraries, in
    place of the installed one. That copy is then removed from sys.modules while this function runs.
    """
    import pythonfmu

    copied = Path(pythonfmu.__file__).parent != Path(_find_pythonfmu_folder(), "pythonfmu")
    names = (package, script.stem, *(["pythonfmu"] if copied else []))
    path, removed_modules = list(sys.path), _remove_modules(names)
    sys.path.insert(0, _find_pythonfmu_folder())
    try:
        from pythonfmu import FmuBuilder

        built: Path = FmuBuilder.build_FMU(
            script,
            dest=output_folder,
            project_files=[script.parent / package, script.parent / "parameters.toml"],
            needsExecutionTool=False,
            canGetAndSetFMUstate=True,
            canSerializeFMUstate=True,
        )
    finally:
        sys.path[:] = path
        _remove_modules(names)
        sys.modules.update(removed_modules)
    return built


def _pythonfmu_licence() -> bytes:
    """Licence text of pythonfmu, whose code the FMU contains; RuntimeError if the file is missing."""
    files = [file for file in distribution("pythonfmu").files or () if file.name == "LICENSE"]
    if not files:
        raise RuntimeError(f"pythonfmu in {_find_pythonfmu_folder()} has no file LICENSE; install it again")
    return Path(str(files[0].locate())).read_bytes()


def _find_pythonfmu_folder() -> str:
    """Folder in which pythonfmu is installed."""
    return str(distribution("pythonfmu").locate_file(""))


def _remove_modules(package_names: Collection[str]) -> dict[str, ModuleType]:
    """Remove the modules of packages from sys.modules and return them; the next import loads them again."""
    loaded = [name for name in sys.modules if name.partition(".")[0] in package_names]
    return {name: sys.modules.pop(name) for name in loaded}


def _write_text(path: Path, text: str) -> None:
    """Write a text file, and make its folder if missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
