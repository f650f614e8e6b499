"""A linear spring in a package of its own: the shortest joint that goes the whole way."""

from collections.abc import Mapping
from dataclasses import dataclass

from jointfmu.joints.kind import Kind
from jointfmu.joints.model import Model, Ramp, Variable
from jointfmu.quantity import Checked, Number, quantity


@dataclass(frozen=True, kw_only=True)
class LinearSpring(Checked):
    """A spring that obeys Hooke's law."""

    c: float = quantity("N/m", "stiffness", gt=0.0)

    def motion(self, v: Mapping[str, Number]) -> dict[str, Number]:
        """Force [N] and stiffness [N/m] at s_rel [m]."""
        return {"f": -self.c * v["s_rel"], "K": self.c + 0.0 * v["s_rel"]}


MODEL = Model(
    name="ToySpring",
    joint="toy",
    doc="Linear spring: motion in, force out",
    parameters=LinearSpring,
    spring=lambda parameters: parameters,
    inputs=(Variable("s_rel", "m", "elongation", 1e-3),),
    outputs=(
        Variable("f", "N", "force on side 2, restoring", 10.0),
        Variable("K", "N/m", "stiffness -df/ds_rel", 1e4),
    ),
    evaluate=LinearSpring.motion,
    outside=(),
    ramp=Ramp("s_rel", 1e-3, 1e-5),
    dependencies={"K": ()},
    linear={"f": {"s_rel": "parameters"}},
)
KIND = Kind(name="toy", package=__name__, default="spring", laws={"linear": LinearSpring}, models=(MODEL,))
