"""Harmonic drive: torsional stiffness, hysteresis, friction, lost motion and kinematic error."""

from ..kind import JointKind, RoughSurface
from .law import HarmonicDriveParameters, RoughHarmonicDriveParameters
from .prescribed_midline import CatalogueDriveParameters, TableDriveParameters
from .variables import MODELS

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
)
