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
GROUND = -1
"""Index of the parent of a link that is connected to the ground."""


@dataclass(frozen=True, slots=True)
class Link:
    """Link of a tree, with the joint that connects it to its parent.

    The frame of a link has its z axis along the joint axis. A hinge rotates the frame about z, a slide moves
    it along z. All arrays are in the frame of the link unless stated otherwise.

    name             : name of the joint
    parent           : index of the parent link, smaller than the own index; GROUND: the ground
    is_slide         : whether the joint is a slide; otherwise a hinge
    rotation, origin : axes (columns of a (3, 3) matrix) and origin (3) [m] of the frame, in the frame of the
        parent, at joint position zero
    mass             : [kg] of the link, with all bodies fixed to it
    centre           : (3) [m] centre of mass
    inertia          : (3, 3) [kg.m2] about the centre of mass
    armature         : [kg.m2 or kg] inertia of a rigidly connected motor, reflected to the joint
    damping          : [N.m.s/rad or N.s/m] viscous damping of the joint
    stiffness        : [N.m/rad or N/m] of a spring in the joint
    spring_position  : [rad or m] joint position at which this spring is relaxed
    """

    name: str
    parent: int
    is_slide: bool
    rotation: Array
    origin: Array
    mass: float
    centre: Array
    inertia: Array
    armature: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    spring_position: float = 0.0

    @property
    def axis_index(self) -> int:
        """Index of the joint axis in spatial vectors: rotation about z, or translation along z."""
        return 5 if self.is_slide else 2


@dataclass(frozen=True, slots=True)
class Frame:
    """Frame fixed to a link: axes (columns of `rotation`) and origin [m], both in the frame of the link."""

    link: int
    rotation: Array
    origin: Array


@dataclass(frozen=True, slots=True)
class Body:
    """Additional rigid body in a frame of a link.

    mass    : [kg]
    centre  : (3) [m] centre of mass
    inertia : (3) [kg.m2] moments of inertia about axes through the centre of mass, parallel to the frame
    """

    frame: Frame
    mass: Number
    centre: Sequence[Number]
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
    def at_origin(cls, mass: float) -> "Payload":
        """Point mass [kg] at the origin of the tip body."""
        return cls(m=mass, x=0.0, y=0.0, z=0.0, J_x=0.0, J_y=0.0, J_z=0.0)

    def make_body(self, tip: Frame) -> Body:
        """The payload as a body in the frame of the tip."""
        return Body(tip, self.m, (self.x, self.y, self.z), (self.J_x, self.J_y, self.J_z))


@dataclass(frozen=True, slots=True)
class RotorMotion:
    """Motion of the rotor of a joint relative to the parent of the link.

    inertia      : [kg.m2] about its axis
    speed        : [rad/s]
    torque       : [N.m] on the rotor; None: the acceleration is prescribed
    acceleration : [rad/s2], prescribed
    is_coupled   : whether the rotor acts on the parent by its spin; otherwise it rotates as in the ground
    """

    inertia: Number
    speed: Number
    torque: Number | None = None
    acceleration: Number = 0.0
    is_coupled: bool = True


