"""Gear contact: two tooth flanks under a load (Yu 2022)."""

from ..kind import Kind, RoughSurface
from .spring import GearContact, RoughGearContact
from .variables import MODELS

KIND = Kind(
    name="gear_contact",
    package=__name__,
    default="beveloid",
    laws={"yu2022": GearContact, "roughness": RoughGearContact},
    models=MODELS,
    surfaces=(RoughSurface("surface1", direction="x"), RoughSurface("surface2", direction="y")),
    papers=("yu2022",),
)
