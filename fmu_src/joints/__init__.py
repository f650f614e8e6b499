"""What the builders know of each joint, a folder each for those of KINDS."""

from importlib import import_module

from jointfmu.joints import KINDS

from ..joint_parts import Parts

PARTS: dict[str, Parts] = {
    name: import_module(f".{name}", __name__).PARTS for name, kind in KINDS.items() if kind.own
}
"""{name of a joint: its parts}; a joint of another package is added."""
