"""What the tools know of a joint: modules of its folder in `tools/joints`, which the folder names.

The folders stand above the tools that they serve. They are read with `import jointfmu_tools`; a part is
loaded when its tool asks for it.
"""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the command line begins here, and is there at once
    from jointfmu.joints.kind import Kind

TOOLS = (
    "catalogue",
    "checks",
    "export",
    "field",
    "figures",
    "fit",
    "frequencies",
    "interface",
    "laboratory",
    "modelica",
    "new",
    "pressure",
    "reduced",
    "report",
    "ringing",
)
"""Names that a part may have: each is of the tool that asks for it."""


class ToolParts:
    """The parts of one joint.

    Raises ImportError if a name is of no tool or has no module, or if a tool's module is not named.
    """

    def __init__(self, package: str, names: Sequence[str]) -> None:
        self.package, self.names = package, names
        there = {module.name for module in iter_modules([str(self.folder)])}
        for name in {*names} ^ (there & {*TOOLS}):
            wrong = "is a part that its __init__.py must name" if name in TOOLS else "is of no tool"
            wrong = wrong if name in there else "is not there"
            raise ImportError(f"{package}.{name} {wrong}; parts are {', '.join(TOOLS)}")

    @property
    def folder(self) -> Path:
        """The joint's folder."""
        return Path(str(import_module(self.package).__file__)).parent

    def load(self, tool: str) -> ModuleType | None:
        """The part for a tool; None if the joint has none."""
        return import_module(f"{self.package}.{tool}") if tool in self.names else None


PARTS: dict[str, ToolParts] = {}
"""{name of a joint: its parts}, filled by `jointfmu_tools.joints`; a joint of another package is added."""


def part(kind: "Kind", tool: str) -> ModuleType | None:
    """What a tool finds of a joint; None if there is nothing."""
    return PARTS[kind.name].load(tool) if kind.name in PARTS else None
