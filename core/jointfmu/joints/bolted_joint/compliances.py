"""Who gives way in a tightened bolted joint: interface, members and bolts under small loads of the whole."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...quantity import Array

if TYPE_CHECKING:
    from .spring import BoltedJointSpring


DIRECTIONS = {"x": "N/m", "y": "N/m", "z": "N/m", "rx": "N.m/rad", "ry": "N.m/rad", "rz": "N.m/rad"}
"""{force along or moment about an axis: unit of its stiffness}."""
PARTS = ("interface", "members", "bolts")
MATTERS = 0.1
"""Part of the whole's compliance [1] from which on the interface is worth a law of its own."""


class Compliances(NamedTuple):
    """Of a tightened joint, under a unit force along x, y, z and a unit moment about them.

    parts      : (3, 6) [m/N, rad/(N.m)] twice the energy that interface, members and bolts store
    rigid      : (6) of the interface alone between rigid sides, without bolts
    bolts      : (6) [N/m, N.m/rad] stiffness of the bolts alone between rigid sides
    bolt_force : (bolts, 6) [N per N, N per N.m] what each bolt gets of it
    """

    parts: Array
    rigid: Array
    bolts: Array
    bolt_force: Array

    @classmethod
    def of(cls, spring: "BoltedJointSpring", preload: float, moment: float = 0.0) -> "Compliances":
        """Of a joint with elastic sides, tightened by the force of each bolt [N] and a moment [N.m]."""
        whole, modes, bolt = spring.whole, spring.modes, spring.joint.bolt_stiffness
        H = spring.slope(preload, moment)
        motion = np.linalg.inv(whole.condensed(H))
        amplitude = -np.linalg.solve(H[6:, 6:], H[6:, :6] @ motion)
        force = bolt * (whole.seats @ motion[2:5] + modes.stretch @ amplitude)
        members = modes.stiffness @ amplitude**2
        stretch = np.sum(force**2, axis=0) / bolt if bolt > 0.0 else np.zeros(6)
        interface = np.diag(motion) - members - stretch
        shanks = np.zeros((6, 6))
        shanks[2:5, 2:5] = bolt * whole.seats.T @ whole.seats
        alone = np.diag(np.linalg.inv(H[:6, :6] - shanks))
        return cls(np.stack([interface, members, stretch]), alone, np.diag(shanks), force)

    @property
    def whole(self) -> Array:
        """(6) of the joint."""
        return np.asarray(self.parts.sum(axis=0))

    @property
    def shares(self) -> Array:
        """(3, 6) [1] of interface, members and bolts in the compliance."""
        return self.parts / self.whole

    @property
    def members(self) -> Array:
        """Stiffness (6) [N/m, N.m/rad] of the members: springs in series with the rest in their place."""
        return np.asarray(1.0 / self.parts[1])

    def rows(self) -> list[tuple[str, str, list[float], list[float]]]:
        """Each direction's name and unit, stiffness of the whole, interface, members and bolts (0: none),
        and their shares [1] in the compliance."""
        each = np.stack([1.0 / self.whole, 1.0 / self.rigid, self.members, self.bolts])
        return [
            (_stiffness_name(name), unit, each[:, i].tolist(), self.shares[:, i].tolist())
            for i, (name, unit) in enumerate(DIRECTIONS.items())
        ]

    @property
    def matters(self) -> bool:
        """Whether the interface has a say in the stiffness along or about any axis."""
        return bool(np.max(self.shares[0]) >= MATTERS)

    @property
    def load_factor(self) -> float:
        """Part [1] that the bolts take of a force along z: n Phi_K of VDI 2230."""
        return float(self.bolt_force[:, 2].sum())

    def opening_load(self, tension: float) -> float:
        """Force [N] along z that takes all pressure off the interface, linearly; tension [N] of a bolt."""
        force = self.bolt_force[:, 2]
        return tension / (1.0 / len(force) - float(force.mean()))


def _stiffness_name(direction: str) -> str:
    """A direction as its stiffness is called: K_zz, K_rx."""
    return f"K_{direction if direction.startswith('r') else 2 * direction}"
