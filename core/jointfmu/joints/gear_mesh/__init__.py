"""Gear mesh: tooth pairs with rough flanks (Yu 2022) and bending teeth between two wheels."""

from ..kind import Kind, RoughSurface
from .spring import GearMesh, RoughGearMesh
from .variables import MODELS

KIND = Kind(
    name="gear_mesh",
    package=__name__,
    default="beveloid_pair",
    laws={"yu2022": GearMesh, "roughness": RoughGearMesh},
    models=MODELS,
    surfaces=(RoughSurface("surface1", direction="x"), RoughSurface("surface2", direction="y")),
)
