"""Modal compliance of the members (the bodies of the joint) between their attachments.

A mode is a displacement field of both members with fixed attachments, scaled by its modal coordinate a [m].
The loads on the modes are the changes of contact pressure, traction and bolt force since tightening. The
elastic energy of the members is the sum of stiffness a^2/2.
"""

from dataclasses import dataclass

import numpy as np

from ...quantity import Array
from .law import MODAL_ENTRY_NAMES, ElasticBodies

MODAL_DISPLACEMENT_DECIMALS = 4
"""Decimals to which the displacements of a mode are rounded [1]; the displacements are at most 1."""
PATCH_POSITION_TOLERANCE = 1e-6
"""Largest distance [m] of a friction patch from its position when the modes were computed."""
_OTHER_CONTACT_TEXT = (
    "[bodies] was computed for another contact; write the file again with jointfmu new bolted-joint"
)
"""Reason of the errors about modes whose points or patches are not those of the contact."""


@dataclass(frozen=True)
class MemberModes:
    """Deformation modes of the members: stiffness of k modes, and displacements per modal coordinate.

    The displacements are those of n contact points, m friction patches and b bolts.

    modal_stiffness    : (k) [N/m]
    point_opening      : (n, k) [1] of the contact at the points
    patch_displacement : (3, m, k) [1] of the patches along x, along y and around their centres
    bolt_elongation    : (b, k) [1]
    """

    modal_stiffness: Array
    point_opening: Array
    patch_displacement: Array
    bolt_elongation: Array

    @classmethod
    def from_rigid_members(cls, point_count: int, patch_count: int, bolt_count: int) -> "MemberModes":
        """Empty set of modes for rigid members, with the given numbers of points, patches and bolts."""
        return cls(
            np.zeros(0), np.zeros((point_count, 0)), np.zeros((3, patch_count, 0)), np.zeros((bolt_count, 0))
        )

    @classmethod
    def from_elastic_bodies(
        cls, elastic_bodies: ElasticBodies, point_count: int, patch_positions: Array
    ) -> "MemberModes":
        """Deformation modes of elastic members, read from the section [bodies] of a parameter file.

        point_count     : number n of contact points
        patch_positions : (m, 2) [m] of the friction patches

        Raises ValueError if the modes were computed for another contact.
        """
        count = len(elastic_bodies.stiffness)
        position = np.stack([elastic_bodies.x, elastic_bodies.y], axis=1)
        if len(elastic_bodies.opening) != point_count * count or position.shape != patch_positions.shape:
            stated = f"{len(elastic_bodies.opening) // count} points and {len(position)} patches"
            raise ValueError(
                f"[bodies] has {stated}, but the contact has {point_count} points and {len(patch_positions)} "
                f"patches: {_OTHER_CONTACT_TEXT}"
            )
        if (distance := float(np.max(np.abs(position - patch_positions)))) > PATCH_POSITION_TOLERANCE:
            raise ValueError(
                f"[bodies] has patches up to {distance:.3g} m away from those of the contact, allowed is "
                f"{PATCH_POSITION_TOLERANCE:g} m: {_OTHER_CONTACT_TEXT}"
            )
        rows = {
            name: np.array(getattr(elastic_bodies, name)).reshape(-1, count) for name in MODAL_ENTRY_NAMES
        }
        patch_displacement = np.stack([rows[f"patch_{direction}"] for direction in ("x", "y", "around")])
        return cls(np.array(elastic_bodies.stiffness), rows["opening"], patch_displacement, rows["stretch"])
