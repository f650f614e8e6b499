"""Shares of interface, members and bolts in the compliance of a tightened joint."""

from typing import NamedTuple

import numpy as np

from ...quantity import Array
from .equilibrium import JointAssembly, condense_stiffness

DIRECTIONS = {"x": "N/m", "y": "N/m", "z": "N/m", "rx": "N.m/rad", "ry": "N.m/rad", "rz": "N.m/rad"}
"""{force along or moment about an axis: unit of its stiffness}."""
COMPONENTS = ("interface", "members", "bolts")
MIN_INTERFACE_SHARE = 0.1
"""Part of the whole's compliance [1] from which on the interface is worth a law of its own."""
RELATIVE_ROUND_OFF = 1e-9
"""Stiffness of bolts over that of the whole [1] up to which it is that of places rounded off an axis."""


class Compliances(NamedTuple):
    """Of a tightened joint that moves along x, y, z or turns about them, the other five motions held, as K_xx
    to K_rz of the FMU are.

    parts      : (3, 6) [m/N, rad/(N.m)] twice the energy that interface, members and bolts store at a unit
                 force or moment
    rigid      : (6) of the interface alone between rigid sides, without bolts
    bolts      : (6) [N/m, N.m/rad] stiffness of the bolts alone between rigid sides
    bolt_force : (bolts, 6) [N per N, N per N.m] what each bolt gets of a force or moment that leaves the
                 other motions free
    """

    components: Array
    interface_stiffness: Array
    bolt_stiffness: Array
    bolt_force: Array

    @classmethod
    def of(cls, assembly: JointAssembly, H: Array, bolt_tangent: Array) -> "Compliances":
        """Compliances of a tightened joint.

        H            : tangent stiffness (6 + k, 6 + k) of the assembly, see `JointAssembly.tangent_stiffness`
        bolt_tangent : (b) [N/m] of the bolts, part of H
        """
        K, follow = condense_stiffness(H), -np.linalg.solve(H[6:, 6:], H[6:, :6])
        rigid, bolt = assembly.elongation_jacobian[:, :6], bolt_tangent[:, None]
        elongation = rigid + assembly.modes.bolt_elongation @ follow
        members = assembly.modes.stiffness @ follow**2
        bolts, rigid_bolts = (np.sum(bolt * each**2, axis=0) for each in (elongation, rigid))
        held = np.diag(K)
        parts = np.stack([held - members - bolts, members, bolts]) / held**2
        interface = 1.0 / (np.diag(H)[:6] - rigid_bolts)
        return cls(parts, interface, rigid_bolts, bolt * elongation @ np.linalg.inv(K))

    @property
    def total(self) -> Array:
        """(6) of the joint."""
        return np.asarray(self.components.sum(axis=0))

    @property
    def shares(self) -> Array:
        """(3, 6) [1] of interface, members and bolts in the compliance."""
        return self.components / self.total

    @property
    def member_stiffness(self) -> Array:
        """Stiffness (6) [N/m, N.m/rad] of the members: springs in series with the rest."""
        return np.asarray(1.0 / self.components[1])

    def rows(self) -> list[tuple[str, str, list[float], list[float]]]:
        """Each direction's name and unit, stiffness of the whole, interface, members and bolts (0: none),
        and their shares [1] in the compliance."""
        whole = 1.0 / self.total
        bolts = np.where(self.bolt_stiffness > RELATIVE_ROUND_OFF * whole, self.bolt_stiffness, 0.0)
        each = np.stack([whole, 1.0 / self.interface_stiffness, self.member_stiffness, bolts])
        return [
            (_stiffness_name(name), unit, each[:, i].tolist(), self.shares[:, i].tolist())
            for i, (name, unit) in enumerate(DIRECTIONS.items())
        ]

    @property
    def matters(self) -> bool:
        """Whether the interface has a say in the stiffness along or about any axis."""
        return bool(np.max(self.shares[0]) >= MIN_INTERFACE_SHARE)

    @property
    def load_factor(self) -> float:
        """Part [1] that the bolts take of a force along z: n Phi_K of VDI 2230."""
        return float(self.bolt_force[:, 2].sum())

    def opening_load(self, tension: float) -> float:
        """Force [N] along z that takes the pressure off around the bolt that gets most, linearly: its place
        has the part of the force that it has of what all bolts get; tension [N] of a bolt.
        """
        force = self.bolt_force[:, 2]
        part = force.max() / force.sum() if np.any(force) else 1.0 / len(force)
        return tension / float(part * (1.0 - self.load_factor))


def _stiffness_name(direction: str) -> str:
    """A direction as its stiffness is called: K_zz, K_rx."""
    return f"K_{direction if direction.startswith('r') else 2 * direction}"
