"""Tool modules of the joints, one folder for each joint."""

from importlib import import_module

from ..common.joint_parts import PARTS

_JOINT_FOLDERS = ("harmonic_drive", "bolted_joint", "gear_contact", "gear_mesh")
PARTS |= {name: import_module(f".{name}", __name__).TOOL_MODULES for name in _JOINT_FOLDERS}

__all__ = ["PARTS"]
