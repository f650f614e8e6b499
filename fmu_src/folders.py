"""Builder data and source folder of a model: of its joint, or of the partners.

Partners are the FMUs that a joint is connected to in a system: inertia, mass, loads.
"""

from pathlib import Path

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model

from . import joints, partners
from .joint_parts import FmuParts


def find_fmu_parts(model: Model) -> FmuParts:
    """Builder data of a model: C code, flanges, charts of the page.

    Raises ValueError if the joint of the model has no builder data.
    """
    if model.joint not in KINDS:
        return partners.FMU_PARTS
    if model.joint not in joints.FMU_PARTS:
        known = ", ".join(joints.FMU_PARTS)
        raise ValueError(f"joint {model.joint!r} has no FMU parts; joints with FMU parts: {known}")
    return joints.FMU_PARTS[model.joint]


def find_source_folder(model: Model) -> Path:
    """Folder with the C sources, documentation page and icons of a model's joint."""
    return find_fmu_parts(model).folder


def find_asset(model: Model, file_name: str) -> Path:
    """Path of a required file (page or icon) in the folder of a model.

    Raises ValueError if the file is missing.
    """
    folder = find_source_folder(model)
    if not (folder / file_name).is_file():
        raise ValueError(
            f"{model.name}: {folder / file_name} is missing; it must be in the folder of the other parts"
        )
    return folder / file_name
