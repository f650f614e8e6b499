"""How the bolts press on the interface, and what a bolt bears."""

import numpy as np

from jointfmu.joints.bolted_joint.law import Bolted, bolt_pressures, pressures
from jointfmu.mechanics.footprint.bolts import pressure_shape
from jointfmu.mechanics.footprint.shape import NodalField

from ...drawing.proof import proof_load
from ...pressure import NominalPressure


def _mean(joint: Bolted, preload: float) -> float:
    return float(bolt_pressures(joint, preload, 0.0)[0])


def _peak(joint: Bolted, preload: float) -> float:
    return float(np.max(pressures(joint, pressure_shape(joint.pattern), preload, 0.0)))


def _usual(joint: Bolted) -> float:
    """A preload [N] that a bolt bears: that of an M16, or 70 % of the proof load of a smaller one."""
    borne = _borne(joint)
    return 30e3 if borne is None else min(30e3, 0.7 * borne[0])


def _borne(joint: Bolted) -> tuple[float, str] | None:
    pattern = joint.pattern
    return None if isinstance(pattern, NodalField) else proof_load(pattern.hole_diameter)


PRESSURE = NominalPressure(load="preload", usual=_usual, mean=_mean, peak=_peak, borne=_borne)
