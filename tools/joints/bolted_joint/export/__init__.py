"""What other solvers are given of a bolted joint."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.law import Bolted, shear_ratio
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.joints.model import Variable
from jointfmu.quantity import quantity

from ....export.exports import Exports, LoadCurve

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from ....export.mesh import Mesh
    from ....export.placing import Placing, Springs
    from ....export.tables import LoadTable


@dataclass(frozen=True, slots=True)
class Tightening:
    """Working point."""

    preload: float = quantity("N", "the force of each bolt")
    moment: float = quantity("N.m", "the bending moment")

    def __str__(self) -> str:
        return f"preload {self.preload:g} N per bolt, moment {self.moment:g} N.m"


def _springs(
    joint: Bolted, state: Tightening | None, mesh: "Mesh | None", placing: "Placing"
) -> "tuple[Springs, str]":
    from . import springs

    spring = BoltedJointSpring.of_nodes(joint)
    if state is None:
        if mesh is None:
            raise ValueError("springs need a preload, or node pairs with their pressure")
        return springs.under_pressure(spring, mesh), f"pressures of {mesh.path.name}"
    if mesh is None:
        return springs.of_joint(spring, state.preload, state.moment, placing.first), str(state)
    there = springs.on_mesh(spring, mesh, state.preload, state.moment)
    return there, f"{state}, on the nodes of {mesh.path.name}"


def _contact(joint: Bolted) -> "tuple[Curve, Sequence[str]]":
    ratio = float(shear_ratio(joint))
    more = f"tangential stiffness of the law: {ratio:.9g} times the slope of the table"
    return BoltedJointSpring.of_nodes(joint).curve, [more]


def _pull(joint: Bolted, state: Tightening | None, error: float) -> "LoadTable":
    from .springs import pull_table

    if state is None:
        raise ValueError("the curve of a bolted_joint needs a preload")
    return pull_table(BoltedJointSpring.of_nodes(joint), state.preload, state.moment, error)


_VARIABLES = KIND.variables
EXPORTS = Exports(
    state=Tightening,
    springs=_springs,
    contact=_contact,
    curve=LoadCurve(
        meaning="force that holds the interface together over its separation from the tightened state, "
        "with the tension of the bolts; without members and damping",
        columns=(
            _VARIABLES["s_rel_z"],
            Variable("pull", "N", "force that holds it together"),
            _VARIABLES["K_zz"],
        ),
        name="force",
        table=_pull,
    ),
)
