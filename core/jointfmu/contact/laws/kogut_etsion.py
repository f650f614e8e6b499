"""Elastic-plastic contact spot of Kogut and Etsion (2002): power-law fits from first to full yield.

area/a_c = m (w/w_c)^n, load/f_c = c (w/w_c)^d, with the deformation w; index c: values at first yield.
"""

from dataclasses import dataclass
from typing import NamedTuple


class ElasticPlasticStage(NamedTuple):
    """Power laws of area and load in the deformation w, in one elastic-plastic stage of a contact spot.

    area/a_c = m (w/w_c)^n with area_factor m and area_exponent n; load/f_c = c (w/w_c)^d with load_factor c
    and load_exponent d [1]. Index c: values at first yield.
    """

    area_factor: float
    area_exponent: float
    load_factor: float
    load_exponent: float


FIRST_ELASTIC_PLASTIC_STAGE = ElasticPlasticStage(
    area_factor=0.93, area_exponent=1.136, load_factor=1.03, load_exponent=1.425
)
"""Power laws from first yield to SECOND_STAGE_OVER_YIELD_DEFORMATION times its deformation."""
SECOND_ELASTIC_PLASTIC_STAGE = ElasticPlasticStage(
    area_factor=0.94, area_exponent=1.146, load_factor=1.40, load_exponent=1.263
)
"""Power laws from there to FULL_PLASTIC_OVER_YIELD_DEFORMATION times the deformation at first yield."""
SECOND_STAGE_OVER_YIELD_DEFORMATION = 6.0
"""Deformation w/w_c [1] at the start of the second stage."""
FULL_PLASTIC_OVER_YIELD_DEFORMATION = 110.0
"""Deformation w/w_c [1] from which on the spot is fully plastic."""


@dataclass(frozen=True, slots=True)
class AreaPowerLaws:
    """Load and stiffness of a spot in one elastic-plastic stage, as powers of its area a.

    load = f_c load_factor (a/a_c)^load_exponent,
    stiffness = (f_c/w_c) stiffness_factor (a/a_c)^stiffness_exponent,
    with area a_c, load f_c and deformation w_c at first yield
    """

    load_factor: float
    load_exponent: float
    stiffness_factor: float
    stiffness_exponent: float


def eliminate_deformation(elastic_plastic_stage: ElasticPlasticStage) -> AreaPowerLaws:
    """Express load and stiffness of a stage as powers of the area instead of the deformation.

    The exponents are d/n for the load and (d - 1)/n for the stiffness, with the exponents n of the area and d
    of the load as powers of the deformation.
    """
    p, q = (
        elastic_plastic_stage.load_exponent / elastic_plastic_stage.area_exponent,
        (elastic_plastic_stage.load_exponent - 1.0) / elastic_plastic_stage.area_exponent,
    )
    return AreaPowerLaws(
        elastic_plastic_stage.load_factor * elastic_plastic_stage.area_factor**-p,
        p,
        elastic_plastic_stage.load_factor
        * elastic_plastic_stage.load_exponent
        * elastic_plastic_stage.area_factor**-q,
        q,
    )


SECOND_STAGE_OVER_YIELD_AREA = (
    FIRST_ELASTIC_PLASTIC_STAGE.area_factor
    * SECOND_STAGE_OVER_YIELD_DEFORMATION**FIRST_ELASTIC_PLASTIC_STAGE.area_exponent
)
"""Area a/a_c = 7.1197 [1] at the start of the second stage."""
FULL_PLASTIC_OVER_YIELD_AREA = (
    SECOND_ELASTIC_PLASTIC_STAGE.area_factor
    * FULL_PLASTIC_OVER_YIELD_DEFORMATION**SECOND_ELASTIC_PLASTIC_STAGE.area_exponent
)
"""Area a/a_c = 205.38 [1] from which on the spot is fully plastic."""
