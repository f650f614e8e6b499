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
from jointfmu_fmu_src.xml_parts import PARAMETER_VARIABILITIES

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.kind import JointKind
from jointfmu.parameters import ParameterFile, format_parameter_file

_PRIVATE_PACKAGE_PLACEHOLDER = "PRIVATE_PACKAGE"
"""Placeholder for the name of the private package, which contains a digest of all sources."""
_ENTRY_SCRIPT_TEMPLATE_PATH = Path(__file__).with_name("entry.txt")
"""Template of the Python module that pythonfmu loads."""


def collect_runtime_sources(joint_kind: JointKind) -> dict[str, str]:
    """Collect the Python code inside an FMU of the flavour python: {path in its private package: text}.

    The code is the FMU instance (slave), the joints and all modules that they import; it requires only numpy.
    Imports of public packages become imports of the private package, which has another name in each build. So
    FMUs of different builds can run in one process.
    """
    builtin_packages = [joint.package for joint in KINDS.values() if joint.is_builtin]
    roots = {"jointfmu", "jointfmu_fmu_src", joint_kind.package.partition(".")[0]}
    files = find_imported_modules(
        ["jointfmu_fmu_src.python.slave", *builtin_packages, joint_kind.package], roots
    )
    sources = {}
    for name, path in files.items():
        path_inside = _make_private_module_name(name).replace(".", "/")
        file = (
            "/".join(filter(None, (path_inside, "__init__.py")))
            if path.name == "__init__.py"
            else f"{path_inside}.py"
        )
        sources[file] = _rewrite_imports(path.read_text(encoding="utf-8"), roots)
    return dict(sorted(sources.items()))


def _make_private_module_name(public_module_name: str) -> str:
    """Name inside the private package of an FMU for a public module; empty for the package `jointfmu`."""
    return re.sub(r"^jointfmu\b\.?", "", re.sub(r"^jointfmu_fmu_src\b", "fmus", public_module_name))


def _rewrite_imports(module_text: str, root_package_names: Collection[str]) -> str:
    """Replace imports of public packages by imports of the FMU's private package in the text of a module."""
    for root in root_package_names:
        package = f"{_PRIVATE_PACKAGE_PLACEHOLDER}.{_make_private_module_name(root)}".rstrip(".")
        module_text = re.sub(rf"^from {root}\b", f"from {package}", module_text, flags=re.MULTILINE)
    return module_text


def build_python_fmu(
    fmu_name: str,
    parameter_file: ParameterFile,
    output_folder: Path,
    parameter_variability: str = PARAMETER_VARIABILITIES[0],
    fmu_alias: str = "",
) -> Path:
    """Write `out/NAME.fmu`, or `out/ALIAS.fmu` if an alias is given; an existing file is replaced atomically.

    parameter_variability : FMI variability of all parameters, one of PARAMETER_VARIABILITIES

    Raises ValueError if the parameters are of another joint or the folder cannot be written,
    ImportError if pythonfmu is missing, RuntimeError if its libraries are missing.
    """
    import pythonfmu  # noqa: F401  (fails before anything is written)

    kind = KINDS[MODELS[fmu_name].joint]
    fmu_model = MODELS[fmu_name].with_parameters(parameter_file.joint, parameter_file.values)
    title = replace(fmu_model, alias=fmu_alias).title
    sources = collect_runtime_sources(kind) | {"parameters.toml": format_parameter_file(parameter_file)}
    content = [f"{k}\0{v}" for k, v in sources.items()] + [parameter_variability]
    digest = sha256("\0".join(content).encode()).hexdigest()[:16]
    package = f"jointfmu_{digest}"
    target = output_folder / f"{title}.fmu"
    with staging_folder(target) as work:
        script = work / "src" / f"{title}_{digest}.py"
        entry = {"package": package, "kind": _make_private_module_name(kind.package), "digest": digest}
        entry["variability"] = parameter_variability
        _write_text(
            script,
            _ENTRY_SCRIPT_TEMPLATE_PATH.read_text(encoding="utf-8").format(name=title, fmu=fmu_name, **entry),
        )
        for path, text in sources.items():
            root = work / "src" if path == "parameters.toml" else work / "src" / package
            _write_text(
                root / path,
                text.replace(_PRIVATE_PACKAGE_PLACEHOLDER, package) if path.endswith(".py") else text,
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
        licences = {"license.txt": read_licence().encode(), "pythonfmu.txt": _read_pythonfmu_licence()}
        members |= {f"documentation/licenses/{file}": text for file, text in licences.items()}
        write_archive(
            members | make_proof_files(fmu_model, parameter_file, is_native=False), work / target.name
        )
    return target


def _run_pythonfmu(entry_script_path: Path, private_package_name: str, output_folder: Path) -> Path:
    """Build an FMU with the installed pythonfmu, and restore sys.path and sys.modules afterwards.

    An FMU that runs in this process may have imported its own copy of pythonfmu, which contains no libraries,
    in place of the installed pythonfmu. This copy is removed from sys.modules while the function runs.
    """
    import pythonfmu

    copied = Path(pythonfmu.__file__).parent != Path(_find_pythonfmu_folder(), "pythonfmu")
    names = (private_package_name, entry_script_path.stem, *(["pythonfmu"] if copied else []))
    path, removed_modules = list(sys.path), _remove_modules(names)
    sys.path.insert(0, _find_pythonfmu_folder())
    try:
        from pythonfmu import FmuBuilder

        built: Path = FmuBuilder.build_FMU(
            entry_script_path,
            dest=output_folder,
            project_files=[
                entry_script_path.parent / private_package_name,
                entry_script_path.parent / "parameters.toml",
            ],
            needsExecutionTool=False,
            canGetAndSetFMUstate=True,
            canSerializeFMUstate=True,
        )
    finally:
        sys.path[:] = path
        _remove_modules(names)
        sys.modules.update(removed_modules)
    return built


def _read_pythonfmu_licence() -> bytes:
    """Read the licence text of pythonfmu, whose code the FMU contains.

    Raises RuntimeError if the file is missing.
    """
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


def _write_text(text_file_path: Path, file_text: str) -> None:
    """Write a text file, and make its folder if missing."""
    text_file_path.parent.mkdir(parents=True, exist_ok=True)
    text_file_path.write_text(file_text, encoding="utf-8")
