"""Tooth contact of a gear: uniform pressure on the rough flanks."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ...contact.interface import evaluate_at_pressure
from ...contact.laws.roughness import RoughnessLaw
from ...contact.laws.table import TableLaw
from ...contact.laws.yu2022 import Yu2022
from ...mechanics.curve import Curve, tabulate_approach
from ...quantity import Array, Number, quantity_field


@dataclass(frozen=True, kw_only=True)
class GearContactParameters(Yu2022):
    """Parameters of the gear contact with the law of Yu 2022: the parameters of this law."""


@dataclass(frozen=True, kw_only=True)
class RoughGearContactParameters(RoughnessLaw):
    """Parameters of the gear contact with the law `roughness`."""


@dataclass(frozen=True, kw_only=True)
class TableGearContactParameters(TableLaw):
    """Parameters of the gear contact with the law `table`."""

    H: float = quantity_field(
        "Pa", "hardness of the softer body; only the real contact area depends on it", gt=0.0
    )

    def real_area(self, pressure: Number) -> tuple[Number, Number]:
        """Real area (...) [m2] at pressures (...) [Pa] and its elastic fraction [1].

        A table of the stiffness does not contain the area. It is taken as load over hardness, as if all spots
        yield.
        """
        return self.A_0 * pressure / self.H, 0.0 * pressure

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities of the law `table`, with the real area of `real_area`."""
        state = super().contact_quantities(largest_log_area)
        A_r, elastic_fraction = self.real_area(state["F"] / self.A_0)
        return state | {"A_r": A_r, "elastic_fraction": elastic_fraction}


ContactParameters: TypeAlias = GearContactParameters | RoughGearContactParameters | TableGearContactParameters
"""Parameter set of a gear contact with any law."""


@dataclass(frozen=True, slots=True)
class GearContactSpring:
    """Tabulated gear contact: normal force in, approach out.

    curve : pressure [Pa] of the flanks as a function of their approach [m]
    """

    joint: ContactParameters
    curve: Curve

    @classmethod
    def tabulate(cls, joint_parameters: ContactParameters) -> "GearContactSpring":
        """Tabulate the pressure of the flanks as a function of their approach, for a parameter set."""
        return cls(joint_parameters, tabulate_approach(joint_parameters))

    @property
    def max_force(self) -> float:
        """Force at the end of the table [N]: the largest pressure of the law on the whole nominal area."""
        return self.joint.A_0 * self.curve.end_point[1]

    def evaluate(self, normal_force: ArrayLike) -> dict[str, Array]:
        """Outputs at normal forces f (...) [N].

        s_rel [m] approach from first contact, K_N [N/m], A_r [m2], elastic_fraction [1]. For a tensile force
        the flanks are separated: all outputs are zero.
        """
        force = np.maximum(np.asarray(normal_force, dtype=np.float64), 0.0)
        delta = self.curve.inverse(force / self.joint.A_0)
        stiffness = self.curve.derivatives(delta, 1)[1]
        contact_force = np.where(force > 0.0, force, self.max_force)  # any force that the law accepts
        state = evaluate_at_pressure(self.joint, contact_force / self.joint.A_0)
        first = self.curve.displacement[0]
        return contact_outputs(
            self.joint, force, delta - first, stiffness, state["A_r"], state["elastic_fraction"]
        )


def contact_outputs(
    joint_parameters: ContactParameters,
    normal_force: Number,
    flank_approach: Number,
    contact_stiffness: Number,
    real_area: Number,
    elastic_fraction: Number,
) -> dict[str, Number]:
    """Outputs of the gear contact at a normal force f [N].

    flank_approach : [m] from first contact
    contact_stiffness : [N/m3] per nominal area, of the curve
    real_area : [m2] real contact area of the law
    elastic_fraction : [1] elastic fraction of the real area
    """
    return {
        "s_rel": flank_approach,
        "K_N": joint_parameters.A_0 * contact_stiffness,
        "A_r": np.where(normal_force > 0.0, real_area, 0.0),
        "elastic_fraction": np.where(normal_force > 0.0, elastic_fraction, 0.0),
    }
