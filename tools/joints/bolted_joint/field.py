"""How a bolted joint carries its bolts' forces under a pressure that comes as a field."""

from dataclasses import replace
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from jointfmu.joints.bolted_joint.law import Bolted, pressures, shear_ratio
from jointfmu.mechanics.footprint.shape import MergedShape, PressureShape
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ...fields.clamped import Clamping
from .layout import PlaneLayout

if TYPE_CHECKING:
    from ...fem.geometry import Assembly


def _pressures(
    joint: Bolted, shape: PressureShape | MergedShape, preload: ArrayLike, moment: ArrayLike
) -> Array:
    """Node pressures [Pa] under what embedding has left of the preload: a field is computed for that."""
    return pressures(replace(joint, embedding=0.0), shape, preload, moment)


def _whole(file: ParameterFile, assembly: "Assembly", preload: float, attached: str) -> ParameterFile:
    from .new.computed import whole_of

    return whole_of(file, lambda: assembly, preload, attached).file


FIELD = Clamping(pressures=_pressures, shear_ratio=shear_ratio, layout=PlaneLayout.of, whole=_whole)
