"""Export of the toy joint: the spring as a table."""

import numpy as np
from jointfmu_tools.exchange.export.exports import JointExports, LoadCurveExport
from jointfmu_tools.exchange.export.tables import LoadTable

from jointfmu.joints.model import Variable

from .. import KIND


def _line(spring, state, error):
    s = np.array([-1e-3, 0.0, 1e-3])
    return LoadTable(np.stack([s, spring.c * s, np.full(3, spring.c)], axis=1), (0.0, 0.0), (0.0, 0.0))


COLUMNS = (KIND.variables["s_rel"], Variable("pull", "N", "force that holds it"), KIND.variables["K"])
CURVE = {"curve_meaning": "force", "curve_variables": COLUMNS, "table_name": "force"}
EXPORTS = JointExports(curve=LoadCurveExport(**CURVE, compute_table=_line))
