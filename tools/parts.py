"""What a tool finds of a joint: the module of the tool's name in the joint's folder of `tools/joints`."""

from importlib import import_module
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from jointfmu.joints.kind import Kind


def part(kind: Kind, tool: str) -> ModuleType | None:
    """The module; None if there is none. A joint of another package has them in its own, as `tools`."""
    package = f"{__package__}.joints.{kind.name}" if kind.own else f"{kind.package}.tools"
    name = f"{package}.{tool}"
    return import_module(name) if find_spec(package) and find_spec(name) else None


def folder(kind: Kind) -> Path:
    """The joint's folder of parts; need not be there."""
    package = f"{__package__}.joints.{kind.name}" if kind.own else kind.package
    return Path(str(files(package))) / ("" if kind.own else "tools")
