"""The plates of a drawing by finite elements: the pressure between them, and the stiffness of the whole."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.joints.bolted_joint.bodies import ElasticBodies
from jointfmu.joints.bolted_joint.compliances import PARTS, Compliances
from jointfmu.joints.bolted_joint.law import pressures, working_preload
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.mechanics.curve import approach_curve
from jointfmu.mechanics.footprint.bolts import pressure_shape
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.mechanics.footprint.shape import PressureShape
from jointfmu.parameters import ParameterFile
from jointfmu.progress import step
from jointfmu.quantity import Array, flatten

from ....drawing.part import NewJoint
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


def with_computed_field(file: ParameterFile, plates: Plates) -> tuple[ParameterFile, PressureShape]:
    """The joint with the pressure of two elastic plates in contact instead of the cones of its bolts; at all
    nodes.

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


def whole_joint(
    file: ParameterFile, plates: Plates, attached: str, shape: PressureShape | None = None
) -> ComputedJoint:
    """The whole joint of a drawing at its preload, see `whole_of`."""
    return whole_of(file, lambda: plates.assembly(file), plates.preload, attached, shape)


def whole_of(
    file: ParameterFile,
    assembly: "Callable[[], Assembly]",
    preload: float,
    attached: str,
    shape: PressureShape | None = None,
) -> ComputedJoint:
    """The whole joint under the force [N] of each bolt at tightening: the bodies move at their attachments.

    shape : the pressure at all nodes of a field, of which the file has few; None: what the file has

    Raises ValueError for heads that overlap or leave the plate, and if a package is missing.
    """

    with installed("the whole joint"):
        from ....fem.geometry import check_thickness
        from ....fem.reduction.elastic_bodies import elastic_bodies
        from ....fem.whole_joint import WholeJoint

        step("members by finite elements")
        clamped = assembly()
        check_thickness(clamped)
        joint = WholeJoint.of(clamped, attached)
        springs = _springs(file, preload, joint, shape)
        linear = joint.linear(springs, file.values.bolt_stiffness)
        bodies = replace(
            elastic_bodies(linear, BoltedJointSpring.of(file.values), springs[:, 2], preload),
            thickness=(clamped.side1.clamped, clamped.side2.clamped),
            outline=_outline(clamped, joint.interface.centroid),
            hole_diameter=clamped.bolts.hole_diameter,
            head_diameter=clamped.bolts.head_diameter,
            thread_depth=getattr(clamped.side2, "depth", 0.0),
        )
        compliances = linear.compliances()
    return ComputedJoint(compliances, with_bodies(file, bodies, attached))


def _outline(clamped: "Assembly", centroid: Array) -> tuple[float, ...]:
    """Lowest x and y, highest x and y [m] of a contact, from its centroid [m]."""
    half = np.min([side.layers()[0].outer for side in (clamped.side1, clamped.side2)], axis=0)
    return tuple(np.concatenate([-half - centroid, half - centroid]).tolist())


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


def _springs(file: ParameterFile, preload: float, joint: "WholeJoint", shape: PressureShape | None) -> Array:
    """Stiffness (points, 3) [N/m3] of the tightened interface along x, y, z at the points of the elements.

    That of the nearest node of the joint's own contact, together as stiff as that; shape as in `whole_of`.
    """
    from scipy.spatial import cKDTree

    values, at = file.values, joint.interface
    shape = shape or pressure_shape(values.pattern)
    curve = approach_curve(values)
    normal = curve.derivatives(curve.inverse(pressures(values, shape, preload, 0.0)), 1)[1]
    here = normal[cKDTree(shape.position).query(at.centred)[1]]
    here = here * (values.A_0 * (shape.share @ normal) / (at.area @ here))
    ratio = float(values.shear_ratio())
    return np.stack([ratio * here, ratio * here, here], axis=1)


Facts = dict[str, tuple[float, str, str]]


def facts(
    file: ParameterFile,
    plates: Plates,
    attached: str,
    sides: str | None,
    alone: str,
    shape: PressureShape | None = None,
) -> NewJoint:
    """The whole joint beside the interface, and the parameters with elastic sides; or a line that says why it
    cannot be computed.

    sides : rigid or elastic as stated; None: elastic if the packages are there
    alone : that the FMU is the interface alone
    shape : as in `whole_of`

    Raises ValueError if it was asked for and cannot be computed.
    """
    try:
        found = whole_joint(file, plates, attached, shape)
    except ValueError as error:
        if sides == "elastic":
            raise
        return NewJoint(file, {}, [f"members and bolts are not computed, {alone}: {error}"])
    if sides == "rigid":
        return NewJoint(file, _rows(found.compliances, plates.tension, attached), [])
    return NewJoint(found.file, whole_facts(found.file, plates.preload), [])


def whole_facts(file: ParameterFile, preload: float) -> Facts:
    """Of a joint with elastic sides, as report and FMU have it; preload [N] tightens each bolt."""
    found = BoltedJointSpring.of(file.values).compliances(preload)
    tension = float(working_preload(file.values, preload))
    told = f" at preload = {preload:.5g} N"
    return _rows(found, tension, file.values.bodies.attached, told)


def _rows(found: Compliances, tension: float, attached: str, told: str = "") -> Facts:
    """The whole joint with a tension [N] of each bolt, and where its FMU has this; empty: the interface is
    all that the FMU has."""
    return _stiffnesses(found, attached, told) | _load(found, tension, attached) | _share(found, not told)


def _stiffnesses(found: Compliances, attached: str, told: str) -> Facts:
    """Of the whole joint, then of its members, in all directions."""
    rows, members = {}, {}
    for name, unit, (whole, interface, alone, _), parts in found.rows():
        shares = ", ".join(f"{share:.0%} {part}" for share, part in zip(parts, PARTS, strict=True))
        rows[f"whole_{name}"] = (
            whole,
            unit,
            f"of the whole joint between {ATTACHED[attached]}, other motions held"
            + (f" (the FMU's {name}{told})" if told else "")
            + f"; of its energy {shares}; the interface alone is {interface / whole:.3g} times as stiff",
        )
        members[f"members_{name}"] = (alone, unit, "of its members, as a spring in series with the rest")
    return rows | members


def _share(found: Compliances, alone: bool) -> Facts:
    """Whether the interface matters for the whole."""
    share = found.shares[0]
    rest = max(part for i, part in enumerate(share) if i != 2)
    text = f"part of the interface in the whole's compliance along z, at most {rest:.3g} in others; " + (
        "the FMU is the interface alone (--sides rigid)"
        if alone
        else "the FMU is the whole (sides = elastic)"
    )
    return {"interface_share": (float(share[2]), "1", text)}


def _load(found: Compliances, tension: float, attached: str) -> Facts:
    """What an outer force along the axis does, without an eccentric one's bending."""
    where = f"a force along z at {ATTACHED[attached]}"
    opens = found.opening_load(tension)
    free = f"{where}, other motions free"
    return {
        "whole_load_factor": (found.load_factor, "1", f"n Phi_K: part that the bolts take of {free}"),
        "whole_bolt_share": (
            float(found.bolt_force[:, 2].max()),
            "1",
            f"part that one bolt takes at most of {free}",
        ),
        "opening_load": (
            opens,
            "N",
            f"{where} that takes the pressure off around the bolt that gets most, linear; a joint that peels "
            "opens before, as the report draws",
        ),
    }
