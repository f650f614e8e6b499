"""Joints: one subpackage per joint. KINDS lists them all."""

from importlib import import_module

from .kind import JointKind
from .model import Model

_JOINT_PACKAGES = (
    "harmonic_drive",
    "bolted_joint",
    "gear_contact",
    "gear_mesh",
)
"""Subpackages of this folder, one for each joint."""
KINDS: dict[str, JointKind] = {name: import_module(f".{name}", __name__).KIND for name in _JOINT_PACKAGES}
"""{name of the joint: its description}, in the order of all listings."""
MODELS: dict[str, Model] = {model.name: model for kind in KINDS.values() for model in kind.models}
"""{name of the FMU: its model} for all joints."""


def register_joint(joint_kind: JointKind) -> None:
    """Add a kind of joint of another package, for this process: it is built and listed like the others.

    Raises ValueError if its name, or the name of one of its models, is already in use.
    """
    taken = [
        name
        for name in (joint_kind.name, *(model.name for model in joint_kind.models))
        if name in KINDS | MODELS
    ]
    if taken:
        raise ValueError(
            f"joint {joint_kind.name!r}: the name {taken[0]!r} is already used by another joint; state "
            "another name"
        )
    KINDS[joint_kind.name] = joint_kind
    MODELS.update((model.name, model) for model in joint_kind.models)
