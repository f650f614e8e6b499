"""Builder data and source folder of a model: of its joint, or of the partners.

Partners are the FMUs that a joint is connected to in a system: inertia, mass, loads.
"""

from pathlib import Path

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model

from . import joints, partners
from .joint_parts import FmuBuildData


def find_fmu_build_data(fmu_model: Model) -> FmuBuildData:
    """Find what the builder needs of an FMU's joint: C code, flanges, charts of the documentation page.

    Raises ValueError if the joint of the model has no builder data.
    """
    if fmu_model.joint not in KINDS:
        return partners.FMU_BUILD_DATA
    if fmu_model.joint not in joints.FMU_BUILD_DATA:
        known = ", ".join(joints.FMU_BUILD_DATA)
        raise ValueError(f"joint {fmu_model.joint!r} has no FMU parts; joints with FMU parts: {known}")
    return joints.FMU_BUILD_DATA[fmu_model.joint]


def find_joint_folder(fmu_model: Model) -> Path:
    """Folder with the C sources, documentation page and icons of the joint of an FMU's model."""
    return find_fmu_build_data(fmu_model).joint_folder


def find_page_or_icon(fmu_model: Model, asset_file_name: str) -> Path:
    """Path of a documentation page or icon in the folder of a joint.

    Raises ValueError if the file is missing.
    """
    folder = find_joint_folder(fmu_model)
    if not (folder / asset_file_name).is_file():
        raise ValueError(
            f"{fmu_model.name}: {folder / asset_file_name} is missing; it must be in the folder of the other "
            "parts"
        )
    return folder / asset_file_name