@dataclass(frozen=True, slots=True)
class TreeMotion:
    """Results of the forward dynamics: accelerations and forces of all joints and rotors.

    accelerations       : [rad/s2 or m/s2] of the joints
    forces              : [N.m or N] on the joints: as given, or as the prescribed accelerations need them
    rotor_accelerations : [rad/s2] of the rotors, by joint
    rotor_torques       : [N.m] on the rotors: as given, or as the prescribed accelerations need them
    """

    accelerations: list[Number]
    forces: list[Number]
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
    positions: Sequence[Number],
    speeds: Sequence[Number],
    forces: Sequence[Number | None],
    prescribed_accelerations: Sequence[Number] | None = None,
    rotors: Mapping[str, RotorMotion] | None = None,
    payload: Body | None = None,
) -> TreeMotion:
    """Accelerations of all joints and rotors.

    gravity                  : (3) [m/s2] acceleration of free fall, in the axes of the ground
    positions, speeds        : of the joints [rad or m], [rad/s or m/s]
    forces                   : [N.m or N] on each joint; None: its acceleration is prescribed
    prescribed_accelerations : [rad/s2 or m/s2] of the joints without a force; None: zero
    rotors                   : {joint: motion of its rotor}
    """
    rotors = rotors or {}
    transforms, velocities, biases = list[tuple[Matrix, Matrix]](), list[Vector](), list[Vector]()
    inertias, bias_forces = list[Matrix](), list[Vector]()
    for i, link in enumerate(links):
        moving, fixed = _joint_transform(link, positions[i]), _frame_transform(link)
        relative = _unit_vector(link.axis_index, speeds[i])
        velocity = relative
        if link.parent != GROUND:
            carried = _multiply(moving, _multiply(fixed, velocities[link.parent]))
            velocity = _add(carried, relative)
        inertia = _spatial_inertia(link.mass, link.centre.tolist(), link.inertia.tolist())
        if payload and payload.frame.link == i:
            inertia = _add_matrices(inertia, _payload_inertia(payload))
        transforms.append((moving, fixed))
        velocities.append(velocity)
        biases.append(_cross_motion(velocity, relative))
        inertias.append(inertia)
        bias_forces.append(_cross_force(velocity, _multiply(inertia, velocity)))
    for link in links:  # reactions of the rotors on the links that carry them
        if link.name in rotors and rotors[link.name].is_coupled and link.parent != GROUND:
            _add_rotor(inertias, bias_forces, velocities, link, rotors[link.name])
    count = len(links)
    columns: list[Vector] = [[]] * count
    pivots, remainders = [0.0] * count, [0.0] * count
    passive = [
        link.stiffness * (x - link.spring_position) + link.damping * v
        for link, x, v in zip(links, positions, speeds, strict=True)
    ]
    given = prescribed_accelerations or [0.0] * count
    for i in reversed(range(len(links))):
        link, axis, force = links[i], links[i].axis_index, forces[i]
        inertia, bias = inertias[i], biases[i]
        columns[i] = [row[axis] for row in inertia]
        if force is None:
            bias = _add(bias, _unit_vector(axis, given[i]))
            passed_inertia, passed_force = inertia, _add(bias_forces[i], _multiply(inertia, bias))
        else:
            pivots[i] = columns[i][axis] + link.armature
            remainders[i] = force - passive[i] - bias_forces[i][axis]
            passed_inertia = _subtract_outer(inertia, columns[i], pivots[i])
            ratio = remainders[i] / pivots[i]
            passed_force = _add(
                _add(bias_forces[i], _multiply(passed_inertia, bias)), [u * ratio for u in columns[i]]
            )
        if link.parent != GROUND:
            for transform in transforms[i]:
                passed_inertia = _congruence(transform, passed_inertia)
                passed_force = _multiply(_transpose(transform), passed_force)
            inertias[link.parent] = _add_matrices(inertias[link.parent], passed_inertia)
            bias_forces[link.parent] = _add(bias_forces[link.parent], passed_force)
    ground: Vector = [0.0, 0.0, 0.0, *(-float(g) for g in gravity)]
    spatial: list[Vector] = []
    accelerations, forces = list[Number](), [*forces]
    rotor_accelerations, rotor_torques = dict[str, Number](), dict[str, Number]()
    for i, link in enumerate(links):
        moving, fixed = transforms[i]
        parent = ground if link.parent == GROUND else spatial[link.parent]
        if link.name in rotors:
            rotor = rotors[link.name]
            spin = _carrier_angular_acceleration(link, parent, rotor)
            if rotor.torque is None:
                rotor_accelerations[link.name] = rotor.acceleration
                rotor_torques[link.name] = rotor.inertia * (rotor.acceleration + spin)
            else:
                rotor_accelerations[link.name] = rotor.torque / rotor.inertia - spin
                rotor_torques[link.name] = rotor.torque
        carried = _add(_multiply(moving, _multiply(fixed, parent)), biases[i])
        is_prescribed = forces[i] is None
        acceleration = given[i] if is_prescribed else (remainders[i] - _dot(columns[i], carried)) / pivots[i]
        spatial.append(_add(carried, _unit_vector(link.axis_index, acceleration)))
        accelerations.append(acceleration)
        if is_prescribed:
            needed = _dot(columns[i], spatial[i]) + bias_forces[i][link.axis_index]
            forces[i] = needed + link.armature * acceleration + passive[i]
    return TreeMotion(accelerations, forces, rotor_accelerations, rotor_torques)


