"""Harmonic drive: torsional stiffness, hysteresis, friction, lost motion and kinematic error."""

from ..kind import FlangeRating, JointKind, RoughSurface
from .drive import DriveParameters
from .friction import friction_limits
from .law import HarmonicDriveParameters, RoughHarmonicDriveParameters
from .prescribed_midline import CatalogueDriveParameters, TableDriveParameters
from .variables import MODELS


def _find_flange_ratings(drive_parameters: DriveParameters) -> dict[str, FlangeRating]:
    """Rated torque, motion ratio and dry friction of wave generator (flange1) and output (flange2)."""
    ratio = abs(drive_parameters.ratio)
    friction = float(max(friction_limits(drive_parameters, 0.0, 0.0)))
    return {
        "flange1": FlangeRating(drive_parameters.rated_torque / ratio, ratio, friction),
        "flange2": FlangeRating(drive_parameters.rated_torque, 1.0, 0.0),
    }


KIND = JointKind(
    name="harmonic_drive",
    package=__name__,
    default_file_stem="cd_14_100",
    laws={
        "hu2023": HarmonicDriveParameters,
        "roughness": RoughHarmonicDriveParameters,
        "catalogue": CatalogueDriveParameters,
        "table": TableDriveParameters,
    },
    extract_law=lambda drive: drive.law,
    laws_without_interface=("catalogue", "table"),
    models=MODELS,
    surfaces=(RoughSurface("surface", is_areal=True),),
    find_flange_ratings=_find_flange_ratings,
)
"""Description of the harmonic drive for builders and tools."""
