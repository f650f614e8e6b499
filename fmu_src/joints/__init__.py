"""Builder data of each joint; every built-in joint of KINDS has its own folder."""

from importlib import import_module

from jointfmu.joints import KINDS

from ..joint_parts import FmuParts

FMU_PARTS: dict[str, FmuParts] = {
    name: import_module(f".{name}", __name__).FMU_PARTS for name, kind in KINDS.items() if kind.is_builtin
}
"""{name of a joint: its builder data}; joints of other packages add an entry."""