def frame_motion(
    links: Sequence[Link], frame: Frame, positions: Sequence[Number], speeds: Sequence[Number]
) -> FrameMotion:
    """Pose and velocity of a frame in the axes of the ground."""
    position, rotation = frame.origin.tolist(), frame.rotation.tolist()
    velocity: Vector = [0.0, 0.0, 0.0]
    angular_velocity: Vector = [0.0, 0.0, 0.0]
    i = frame.link
    while i != GROUND:  # from the frame to the ground, in the frame of each parent
        link, axis = links[i], _unit_vector(2, speeds[i])[:3]
        if link.is_slide:
            velocity = _add(velocity, axis)
            position = _add(position, _unit_vector(2, positions[i])[:3])
            turned = link.rotation.tolist()
        else:
            velocity = _add(velocity, _cross(axis, position))
            angular_velocity = _add(angular_velocity, axis)
            turned = _product(link.rotation.tolist(), _transpose(_z_rotation(positions[i])))
        rotation = _product(turned, rotation)
        position = _add(link.origin.tolist(), _multiply(turned, position))
        velocity, angular_velocity = _multiply(turned, velocity), _multiply(turned, angular_velocity)
        i = link.parent
    return FrameMotion(position, rotation, velocity, angular_velocity)


def _add_rotor(
    inertias: list[Matrix],
    bias_forces: list[Vector],
    velocities: Sequence[Vector],
    link: Link,
    rotor: RotorMotion,
) -> None:
    """Add the reaction of a rotor to the inertia and the bias force of the link that carries it."""
    parent, axis = link.parent, link.rotation[:, 2].tolist()
    gyroscopic = _cross(velocities[parent][:3], [rotor.inertia * rotor.speed * a for a in axis])
    if rotor.torque is None:
        reaction = rotor.inertia * rotor.acceleration
    else:
        reaction = rotor.torque
        removed = _subtract_outer([[0.0] * 3 for _ in axis], [rotor.inertia * a for a in axis], rotor.inertia)
        inertias[parent] = _add_matrices(inertias[parent], _pad(removed))
    moment = _add(gyroscopic, [reaction * a for a in axis])
    bias_forces[parent] = _add(bias_forces[parent], [*moment, 0.0, 0.0, 0.0])


def _carrier_angular_acceleration(link: Link, parent_acceleration: Vector, rotor: RotorMotion) -> Number:
    """Angular acceleration [rad/s2] of the link that carries a rotor, about the axis of the rotor."""
    if not rotor.is_coupled or link.parent == GROUND:
        return 0.0
    return _dot(link.rotation[:, 2].tolist(), parent_acceleration[:3])


def _spatial_inertia(mass: Number, centre: Sequence[Number], inertia: Sequence[Sequence[Number]]) -> Matrix:
    """Spatial inertia (6, 6) about the origin; `inertia` (3, 3) is about the centre of mass."""
    lever = _skew(centre)
    steiner = _product(lever, _transpose(lever))
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


def _payload_inertia(payload: Body) -> Matrix:
    """Spatial inertia (6, 6) of a payload about the origin of the link that carries it."""
    axes = payload.frame.rotation.tolist()
    centre = _add(payload.frame.origin.tolist(), _multiply(axes, list(payload.centre)))
    diagonal = [[x if r == c else 0.0 for c, x in enumerate(payload.inertia)] for r in range(3)]
    inertia = _product(_product(axes, diagonal), _transpose(axes))
    return _spatial_inertia(payload.mass, centre, inertia)


def _frame_transform(link: Link) -> Matrix:
    """Constant transform (6, 6) of motion vectors from the parent's frame to the link's at position zero."""
    return _motion_transform(link.rotation.T.tolist(), link.origin.tolist())


def _joint_transform(link: Link, position: Number) -> Matrix:
    """Transform (6, 6) of motion vectors by the motion of a joint from position zero."""
    if link.is_slide:
        return _motion_transform(np.eye(3).tolist(), [0.0, 0.0, position])
    return _motion_transform(_z_rotation(position), [0.0, 0.0, 0.0])


