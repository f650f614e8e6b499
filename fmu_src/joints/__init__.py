"""Builder data of each joint; every built-in joint of KINDS has its own folder."""

from importlib import import_module

from jointfmu.joints import KINDS

from ..joint_parts import FmuBuildData

FMU_BUILD_DATA: dict[str, FmuBuildData] = {
    name: import_module(f".{name}", __name__).FMU_BUILD_DATA
    for name, kind in KINDS.items()
    if kind.is_builtin
}
"""{name of a joint: its builder data}; joints of other packages add an entry."""
