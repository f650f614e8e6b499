"""Layout and contact pressures of a bolted joint, also for a computed pressure field."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.joints.bolted_joint.bodies import ElasticBodies
from jointfmu.joints.bolted_joint.law import Bolted, bolt_pressures, pressures
from jointfmu.mechanics.footprint.bolts import BoltPattern, pressure_shape
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.mechanics.footprint.shape import MergedShape, NodalField, PressureShape
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ...drawing.vdi2230 import proof_load
from ...fem.validation import MeasuredFrequencies
from ...fields.clamped import Clamping
from ...pressure import NominalPressure

if TYPE_CHECKING:
    from ...fem.geometry import Assembly


@dataclass(frozen=True)
class PlaneLayout:
    """Geometry of a bolted joint in the contact plane, relative to the centroid of the contact [m].

    bolt_positions : (b, 2); empty if the file has none
    outline        : rectangles (lower corner, upper corner) of the contact, the outer one first; empty for a
                     pressure field without bodies
    extent         : (2, 2) lower and upper corner of the bounding box
    hole_diameter, head_diameter : 0 if the file has none
    """

    bolts: Array
    outline: tuple[Array, ...]
    extent: Array
    hole: float
    head: float

    @classmethod
    def of(cls, joint: Bolted) -> "PlaneLayout":
        """Layout from the parameters of a joint."""
        pattern = joint.pattern
        bodies = joint.bodies if isinstance(joint.bodies, ElasticBodies) else None
        head = bodies.head_diameter if bodies else 0.0
        if isinstance(pattern, NodalField):
            place = pressure_shape(pattern).position
            known = bodies and bodies.outline
            extent = np.reshape(known, (2, 2)) if known else np.stack([place.min(axis=0), place.max(axis=0)])
            bolts = np.column_stack([bodies.bolt_x, bodies.bolt_y]) if bodies else np.zeros((0, 2))
            hole = bodies.hole_diameter if bodies else 0.0
            return cls(bolts, (extent,) if known else (), extent, hole, head)
        if isinstance(pattern, BoltedPlate):
            half = 0.5 * np.array([[-pattern.length, -pattern.width], [pattern.length, pattern.width]])
            outline = (half - pattern.centroid,)
            return cls(pattern.bolts - pattern.centroid, outline, outline[0], pattern.hole_diameter, head)
        return cls(pattern.bolts, frame := _frame(pattern), frame[0], pattern.hole_diameter, head)


def _frame(pattern: BoltPattern) -> tuple[Array, Array]:
    half = 0.5 * np.array([pattern.column_spacing, pattern.row_spacing])
    signs = np.array([[-1.0], [1.0]])
    return signs * (half + 0.5 * pattern.flange_width), signs * (half - 0.5 * pattern.flange_width)


def _mean(joint: Bolted, preload: float) -> float:
    return float(bolt_pressures(joint, preload, 0.0)[0])


def _peak(joint: Bolted, preload: float) -> float:
    return float(np.max(pressures(joint, pressure_shape(joint.pattern), preload, 0.0)))


def _usual(joint: Bolted) -> float:
    """Typical preload [N] of a bolt: 30 kN (M16), or 70 % of the proof load of a smaller bolt."""
    borne = _borne(joint)
    return 30e3 if borne is None else min(30e3, 0.7 * borne[0])


def _borne(joint: Bolted) -> tuple[float, str] | None:
    pattern = joint.pattern
    return None if isinstance(pattern, NodalField) else proof_load(pattern.hole_diameter)


PRESSURE = NominalPressure(load="preload", usual=_usual, mean=_mean, peak=_peak, borne=_borne)


def _pressures(
    joint: Bolted, shape: PressureShape | MergedShape, preload: ArrayLike, moment: ArrayLike
) -> Array:
    """Nodal pressures [Pa] at a preload, without a further loss by embedding.

    A field is computed for the preload that remains after embedding.
    """
    return pressures(replace(joint, embedding=0.0), shape, preload, moment)


def _whole(
    file: ParameterFile, assembly: "Assembly", preload: float, attached: str, shape: PressureShape
) -> ParameterFile:
    from .new.computed import whole_of

    return whole_of(file, lambda: assembly, preload, attached, shape).file


def _facts(file: ParameterFile, preload: float) -> dict[str, tuple[float, str, str]]:
    from .new.computed import whole_facts

    return whole_facts(file, preload)


FIELD = Clamping(
    pressures=_pressures,
    shear_ratio=lambda joint: joint.shear_ratio(),
    layout=PlaneLayout.of,
    whole=_whole,
    facts=_facts,
)


FREQUENCIES = MeasuredFrequencies(points="zhao2018_modes", assembly="box_specimen_by_frequency")
