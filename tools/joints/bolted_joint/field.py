"""Layout, contact pressures and elastic bodies of a bolted joint, also for a computed pressure field."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.joints.bolted_joint.law import AnyBoltedJoint, ElasticBodies, bolt_pressures, preload_pressure
from jointfmu.mechanics.footprint.bolts import BoltedFrame, pressure_distribution
from jointfmu.mechanics.footprint.distribution import NodalField, PressureDistribution
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ...common.pressure import NominalPressureModel
from ...inputs.drawing.vdi2230 import proof_load

if TYPE_CHECKING:
    from ...fem.geometry import Assembly


@dataclass(frozen=True)
class PlaneLayout:
    """Geometry of a bolted joint in the contact plane, relative to the centroid of the contact [m].

    bolt_positions : (b, 2) of b bolts; empty if the file has none
    contact_outline : rectangles (lower corner, upper corner) of the contact, the outer one first; empty for a
        pressure field without bodies
    bounding_box : (2, 2) lower and upper corner of the bounding box
    hole_diameter, head_diameter : 0 if the file has none
    """

    bolt_positions: Array
    contact_outline: tuple[Array, ...]
    bounding_box: Array
    hole_diameter: float
    head_diameter: float

    @classmethod
    def from_joint_parameters(cls, joint_parameters: AnyBoltedJoint) -> "PlaneLayout":
        """Bolt layout and outline of the contact, from the parameters of a joint."""
        pattern = joint_parameters.pattern
        bodies = joint_parameters.bodies if isinstance(joint_parameters.bodies, ElasticBodies) else None
        head = bodies.head_diameter if bodies else 0.0
        if isinstance(pattern, NodalField):
            place = pressure_distribution(pattern).position
            known = bodies and bodies.outline
            extent = np.reshape(known, (2, 2)) if known else np.stack([place.min(axis=0), place.max(axis=0)])
            bolts = np.column_stack(
                [bodies.bolt_x, bodies.bolt_y] if bodies else [pattern.each_bolt_x, pattern.each_bolt_y]
            )
            hole = bodies.hole_diameter if bodies else 0.0
            return cls(bolts, (extent,) if known else (), extent, hole, head)
        if isinstance(pattern, BoltedPlate):
            half = 0.5 * np.array([[-pattern.length, -pattern.width], [pattern.length, pattern.width]])
            outline = (half - pattern.centroid,)
            return cls(
                pattern.bolt_positions_from_middle - pattern.centroid,
                outline,
                outline[0],
                pattern.hole_diameter,
                head,
            )
        return cls(
            pattern.bolt_positions_from_middle,
            frame := _frame_outline(pattern),
            frame[0],
            pattern.hole_diameter,
            head,
        )


def _frame_outline(bolted_frame: BoltedFrame) -> tuple[Array, Array]:
    """Outer and inner rectangle of a bolted frame, each (2, 2) [m]: lower corner, upper corner."""
    half = 0.5 * np.array([bolted_frame.column_spacing, bolted_frame.row_spacing])
    signs = np.array([[-1.0], [1.0]])
    return signs * (half + 0.5 * bolted_frame.flange_width), signs * (half - 0.5 * bolted_frame.flange_width)


def _mean_pressure(joint_parameters: AnyBoltedJoint, preload: float) -> float:
    """Mean contact pressure [Pa] at a preload [N] per bolt."""
    return float(bolt_pressures(joint_parameters, preload, 0.0)[0])


def _peak_pressure(joint_parameters: AnyBoltedJoint, preload: float) -> float:
    """Largest contact pressure [Pa] at a preload [N] per bolt."""
    return float(
        np.max(
            preload_pressure(joint_parameters, pressure_distribution(joint_parameters.pattern), preload, 0.0)
        )
    )


def _default_preload(joint_parameters: AnyBoltedJoint) -> float:
    """Typical preload [N] of a bolt: 70 % of its proof load, at most 30 kN (M16); 30 kN if it is unknown."""
    hole = PlaneLayout.from_joint_parameters(joint_parameters).hole_diameter
    borne = proof_load(hole) if hole else None
    return 30e3 if borne is None else min(30e3, 0.7 * borne[0])


def _proof_load(parameter_file: ParameterFile) -> tuple[float, str] | None:
    """Proof load [N] of one bolt, and a text that names this limit in messages; None if not known."""
    hole = PlaneLayout.from_joint_parameters(parameter_file.values).hole_diameter
    return proof_load(hole, parameter_file.sources.get("inputs.preload", "")) if hole else None


NOMINAL_PRESSURE = NominalPressureModel(
    load_variable="preload",
    default_load=_default_preload,
    mean_pressure=_mean_pressure,
    peak_pressure=_peak_pressure,
    load_capacity=_proof_load,
)
"""Nominal contact pressure of the bolted joint over its preload."""


def insert_elastic_bodies(
    parameter_file: ParameterFile,
    assembly: "Assembly",
    preload: float,
    attachment_kind: str,
    normalised_pressure: PressureDistribution,
) -> ParameterFile:
    """Compute the elastic bodies of an assembly; return the parameter file of the joint with them.

    parameter_file      : parameters of the joint with rigid sides
    preload             : [N] per bolt
    attachment_kind     : surfaces that move rigidly with the connected bodies, a key of ATTACHMENT_SURFACES
    normalised_pressure : contact pressure over mean pressure [1] at all nodes of the finite elements
    """
    from .new.plate_finite_elements import compute_joint_of_assembly

    return compute_joint_of_assembly(
        parameter_file, lambda: assembly, preload, attachment_kind, normalised_pressure
    ).parameter_file


def compute_complete_joint_results(
    parameter_file: ParameterFile, preload: float
) -> dict[str, tuple[float, str, str]]:
    """Stiffnesses, load factor and shares of the complete joint: {name: (value, unit, meaning)}."""
    from .new import plate_finite_elements

    return plate_finite_elements.compute_elastic_joint_results(parameter_file, preload)
