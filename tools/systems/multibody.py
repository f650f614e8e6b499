"""Rigid-body dynamics of a tree of links, each with one degree of freedom against its parent.

Forward dynamics by the articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, table
7.1). Spatial vectors are lists of six Numbers, first angular, then linear, in the frame of a link; matrices
are lists of rows. A Number is a float, an array over samples, or a symbol.

A rotor rotates on the parent of a driven joint, coaxially with the joint. The mass and the inertia of the
robot file include it as part of the parent. The kinetic energy of its spin is
J (theta' + a omega)^2 / 2 - J (a omega)^2 / 2, with the inertia J, the axis a, the rotor speed theta'
relative to the parent, and the angular velocity omega of the parent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array, CheckedParameters, Number, quantity_field

Vector = list[Number]
"""Spatial vector or vector: list of Numbers."""
Matrix = list[Vector]
"""Matrix: list of rows."""
GROUND_INDEX = -1
"""Index of the parent of a link that is connected to the ground."""


@dataclass(frozen=True, slots=True)
class Link:
    """Link of a tree, with the joint that connects it to its parent.

    The frame of a link has its z axis along the joint axis. A hinge rotates the frame about z, a slide moves
    it along z. All arrays are in the frame of the link unless stated otherwise.

    name                    : name of the joint
    parent_index            : index of the parent link, smaller than the own index; or GROUND_INDEX
    is_sliding_joint        : whether the joint is a slide; otherwise a hinge
    rotation, origin        : axes (columns of a (3, 3) matrix) and origin (3) [m] of the frame, in the
        frame of the parent, at joint position zero
    mass                    : [kg] of the link, with all bodies fixed to it
    centre_of_mass          : (3) [m] centre of mass
    inertia                 : (3, 3) [kg.m2] about the centre of mass
    reflected_motor_inertia : [kg.m2 or kg] inertia of a rigidly connected motor, reflected to the joint
    damping                 : [N.m.s/rad or N.s/m] viscous damping of the joint
    stiffness               : [N.m/rad or N/m] of a spring in the joint
    spring_position         : [rad or m] joint position at which this spring is relaxed
    """

    name: str
    parent_index: int
    is_sliding_joint: bool
    rotation: Array
    origin: Array
    mass: float
    centre_of_mass: Array
    inertia: Array
    reflected_motor_inertia: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    spring_position: float = 0.0

    @property
    def axis_index(self) -> int:
        """Index of the joint axis in spatial vectors: rotation about z, or translation along z."""
        return 5 if self.is_sliding_joint else 2


@dataclass(frozen=True, slots=True)
class Frame:
    """Frame fixed to a link: axes (columns of `rotation`) and origin [m], both in the frame of the link."""

    link_index: int
    rotation: Array
    origin: Array


@dataclass(frozen=True, slots=True)
class RigidBody:
    """Additional rigid body in a frame of a link.

    mass           : [kg]
    centre_of_mass : (3) [m] centre of mass
    inertia        : (3) [kg.m2] moments of inertia about axes through the centre of mass, parallel to the
        frame
    """

    frame: Frame
    mass: Number
    centre_of_mass: Sequence[Number]
    inertia: Sequence[Number]


@dataclass(frozen=True, kw_only=True)
class Payload(CheckedParameters):
    """Payload of a robot: rigid body at the tip, in the frame of the tip body."""

    m: float = quantity_field("kg", "mass of the payload", ge=0.0)
    x: float = quantity_field("m", "centre of mass of the payload along x of the tip body")
    y: float = quantity_field("m", "centre of mass of the payload along y of the tip body")
    z: float = quantity_field("m", "centre of mass of the payload along z of the tip body")
    J_x: float = quantity_field(
        "kg.m2", "moment of inertia of the payload about x through its centre", ge=0.0
    )
    J_y: float = quantity_field(
        "kg.m2", "moment of inertia of the payload about y through its centre", ge=0.0
    )
    J_z: float = quantity_field(
        "kg.m2", "moment of inertia of the payload about z through its centre", ge=0.0
    )

    @classmethod
    def make_point_mass(cls, mass: float) -> "Payload":
        """Point mass [kg] at the origin of the tip body."""
        return cls(m=mass, x=0.0, y=0.0, z=0.0, J_x=0.0, J_y=0.0, J_z=0.0)

    def make_body(self, tip_frame: Frame) -> RigidBody:
        """The payload as a body in the frame of the tip."""
        return RigidBody(tip_frame, self.m, (self.x, self.y, self.z), (self.J_x, self.J_y, self.J_z))


@dataclass(frozen=True, slots=True)
class RotorMotion:
    """Motion of the motor rotor of a joint relative to the parent link, which carries the rotor.

    inertia      : [kg.m2] about its axis
    speed        : [rad/s]
    torque       : [N.m] on the rotor; None: the acceleration is prescribed
    acceleration : [rad/s2], prescribed
    is_coupled   : whether the spin of the rotor acts on the parent; otherwise the rotor rotates as if its
        axis were fixed to the ground
    """

    inertia: Number
    speed: Number
    torque: Number | None = None
    acceleration: Number = 0.0
    is_coupled: bool = True


@dataclass(frozen=True, slots=True)
class TreeMotion:
    """Results of the forward dynamics: accelerations and forces of all joints and rotors.

    joint_accelerations : [rad/s2 or m/s2] of the joints
    joint_forces        : [N.m or N] on the joints: as given, or as the prescribed accelerations need them
    rotor_accelerations : [rad/s2] of the rotors, by joint
    rotor_torques       : [N.m] on the rotors: as given, or as the prescribed accelerations need them
    """

    joint_accelerations: list[Number]
    joint_forces: list[Number]
    rotor_accelerations: dict[str, Number]
    rotor_torques: dict[str, Number]


@dataclass(frozen=True, slots=True)
class FrameMotion:
    """Pose and velocity of a frame, in the axes of the ground.

    position, velocity, angular_velocity : (3) [m], [m/s], [rad/s]
    rotation                             : (3, 3) axes as columns
    """

    position: Vector
    rotation: Matrix
    velocity: Vector
    angular_velocity: Vector


def forward_dynamics(
    links: Sequence[Link],
    gravity: Sequence[float],
    joint_positions: Sequence[Number],
    joint_speeds: Sequence[Number],
    joint_forces: Sequence[Number | None],
    prescribed_accelerations: Sequence[Number] | None = None,
    rotor_motions: Mapping[str, RotorMotion] | None = None,
    payload: RigidBody | None = None,
) -> TreeMotion:
    """Accelerations of all joints and rotors.

    gravity                  : (3) [m/s2] acceleration of free fall, in the axes of the ground
    joint_positions          : [rad or m]
    joint_speeds             : [rad/s or m/s]
    joint_forces             : [N.m or N] on each joint; None: its acceleration is prescribed
    prescribed_accelerations : [rad/s2 or m/s2] of the joints without a force; None: zero
    rotor_motions            : {joint: motion of its rotor}
    """
    rotor_motions = rotor_motions or {}
    transforms, velocities, biases = list[tuple[Matrix, Matrix]](), list[Vector](), list[Vector]()
    inertias, bias_forces = list[Matrix](), list[Vector]()
    for i, link in enumerate(links):
        moving, fixed = _joint_transform(link, joint_positions[i]), _frame_transform(link)
        relative = _make_axis_vector(link.axis_index, joint_speeds[i])
        velocity = relative
        if link.parent_index != GROUND_INDEX:
            carried = _multiply_matrix_vector(
                moving, _multiply_matrix_vector(fixed, velocities[link.parent_index])
            )
            velocity = _add_vectors(carried, relative)
        inertia = _spatial_inertia(link.mass, link.centre_of_mass.tolist(), link.inertia.tolist())
        if payload and payload.frame.link_index == i:
            inertia = _add_matrices(inertia, _payload_inertia(payload))
        transforms.append((moving, fixed))
        velocities.append(velocity)
        biases.append(_cross_motion(velocity, relative))
        inertias.append(inertia)
        bias_forces.append(_cross_force(velocity, _multiply_matrix_vector(inertia, velocity)))
    for link in links:  # reactions of the rotors on the links that carry them
        if (
            link.name in rotor_motions
            and rotor_motions[link.name].is_coupled
            and link.parent_index != GROUND_INDEX
        ):
            _add_rotor_reaction(inertias, bias_forces, velocities, link, rotor_motions[link.name])
    count = len(links)
    columns: list[Vector] = [[]] * count
    pivots, remainders = [0.0] * count, [0.0] * count
    passive = [
        link.stiffness * (x - link.spring_position) + link.damping * v
        for link, x, v in zip(links, joint_positions, joint_speeds, strict=True)
    ]
    given = prescribed_accelerations or [0.0] * count
    for i in reversed(range(len(links))):
        link, axis, force = links[i], links[i].axis_index, joint_forces[i]
        inertia, bias = inertias[i], biases[i]
        columns[i] = [row[axis] for row in inertia]
        if force is None:
            bias = _add_vectors(bias, _make_axis_vector(axis, given[i]))
            passed_inertia, passed_force = (
                inertia,
                _add_vectors(bias_forces[i], _multiply_matrix_vector(inertia, bias)),
            )
        else:
            pivots[i] = columns[i][axis] + link.reflected_motor_inertia
            remainders[i] = force - passive[i] - bias_forces[i][axis]
            passed_inertia = _subtract_outer_product(inertia, columns[i], pivots[i])
            ratio = remainders[i] / pivots[i]
            passed_force = _add_vectors(
                _add_vectors(bias_forces[i], _multiply_matrix_vector(passed_inertia, bias)),
                [u * ratio for u in columns[i]],
            )
        if link.parent_index != GROUND_INDEX:
            for transform in transforms[i]:
                passed_inertia = _transform_spatial_inertia(transform, passed_inertia)
                passed_force = _multiply_matrix_vector(_transpose(transform), passed_force)
            inertias[link.parent_index] = _add_matrices(inertias[link.parent_index], passed_inertia)
            bias_forces[link.parent_index] = _add_vectors(bias_forces[link.parent_index], passed_force)
    ground: Vector = [0.0, 0.0, 0.0, *(-float(g) for g in gravity)]
    spatial: list[Vector] = []
    accelerations, joint_forces = list[Number](), [*joint_forces]
    rotor_accelerations, rotor_torques = dict[str, Number](), dict[str, Number]()
    for i, link in enumerate(links):
        moving, fixed = transforms[i]
        parent = ground if link.parent_index == GROUND_INDEX else spatial[link.parent_index]
        if link.name in rotor_motions:
            rotor = rotor_motions[link.name]
            spin = _carrier_angular_acceleration(link, parent, rotor)
            if rotor.torque is None:
                rotor_accelerations[link.name] = rotor.acceleration
                rotor_torques[link.name] = rotor.inertia * (rotor.acceleration + spin)
            else:
                rotor_accelerations[link.name] = rotor.torque / rotor.inertia - spin
                rotor_torques[link.name] = rotor.torque
        carried = _add_vectors(
            _multiply_matrix_vector(moving, _multiply_matrix_vector(fixed, parent)), biases[i]
        )
        is_prescribed = joint_forces[i] is None
        acceleration = (
            given[i] if is_prescribed else (remainders[i] - _dot_product(columns[i], carried)) / pivots[i]
        )
        spatial.append(_add_vectors(carried, _make_axis_vector(link.axis_index, acceleration)))
        accelerations.append(acceleration)
        if is_prescribed:
            needed = _dot_product(columns[i], spatial[i]) + bias_forces[i][link.axis_index]
            joint_forces[i] = needed + link.reflected_motor_inertia * acceleration + passive[i]
    return TreeMotion(accelerations, joint_forces, rotor_accelerations, rotor_torques)


def compute_frame_motion(
    links: Sequence[Link],
    link_frame: Frame,
    joint_positions: Sequence[Number],
    joint_speeds: Sequence[Number],
) -> FrameMotion:
    """Position, axes, velocity and angular velocity of a frame, in the axes of the ground."""
    position, rotation = link_frame.origin.tolist(), link_frame.rotation.tolist()
    velocity: Vector = [0.0, 0.0, 0.0]
    angular_velocity: Vector = [0.0, 0.0, 0.0]
    i = link_frame.link_index
    while i != GROUND_INDEX:  # from the frame to the ground, in the frame of each parent
        link, axis = links[i], _make_axis_vector(2, joint_speeds[i])[:3]
        if link.is_sliding_joint:
            velocity = _add_vectors(velocity, axis)
            position = _add_vectors(position, _make_axis_vector(2, joint_positions[i])[:3])
            turned = link.rotation.tolist()
        else:
            velocity = _add_vectors(velocity, _cross_product(axis, position))
            angular_velocity = _add_vectors(angular_velocity, axis)
            turned = _multiply_matrices(
                link.rotation.tolist(), _transpose(_z_rotation_matrix(joint_positions[i]))
            )
        rotation = _multiply_matrices(turned, rotation)
        position = _add_vectors(link.origin.tolist(), _multiply_matrix_vector(turned, position))
        velocity, angular_velocity = (
            _multiply_matrix_vector(turned, velocity),
            _multiply_matrix_vector(turned, angular_velocity),
        )
        i = link.parent_index
    return FrameMotion(position, rotation, velocity, angular_velocity)


def _add_rotor_reaction(
    link_inertias: list[Matrix],
    bias_forces: list[Vector],
    link_velocities: Sequence[Vector],
    link: Link,
    rotor_motion: RotorMotion,
) -> None:
    """Add the reaction of a rotor to the inertia and the bias force of the link that carries it."""
    parent, axis = link.parent_index, link.rotation[:, 2].tolist()
    gyroscopic = _cross_product(
        link_velocities[parent][:3], [rotor_motion.inertia * rotor_motion.speed * a for a in axis]
    )
    if rotor_motion.torque is None:
        reaction = rotor_motion.inertia * rotor_motion.acceleration
    else:
        reaction = rotor_motion.torque
        removed = _subtract_outer_product(
            [[0.0] * 3 for _ in axis], [rotor_motion.inertia * a for a in axis], rotor_motion.inertia
        )
        link_inertias[parent] = _add_matrices(link_inertias[parent], _pad_to_spatial_matrix(removed))
    moment = _add_vectors(gyroscopic, [reaction * a for a in axis])
    bias_forces[parent] = _add_vectors(bias_forces[parent], [*moment, 0.0, 0.0, 0.0])


def _carrier_angular_acceleration(
    link: Link, parent_acceleration: Vector, rotor_motion: RotorMotion
) -> Number:
    """Angular acceleration [rad/s2] of the link that carries a rotor, about the axis of the rotor."""
    if not rotor_motion.is_coupled or link.parent_index == GROUND_INDEX:
        return 0.0
    return _dot_product(link.rotation[:, 2].tolist(), parent_acceleration[:3])


def _spatial_inertia(
    mass: Number, centre_of_mass: Sequence[Number], inertia: Sequence[Sequence[Number]]
) -> Matrix:
    """Spatial inertia (6, 6) about the origin; `inertia` (3, 3) is about the centre of mass."""
    lever = _skew_matrix(centre_of_mass)
    steiner = _multiply_matrices(lever, _transpose(lever))
    upper = [
        [
            *(inertia[r][c] + mass * steiner[r][c] for c in range(3)),
            *(mass * lever[r][c] for c in range(3)),
        ]
        for r in range(3)
    ]
    lower = [
        [*(mass * lever[c][r] for c in range(3)), *(mass if r == c else 0.0 for c in range(3))]
        for r in range(3)
    ]
    return upper + lower


def _payload_inertia(payload: RigidBody) -> Matrix:
    """Spatial inertia (6, 6) of a payload about the origin of the link that carries it."""
    axes = payload.frame.rotation.tolist()
    centre = _add_vectors(
        payload.frame.origin.tolist(), _multiply_matrix_vector(axes, list(payload.centre_of_mass))
    )
    diagonal = [[x if r == c else 0.0 for c, x in enumerate(payload.inertia)] for r in range(3)]
    inertia = _multiply_matrices(_multiply_matrices(axes, diagonal), _transpose(axes))
    return _spatial_inertia(payload.mass, centre, inertia)


def _frame_transform(link: Link) -> Matrix:
    """Constant transform (6, 6) of motion vectors from the parent's frame to the link's at position zero."""
    return _motion_transform(link.rotation.T.tolist(), link.origin.tolist())


def _joint_transform(link: Link, joint_position: Number) -> Matrix:
    """Transform (6, 6) of motion vectors by the motion of a joint from position zero."""
    if link.is_sliding_joint:
        return _motion_transform(np.eye(3).tolist(), [0.0, 0.0, joint_position])
    return _motion_transform(_z_rotation_matrix(joint_position), [0.0, 0.0, 0.0])


def _motion_transform(rotation_matrix: Matrix, frame_origin: Vector) -> Matrix:
    """Matrix (6, 6) that transforms spatial motion vectors to another frame.

    rotation_matrix : (3, 3) converts components from the old frame to the new frame
    frame_origin    : (3) [m] origin of the new frame, in the old frame
    """
    lower = _multiply_matrices(rotation_matrix, _skew_matrix(frame_origin))
    return [
        *([*row, 0.0, 0.0, 0.0] for row in rotation_matrix),
        *([*(-x for x in low), *row] for low, row in zip(lower, rotation_matrix, strict=True)),
    ]


def _z_rotation_matrix(rotation_angle: Number) -> Matrix:
    """Map (3, 3) of components to a frame that is rotated by an angle about z."""
    c, s = np.cos(rotation_angle), np.sin(rotation_angle)
    return [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]


def _make_axis_vector(coordinate_index: int, component: Number) -> Vector:
    """Spatial vector (6) whose only nonzero component is that of one coordinate."""
    return [component if k == coordinate_index else 0.0 for k in range(6)]


def _cross_motion(spatial_velocity: Vector, motion_vector: Vector) -> Vector:
    """Spatial cross product of a velocity with a motion vector."""
    w, v, a, b = spatial_velocity[:3], spatial_velocity[3:], motion_vector[:3], motion_vector[3:]
    return [*_cross_product(w, a), *_add_vectors(_cross_product(v, a), _cross_product(w, b))]


def _cross_force(spatial_velocity: Vector, force_vector: Vector) -> Vector:
    """Spatial cross product of a velocity with a force vector."""
    w, v, n, f = spatial_velocity[:3], spatial_velocity[3:], force_vector[:3], force_vector[3:]
    return [*_add_vectors(_cross_product(w, n), _cross_product(v, f)), *_cross_product(w, f)]


def _cross_product(first_vector: Sequence[Number], second_vector: Sequence[Number]) -> Vector:
    """Cross product of two vectors (3)."""
    return _multiply_matrix_vector(_skew_matrix(first_vector), list(second_vector))


def _skew_matrix(first_vector: Sequence[Number]) -> Matrix:
    """Matrix (3, 3) of the cross product a x ... with a first vector a (3)."""
    a = first_vector
    return [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]


def _dot_product(first_vector: Sequence[Number], second_vector: Sequence[Number]) -> Number:
    """Scalar product of two vectors; products with a constant zero are left out."""
    terms = [
        x * y
        for x, y in zip(first_vector, second_vector, strict=True)
        if not (_is_constant_zero(x) or _is_constant_zero(y))
    ]
    return sum(terms[1:], terms[0]) if terms else 0.0


def _is_constant_zero(number: Number) -> bool:
    """Whether a value is the number zero; False for a symbolic expression."""
    return isinstance(number, float) and number == 0.0


def _add_vectors(first_vector: Sequence[Number], second_vector: Sequence[Number]) -> Vector:
    """Sum of two vectors."""
    return [
        y if _is_constant_zero(x) else x if _is_constant_zero(y) else x + y
        for x, y in zip(first_vector, second_vector, strict=True)
    ]


def _add_matrices(first_matrix: Matrix, second_matrix: Matrix) -> Matrix:
    """Sum of two matrices."""
    return [_add_vectors(x, y) for x, y in zip(first_matrix, second_matrix, strict=True)]


def _multiply_matrix_vector(matrix: Matrix, vector: Sequence[Number]) -> Vector:
    """Product of a matrix and a vector."""
    return [_dot_product(row, vector) for row in matrix]


def _transpose(matrix: Matrix) -> Matrix:
    """Transposed matrix."""
    return [list(row) for row in zip(*matrix, strict=True)]


def _multiply_matrices(left_matrix: Matrix, right_matrix: Matrix) -> Matrix:
    """Product of two matrices."""
    columns = _transpose(right_matrix)
    return [[_dot_product(row, column) for column in columns] for row in left_matrix]


def _pad_to_spatial_matrix(angular_block: Matrix) -> Matrix:
    """Spatial matrix (6, 6) with an angular block (3, 3), otherwise zero."""
    return [*([*row, 0.0, 0.0, 0.0] for row in angular_block), *([0.0] * 6 for _ in range(3))]


def _transform_spatial_inertia(transform: Matrix, spatial_inertia: Matrix) -> Matrix:
    """Spatial inertia in another frame: transform^T inertia transform, symmetric."""
    columns = _transpose(transform)
    products = _transpose(_multiply_matrices(spatial_inertia, transform))
    return _mirror_upper_triangle(
        [[_dot_product(columns[r], products[c]) if c >= r else 0.0 for c in range(6)] for r in range(6)]
    )


def _subtract_outer_product(matrix: Matrix, column: Vector, pivot: Number) -> Matrix:
    """Symmetric matrix minus (column times its transpose)/pivot: elimination of one coordinate."""
    scaled = [0.0 if _is_constant_zero(x) else x / pivot for x in column]
    return _mirror_upper_triangle(
        [
            [
                matrix[r][c]
                if _is_constant_zero(column[r]) or _is_constant_zero(column[c])
                else matrix[r][c] - column[r] * scaled[c]
                if c >= r
                else 0.0
                for c in range(len(column))
            ]
            for r in range(len(column))
        ]
    )


def _mirror_upper_triangle(upper_triangle: Matrix) -> Matrix:
    """Symmetric matrix from its upper triangle."""
    return [
        [upper_triangle[min(r, c)][max(r, c)] for c in range(len(upper_triangle))]
        for r in range(len(upper_triangle))
    ]
