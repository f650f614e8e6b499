"""What the builders know of each joint, a folder each; a builder finds its file there by its own name."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from jointfmu.joints.kind import Kind


def package(kind: Kind) -> str:
    """Import name of a joint's folder here; a joint of another package has it in its own, as `fmu`."""
    return f"{__name__}.{kind.name}" if kind.own else f"{kind.package}.fmu"


def part(kind: Kind, builder: str) -> ModuleType | None:
    """What a builder finds in the joint's folder, the module of the builder's name; None if there is none."""
    name = f"{package(kind)}.{builder}"
    return import_module(name) if find_spec(package(kind)) and find_spec(name) else None


def folder(kind: Kind) -> Path:
    """The joint's folder: page, icons, C part, Modelica templates.

    Raises ValueError if there is none.
    """
    spec = find_spec(package(kind))
    if spec is None or not spec.submodule_search_locations:
        raise ValueError(
            f"joint {kind.name!r}: {package(kind)} is missing; expected the folder of its FMU parts"
        )
    return Path(spec.submodule_search_locations[0])
