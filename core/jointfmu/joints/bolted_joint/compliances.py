"""Shares of interface, members and bolts in the compliance of a tightened joint."""

from typing import NamedTuple

import numpy as np

from ...quantity import Array
from .equilibrium import JointAssembly

STIFFNESS_UNITS = {"x": "N/m", "y": "N/m", "z": "N/m", "rx": "N.m/rad", "ry": "N.m/rad", "rz": "N.m/rad"}
"""{force along or moment about an axis: unit of its stiffness}."""
COMPLIANCE_COMPONENTS = ("interface", "members", "bolts")
"""Parts of the joint whose compliances add up, in the order of `component_compliances`."""
MIN_INTERFACE_COMPLIANCE_SHARE = 0.1
"""Share of the interface in the compliance of the joint [1] from which its law matters."""
MIN_BOLT_OVER_JOINT_STIFFNESS = 1e-9
"""Bolt stiffness over joint stiffness [1] that counts as zero: round-off of the bolt positions."""


def condense_stiffness(tangent_stiffness: Array) -> Array:
    """Stiffness (6, 6) [N/m, N, N.m] between the sides of the joint, with the members in equilibrium.

    The modal coordinates are eliminated from the tangent stiffness H (static condensation).
    """
    return np.asarray(
        tangent_stiffness[:6, :6]
        - tangent_stiffness[:6, 6:] @ np.linalg.solve(tangent_stiffness[6:, 6:], tangent_stiffness[6:, :6])
    )


class Compliances(NamedTuple):
    """Compliances of a tightened joint along and about x, y, z; for each, the other five motions are zero.

    component_compliances : (3, 6) [m/N, rad/(N.m)] twice the energy in interface, members and bolts at a unit
                            force or moment
    interface_compliance  : (6) [m/N, rad/(N.m)] of the interface alone between rigid members, without bolts
    bolt_stiffness        : (6) [N/m, N.m/rad] of the bolts alone between rigid members
    bolt_force            : (b, 6) [1, 1/m] force of each bolt at a unit force or moment, other motions free
    """

    component_compliances: Array
    interface_compliance: Array
    bolt_stiffness: Array
    bolt_force: Array

    @classmethod
    def from_assembly(
        cls, assembly: JointAssembly, tangent_stiffness: Array, active_bolt_stiffness: Array
    ) -> "Compliances":
        """Compliances of a tightened joint.

        tangent_stiffness     : H (6 + k, 6 + k) of the assembly, see `JointAssembly.tangent_stiffness`
        active_bolt_stiffness : (b) [N/m] of the bolts, part of H
        """
        K, follow = (
            condense_stiffness(tangent_stiffness),
            -np.linalg.solve(tangent_stiffness[6:, 6:], tangent_stiffness[6:, :6]),
        )
        rigid, bolt = assembly.full_elongation_jacobian[:, :6], active_bolt_stiffness[:, None]
        elongation = rigid + assembly.modes.bolt_elongation @ follow
        members = assembly.modes.modal_stiffness @ follow**2
        bolts, rigid_bolts = (np.sum(bolt * each**2, axis=0) for each in (elongation, rigid))
        held = np.diag(K)
        parts = np.stack([held - members - bolts, members, bolts]) / held**2
        interface = 1.0 / (np.diag(tangent_stiffness)[:6] - rigid_bolts)
        return cls(parts, interface, rigid_bolts, bolt * elongation @ np.linalg.inv(K))

    @property
    def total_compliance(self) -> Array:
        """Compliance (6) [m/N, rad/(N.m)] of the complete joint: interface, members and bolts in series."""
        return np.asarray(self.component_compliances.sum(axis=0))

    @property
    def compliance_shares(self) -> Array:
        """Shares (3, 6) [1] of interface, members and bolts in the compliance of the joint."""
        return self.component_compliances / self.total_compliance

    @property
    def member_stiffness(self) -> Array:
        """Stiffness (6) [N/m, N.m/rad] of the members as springs in series with interface and bolts."""
        return np.asarray(1.0 / self.component_compliances[1])

    def compliance_table_rows(self) -> list[tuple[str, str, list[float], list[float]]]:
        """Table of stiffnesses and compliance shares, with one row for each of the six directions.

        A row has the name of the stiffness, its unit, the stiffness of joint, interface, members and bolts
        (0: bolts without stiffness), and the shares [1] of the last three in the compliance of the joint.
        """
        joint = 1.0 / self.total_compliance
        bolts = np.where(
            self.bolt_stiffness > MIN_BOLT_OVER_JOINT_STIFFNESS * joint, self.bolt_stiffness, 0.0
        )
        each = np.stack([joint, 1.0 / self.interface_compliance, self.member_stiffness, bolts])
        return [
            (_stiffness_name(name), unit, each[:, i].tolist(), self.compliance_shares[:, i].tolist())
            for i, (name, unit) in enumerate(STIFFNESS_UNITS.items())
        ]

    @property
    def is_interface_relevant(self) -> bool:
        """Whether the interface has a share of at least MIN_INTERFACE_COMPLIANCE_SHARE in a compliance."""
        return bool(np.max(self.compliance_shares[0]) >= MIN_INTERFACE_COMPLIANCE_SHARE)

    @property
    def joint_load_factor(self) -> float:
        """Share of all bolts in a force along z [1]: n Phi_K of VDI 2230."""
        return float(self.bolt_force[:, 2].sum())

    def opening_load(self, tightening_force: float) -> float:
        """Force [N] along z at which the contact around the most loaded bolt opens, by linear theory.

        tightening_force : [N] of a bolt. The contact around a bolt has the same share of the force on the
                           interface as the bolt has of the force on all bolts.
        """
        force = self.bolt_force[:, 2]
        share = force.max() / force.sum() if np.any(force) else 1.0 / len(force)
        return tightening_force / float(share * (1.0 - self.joint_load_factor))


def _stiffness_name(stiffness_direction: str) -> str:
    """Name of the stiffness along or about an axis: K_zz, K_rx."""
    return f"K_{stiffness_direction if stiffness_direction.startswith('r') else 2 * stiffness_direction}"
