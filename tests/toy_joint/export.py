"""The spring as a table."""

import numpy as np

from jointfmu.export.exports import Exports, LoadCurve
from jointfmu.export.tables import Table


def _line(spring, state, error):
    s = np.array([-1e-3, 0.0, 1e-3])
    return Table(np.stack([s, spring.c * s, np.full(3, spring.c)], axis=1), (0.0, 0.0), (0.0, 0.0))


HEADS = (("s_rel", "m"), ("pull", "N"), ("K", "N/m"))
EXPORTS = Exports(curve=LoadCurve(meaning="pull over elongation", heads=HEADS, name="force", table=_line))
