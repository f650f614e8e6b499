"""Bolted joints with elastic plates by finite elements, as references for the reduced joint.

`PlateJoint` is a joint as `jointfmu new` makes it, with its linear finite elements. `FrictionElements` has
Coulomb friction at every element of the contact. `Lap` has the closed form of shear lag, `vdi_2230` the load
factor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jointfmu_tools.fem.elasticity import CholeskyFactor
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate
from jointfmu_tools.fem.reduction.elastic_bodies import reduce_bodies
from jointfmu_tools.fem.reduction.states import CellwiseJoint, UnitLoadResponse, approach_at_stiffness
from jointfmu_tools.fem.whole_joint import JointFiniteElements, LinearJoint
from jointfmu_tools.joints.bolted_joint.new import NEW_JOINT_COMMAND, plate_finite_elements
from jointfmu_tools.joints.bolted_joint.new.plate import read_drawing
from numpy.typing import NDArray
from scipy import sparse as sp

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, JointInputs
from jointfmu.joints.bolted_joint.law import RoughBoltedJointParameters, preload_pressure
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import NodalField
from jointfmu.mechanics.footprint.point_reduction import reduce_points
from jointfmu.parameters import ParameterFile

from .contact_patches import gross_slip_forces, random_poles
from .coulomb_springs import Springs
from .lap_beam.loops import Joint as Loops
from .lap_beam.reduction import RIGHT_SIDES_PER_SOLVE, ReducedBeam, patches

Array = NDArray[np.float64]

EXAMPLE = {
    "plate": "200x100",
    "bolts": "4xM12",
    "at": ["160x60"],
    "grip": ["40"],
    "material": ["steel"],
    "finish": ["ground"],
    "preload": "30e3",
}
"""Plate of the README, as options of `jointfmu new bolted-joint`."""
PLATES: dict[str, object] = {"grip": ["20"], "material": ["steel"], "Ra": ["0.8"], "embedding": "0"}
PLATES |= {"preload": "15e3"}
BRACKET = PLATES | {"plate": "80x60", "bolts": "2xM8", "at": ["-20,-15", "-20,15"]}
LEVER = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.06]) / 3.0
"""Force [1] and moment [m] on the bracket, which slips at about a third of its friction limit."""
JOINTS: dict[str, tuple[str, dict[str, object], Array]] = {
    "flange": (
        "faces",
        PLATES | {"plate": "80x80", "bolts": "4xM8", "at": ["50x50"]},
        np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ),
    "lap": (
        "edge",
        PLATES | {"plate": "90x40", "bolts": "2xM8", "at": ["40x0"]},
        np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ),
    "six": (
        "faces",
        PLATES
        | {
            "grip": ["24"],
            "plate": "100x80",
            "bolts": "6xM8",
            "at": ["70x50"],
            "grid": "3x2",
            "preload": "12e3",
        },
        np.array([0.3, 1.0, 0.0, 0.0, 0.0, 0.0]) / 1.05,
    ),
    "bracket": ("edge", BRACKET, LEVER),
    "bracket-far": ("edge", BRACKET, 3.0 * LEVER),
}
"""Attachment, drawing and force: along x and y [1], moments about the centre [m]."""
STEPS = 8
"""Steps from one end of a cycle to the other."""
POLE_ROTATIONS = (2e-3, 4e-3, 8e-3, 1.6e-2)
"""Rotations about a pole [rad], far beyond the deformation of the plates."""
AXES = ("K_xx", "K_yy", "K_zz", "K_rx", "K_ry", "K_rz")
FORCES = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z")
STEEL_M12: dict[str, object] = {
    "plate": "40x40",
    "bolts": "M12",
    "grip": ["40"],
    "material": ["steel"],
}
FACES: dict[str, object] = {"Ra": ["0.8"], "embedding": "0"}
LAP_LOAD = 40e3
"""Normal force of the lap [N]."""
TOUCH_RATIO = 1e-3
"""Approach from which a linear interface has its stiffness, over the approach after tightening [1]."""
RELATIVE_RISE = 1e-6
"""Relative growth of the stiffness of a linear interface [1]."""


@dataclass(frozen=True)
class PlateJoint:
    """Joint of two plates between its attachments: reduced models with elastic and with rigid plates, and
    finite elements.

    file, rigid : parameters with elastic plates, with rigid plates
    linear      : finite elements, linear about the preloaded state
    normal      : (q) [Pa/m] stiffness of the interface at the points of the finite elements
    preload     : [N] of a bolt
    members     : [N/m] stiffness of the clamped members of a bolt, VDI 2230
    """

    file: ParameterFile
    rigid: ParameterFile
    linear: LinearJoint
    normal: Array
    preload: float
    members: float

    @classmethod
    def of(
        cls,
        attached: str,
        example: Mapping[str, object] = EXAMPLE,
        refinement: float = 1.0,
        elements: bool = False,
    ) -> "PlateJoint":
        """Make the joint as the command makes it.

        refinement : divides the element sizes [1]; above 1, the reduced joint keeps the elements of the
            command
        elements   : True: one contact point for each element; False: nine points
        """
        options = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | dict(example)
        drawn = read_drawing(options)
        file, plates = drawn.parameter_file, drawn.bolted_plates
        joint = JointFiniteElements.from_assembly(plates.make_assembly(file), attached, refinement)
        if elements:
            joint = replace(joint, contact_interface=patches(joint.contact_interface))
        springs = plate_finite_elements._interface_stiffness(file, plates.preload, joint, None)
        linear = joint.linearise_joint(springs, file.values.bolt_stiffness)
        if refinement <= 1.0:
            rigid = BoltedJointSpring.from_joint(file.values)
            bodies = reduce_bodies(linear, rigid, springs[:, 2], plates.preload)
            elastic = plate_finite_elements.set_elastic_bodies(file, bodies, attached)
        else:
            elastic = plate_finite_elements.compute_joint(file, plates, attached).parameter_file
        return cls(
            file=elastic,
            rigid=file,
            linear=linear,
            normal=springs[:, 2],
            preload=plates.preload,
            members=drawn.clamped_bolt.member_stiffness,
        )

    @property
    def spring(self) -> BoltedJointSpring:
        """Spring with elastic plates."""
        return BoltedJointSpring.from_joint(self.file.values)

    def load(self) -> Array:
        """Forces and moments (6) at gross slip, or at the loss of the clamping force."""
        values, spring = self.file.values, self.spring
        clamping = values.n_bolts * self.preload
        radius = float(np.sqrt(spring.points.area_share @ np.sum(spring.points.position**2, axis=1)))
        mu = values.mu
        return clamping * np.array([mu, mu, 1.0, radius, radius, mu * radius])


def follow_motions(
    spring: BoltedJointSpring, motions: Sequence[Array], preload: float, names: Sequence[str] = FORCES
) -> list[Array]:
    """Forces and moments, or other outputs, along a sequence of motions (6) from rest."""
    memory, rows = spring.initial_history(), []
    for six in motions:
        out, memory = spring.advance(JointInputs(preload, 0.0, six), memory)
        rows.append(np.array([float(out[name]) for name in names]))
    return rows


def stiffnesses(joint: PlateJoint) -> tuple[Array, Array]:
    """Stiffnesses (6) of the reduced joint and of finite elements for each motion, other motions held."""
    out = joint.spring.evaluate(joint.preload, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return np.array([float(out[name]) for name in AXES]), joint.linear.stiffness_matrix.diagonal()


def joint_on_cells(joint: PlateJoint, count: int) -> CellwiseJoint:
    """Joint with all compliances of `count` cells of the contact, without modes and patches."""
    fine = reduce_points(pressure_distribution(joint.rigid.values.pattern), count)
    spring = BoltedJointSpring.from_joint(joint.rigid.values).with_nodes(fine)
    at = joint.linear.joint_model.contact_interface
    bolts = (
        joint.linear.joint_model.bolt_positions
        - at.quadrature_area @ at.quadrature_position / at.quadrature_area.sum()
    )
    return CellwiseJoint.from_cells(
        UnitLoadResponse.from_joint(joint.linear.joint_model, spring, joint.normal), bolts, joint.preload
    )


def pole_deviations(spring: BoltedJointSpring, preload: float, count: int) -> Array:
    """Deviation of the force in gross slip for rotations about poles, over the friction limit [1]: 95 %
    quantile, largest.

    The reference has all nodes with the pressure after tightening.
    """
    values, shape, found = spring.joint, pressure_distribution(spring.joint.pattern), []
    friction = values.mu * values.A_0 * shape.area_share * preload_pressure(values, shape, preload, 0.0)
    poles = random_poles(shape, count)
    for (x, y), force in zip(
        poles, gross_slip_forces(shape.make_friction_patches(), friction, poles), strict=True
    ):
        motions = [turn * np.array([y, -x, 0.0, 0.0, 0.0, 1.0]) for turn in POLE_ROTATIONS]
        found.append(
            np.linalg.norm(follow_motions(spring, motions, preload)[-1][:2] + force) / np.sum(friction)
        )
    return np.quantile(found, [0.95, 1.0])


@dataclass(frozen=True)
class FrictionElements:
    """Joint by finite elements with Coulomb friction at every element, loaded along one motion.

    loops     : the elements of the contact on Coulomb springs; the load is the scale of the motion [1]
    motion    : (6) [m, rad] of side 2 per load
    stiffness : [N.m] of the linear joint along the motion
    """

    loops: Loops
    motion: Array
    stiffness: float

    @classmethod
    def of(
        cls,
        whole: JointFiniteElements,
        pressure: Array,
        spring: BoltedJointSpring,
        force: float,
        wrench: Array,
    ) -> "FrictionElements":
        """Joint with the curve, friction and bolts of `spring`.

        The motion is that of the linear joint under `wrench` (6), scaled to a force [N].

        pressure : (P) [Pa] at the points of the interface
        """
        values, ratio = spring.joint, float(spring.joint.shear_stiffness_ratio())
        approach, at = spring.curve.inverse(pressure), whole.contact_interface
        springs = np.outer(spring.curve.derivatives(approach, 1)[1], [ratio, ratio, 1.0])
        linear = whole.linearise_joint(springs, values.bolt_stiffness)
        matrix = linear.body_stiffness_matrix + linear.contact_stiffness_matrix + linear.bolt_stiffness_matrix
        apart = [
            sign * whole.relative_displacement_matrix(axis) for axis, sign in ((0, 1.0), (1, 1.0), (2, -1.0))
        ]
        K = linear.stiffness_matrix
        motion = np.linalg.solve(K, wrench) * force
        beam = ReducedBeam(
            np.array([0.5 / np.pi]),  # unit square of the frequency: the load is the motion
            0.0,
            approach,
            springs,
            at.quadrature_area,
            at.quadrature_position,
            np.stack([rows @ (linear.unit_motion_displacement @ motion) for rows in apart], axis=1),
            compliance(matrix.tocsr(), apart, whole.attachment_unknowns, whole.bodies[0].unknown_count),
        )
        loops = Loops(beam, Springs.of(spring.curve, ratio, values.mu))
        return cls(loops, motion, float(motion @ K @ motion))

    @classmethod
    def clamped(cls, joint: PlateJoint, wrench: Array) -> "FrictionElements":
        """Joint under the preload of its bolts; load 1 is the linear response at the friction limit."""
        spring = BoltedJointSpring.from_joint(joint.rigid.values)
        pressure = spring.curve.derivatives(approach_at_stiffness(spring, joint.normal), 0)[0]
        return cls.of(joint.linear.joint_model, pressure, spring, joint.load()[0], wrench)

    def follow(self, loads: Sequence[float]) -> tuple[Array, Array]:
        """Generalized force (n) [N.m] and accumulated heat (n) [J] along a sequence of loads from rest."""
        state, rows, heat = self.loops.at_rest(), [], 0.0
        for load in loads:
            state = self.loops.apply_load(state, load)
            heat += 0.5 * state.loss
            rows.append((load * self.stiffness + 0.5 * (load - state.q), heat))
        force, loss = np.array(rows).T
        return force, loss


def compliance(
    matrix: sp.csr_matrix, apart: Sequence[sp.csr_matrix], held: tuple[Array, Array], first: int
) -> Array:
    """Compliance (3 P, 3 P) [m/N] of the patches for pairs of opposite forces, with fixed attachments."""
    count = apart[0].shape[0]
    free = np.setdiff1d(np.arange(matrix.shape[0]), np.concatenate([held[0], first + held[1]]))
    factor = CholeskyFactor(matrix[free][:, free])
    rows = sp.vstack(apart).tocsr()[np.arange(3 * count).reshape(3, count).T.ravel()][:, free]
    blocks = (rows[i : i + RIGHT_SIDES_PER_SOLVE] for i in range(0, 3 * count, RIGHT_SIDES_PER_SOLVE))
    return np.hstack([rows @ factor.solve_linear_system(block.T.toarray()) for block in blocks])


def follow_loads(
    one: BoltedJointSpring, preload: float, motion: Array, loads: Sequence[float]
) -> tuple[Array, Array]:
    """Generalized force and heat of the reduced joint, as `FrictionElements.follow` returns them."""
    names = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z", "E_loss")
    rows = np.array(follow_motions(one, [load * motion for load in loads], preload, names))
    return -rows[:, :6] @ motion, rows[:, 6]


def cycle_loads(amplitude: float) -> Array:
    """Loads of one full cycle: from zero to an amplitude, then to the opposite load and back."""
    down = amplitude * np.linspace(1.0, -1.0, STEPS + 1)[1:]
    return np.concatenate([amplitude * np.linspace(0.0, 1.0, STEPS + 1)[1:], down, -down])


def vdi_2230(bolt: float, members: float, interface: float, load: float) -> tuple[float, float, float]:
    """Load factor [1], additional bolt force [N] and opening load over the preload [1] for a load [N] at the
    heads.

    VDI 2230, with the interface in series with the members; stiffnesses in N/m.
    """
    factor = bolt / (bolt + 1.0 / (1.0 / members + 1.0 / interface))
    return factor, factor * load, 1.0 / (1.0 - factor)


def linear_curve(stiffness: float, approach: float) -> Curve:
    """Pressure of a linear interface with a stiffness [Pa/m], in contact from TOUCH_RATIO of an approach [m]
    on.

    The stiffness grows by RELATIVE_RISE per approach, so that a stiffness determines an approach.
    """
    places, bend = np.array([0.0, TOUCH_RATIO, 20.0]) * approach, RELATIVE_RISE * stiffness / approach
    slopes = stiffness + bend * (places - approach)
    slopes[0] = 0.0
    loads = np.concatenate([[0.0], np.cumsum(0.5 * (slopes[1:] + slopes[:-1]) * np.diff(places))])
    bends = np.array([slopes[1] / places[1], bend])
    return Curve(places, loads, slopes, bends, bends)


@dataclass(frozen=True)
class Lap:
    """Lap joint of two thin plates, each fixed at one end and kept plane, on a linear interface."""

    assembly: Assembly
    bodies: JointFiniteElements
    values: RoughBoltedJointParameters

    @classmethod
    def of(cls, refinement: float = 1.0) -> "Lap":
        """Lap of steel; element sizes are divided by `refinement`."""
        given = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | FACES
        given |= STEEL_M12 | {"tapped": True}  # so the command makes no bodies
        values = NEW_JOINT_COMMAND.make_joint(given).parameter_file.values
        plate = Plate(length=0.1, width=0.04, thickness=2e-3, E=206e9, nu=0.0, density=7850.0)
        bolts = BoltList(x=(0.0,), y=(0.0,), hole_diameter=2e-3, head_diameter=4e-3)
        assembly = Assembly("lap", plate, plate, bolts)
        joint = JointFiniteElements.from_assembly(assembly, "edge", refinement)
        held = []
        for body, ends in zip(joint.bodies, joint.attachment_unknowns, strict=True):
            z = np.abs(body.node_positions[2])
            held.append(np.union1d(ends, 3 * np.flatnonzero(z > z.max() - 1e-9) + 2))
        joint = replace(joint, attachment_unknowns=(held[0], held[1]))
        at = patches(joint.contact_interface)
        one = np.ones(at.quadrature_area.size)
        x, y = (
            at.quadrature_position - at.quadrature_area @ at.quadrature_position / at.quadrature_area.sum()
        ).T
        lists = {
            "share": at.quadrature_area / at.quadrature_area.sum(),
            "x": x,
            "y": y,
            "equal": one,
            "tilt": y / y.max(),
        }
        field = NodalField(**{name: tuple(each.tolist()) for name, each in lists.items()})
        area = float(at.quadrature_area.sum())
        values = replace(values, pattern=field, A_0=area, n_bolts=1.0, row_bolts=1.0, bolt_stiffness=0.0)
        return cls(assembly, joint, values)

    def linear(self, reach: float) -> tuple[float, BoltedJointSpring, LinearJoint]:
        """Tangential stiffness [Pa/m], spring of the interface alone, linear solution by finite elements.

        reach : length of the lap over the length of shear lag [1]
        """
        plate, beta = self.assembly.side1, reach / self.assembly.side1.length
        shear = 0.5 * beta**2 * plate.E * plate.thickness
        spring = BoltedJointSpring.from_joint(self.values)
        normal = shear / spring.friction_law.foundation().stiffness_ratio
        spring = replace(spring, curve=linear_curve(normal, LAP_LOAD / self.values.A_0 / normal))
        springs = np.tile([shear, shear, normal], (self.bodies.contact_interface.quadrature_area.size, 1))
        return shear, spring, self.bodies.linearise_joint(springs, 0.0)

    def reduced(self, spring: BoltedJointSpring, linear: LinearJoint, normal: float) -> BoltedJointSpring:
        """Lap joint reduced to the modes of its plates."""
        stiffness = np.full(self.bodies.contact_interface.quadrature_area.size, normal)
        bodies = reduce_bodies(linear, spring, stiffness, LAP_LOAD)
        whole = BoltedJointSpring.from_joint(replace(self.values, sides="elastic", bodies=bodies))
        return replace(whole, curve=spring.curve)

    def compliances(self, reach: float) -> tuple[float, float, float]:
        """Compliance [m/N] along x: reduced joint, finite elements, closed form of shear lag."""
        shear, spring, linear = self.linear(reach)
        plate, beta = self.assembly.side1, reach / self.assembly.side1.length
        whole = self.reduced(spring, linear, shear / spring.friction_law.foundation().stiffness_ratio)
        out = whole.evaluate(LAP_LOAD, 0.0, (0.0,) * 3, (0.0,) * 3)
        per = plate.E * plate.thickness * plate.width
        form = (1.0 / (beta * np.tanh(0.5 * reach)) + 0.5 * plate.length) / per
        return 1.0 / float(out[AXES[0]]), float(linear.compliances().total_compliance[0]), form
