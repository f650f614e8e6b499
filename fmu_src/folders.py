"""The folder of what is an FMU's own: that of its joint, or of the joints' partners."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model

from . import joints

_PARTNERS = "partners"


def part(model: Model, builder: str) -> ModuleType | None:
    """What a builder finds in the folder, the module of the builder's name; None if there is none."""
    if model.joint in KINDS:
        return joints.part(KINDS[model.joint], builder)
    name = f"{__package__}.{_PARTNERS}.{builder}"
    return import_module(name) if find_spec(name) else None


def own_folder(model: Model) -> Path:
    """The folder."""
    own = model.joint in KINDS
    return joints.folder(KINDS[model.joint]) if own else Path(__file__).with_name(_PARTNERS)


def asset(model: Model, name: str) -> Path:
    """A file that every FMU needs of its folder.

    Raises ValueError if it is not there.
    """
    folder = own_folder(model)
    if not (folder / name).is_file():
        raise ValueError(f"{model.name}: {folder / name} is missing; expected it beside the other parts")
    return folder / name
