"""Tool modules of the joints: which module of a joint's folder in `tools/joints` serves which tool.

The `__init__.py` of the folder names the modules (`JointToolModules`). `import jointfmu_tools` reads these
names; a module is imported when its tool asks for it.
"""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the command line imports this module first: no slow imports
    from jointfmu.joints.kind import JointKind

TOOL_NAMES = (
    "checks",
    "export",
    "figures",
    "fit",
    "laboratory",
    "modelica",
    "new",
    "pressure",
    "published",
    "report",
    "ringing",
    "uncertainty",
)
"""Tools that look for a module in the folder of a joint."""


class JointToolModules:
    """Tool modules of one joint: which module of its folder serves which tool.

    package_name : name of the package that is the joint's folder
    module_names : tools that are served by a module of the same name
    modules      : {tool: name of its module}, for tools served by a module of another name

    Raises ImportError if a name is not in TOOL_NAMES, if a named module is missing, or if the folder has a
    module with the name of a tool that is not in `module_names`.
    """

    def __init__(self, package_name: str, module_names: Sequence[str], **modules: str) -> None:
        self.package, self.modules = package_name, {name: name for name in module_names} | modules
        existing = {module.name for module in iter_modules([str(self.joint_folder)])}
        faults = {name: "is a part that no tool uses" for name in self.modules if name not in TOOL_NAMES}
        faults |= dict.fromkeys(
            existing & {*TOOL_NAMES} - {*module_names}, "is a part that its __init__.py must name"
        )
        faults |= {name: "has no module" for name in self.modules.values() if name not in existing}
        for name, text in faults.items():
            raise ImportError(
                f"{package_name}.{name} {text}; expected modules with these names: {', '.join(TOOL_NAMES)}"
            )

    @property
    def joint_folder(self) -> Path:
        """Path of the joint's folder."""
        return Path(str(import_module(self.package).__file__)).parent

    def load_joint_module(self, tool_name: str) -> ModuleType | None:
        """Import the module of this joint for a tool; None if the joint has no such module."""
        return (
            import_module(f"{self.package}.{self.modules[tool_name]}") if tool_name in self.modules else None
        )


PARTS: dict[str, JointToolModules] = {}
"""{name of a joint: its tool modules}. `jointfmu_tools.joints` fills it; other packages add their joints."""


def load_tool_module(joint_kind: "JointKind", tool_name: str) -> ModuleType | None:
    """Import the module of a joint for a tool; None if the joint has no such module."""
    return PARTS[joint_kind.name].load_joint_module(tool_name) if joint_kind.name in PARTS else None
