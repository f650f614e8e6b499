"""Harmonic drive: torsional stiffness, hysteresis, friction, lost motion and kinematic error."""

from ..kind import Kind, RoughSurface
from .given import CatalogueDrive, TableDrive
from .law import HarmonicDrive, RoughHarmonicDrive
from .variables import MODELS

KIND = Kind(
    name="harmonic_drive",
    package=__name__,
    default="cd_14_100",
    laws={
        "hu2023": HarmonicDrive,
        "roughness": RoughHarmonicDrive,
        "catalogue": CatalogueDrive,
        "table": TableDrive,
    },
    law_of=lambda drive: drive.law,
    models=MODELS,
    surfaces=(RoughSurface("surface", areal=True),),
)
