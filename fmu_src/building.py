"""Build FMUs by name and flavour, as `jointfmu build` does."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path

from jointfmu.files.outputs import ARCHIVE_FILE, check_outputs
from jointfmu.joints import MODELS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.progress import map_jobs

from .naming import check_fmu_name
from .native.build import build_native_fmu as build_native
from .python.build import build_python_fmu as build_python
from .xml_parts import PARAMETER_VARIABILITIES

FLAVOUR_BUILDERS: dict[str, Callable[..., Path]] = {
    "fmi2": partial(build_native, fmi_version="2"),
    "fmi3": partial(build_native, fmi_version="3"),
    "python": build_python,
}
"""{flavour of an FMU: function that builds one FMU in this flavour}."""


def build_fmus(
    fmu_names: Sequence[str],
    fmu_flavours: Sequence[str],
    parameter_file: ParameterFile | None,
    output_folder: Path,
    parameter_variability: str = PARAMETER_VARIABILITIES[0],
    fmu_alias: str | None = None,
    process_pool: Executor | None = None,
    replace_foreign_files: bool = False,
) -> list[Path]:
    """Build FMUs into `out/FLAVOUR/NAME.fmu` and return their paths.

    fmu_names             : FMUs to build; if empty: all FMUs of the joint of the parameter file, else of all
        joints
    fmu_flavours          : flavours to build: fmi2, fmi3, python
    parameter_file        : parameter file of a joint; None: the default file of each joint
    parameter_variability : FMI variability of all parameters, one of PARAMETER_VARIABILITIES
    fmu_alias             : name of the FMU instead of its own; only for a single FMU
    process_pool          : processes that build in parallel; None: build in this process
    replace_foreign_files : whether to replace also files that jointfmu did not write

    Raises ValueError for an unknown name or flavour, a parameter file of another joint, an alias that is
    no identifier or is given for several FMUs, and files that may not or cannot be replaced. These checks
    come before the first build where possible.
    """
    for noun, values, allowed in (
        ("FMU", fmu_names, list(MODELS)),
        ("flavour", fmu_flavours, list(FLAVOUR_BUILDERS)),
    ):
        if unknown := [value for value in values if value not in allowed]:
            raise ValueError(f"unknown {noun} {unknown[0]!r}, allowed are {', '.join(allowed)}")
    if not fmu_names:
        joint = parameter_file.joint if parameter_file else None
        fmu_names = [name for name, model in MODELS.items() if joint in (None, model.joint)]
    if fmu_alias is not None and len(set(fmu_names)) != 1:
        raise ValueError(f"name {fmu_alias!r} is for one FMU; state one FMU of {', '.join(fmu_names)}")
    if fmu_alias is not None:
        check_fmu_name(fmu_alias)
    for name in fmu_names:
        if parameter_file:
            MODELS[name].with_parameters(parameter_file.joint, parameter_file.values)
    titles = [fmu_alias or name for name in fmu_names]
    check_outputs(
        (output_folder / f / f"{title}.fmu" for f in fmu_flavours for title in titles),
        ARCHIVE_FILE,
        replace_foreign_files,
    )
    options = {"parameter_variability": parameter_variability, "fmu_alias": fmu_alias or ""}
    build_one = partial(_build_flavours, fmu_flavours, parameter_file, output_folder, options)
    paths_by_name = map_jobs(process_pool, build_one, "build", fmu_names)
    return [path for paths in zip(*paths_by_name, strict=True) for path in paths]


def _build_flavours(
    fmu_flavours: Sequence[str],
    parameter_file: ParameterFile | None,
    output_folder: Path,
    build_options: Mapping[str, str],
    fmu_name: str,
) -> list[Path]:
    """Build one FMU in several flavours, which share the compiled model. Returns the paths of the files."""
    file = parameter_file or load_default(MODELS[fmu_name].joint)
    return [
        FLAVOUR_BUILDERS[flavour](fmu_name, file, output_folder / flavour, **build_options)
        for flavour in fmu_flavours
    ]
