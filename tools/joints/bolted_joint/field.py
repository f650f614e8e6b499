"""How a bolted joint carries its bolts' forces under a pressure that comes as a field."""

from dataclasses import replace

from numpy.typing import ArrayLike

from jointfmu.joints.bolted_joint.law import Bolted, pressures, shear_ratio
from jointfmu.mechanics.footprint.shape import MergedShape, PressureShape

from ...fields.clamped import Array, Clamping


def _pressures(
    joint: Bolted, shape: PressureShape | MergedShape, preload: ArrayLike, moment: ArrayLike
) -> Array:
    """Node pressures [Pa] under what embedding has left of the preload: a field is computed for that."""
    return pressures(replace(joint, embedding=0.0), shape, preload, moment)


FIELD = Clamping(pressures=_pressures, shear_ratio=shear_ratio)
