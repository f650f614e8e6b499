"""Harmonic drive: the contact of flexspline and flexible bearing (Hu 2023)."""

from ...asperity.hu2023 import Hu2023
from ..kind import Kind, RoughSurface
from .law import HarmonicDrive
from .variables import MODELS

KIND = Kind(
    name="harmonic_drive",
    package=__name__,
    default="cd_14_100",
    parameters=HarmonicDrive,
    law=Hu2023,
    law_of=lambda drive: drive.law,
    models=MODELS,
    surfaces=(RoughSurface("surface", areal=True),),
    papers=("hu2023",),
)
