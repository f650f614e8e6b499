"""Harmonic drive: torsional stiffness, hysteresis, friction, lost motion and kinematic error."""

from ..kind import JointKind, RoughSurface
from .law import HarmonicDrive, RoughHarmonicDrive
from .prescribed_midline import CatalogueDrive, TableDrive
from .variables import MODELS

KIND = JointKind(
    name="harmonic_drive",
    package=__name__,
    default_stem="cd_14_100",
    laws={
        "hu2023": HarmonicDrive,
        "roughness": RoughHarmonicDrive,
        "catalogue": CatalogueDrive,
        "table": TableDrive,
    },
    extract_law=lambda drive: drive.law,
    models=MODELS,
    surfaces=(RoughSurface("surface", is_areal=True),),
)
