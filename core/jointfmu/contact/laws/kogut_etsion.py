"""Elastic-plastic contact spot of Kogut and Etsion (2002): power-law fits from first to full yield.

area/a_c = m (w/w_c)^n, load/f_c = c (w/w_c)^d, with the deformation w; index c: values at first yield.
"""

from dataclasses import dataclass
from typing import NamedTuple


class PlasticStage(NamedTuple):
    """One stage of the fit: factor m and exponent n of the area, factor c and exponent d of the load [1]."""

    m: float
    n: float
    c: float
    d: float


FIRST_STAGE = PlasticStage(m=0.93, n=1.136, c=1.03, d=1.425)
SECOND_STAGE = PlasticStage(m=0.94, n=1.146, c=1.40, d=1.263)
SECOND_STAGE_ONSET = 6.0
"""Deformation w/w_c [1] at the start of the second stage."""
PLASTIC_ONSET = 110.0
"""Deformation w/w_c [1] from which on the spot is fully plastic."""


@dataclass(frozen=True, slots=True)
class AreaPowers:
    """Load and stiffness of one stage as powers of the spot area a.

    load = f_c load_factor (a/a_c)^load_exponent,
    stiffness = (f_c/w_c) stiffness_factor (a/a_c)^stiffness_exponent
    """

    A: float
    p: float
    B: float
    q: float


def eliminate_deformation(stage: PlasticStage) -> AreaPowers:
    """Load and stiffness of a stage as powers of the area, with exponents d/n and (d - 1)/n [1]."""
    p, q = stage.d / stage.n, (stage.d - 1.0) / stage.n
    return AreaPowers(stage.c * stage.m**-p, p, stage.c * stage.d * stage.m**-q, q)


SECOND_STAGE_AREA = FIRST_STAGE.m * SECOND_STAGE_ONSET**FIRST_STAGE.n
"""Area a/a_c = 7.1197 [1] at the start of the second stage."""
PLASTIC_AREA = SECOND_STAGE.m * PLASTIC_ONSET**SECOND_STAGE.n
"""Area a/a_c = 205.38 [1] from which on the spot is fully plastic."""
