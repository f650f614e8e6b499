"""Stiffness matrix of a complete joint between two nodes of the user's model, with rigid arms."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array

from .target_model import AXIS_ORDER, TargetModel

DOF_NAMES = ("x", "y", "z", "rx", "ry", "rz")
"""Degrees of freedom of a node: displacements along x, y, z and rotations about x, y, z."""
MAX_RELATIVE_ROUND_OFF = 1e-9
"""Magnitude of K_ij over sqrt(K_ii K_jj) [1] that counts as zero: exported numbers have ten digits."""


@dataclass(frozen=True, slots=True)
class JointStiffness:
    """Stiffness matrix of a complete joint: side 2 relative to side 1, about the centroid of the contact.

    stiffness_matrix : symmetric K (6, 6) [N/m, N, N.m/rad] in the frame of the joint: K times displacement
                       and rotation of side 2 relative to side 1 is the force and moment that move side 2
    node_positions   : (2, 3) [m] of the nodes of side 1 and side 2 from the centroid, along the model's axes.
                       Each node moves with the attachment of its side as a rigid body
    """

    stiffness_matrix: Array
    node_positions: Array

    @classmethod
    def from_tangent_stiffness(cls, tangent_stiffness: Array, node_positions: Array) -> "JointStiffness":
        """Take the symmetric part of a tangent stiffness (6, 6), and set entries of round-off to zero."""
        K = 0.5 * (tangent_stiffness + tangent_stiffness.T)
        size = np.sqrt(np.abs(np.diag(K)))
        return cls(
            np.where(np.abs(K) > MAX_RELATIVE_ROUND_OFF * np.outer(size, size), K, 0.0), node_positions
        )

    @property
    def max_relative_coupling(self) -> float:
        """Largest |K_ij|/sqrt(K_ii K_jj) [1] of the stiffness K for two different degrees of freedom i, j."""
        size = np.sqrt(np.diag(self.stiffness_matrix))
        return float(np.max(np.abs(self.stiffness_matrix / np.outer(size, size) - np.eye(6))))

    def matrix_in_model_axes(self, target_model: TargetModel) -> Array:
        """Stiffness K (6, 6) about the centroid, along the model's axes and in its units."""
        axes = list(AXIS_ORDER[target_model.joint_normal_axis])
        order = [*axes, *(axis + 3 for axis in axes)]
        length = target_model.unit_set.convert_from_si(1.0, "m")
        exponent = np.repeat([-0.5, 0.5], 3)
        K = np.zeros((6, 6))
        K[np.ix_(order, order)] = self.stiffness_matrix * length ** np.add.outer(exponent, exponent)
        return K

    def matrix_between_nodes(self, target_model: TargetModel) -> Array:
        """Stiffness K (12, 12) between the nodes of side 1 and side 2, in the model's axes and units.

        The motion of the centroid is u + theta x (-r) for a node at r with displacement u and rotation theta
        (rigid arm). So K_nodes = B^T K B with B = [-T(r1), T(r2)].
        """
        arms = [rigid_arm_matrix(target_model.unit_set.convert_from_si(r, "m")) for r in self.node_positions]
        B = np.hstack([-arms[0], arms[1]])
        return np.asarray(B.T @ self.matrix_in_model_axes(target_model) @ B)

    def node_positions_in_model_units(self, target_model: TargetModel) -> Array:
        """Positions (2, 3) of the nodes in the units of the model."""
        return target_model.unit_set.convert_from_si(self.node_positions, "m")

    def diagonal_stiffness(self) -> dict[str, float]:
        """{name: diagonal entry of K [N/m, N.m/rad] in the frame of the joint, about the centroid}."""
        return {
            f"K_{name if len(name) > 1 else 2 * name}": float(value)
            for name, value in zip(DOF_NAMES, np.diag(self.stiffness_matrix), strict=True)
        }


def rigid_arm_matrix(node_position: Array) -> Array:
    """Matrix T (6, 6) of a rigid arm from a node at r: motion of the origin = T times motion of the node."""
    x, y, z = node_position
    T = np.eye(6)
    T[:3, 3:] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return T


def describe_joint_stiffness(joint_stiffness: JointStiffness, target_model: TargetModel) -> Sequence[str]:
    """Describe the stiffness matrix in comment lines: meaning, frame and point, positions of the nodes."""
    axes = ["xyz"[axis] for axis in AXIS_ORDER[target_model.joint_normal_axis]]
    diagonal = ", ".join(
        f"{name} {value:.9g}" for name, value in joint_stiffness.diagonal_stiffness().items()
    )
    nodes = [
        f"node {target_model.first_free_number + side} moves with the attachment of side {side + 1} as a "
        f"rigid body; from the centroid: {', '.join(f'{value:.9g}' for value in position)}"
        for side, position in enumerate(joint_stiffness.node_positions_in_model_units(target_model))
    ]
    return [
        "stiffness: complete joint with interface, members and bolts; symmetric part of the tangent",
        f"stiffness about the centroid of the contact, joint's x, y, z [N/m, N.m/rad]: {diagonal}",
        f"largest coupling K_ij/sqrt(K_ii K_jj): {joint_stiffness.max_relative_coupling:.3g}",
        f"frame: the joint's x (along the bolt rows), y, z (normal, from side 1 to side 2) are the model's "
        f"{', '.join(axes)}; origin: centroid of the contact",
        *nodes,
    ]
