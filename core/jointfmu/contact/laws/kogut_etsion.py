"""Elastic-plastic contact spot of Kogut and Etsion (2002): power-law fits from first to full yield.

area/a_c = m (w/w_c)^n, load/f_c = c (w/w_c)^d, with the deformation w; index c: values at first yield.
"""

from dataclasses import dataclass
from typing import NamedTuple


class PlasticStage(NamedTuple):
    """One elastic-plastic stage: factor m, exponent n of the area; factor c, exponent d of the load [1]."""

    area_factor: float
    area_exponent: float
    load_factor: float
    load_exponent: float


FIRST_STAGE = PlasticStage(area_factor=0.93, area_exponent=1.136, load_factor=1.03, load_exponent=1.425)
"""Power laws from first yield to SECOND_STAGE_DEFORMATION_OVER_FIRST_YIELD times its deformation."""
SECOND_STAGE = PlasticStage(area_factor=0.94, area_exponent=1.146, load_factor=1.40, load_exponent=1.263)
"""Power laws from there to PLASTIC_DEFORMATION_OVER_FIRST_YIELD times the deformation at first yield."""
SECOND_STAGE_DEFORMATION_OVER_FIRST_YIELD = 6.0
"""Deformation w/w_c [1] at the start of the second stage."""
PLASTIC_DEFORMATION_OVER_FIRST_YIELD = 110.0
"""Deformation w/w_c [1] from which on the spot is fully plastic."""


@dataclass(frozen=True, slots=True)
class AreaPowerLaws:
    """Load and stiffness of a spot in one elastic-plastic stage, as powers of its area a.

    load = f_c load_factor (a/a_c)^load_exponent,
    stiffness = (f_c/w_c) stiffness_factor (a/a_c)^stiffness_exponent
    """

    load_factor: float
    load_exponent: float
    stiffness_factor: float
    stiffness_exponent: float


def eliminate_deformation(stage: PlasticStage) -> AreaPowerLaws:
    """Express load and stiffness of a stage by the area instead of w: exponents d/n and (d - 1)/n."""
    p, q = stage.load_exponent / stage.area_exponent, (stage.load_exponent - 1.0) / stage.area_exponent
    return AreaPowerLaws(
        stage.load_factor * stage.area_factor**-p,
        p,
        stage.load_factor * stage.load_exponent * stage.area_factor**-q,
        q,
    )


SECOND_STAGE_AREA_OVER_FIRST_YIELD = (
    FIRST_STAGE.area_factor * SECOND_STAGE_DEFORMATION_OVER_FIRST_YIELD**FIRST_STAGE.area_exponent
)
"""Area a/a_c = 7.1197 [1] at the start of the second stage."""
PLASTIC_AREA_OVER_FIRST_YIELD = (
    SECOND_STAGE.area_factor * PLASTIC_DEFORMATION_OVER_FIRST_YIELD**SECOND_STAGE.area_exponent
)
"""Area a/a_c = 205.38 [1] from which on the spot is fully plastic."""