def _motion_transform(rotation: Matrix, origin: Vector) -> Matrix:
    """Matrix (6, 6) that transforms spatial motion vectors to another frame.

    rotation : (3, 3) maps components to the new frame; origin : (3) [m] of the new frame, in the old one
    """
    lower = _product(rotation, _skew(origin))
    return [
        *([*row, 0.0, 0.0, 0.0] for row in rotation),
        *([*(-x for x in low), *row] for low, row in zip(lower, rotation, strict=True)),
    ]


def _z_rotation(angle: Number) -> Matrix:
    """Map (3, 3) of components to a frame that is rotated by an angle about z."""
    c, s = np.cos(angle), np.sin(angle)
    return [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]


def _unit_vector(index: int, coordinate_count: Number) -> Vector:
    """Unit vector along one coordinate of a number of coordinates."""
    return [coordinate_count if k == index else 0.0 for k in range(6)]


def _cross_motion(velocity: Vector, motion: Vector) -> Vector:
    """Spatial cross product of a velocity with a motion vector."""
    w, v, a, b = velocity[:3], velocity[3:], motion[:3], motion[3:]
    return [*_cross(w, a), *_add(_cross(v, a), _cross(w, b))]


def _cross_force(velocity: Vector, force: Vector) -> Vector:
    """Spatial cross product of a velocity with a force vector."""
    w, v, n, f = velocity[:3], velocity[3:], force[:3], force[3:]
    return [*_add(_cross(w, n), _cross(v, f)), *_cross(w, f)]


def _cross(a: Sequence[Number], b: Sequence[Number]) -> Vector:
    """Cross product of two vectors (3)."""
    return _multiply(_skew(a), list(b))


def _skew(a: Sequence[Number]) -> Matrix:
    """Matrix (3, 3) of the cross product with a vector."""
    return [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]


def _dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    """Scalar product of two vectors; products with a constant zero are left out."""
    terms = [x * y for x, y in zip(a, b, strict=True) if not (_is_zero(x) or _is_zero(y))]
    return sum(terms[1:], terms[0]) if terms else 0.0


def _is_zero(number: Number) -> bool:
    """Whether a Number is a constant zero, not a symbol."""
    return isinstance(number, float) and number == 0.0


def _add(a: Sequence[Number], b: Sequence[Number]) -> Vector:
    """Sum of two vectors."""
    return [y if _is_zero(x) else x if _is_zero(y) else x + y for x, y in zip(a, b, strict=True)]


def _add_matrices(a: Matrix, b: Matrix) -> Matrix:
    """Sum of two matrices."""
    return [_add(x, y) for x, y in zip(a, b, strict=True)]


def _multiply(matrix: Matrix, vector: Sequence[Number]) -> Vector:
    """Product of a matrix and a vector."""
    return [_dot(row, vector) for row in matrix]


def _transpose(matrix: Matrix) -> Matrix:
    """Transposed matrix."""
    return [list(row) for row in zip(*matrix, strict=True)]


def _product(a: Matrix, b: Matrix) -> Matrix:
    """Product of two matrices."""
    columns = _transpose(b)
    return [[_dot(row, column) for column in columns] for row in a]


def _pad(block: Matrix) -> Matrix:
    """Spatial matrix (6, 6) with an angular block (3, 3), otherwise zero."""
    return [*([*row, 0.0, 0.0, 0.0] for row in block), *([0.0] * 6 for _ in range(3))]


def _congruence(transform: Matrix, inertia: Matrix) -> Matrix:
    """Spatial inertia in another frame: transform^T inertia transform, symmetric."""
    columns = _transpose(transform)
    products = _transpose(_product(inertia, transform))
    return _mirror([[_dot(columns[r], products[c]) if c >= r else 0.0 for c in range(6)] for r in range(6)])


def _subtract_outer(matrix: Matrix, column: Vector, pivot: Number) -> Matrix:
    """Matrix minus the outer product of a column with itself over a pivot, symmetric."""
    scaled = [0.0 if _is_zero(x) else x / pivot for x in column]
    return _mirror(
        [
            [
                matrix[r][c]
                if _is_zero(column[r]) or _is_zero(column[c])
                else matrix[r][c] - column[r] * scaled[c]
                if c >= r
                else 0.0
                for c in range(len(column))
            ]
            for r in range(len(column))
        ]
    )


def _mirror(upper: Matrix) -> Matrix:
    """Symmetric matrix from its upper triangle."""
    return [[upper[min(r, c)][max(r, c)] for c in range(len(upper))] for r in range(len(upper))]
