"""`jointfmu build`: names and flavours to FMU files."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path

from jointfmu.files.outputs import ARCHIVE, check_outputs
from jointfmu.joints import MODELS
from jointfmu.parameters import ParameterFile, default
from jointfmu.progress import each

from .naming import checked_name
from .native.build import build as build_native
from .python.build import build as build_python
from .xml_parts import VARIABILITIES

FLAVOURS: dict[str, Callable[..., Path]] = {
    "fmi2": partial(build_native, version="2"),
    "fmi3": partial(build_native, version="3"),
    "python": build_python,
}


def build(
    names: Sequence[str],
    flavours: Sequence[str],
    parameters: ParameterFile | None,
    out: Path,
    variability: str = VARIABILITIES[0],
    alias: str | None = None,
    pool: Executor | None = None,
    force: bool = False,
) -> list[Path]:
    """Build FMUs into `out/FLAVOUR/NAME.fmu`; with a parameter file and no names, those of its joint.

    variability : of the parameters, one of VARIABILITIES
    alias       : the name that one FMU has instead of its own
    pool        : processes that share the work; None: this one does it
    force       : replace FMUs of these names that jointfmu did not write

    Raises ValueError for an unknown name or flavour, a parameter file of another joint, an alias that is
    no identifier or for several FMUs, or files that may not or cannot be written,
    before anything is built where that can be known.
    """
    for noun, given, allowed in (("FMU", names, list(MODELS)), ("flavour", flavours, list(FLAVOURS))):
        if unknown := [name for name in given if name not in allowed]:
            raise ValueError(f"unknown {noun} {unknown[0]!r}, allowed are {', '.join(allowed)}")
    if not names:
        joint = parameters.joint if parameters else None
        names = [name for name, model in MODELS.items() if joint in (None, model.joint)]
    if alias is not None and len(set(names)) != 1:
        raise ValueError(f"name {alias!r} is for one FMU, expected one of {', '.join(names)}")
    if alias is not None:
        checked_name(alias)
    for name in names:
        if parameters:
            MODELS[name].of(parameters.joint, parameters.values)
    titles = [alias or name for name in names]
    check_outputs((out / f / f"{title}.fmu" for f in flavours for title in titles), ARCHIVE, force)
    how = {"variability": variability, "alias": alias or ""}
    work = partial(_built, flavours, parameters, out, how)
    built = each(pool, work, "build", names)
    return [path for paths in zip(*built, strict=True) for path in paths]


def _built(
    flavours: Sequence[str], parameters: ParameterFile | None, out: Path, how: Mapping[str, str], name: str
) -> list[Path]:
    """Build an FMU in some flavours, which share what is compiled; `how`: its variability and alias."""
    file = parameters or default(MODELS[name].joint)
    return [FLAVOURS[flavour](name, file, out / flavour, **how) for flavour in flavours]
