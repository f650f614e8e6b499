"""Linear spring in a package of its own: the shortest complete joint."""

from collections.abc import Mapping
from dataclasses import dataclass

from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.quantity import CheckedParameters, Number, quantity_field


@dataclass(frozen=True, kw_only=True)
class LinearSpring(CheckedParameters):
    c: float = quantity_field("N/m", "stiffness", gt=0.0)

    def motion(self, v: Mapping[str, Number]) -> dict[str, Number]:
        """Force [N] and stiffness [N/m] at the displacement s_rel [m]."""
        return {"f": -self.c * v["s_rel"], "K": self.c + 0.0 * v["s_rel"]}


MODEL = Model(
    name="ToySpring",
    joint="toy",
    doc="Linear spring: motion in, force out",
    parameter_class=LinearSpring,
    tabulate=lambda parameters: parameters,
    inputs=(Variable("s_rel", "m", "elongation", 1e-3),),
    outputs=(Variable("f", "N", "force on side 2", 10.0), Variable("K", "N/m", "stiffness", 1e4)),
    evaluate=LinearSpring.motion,
    validity_limits=(),
    ramp=LoadRamp("s_rel", 1e-3, 1e-5),
    dependencies={"K": ()},
    linear_factors={"f": {"s_rel": "parameters"}},
)
KIND = JointKind(
    name="toy", package=__name__, default_file_stem="spring", laws={"linear": LinearSpring}, models=(MODEL,)
)
