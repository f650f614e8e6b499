"""Tooth contact of a gear: uniform pressure on the rough flanks."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ...contact.interface import at_pressure
from ...contact.laws.roughness import Roughness
from ...contact.laws.yu2022 import Yu2022
from ...mechanics.curve import Curve, approach_curve
from ...quantity import Array, Number


@dataclass(frozen=True, kw_only=True)
class GearContact(Yu2022):
    """Parameters of the gear contact: those of the law of Yu 2022."""


@dataclass(frozen=True, kw_only=True)
class RoughGearContact(Roughness):
    """The same with the law `roughness`."""


Contact: TypeAlias = GearContact | RoughGearContact
"""A gear contact with any law."""


@dataclass(frozen=True, slots=True)
class GearContactSpring:
    """The exported contact: force in, approach out."""

    joint: Contact
    curve: Curve

    @classmethod
    def of(cls, joint: Contact) -> "GearContactSpring":
        """Tabulate a contact."""
        return cls(joint, approach_curve(joint))

    @property
    def max_force(self) -> float:
        """Force at the end of the table [N]: the hardness on the whole nominal area."""
        return self.joint.A_0 * self.curve.end[1]

    def approach(self, f: ArrayLike) -> dict[str, Array]:
        """Approach [m] from first touch, stiffness [N/m], real area [m2] and its elastic part at f (...) [N].

        A pulling force finds the flanks apart: everything is zero.
        """
        force = np.maximum(np.asarray(f, dtype=np.float64), 0.0)
        delta = self.curve.inverse(force / self.joint.A_0)
        stiffness = self.curve.derivatives(delta, 1)[1]
        touching = np.where(force > 0.0, force, self.max_force)
        state = at_pressure(self.joint, touching / self.joint.A_0)
        first = self.curve.displacement[0]
        return contact(self.joint, force, delta - first, stiffness, state["A_r"], state["elastic_fraction"])


def contact(
    joint: Contact, f: Number, approach: Number, stiffness: Number, area: Number, elastic: Number
) -> dict[str, Number]:
    """What the contact exports at a load [N].

    Given are approach [m] and stiffness per area [N/m3] of the curve there, and real area [m2] and its
    elastic part [1] of the law.
    """
    return {
        "s_rel": approach,
        "K_N": joint.A_0 * stiffness,
        "A_r": np.where(f > 0.0, area, 0.0),
        "elastic_fraction": np.where(f > 0.0, elastic, 0.0),
    }
