"""Bolted joint: its parameters and the pressure under its bolts (Zhao 2018, section 3)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ...contact.laws.roughness import RoughnessLaw
from ...contact.laws.table import TableLaw
from ...contact.laws.zhao2018 import Zhao2018
from ...contact.surface import ElasticConstants
from ...mechanics.footprint.bolts import BoltedFrame, PressureSource
from ...mechanics.footprint.distribution import MergedDistribution, NodalField, PressureDistribution
from ...mechanics.footprint.plate import BoltedPlate
from ...quantity import (
    Array,
    CheckedParameters,
    Interval,
    Number,
    ParameterLimit,
    check_fields,
    check_limits,
    choice_field,
    group_field,
    quantity_field,
    select,
    series_field,
)

MAX_MODES = 16
"""Largest number of modes of the members [1]."""
MODAL_ENTRY_NAMES = ("opening", "patch_x", "patch_y", "patch_around", "stretch")
"""Entries of the section [bodies] of a parameter file with the displacements of the members' modes."""
ELASTIC_SIDE_REQUIREMENTS = {
    "memory": "elastic sides need friction with memory",
    "damping": "the dashpots act between rigid sides only",
}
"""{parameter: reason} of the choices that elastic sides prescribe."""
TIGHTENING_TEMPERATURE = 293.15
"""Temperature [K] of bolts and members at tightening: 20 degrees C."""
MAX_EXPANSION_COEFFICIENT = 1e-3
"""Largest magnitude of a thermal expansion coefficient [1/K]: several times that of any plastic."""


