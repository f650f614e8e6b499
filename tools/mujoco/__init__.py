"""A joint between two flanges as MuJoCo's passive force: an FMU's own C sources, compiled to its plugin."""

from importlib.util import find_spec
from pathlib import Path

import fmpy
from jointfmu_fmu_src.archive import workshop
from jointfmu_fmu_src.native.compiled.compiler import file_name, libraries

from jointfmu.files import archives

from ..host import description

INPUTS = ["phi1", "w1", "phi2", "w2"]
TORQUES = ["tau1", "tau2"]


def plugin(fmu: str | Path, out: str | Path) -> Path:
    """Compile a native FMU (fmi3, or fmi2) to a plugin of the installed MuJoCo, for this machine.

    `mujoco.mj_loadPluginLibrary` takes the file, which is `out/NAME.so` (macOS: `.dylib`); the plugin is
    `jointfmu.NAME`, with the FMU's parameters as its attributes, and the joints for `phi1` and `phi2`.

    Raises ValueError if the FMU is none of two flanges, has no sources or cannot be read, if there is no
    library of MuJoCo to link to or `out` cannot be written; ImportError if mujoco or ziglang is missing;
    RuntimeError with the compiler's first error.
    """
    name, sources = _sources(Path(fmu))
    include, library = _mujoco()
    own = Path(__file__).with_name("plugin.c")
    files = sources | {own.name: own.read_text(encoding="utf-8")}
    units = [path for path in files if path.endswith(".c") and path not in ("fmi2.c", "fmi3.c")]
    platform = fmpy.platform_tuple
    (built,) = libraries(name, files, units, [platform], linked=(f"-I{include}", str(library))).values()
    target = Path(out) / file_name(name, platform)
    with workshop(target) as work:
        (work / target.name).write_bytes(built)
    return target


def _sources(fmu: Path) -> tuple[str, dict[str, str]]:
    """Name of an FMU and its C files."""
    described = description(fmu)
    with archives.open_archive(fmu) as archive:
        sources = {
            member.removeprefix("sources/"): archives.read_member(archive, member).decode()
            for member in archive.namelist()
            if member.startswith("sources/") and member.endswith((".c", ".h"))
        }
    names = {
        kind: [v.name for v in described.modelVariables if v.causality == kind]
        for kind in ("input", "output")
    }
    if names["input"][: len(INPUTS)] != INPUTS or names["output"][:2] != TORQUES:
        raise ValueError(
            f"{fmu}: has the inputs {', '.join(names['input']) or 'none'}; expected a joint with "
            f"{', '.join(INPUTS)} and the outputs {', '.join(TORQUES)}"
        )
    if "instance.h" not in sources:
        raise ValueError(f"{fmu}: has no C sources of jointfmu; expected an FMU of flavour fmi2 or fmi3")
    return described.modelName, sources


def _mujoco() -> tuple[Path, Path]:
    """Headers and shared library of the installed MuJoCo."""
    spec = find_spec("mujoco")
    if spec is None or spec.origin is None:
        raise ImportError("mujoco is missing: pip install mujoco", name="mujoco")
    folder = Path(spec.origin).parent
    found = [*folder.glob("libmujoco.so.*"), *folder.glob("libmujoco.*.dylib")]
    if not found:
        raise ValueError(f"{folder}: holds no libmujoco to link to; expected MuJoCo on Linux or macOS")
    return folder / "include", found[0]
