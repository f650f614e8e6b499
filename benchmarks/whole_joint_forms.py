"""The whole bolted joint with elastic sides beside hand values: VDI 2230 at the heads, and shear lag.

Run: python benchmarks/whole_joint_forms.py
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from elastic_sides import AXES, Joint, along
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate
from jointfmu_tools.fem.reduction.elastic_bodies import reduce_bodies
from jointfmu_tools.fem.whole_joint import JointFiniteElements, LinearJoint
from jointfmu_tools.joints.bolted_joint.new import NEW
from lap_beam_reduction import patches
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import RoughBoltedJoint
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.distribution import NodalField

Array = NDArray[np.float64]

FACES: dict[str, object] = {"Ra": ["0.8"], "embedding": "0"}
EXAMPLES: dict[str, dict[str, object]] = {
    "M12, grip 40, steel": {"plate": "40x40", "bolts": "M12", "grip": ["40"], "material": ["steel"]},
    "M8, grip 20, aluminium": {
        "plate": "25x25",
        "bolts": "M8",
        "grip": ["20"],
        "material": ["aluminium"],
        "head": "socket",
    },
    "M16, grip 2 x 30, steel": {
        "plate": "50x50",
        "bolts": "M16",
        "grip": ["60"],
        "material": ["steel"],
        "head": "socket",
    },
    "M16, grip 40, steel": {
        "plate": "80x80",
        "bolts": "M16",
        "grip": ["40"],
        "material": ["steel"],
        "preload": "60e3",
    },
}
"""D_A is the side of a plate. The third is the tapped M16 with its mirror image: side 1 has half of it."""
PULLED, LOAD = 81, 30e3
"""Pulls at the heads [1], and the load [N] of the last example."""
REACH = (0.5, 2.0, 6.0)
"""Length of a lap over that of shear lag [1]."""
PRESS = 40e3
"""What presses the lap [N]."""
LINEAR = 1e-3
"""Approach at which a linear interface is as stiff as it stays, over that at tightening [1]."""
RISES = 1e-6
"""Of a stiffness that is called linear [1]."""


@dataclass(frozen=True)
class Pulled:
    """A joint pulled at its heads.

    bolt, members, interface : [N/m] stiffness of each; that of the members without the interface
    factor        : load factor of small loads [1]; `added` [N] what the bolt gets of LOAD, or of half the
                    preload if that is less
    opens         : load over the preload at which nothing presses any more [1]
    """

    bolt: float
    members: float
    interface: float
    factor: float
    load: float
    added: float
    opens: float

    @classmethod
    def of(cls, joint: Joint) -> "Pulled":
        """By the reduced joint, step by step until it is open."""
        spring, preload, bolt = joint.spring, joint.preload, joint.file.values.bolt_stiffness
        alone = BoltedJointSpring.of(joint.rigid.values)
        stiff = [
            float(each.evaluate(preload, 0.0, (0.0,) * 3, (0.0,) * 3)["K_zz"]) for each in (spring, alone)
        ]
        pulls = np.linspace(0.0, 1.5, PULLED) * preload / (stiff[0] - bolt)
        motions = [pull * np.eye(6)[2] for pull in pulls]
        rows = along(spring, motions, preload, ("f_z", "F_bolt[1]", "p_mean"))
        f, tension, pressure = np.array(rows).T
        load = min(LOAD, 0.5 * preload)
        interface = stiff[1] - bolt
        return cls(
            bolt,
            1.0 / (1.0 / (stiff[0] - bolt) - 1.0 / interface),
            interface,
            float((tension[1] - preload) / -f[1]),
            load,
            float(np.interp(load, -f, tension) - preload),
            float(-f[pressure < 1e-3 * pressure[0]][0] / preload),
        )


def by_hand(bolt: float, members: float, interface: float, load: float) -> tuple[float, float, float]:
    """Load factor [1], what the bolt gets of a load [N] at its heads, and the load over the preload [1] that
    opens the joint: VDI 2230, the interface in series with the members."""
    factor = bolt / (bolt + 1.0 / (1.0 / members + 1.0 / interface))
    return factor, factor * load, 1.0 / (1.0 - factor)


def vdi() -> None:
    """Print the examples."""
    print("| joint | bolt | members | VDI | ratio | load factor | VDI | added [kN] | VDI | opens at | VDI |")
    print("|---|" + "---|" * 10)
    for name, example in EXAMPLES.items():
        joint = Joint.of("heads", FACES | example)
        found, hand = Pulled.of(joint), joint.members
        factor, added, opens = by_hand(found.bolt, hand, found.interface, found.load)
        cells = [f"{found.bolt:.4g}", f"{found.members:.4g}", f"{hand:.4g}", f"{found.members / hand:.3f}"]
        cells += [f"{found.factor:.3f}", f"{factor:.3f}", f"{found.added / 1e3:.2f}", f"{added / 1e3:.2f}"]
        print(f"| {name} | " + " | ".join([*cells, f"{found.opens:.3f}", f"{opens:.3f}"]) + " |")


def linear_curve(stiffness: float, approach: float) -> Curve:
    """Pressure of springs of a stiffness [Pa/m] that touch within LINEAR of an approach [m].

    It grows by RISES of itself from there to twice the approach, so that a stiffness tells an approach.
    """
    places, bend = np.array([0.0, LINEAR, 20.0]) * approach, RISES * stiffness / approach
    slopes = stiffness + bend * (places - approach)
    slopes[0] = 0.0
    loads = np.concatenate([[0.0], np.cumsum(0.5 * (slopes[1:] + slopes[:-1]) * np.diff(places))])
    bends = np.array([slopes[1] / places[1], bend])
    return Curve(places, loads, slopes, bends, bends)


@dataclass(frozen=True)
class Lap:
    """Two thin plates, each held at one end and kept plane, on a linear interface."""

    assembly: Assembly
    bodies: JointFiniteElements
    values: RoughBoltedJoint

    @classmethod
    def of(cls, refinement: float = 1.0) -> "Lap":
        """With the ratio of stiffnesses and the friction of an interface of steel."""
        given = dict.fromkeys(option.name for option in NEW.options) | FACES
        given |= EXAMPLES["M12, grip 40, steel"] | {"tapped": True}  # so the command makes no bodies
        values = NEW.make_joint(given).file.values
        plate = Plate(length=0.1, width=0.04, thickness=2e-3, E=206e9, nu=0.0, density=7850.0)
        bolts = BoltList(x=(0.0,), y=(0.0,), hole_diameter=2e-3, head_diameter=4e-3)
        assembly = Assembly("lap", plate, plate, bolts)
        joint = JointFiniteElements.from_assembly(assembly, "edge", refinement)
        held = []
        for body, ends in zip(joint.bodies, joint.attachment_unknowns, strict=True):
            z = np.abs(body.nodes[2])
            held.append(np.union1d(ends, 3 * np.flatnonzero(z > z.max() - 1e-9) + 2))
        joint = replace(joint, attachment_unknowns=(held[0], held[1]))
        at = patches(joint.interface)
        one = np.ones(at.quadrature_area.size)
        x, y = (
            at.quadrature_position - at.quadrature_area @ at.quadrature_position / at.quadrature_area.sum()
        ).T
        lists = {
            "share": at.quadrature_area / at.quadrature_area.sum(),
            "x": x,
            "y": y,
            "equal": one,
            "tilt": y / y.max(),
        }
        field = NodalField(**{name: tuple(each.tolist()) for name, each in lists.items()})
        area = float(at.quadrature_area.sum())
        values = replace(values, pattern=field, A_0=area, n_bolts=1.0, row_bolts=1.0, bolt_stiffness=0.0)
        return cls(assembly, joint, values)

    def linear(self, reach: float) -> tuple[float, BoltedJointSpring, LinearJoint]:
        """[Pa/m] of the interface along it, the interface alone and the lap by finite elements."""
        plate, beta = self.assembly.side1, reach / self.assembly.side1.length
        shear = 0.5 * beta**2 * plate.E * plate.thickness
        spring = BoltedJointSpring.of(self.values)
        normal = shear / spring.friction.foundation().stiffness_ratio
        spring = replace(spring, curve=linear_curve(normal, PRESS / self.values.A_0 / normal))
        springs = np.tile([shear, shear, normal], (self.bodies.interface.quadrature_area.size, 1))
        return shear, spring, self.bodies.linearize(springs, 0.0)

    def reduced(self, spring: BoltedJointSpring, linear: LinearJoint, normal: float) -> BoltedJointSpring:
        """The joint on the modes of its bodies."""
        stiffness = np.full(self.bodies.interface.quadrature_area.size, normal)
        bodies = reduce_bodies(linear, spring, stiffness, PRESS)
        whole = BoltedJointSpring.of(replace(self.values, sides="elastic", bodies=bodies))
        return replace(whole, curve=spring.curve)

    def compliances(self, reach: float) -> tuple[float, float, float]:
        """[m/N] along x by the modes of the reduced joint, by finite elements and by shear lag."""
        shear, spring, linear = self.linear(reach)
        plate, beta = self.assembly.side1, reach / self.assembly.side1.length
        whole = self.reduced(spring, linear, shear / spring.friction.foundation().stiffness_ratio)
        out = whole.evaluate(PRESS, 0.0, (0.0,) * 3, (0.0,) * 3)
        per = plate.E * plate.thickness * plate.width
        form = (1.0 / (beta * np.tanh(0.5 * reach)) + 0.5 * plate.length) / per
        return 1.0 / float(out[AXES[0]]), float(linear.compliances().total[0]), form


def lap() -> None:
    """Print shear lag."""
    print("\n| length over that of shear lag | modes over closed form | finite elements over closed form |")
    print("|---|---|---|")
    one = Lap.of()
    for reach in REACH:
        modes, elements, form = one.compliances(reach)
        print(f"| {reach:g} | {modes / form:.4f} | {elements / form:.4f} |")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print both tables."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    vdi()
    lap()
    return 0


if __name__ == "__main__":
    sys.exit(main())
