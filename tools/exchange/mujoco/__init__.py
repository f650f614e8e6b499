"""MuJoCo plugin of a joint between two flanges, a passive force compiled from the C sources of its FMU."""

from importlib.util import find_spec
from pathlib import Path

import fmpy
from jointfmu_fmu_src.archive import staging_folder
from jointfmu_fmu_src.native.compiled.compiler import compile_libraries, make_library_file_name

from jointfmu.files import archives

from ...run.host import read_description

FLANGE_INPUTS = ["phi1", "w1", "phi2", "w2"]
"""Angles and speeds of both flanges: the first inputs of an FMU of a joint between two flanges."""
FLANGE_TORQUES = ["tau1", "tau2"]
"""Torques on both flanges: the first outputs of an FMU of a joint between two flanges."""


def plugin(fmu: str | Path, out: str | Path) -> Path:
    """Compile a native FMU (fmi3 or fmi2) to a plugin of the installed MuJoCo, for this machine.

    Returns the library `out/NAME.so` (macOS: `.dylib`), which `mujoco.mj_loadPluginLibrary` loads. The plugin
    is called `jointfmu.NAME`. Its attributes are the parameters of the FMU, and `phi1` and `phi2`, the names
    of the two MuJoCo joints.

    Raises ValueError if the FMU is no joint with two flanges, has no sources or cannot be read, if MuJoCo has
    no library to link to, or if `out` cannot be written; ImportError if mujoco or ziglang is missing;
    RuntimeError with the first error of the compiler.
    """
    name, sources = _read_sources(Path(fmu))
    include, library = _find_mujoco()
    plugin_source = Path(__file__).with_name("plugin.c")
    files = sources | {plugin_source.name: plugin_source.read_text(encoding="utf-8")}
    units = [path for path in files if path.endswith(".c") and path not in ("fmi2.c", "fmi3.c")]
    platform = fmpy.platform_tuple
    (content,) = compile_libraries(
        name, files, units, [platform], linker_options=(f"-I{include}", str(library))
    ).values()
    target = Path(out) / make_library_file_name(name, platform)
    with staging_folder(target) as work:
        (work / target.name).write_bytes(content)
    return target


def _read_sources(fmu: Path) -> tuple[str, dict[str, str]]:
    """Read the name of an FMU and {file name: text} of its C sources.

    Raises ValueError if the FMU has no two flanges or no sources.
    """
    model_description = read_description(fmu)
    with archives.open_archive(fmu) as archive:
        sources = {
            member.removeprefix("sources/"): archives.read_member(archive, member).decode()
            for member in archive.namelist()
            if member.startswith("sources/") and member.endswith((".c", ".h"))
        }
    names = {
        kind: [v.name for v in model_description.modelVariables if v.causality == kind]
        for kind in ("input", "output")
    }
    if names["input"][: len(FLANGE_INPUTS)] != FLANGE_INPUTS or names["output"][:2] != FLANGE_TORQUES:
        raise ValueError(
            f"{fmu}: has the inputs {', '.join(names['input']) or 'none'}; expected a joint with "
            f"{', '.join(FLANGE_INPUTS)} and the outputs {', '.join(FLANGE_TORQUES)}"
        )
    if "instance.h" not in sources:
        raise ValueError(f"{fmu}: has no C sources of jointfmu; expected an FMU of flavour fmi2 or fmi3")
    return model_description.modelName, sources


def _find_mujoco() -> tuple[Path, Path]:
    """Header folder and shared library of the installed MuJoCo."""
    spec = find_spec("mujoco")
    if spec is None or spec.origin is None:
        raise ImportError("mujoco is missing: pip install mujoco", name="mujoco")
    folder = Path(spec.origin).parent
    library_paths = [*folder.glob("libmujoco.so.*"), *folder.glob("libmujoco.*.dylib")]
    if not library_paths:
        raise ValueError(f"{folder}: holds no libmujoco to link to; expected MuJoCo on Linux or macOS")
    return folder / "include", library_paths[0]
