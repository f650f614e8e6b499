"""What the tools know of a joint: modules of its folder in `tools/joints`, which the folder names.

The folders stand above the tools that they serve. They are read with `import jointfmu_tools`; a part is
loaded when its tool asks for it.
"""

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
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
    "published",
    "reduced",
    "report",
    "ringing",
    "transmission",
)
"""Names that a part may have: each is of the tool that asks for it."""


class ToolParts:
    """The parts of one joint.

    names   : of modules that are called as their tool
    modules : {tool: module}, for one module that serves several tools

    Raises ImportError if a name is of no tool or has no module, or if a tool's module is not named.
    """

    def __init__(self, package: str, names: Sequence[str], **modules: str) -> None:
        self.package, self.modules = package, {name: name for name in names} | modules
        there = {module.name for module in iter_modules([str(self.folder)])}
        wrong = {name: "is of no tool" for name in self.modules if name not in TOOLS}
        wrong |= dict.fromkeys(there & {*TOOLS} - {*names}, "is a part that its __init__.py must name")
        wrong |= {name: "is not there" for name in self.modules.values() if name not in there}
        for name, text in wrong.items():
            raise ImportError(f"{package}.{name} {text}; parts are {', '.join(TOOLS)}")

    @property
    def folder(self) -> Path:
        return Path(str(import_module(self.package).__file__)).parent

    def load(self, tool: str) -> ModuleType | None:
        """The part for a tool; None if the joint has none."""
        return import_module(f"{self.package}.{self.modules[tool]}") if tool in self.modules else None


@dataclass(frozen=True, slots=True)
class Option:
    """What a user states to a part: a word, a number, or a number with a unit of its own, as text.

    name     : on the command line with hyphens
    text     : meaning, a number's with its unit
    metavar  : what stands for its value in the help
    default  : where nothing is stated
    choices  : words that are allowed; none: any
    many     : it takes several
    by       : sign between the numbers of one value, the x of 200x100
    flag     : it takes none
    required : it must be stated
    number   : it is a number in the unit of its text
    unit     : of a number that may be stated with a unit of its own
    unit_by  : the option that states the unit of numbers without one; it is not passed on
    """

    name: str
    text: str
    metavar: str = "VALUE"
    _: KW_ONLY
    default: float | str | None = None
    choices: Sequence[str] = ()
    many: bool = False
    by: str = ""
    flag: bool = False
    required: bool = False
    number: bool = False
    unit: str = ""
    unit_by: str = ""


PARTS: dict[str, ToolParts] = {}
"""{name of a joint: its parts}, filled by `jointfmu_tools.joints`; a joint of another package is added."""


def part(kind: "Kind", tool: str) -> ModuleType | None:
    """What a tool finds of a joint; None if there is nothing."""
    return PARTS[kind.name].load(tool) if kind.name in PARTS else None
