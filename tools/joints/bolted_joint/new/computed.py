"""The plates of a drawing by finite elements: the pressure between them, and the stiffness of the whole."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.joints.bolted_joint.bodies import ElasticBodies
from jointfmu.joints.bolted_joint.compliances import Compliances
from jointfmu.joints.bolted_joint.law import pressures, shear_ratio
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.mechanics.curve import approach_curve
from jointfmu.mechanics.footprint.bolts import pressure_shape
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile
from jointfmu.progress import step
from jointfmu.quantity import Array, flatten

from ....drawing.vdi2230 import ClampedPart
from ....fem import installed
from . import ATTACHED

if TYPE_CHECKING:
    from ....fem.geometry import Assembly
    from ....fem.whole_joint import WholeJoint


@dataclass(frozen=True, slots=True)
class Plates:
    """Two plates with their bolts: layers and density [kg/m3] of side 1 and 2, bearing [m] the diameter under
    head and nut, preload [N] of each bolt and tension [N] that embedding leaves of it, depth [m] of its
    thread in side 2 (0: it goes through)."""

    plate: BoltedPlate
    layers: tuple[ClampedPart, ...]
    bearing: float
    density: tuple[float, ...]
    preload: float
    tension: float
    depth: float = 0.0

    def assembly(self, file: ParameterFile) -> "Assembly":
        """The bodies. Raises ValueError for heads that overlap or leave the plate."""
        from ....fem.geometry import Assembly, BoltList, Plate, TappedPlate

        sides = [
            Plate(
                length=self.plate.length,
                width=self.plate.width,
                thickness=layer.thickness,
                E=layer.E,
                nu=file.flat[f"side{i + 1}.nu"],
                density=self.density[i],
            )
            for i, layer in enumerate(self.layers)
        ]
        if self.depth:
            sides[1] = TappedPlate(**flatten(sides[1]), depth=self.depth)
        at = self.plate
        bolts = BoltList(x=at.x, y=at.y, hole_diameter=at.hole_diameter, head_diameter=self.bearing)
        return Assembly(file.name, sides[0], sides[1], bolts)


def with_computed_field(file: ParameterFile, plates: Plates) -> ParameterFile:
    """The joint with the pressure of two elastic plates in contact instead of the cones of its bolts.

    Raises ValueError for heads that overlap or leave the plate, and if a package is missing.
    """

    with installed("--field computed"):
        from ....fem.bolted_contact import BoltedContact, with_solution

        step("contact of the plates by finite elements")
        solution = BoltedContact.of(plates.assembly(file)).solve(approach_curve(file.values), plates.tension)
    return with_solution(file, solution, plates.tension)


@dataclass(frozen=True, slots=True)
class ComputedJoint:
    """The joint between its attachments: its compliances, and its parameters with elastic sides."""

    compliances: Compliances
    file: ParameterFile


def whole_joint(file: ParameterFile, plates: Plates, attached: str) -> ComputedJoint:
    """The whole joint of a drawing at its preload, see `whole_of`."""
    return whole_of(file, lambda: plates.assembly(file), plates.preload, attached)


def whole_of(
    file: ParameterFile, assembly: "Callable[[], Assembly]", preload: float, attached: str
) -> ComputedJoint:
    """The whole joint under the force [N] of each bolt at tightening: the bodies move at their attachments.

    Raises ValueError for heads that overlap or leave the plate, and if a package is missing.
    """

    with installed("the whole joint"):
        from ....fem.elastic_sides import elastic_bodies
        from ....fem.whole_joint import WholeJoint

        step("members by finite elements")
        clamped = assembly()
        _check_thickness(clamped)
        joint = WholeJoint.of(clamped, attached)
        springs = _springs(file, preload, joint)
        linear = joint.linear(springs, file.values.bolt_stiffness)
        bodies = replace(
            elastic_bodies(linear, BoltedJointSpring.of(file.values), springs[:, 2], preload),
            thickness=(clamped.side1.clamped, clamped.side2.clamped),
            head_diameter=clamped.bolts.head_diameter,
            thread_depth=getattr(clamped.side2, "depth", 0.0),
        )
        compliances = linear.compliances()
    return ComputedJoint(compliances, with_bodies(file, bodies, attached))


def _check_thickness(assembly: "Assembly") -> None:
    """Raise ValueError for a body thinner than the ring that a head presses on is wide."""
    least = 0.5 * (assembly.bolts.head_diameter - assembly.bolts.hole_diameter)
    for name, body in (("side1", assembly.side1), ("side2", assembly.side2)):
        if not body.clamped >= least:
            raise ValueError(
                f"{name} is {1e3 * body.clamped:.4g} mm thick, expected at least {1e3 * least:.4g} mm: the "
                "width of the ring under a head, which would punch through"
            )


def with_bodies(file: ParameterFile, bodies: ElasticBodies, attached: str) -> ParameterFile:
    """The joint between elastic sides."""
    values = replace(file.values, sides="elastic", bodies=replace(bodies, attached=attached))
    source = f"finite elements of the bodies between {ATTACHED[attached]}, reduced to modes"
    names = [f"bodies.{name}" for name, value in flatten(bodies).items() if value != ()]
    stated = "the whole joint between what it connects; rigid: the interface alone"
    return replace(
        file,
        values=values,
        origins={**file.origins, **dict.fromkeys(names, "derived"), "sides": "user"},
        sources={**file.sources, **dict.fromkeys(names, source), "sides": stated},
    )


def _springs(file: ParameterFile, preload: float, joint: "WholeJoint") -> Array:
    """Stiffness (points, 3) [N/m3] of the tightened interface along x, y, z at the points of the elements.

    That of the nearest point of the joint's own contact, together as stiff as that.
    """
    from scipy.spatial import cKDTree

    values, shape, at = file.values, pressure_shape(file.values.pattern), joint.interface
    curve = approach_curve(values)
    normal = curve.derivatives(curve.inverse(pressures(values, shape, preload, 0.0)), 1)[1]
    centred = at.position - at.area @ at.position / at.area.sum()
    here = normal[cKDTree(shape.position).query(centred)[1]]
    here = here * (values.A_0 * (shape.share @ normal) / (at.area @ here))
    ratio = float(shear_ratio(values))
    return np.stack([ratio * here, ratio * here, here], axis=1)
