"""The patch that two curved flanks share under a load: Hertz's line contact."""

from typing import NamedTuple

import numpy as np

from jointfmu.quantity import Number


class Patch(NamedTuple):
    """Half width [m], area [m2] and greatest pressure [Pa] of a line contact."""

    half_width: Number
    area: Number
    pressure: Number


def patch(load: Number, width: Number, curvature: Number, modulus: Number) -> Patch:
    """Of cylinders under a load [N] (Hertz 1881; Johnson, Contact Mechanics, Eqs. 4.43 to 4.45).

    width     : [m] of the flanks along the line
    curvature : [1/m] of both flanks together, 1/R_1 + 1/R_2, above 0
    modulus   : [Pa] E*
    """
    half = np.sqrt(4.0 * load / (np.pi * width * modulus * curvature))
    return Patch(half, 2.0 * half * width, 2.0 * load / (np.pi * half * width))
