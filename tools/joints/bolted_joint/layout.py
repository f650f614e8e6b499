"""Where a joint's parameters say that its bolts and its outline are."""

from dataclasses import dataclass

import numpy as np

from jointfmu.joints.bolted_joint.bodies import ElasticBodies
from jointfmu.joints.bolted_joint.law import Bolted
from jointfmu.mechanics.footprint.bolts import BoltPattern, pressure_shape
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.mechanics.footprint.shape import NodalField
from jointfmu.quantity import Array


@dataclass(frozen=True)
class PlaneLayout:
    """What lies where in a joint's plane, from the centroid of its contact [m].

    bolts   : (b, 2), none where the file does not say
    outline : rectangles (lower corner, upper corner) of the contact, the outer one first; none of a field
    extent  : (2, 2) lowest and highest places
    hole, head : diameters, 0 where the file does not say
    """

    bolts: Array
    outline: tuple[Array, ...]
    extent: Array
    hole: float
    head: float

    @classmethod
    def of(cls, joint: Bolted) -> "PlaneLayout":
        """Of a joint's parameters."""
        pattern = joint.pattern
        head = joint.bodies.head_diameter if isinstance(joint.bodies, ElasticBodies) else 0.0
        if isinstance(pattern, NodalField):
            shape = pressure_shape(pattern)
            half = np.sqrt(joint.A_0 * shape.share / np.pi)[:, None]
            extent = np.stack([np.min(shape.position - half, 0), np.max(shape.position + half, 0)])
            bolts = np.zeros((0, 2))
            if isinstance(joint.bodies, ElasticBodies):
                bolts = np.column_stack([joint.bodies.bolt_x, joint.bodies.bolt_y])
            return cls(bolts, (), extent, 0.0, head)
        if isinstance(pattern, BoltedPlate):
            half = 0.5 * np.array([[-pattern.length, -pattern.width], [pattern.length, pattern.width]])
            outline = (half - pattern.centroid,)
            return cls(pattern.bolts - pattern.centroid, outline, outline[0], pattern.hole_diameter, head)
        return cls(pattern.bolts, frame := _frame(pattern), frame[0], pattern.hole_diameter, head)


def _frame(pattern: BoltPattern) -> tuple[Array, Array]:
    half = 0.5 * np.array([pattern.column_spacing, pattern.row_spacing])
    signs = np.array([[-1.0], [1.0]])
    return signs * (half + 0.5 * pattern.flange_width), signs * (half - 0.5 * pattern.flange_width)
