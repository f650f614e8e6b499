"""The parts and the folder of what is an FMU's own: those of its joint, or of the joints' partners."""

from pathlib import Path

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model

from . import joints, partners
from .joint_parts import Parts


def parts_of(model: Model) -> Parts:
    """What the builders know of a model.

    Raises ValueError if they know nothing of its joint.
    """
    if model.joint not in KINDS:
        return partners.PARTS
    if model.joint not in joints.PARTS:
        known = ", ".join(joints.PARTS)
        raise ValueError(f"joint {model.joint!r} has no parts of its FMU; they are known of {known}")
    return joints.PARTS[model.joint]


def own_folder(model: Model) -> Path:
    """The folder."""
    return parts_of(model).folder


def asset(model: Model, name: str) -> Path:
    """A file that every FMU needs of its folder.

    Raises ValueError if it is not there.
    """
    folder = own_folder(model)
    if not (folder / name).is_file():
        raise ValueError(f"{model.name}: {folder / name} is missing; expected it beside the other parts")
    return folder / name
