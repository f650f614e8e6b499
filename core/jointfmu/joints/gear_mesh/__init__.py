"""Gear mesh: tooth pairs with rough flanks (Yu 2022) and bending teeth between two wheels."""

from ...asperity.yu2022 import Yu2022
from ..kind import Kind, RoughSurface
from .spring import GearMesh
from .variables import MODELS

KIND = Kind(
    name="gear_mesh",
    package=__name__,
    default="beveloid_pair",
    parameters=GearMesh,
    law=Yu2022,
    models=MODELS,
    surfaces=(RoughSurface("surface1", direction="x"), RoughSurface("surface2", direction="y")),
)