def _expansion_field() -> Any:
    """Dataclass field for a thermal expansion coefficient."""
    bound = MAX_EXPANSION_COEFFICIENT
    return quantity_field("1/K", "thermal expansion coefficient", ge=-bound, le=bound, default=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ClampedSide(ElasticConstants):
    """Material of one side, and its share in the clamped length of the bolts."""

    alpha: float = _expansion_field()
    clamped_length: float = quantity_field(
        "m",
        "length of the side that each bolt clamps, without washers and engaged thread",
        ge=0.0,
        default=0.0,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltMaterial(CheckedParameters):
    """Material of the bolts and their washers."""

    alpha: float = _expansion_field()


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBodies:
    """Choice of rigid members: only interface and bolts deform, so there are no modes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticBodies:
    """Modes of the members, computed for the points, patches and bolts of one contact.

    Raises ValueError if the lengths of the lists contradict each other.
    """

    stiffness: tuple[float, ...] = series_field("N/m", "stiffness of each mode", gt=0.0)
    opening: tuple[float, ...] = series_field(
        "1",
        "modal matrix of the opening at the contact points: all modes of point 1, of point 2, ...",
        ge=-1.0,
        le=1.0,
    )
    patch_x: tuple[float, ...] = series_field(
        "1",
        "modal matrix of the relative displacement along x at the friction patches, same order",
        ge=-1.0,
        le=1.0,
    )
    patch_y: tuple[float, ...] = series_field("1", "as patch_x, along y", ge=-1.0, le=1.0)
    patch_around: tuple[float, ...] = series_field(
        "1",
        "as patch_x, for the mean displacement around the centre of a patch, on the circle of its sliders",
        ge=-1.0,
        le=1.0,
    )
    stretch: tuple[float, ...] = series_field(
        "1",
        "modal matrix of the elongation of the bolts between their seats: all modes of bolt 1, of bolt 2, "
        "...",
        ge=-1.0,
        le=1.0,
    )
    x: tuple[float, ...] = series_field(
        "m", "positions of the friction patches along the bolt rows, from the centroid"
    )
    y: tuple[float, ...] = series_field(
        "m", "positions of the friction patches across the bolt rows, from the centroid"
    )
    bolt_x: tuple[float, ...] = series_field(
        "m", "positions of the bolts along the bolt rows, from the centroid"
    )
    bolt_y: tuple[float, ...] = series_field(
        "m", "positions of the bolts across the bolt rows, from the centroid"
    )
    attached: str = choice_field(
        "unstated",
        "faces",
        "edge",
        "heads",
        doc="surfaces of the bodies that move rigidly with the connected parts",
    )
    thickness: tuple[float, ...] = series_field(
        "m", "thickness of side 1 and 2 at the bolts, for pictures", gt=0.0, is_optional=True
    )
    outline: tuple[float, ...] = series_field(
        "m",
        "smallest x and y, largest x and y of the contact, from its centroid, for pictures",
        is_optional=True,
    )
    hole_diameter: float = quantity_field("m", "clearance hole, for pictures", ge=0.0, default=0.0)
    head_diameter: float = quantity_field(
        "m", "outer diameter of the bearing surfaces of heads and nuts, for pictures", ge=0.0, default=0.0
    )
    thread_depth: float = quantity_field(
        "m", "depth of the threads in side 2, for pictures; 0: bolts go through", ge=0.0, default=0.0
    )

    def __post_init__(self) -> None:
        check_fields(self)
        modes, patches, bolts = len(self.stiffness), len(self.x), len(self.bolt_x)
        if modes > MAX_MODES:
            raise ValueError(f"bodies.stiffness has {modes} deformation modes, expected at most {MAX_MODES}")
        counts = {"y": patches, "bolt_y": bolts, "stretch": bolts * modes}
        counts |= {name: patches * modes for name in MODAL_ENTRY_NAMES if name.startswith("patch_")}
        counts["opening"] = modes * max(len(self.opening) // modes, 1)
        counts |= {name: n for name, n in (("thickness", 2), ("outline", 4)) if getattr(self, name)}
        for name, count in counts.items():
            if (given := len(getattr(self, name))) != count:
                raise ValueError(f"bodies.{name} has {given} numbers, expected {count} with {modes} modes")


@dataclass(frozen=True, kw_only=True)
class BoltParameters:
    """Parameters of the bolts, of the pressure under them, and of the members."""

    side1: ClampedSide = group_field("first body")
    side2: ClampedSide = group_field("second body")
    bolt: BoltMaterial = group_field("bolts", bolt=BoltMaterial)
    n_bolts: float = quantity_field("1", "number of bolts", ge=1.0, is_integer=True)
    row_bolts: float = quantity_field(
        "1", "bolts in each of the two rows that carry the moment", ge=1.0, is_integer=True
    )
    row_distance: float = quantity_field("m", "distance L_a between the two bolt rows", gt=0.0)
    bolt_stiffness: float = quantity_field("N/m", "stiffness of each bolt", ge=0.0, default=0.0)
    plate_stiffness: float = quantity_field(
        "N/m",
        "stiffness of the plates around each bolt, 1/delta_P of VDI 2230 without washers, for the change "
        "of the preload with the temperature; 0: no change",
        ge=0.0,
        default=0.0,
    )
    embedding: float = quantity_field(
        "N", "preload that each bolt loses by embedding (VDI 2230)", ge=0.0, default=0.0
    )
    memory: bool = choice_field(
        True, False, doc="true: friction with partial slip and memory; false: elastic joint"
    )
    damping: bool = choice_field(False, True, doc="true: the dashpots C_xx, C_yy, C_zz of Zhao 2018 act")
    sides: str = choice_field(
        "rigid",
        "elastic",
        doc="rigid: interface and bolts between rigid members; elastic: also the members, with [bodies]",
    )
    bodies: RigidBodies | ElasticBodies = group_field(
        "compliance of the members between their attachments", rigid=RigidBodies, bodies=ElasticBodies
    )
    pattern: PressureSource = group_field(
        "contact pressure: decay around each bolt of a frame, deformation cones of the bolts of a plate, "
        "or points of a field",
        pattern=BoltedFrame,
        plate=BoltedPlate,
        field=NodalField,
    )

    def __post_init__(self) -> None:
        check_fields(self)
        check_limits(self, self.find_parameter_limits())
        if self.has_elastic_members:
            self._check_elastic_sides()

    @property
    def has_elastic_members(self) -> bool:
        """Whether the joint has elastic members, not the interface alone."""
        return self.sides == "elastic"

    def _check_elastic_sides(self) -> None:
        """Raise ValueError if parameters contradict the choice of elastic sides."""
        if isinstance(self.bodies, RigidBodies):
            raise ValueError(
                "sides = elastic needs the section [bodies]; `jointfmu new bolted-joint` writes it"
            )
        for name, wrong in (("memory", False), ("damping", True)):
            if getattr(self, name) is wrong:
                why = ELASTIC_SIDE_REQUIREMENTS[name]
                raise ValueError(
                    f"{name} = {wrong} with sides = elastic; expected {not wrong}, {why}".lower()
                )

    def find_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of n_bolts and row_bolts, which depend on other parameters."""
        why = (
            "each of the two rows has at most half of n_bolts; set row_bolts = 1 if all bolts are in one row"
        )
        rows = ParameterLimit(
            "row_bolts", Interval.from_bounds(ge=1.0, le=np.maximum(0.5 * self.n_bolts, 1.0)), why
        )
        if not isinstance(self.bodies, ElasticBodies) or not self.has_elastic_members:
            return [rows]
        seats = float(len(self.bodies.bolt_x))
        return [
            ParameterLimit(
                "n_bolts", Interval.from_bounds(ge=seats, le=seats), "number of bolts in [bodies]"
            ),
            rows,
        ]


@dataclass(frozen=True, kw_only=True)
class BoltedJointParameters(BoltParameters, Zhao2018):
    """Parameters of the bolted joint with the law of Zhao 2018."""

    plastic_damping: bool = choice_field(
        False, True, doc="true: normal damping from the plastic work of first loading (Zhao 2018, Eqs. 19-20)"
    )


@dataclass(frozen=True, kw_only=True)
class _BoltedJointWithoutPlasticWork(BoltParameters):
    """Parameters of the bolted joint with a law that has no plastic work."""

    plastic_damping: ClassVar[bool] = False

    mass: float = quantity_field(
        "kg", "mass of the structure, used for the equivalent viscous damping", gt=0.0
    )


@dataclass(frozen=True, kw_only=True)
class RoughBoltedJointParameters(_BoltedJointWithoutPlasticWork, RoughnessLaw):
    """Parameters of the bolted joint with the law `roughness`."""


@dataclass(frozen=True, kw_only=True)
class TableBoltedJointParameters(_BoltedJointWithoutPlasticWork, TableLaw):
    """Parameters of the bolted joint with the law `table`."""


AnyBoltedJoint: TypeAlias = BoltedJointParameters | RoughBoltedJointParameters | TableBoltedJointParameters
"""Parameter set of a bolted joint with any interface law."""


def with_rigid_members(joint_parameters: AnyBoltedJoint) -> AnyBoltedJoint:
    """Copy of a joint with rigid members: only the interface and the bolts deform."""
    return (
        replace(joint_parameters, sides="rigid") if joint_parameters.has_elastic_members else joint_parameters
    )


def get_bolted_frame(joint_parameters: AnyBoltedJoint) -> BoltedFrame:
    """Bolted frame of a joint: section [pattern] of its parameter file.

    Raises ValueError if the joint has a plate or a nodal field instead.
    """
    if isinstance(joint_parameters.pattern, BoltedFrame):
        return joint_parameters.pattern
    if isinstance(joint_parameters.pattern, BoltedPlate):
        has = f"[plate], a plate with {len(joint_parameters.pattern.x)} bolts"
    else:
        has = f"[field], a nodal field of {len(joint_parameters.pattern.share)} points"
    raise ValueError(f"the joint has {has}; expected [pattern], a frame of bolts")


RELATIVE_AREA_TOLERANCE = 0.01
"""Largest difference of A_0 from the area that the plate or the frame has without its holes [1]."""
ROW_DISTANCE_TOLERANCE = 1e-3
"""Largest relative difference [1] between row_distance and the distance of the bolt rows."""


def find_contradictions(joint_parameters: AnyBoltedJoint) -> Iterator[str]:
    """Yield one line for each parameter that contradicts the bolts of a parameter file."""
    if isinstance(joint_parameters.pattern, NodalField):
        return
    section, pattern = (
        ("plate" if isinstance(joint_parameters.pattern, BoltedPlate) else "pattern"),
        joint_parameters.pattern,
    )
    count, (row_bolts, row_distance) = len(pattern.bolt_positions_from_middle), pattern.equivalent_bolt_rows
    if joint_parameters.n_bolts != count:
        yield f"n_bolts = {joint_parameters.n_bolts:g} contradicts [{section}], which has {count} bolts"
    if abs(joint_parameters.A_0 / pattern.area - 1.0) > RELATIVE_AREA_TOLERANCE:
        yield (
            f"A_0 = {joint_parameters.A_0:g} m2 contradicts [{section}], whose area without the holes is "
            f"{pattern.area:.6g} m2; allowed is a difference of {RELATIVE_AREA_TOLERANCE:.0%}"
        )
    if joint_parameters.row_bolts != row_bolts:
        stated = f"row_bolts = {joint_parameters.row_bolts:g}"
        yield f"{stated} contradicts [{section}], whose rows have {row_bolts:g} each"
    if abs(joint_parameters.row_distance / row_distance - 1.0) > ROW_DISTANCE_TOLERANCE:
        stated = f"row_distance = {joint_parameters.row_distance:g} m"
        yield f"{stated} contradicts [{section}], where it is {row_distance:.6g} m"


def preload_pressure(
    joint_parameters: AnyBoltedJoint,
    pressure_distribution: PressureDistribution | MergedDistribution,
    preload: ArrayLike,
    bending_moment: ArrayLike,
) -> Array:
    """Pressures (..., n) [Pa] of the n nodes of a tightened joint, 0 at open nodes.

    A moment M raises each bolt force of the row y > 0 by M/(L_a N_b), and lowers the forces of the row y < 0
    by the same amount (Zhao 2018, section 3), with the distance L_a of the rows and N_b bolts in each. For
    other layouts see `BoltedPlate.pressure_distribution`.

    preload        : (...) [N] of each bolt
    bending_moment : (...) [N.m] about x
    """
    force, bending = np.asarray(preload)[..., None], np.asarray(bending_moment)[..., None]
    return np.asarray(
        node_pressure(
            joint_parameters,
            pressure_distribution.preload_pressure_ratio,
            pressure_distribution.moment_pressure_ratio,
            force,
            bending,
        )
    )


def node_pressure(
    joint_parameters: AnyBoltedJoint,
    preload_pressure_ratio: Number,
    moment_pressure_ratio: Number,
    preload: Number,
    bending_moment: Number,
) -> Number:
    """Pressure [Pa] of a node under a preload [N] of each bolt and a moment [N.m]."""
    return superposed_pressure(
        preload_pressure_ratio,
        moment_pressure_ratio,
        *bolt_pressures(joint_parameters, preload, bending_moment),
    )


def working_preload(joint_parameters: AnyBoltedJoint, preload: Number) -> Number:
    """Working force (...) [N] of a bolt: preload (...) [N] minus the loss by embedding, at least 0.

    preload : at the present temperature, see `preload_at_temperature`
    """
    return select(preload >= joint_parameters.embedding, preload - joint_parameters.embedding, 0.0 * preload)


def thermal_mismatch(joint_parameters: AnyBoltedJoint, temperature: Number) -> Number:
    """Free thermal expansion (...) [m] of the clamped members minus that of a bolt.

    Washers expand as the bolt does.

    temperature : (...) [K] of bolts and members
    """
    per_kelvin = sum(
        (side.alpha - joint_parameters.bolt.alpha) * side.clamped_length
        for side in (joint_parameters.side1, joint_parameters.side2)
    )
    return per_kelvin * (temperature - TIGHTENING_TEMPERATURE)


def preload_at_temperature(joint_parameters: AnyBoltedJoint, preload: Number, temperature: Number) -> Number:
    """Preload (...) [N] of a bolt at a temperature [K] of bolts and members: VDI 2230, section 5.4.2.

    preload : (...) [N] at tightening, at TIGHTENING_TEMPERATURE

    The mismatch of the free lengths divided by the compliance of bolt and members is added, with constant
    moduli: F = F_V + sum (alpha_i - alpha_bolt) l_i dT/(delta_S + delta_P), with the preload F_V at
    tightening, expansion coefficients alpha, clamped lengths l_i of the two members, temperature change dT,
    compliances delta_S of the bolt and delta_P of the members. F may be negative, see `working_preload`.
    """
    total = joint_parameters.bolt_stiffness + joint_parameters.plate_stiffness
    are_springs = total > 0.0
    product = joint_parameters.bolt_stiffness * joint_parameters.plate_stiffness
    stiffness = select(are_springs, product / select(are_springs, total, 1.0), 0.0 * total)
    return preload + stiffness * thermal_mismatch(joint_parameters, temperature)


def slip_force(joint_parameters: AnyBoltedJoint, working_force: Number) -> Number:
    """Shear force (...) [N] of gross slip: friction coefficient times the clamping force of all bolts.

    working_force : (...) [N] of each bolt
    """
    return joint_parameters.mu * joint_parameters.n_bolts * working_force


def bolt_pressures(
    joint_parameters: AnyBoltedJoint, preload: Number, bending_moment: Number
) -> tuple[Number, Number]:
    """Mean pressure [Pa] by the preload, and mean pressure [Pa] of a bolt row by the moment.

    A node with preload_pressure_ratio = 1 has the first pressure, one with moment_pressure_ratio = 1 the
    second.
    """
    left = working_preload(joint_parameters, preload)
    return (
        left * joint_parameters.n_bolts / joint_parameters.A_0,
        bending_moment / joint_parameters.row_distance / joint_parameters.A_0,
    )


def superposed_pressure(
    preload_pressure_ratio: Number,
    moment_pressure_ratio: Number,
    mean_pressure: Number,
    moment_pressure: Number,
) -> Number:
    """Pressure [Pa] of a node: sum of the pressures by preload and by moment; 0 if the node is open.

    mean_pressure, moment_pressure : [Pa] result of `bolt_pressures`
    """
    return np.maximum(mean_pressure * preload_pressure_ratio + moment_pressure * moment_pressure_ratio, 0.0)


def row_forces(
    joint_parameters: AnyBoltedJoint, preload: float, bending_moment: float
) -> tuple[float, float]:
    """Force [N] of a bolt in the row y > 0 and in the row y < 0, under a preload [N] and a moment [N.m]."""
    shift, left = (
        bending_moment / (joint_parameters.row_distance * joint_parameters.row_bolts),
        float(working_preload(joint_parameters, preload)),
    )
    return left + shift, left - shift
