"""Figures of docs/validity_bolted_joint.md: complete bolted joint against standards, finite elements and
beams.

    python studies/validity_bolted_joint.py [SECTION ...]

vdi                : load factor, bolt force and opening of joints loaded at the heads, and by VDI 2230
shear-lag          : compliance of a lap joint over its closed form
friction           : force and loss compared with finite elements with Coulomb friction at every element;
                     --joint NAME, --variants, --refinement
points             : force and loss with nine points in each element of the contact over those with one
calculix           : loop of a lap joint in CalculiX with *FRICTION (on request; needs `ccx`)
brake-reuss        : first frequency and damping of the Brake-Reuss beam, and published curves; --images
brake-reuss-form   : the same with the scanned form of the lap
brake-reuss-meshes : first frequency on other meshes (on request)
measured-beam      : a measured beam with a lap joint, unknown torque, friction and faces
"""

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import lapped_beams
import numpy as np
from common import print_table_head, print_table_row, run_study
from jointfmu_tools.fem.reduction import elastic_bodies as reduction
from jointfmu_tools.joints.bolted_joint.new.plate_finite_elements import set_elastic_bodies
from numpy.typing import NDArray
from oracles.calculix import body_lines, solve_deck
from oracles.joint_elements import (
    FACES,
    JOINTS,
    LAP_LOAD,
    STEPS,
    FrictionElements,
    Lap,
    PlateJoint,
    cycle_loads,
    follow_loads,
    follow_motions,
    joint_on_cells,
    vdi_2230,
)
from oracles.lap_beam.reduction import patches

from jointfmu.joints.bolted_joint import friction, law
from jointfmu.joints.bolted_joint import joint as joint_module
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring

Array = NDArray[np.float64]

# vdi, shear-lag

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
"""Joints of the comparison with VDI 2230; D_A is the side of the plate.

The third joint is a tapped M16 with its mirror image."""
PULL_COUNT, LOAD = 81, 30e3
"""Number of tensile loads at the heads, and the last load of the last example [N]."""
LENGTH_RATIOS = (0.5, 2.0, 6.0)
"""Lengths of the lap over the length of shear lag [1]."""


@dataclass(frozen=True)
class TensileJoint:
    """Reduced joint under a tensile load at its bolt heads.

    bolt, members, interface : [N/m] stiffness of each; the members without the interface
    factor : load factor of small loads [1]
    load   : [N], LOAD or half of the preload, whichever is less
    added  : [N] additional bolt force under this load
    opens  : load over the preload at which the contact pressure vanishes [1]
    """

    bolt: float
    members: float
    interface: float
    factor: float
    load: float
    added: float
    opens: float

    @classmethod
    def of(cls, joint: PlateJoint) -> "TensileJoint":
        """Load the joint step by step until it is open."""
        spring, preload, bolt = joint.spring, joint.preload, joint.file.values.bolt_stiffness
        interface_alone = BoltedJointSpring.from_joint(joint.rigid.values)
        stiff = [
            float(each.evaluate(preload, 0.0, (0.0,) * 3, (0.0,) * 3)["K_zz"])
            for each in (spring, interface_alone)
        ]
        pulls = np.linspace(0.0, 1.5, PULL_COUNT) * preload / (stiff[0] - bolt)
        motions = [pull * np.eye(6)[2] for pull in pulls]
        rows = follow_motions(spring, motions, preload, ("f_z", "F_bolt[1]", "p_mean"))
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


def print_vdi() -> None:
    """Print stiffnesses, load factor, additional bolt force and opening load, compared with VDI 2230."""
    columns = "bolt", "members", "VDI", "ratio", "load factor", "VDI", "added [kN]", "VDI", "opens at", "VDI"
    print_table_head("", "joint", *columns)
    for name, example in EXAMPLES.items():
        joint = PlateJoint.of("heads", FACES | example)
        found, hand = TensileJoint.of(joint), joint.members
        factor, added, opens = vdi_2230(found.bolt, hand, found.interface, found.load)
        cells = [f"{found.bolt:.4g}", f"{found.members:.4g}", f"{hand:.4g}", f"{found.members / hand:.3f}"]
        cells += [f"{found.factor:.3f}", f"{factor:.3f}", f"{found.added / 1e3:.2f}", f"{added / 1e3:.2f}"]
        print_table_row(name, *cells, f"{found.opens:.3f}", f"{opens:.3f}")


def print_shear_lag() -> None:
    """Print the compliance of the lap over the closed form of shear lag."""
    columns = "length over that of shear lag", "modes over closed form", "finite elements over closed form"
    print_table_head("", *columns)
    lap = Lap.of()
    for reach in LENGTH_RATIOS:
        modes, elements, form = lap.compliances(reach)
        print_table_row(f"{reach:g}", f"{modes / form:.4f}", f"{elements / form:.4f}")


# friction

LEVELS = (0.2, 0.4, 0.6, 0.8, 1.0, 1.3)
"""Motions over that at which the linear joint reaches the friction limit [1]."""
CYCLES = (0.5, 1.0)
"""Motions with a full cycle [1]."""
VARIANTS = {
    "as it is": (16, 22),
    "60 modes": (60, 22),
    "40 patches": (16, 40),
    "60 patches": (16, 60),
    "60 modes, 60 patches": (60, 60),
}
"""Numbers of modes and patches of the reduced joint."""
CELL_COUNTS = (120, 300)
"""Numbers of cells of a joint without modes and patches."""


@contextmanager
def reduction_size(modes: int, count: int) -> Iterator[None]:
    """Set the number of modes and patches of reduced joints."""
    modules = law, friction, reduction, joint_module
    kept = [(module, "MAX_MODES", module.MAX_MODES) for module in modules]
    kept.append((joint_module, "MAX_PATCHES", joint_module.MAX_PATCHES))
    try:
        for module, name, _ in kept:
            setattr(module, name, count if name == "MAX_PATCHES" else modes)
        joint_module.find_friction_patches.cache_clear()
        yield
    finally:
        for module, name, value in kept:
            setattr(module, name, value)
        joint_module.find_friction_patches.cache_clear()


def friction_deviations(
    full: Mapping[str, tuple[Array, Array]], found: Mapping[str, tuple[Array, Array]]
) -> list[str]:
    """Format deviations of the reduced joint from finite elements with friction (`full`).

    The force deviations are relative to the largest force on first loading. The heat of a cycle is relative
    to the heat by finite elements.
    """
    most = np.max(np.abs(full["first"][0]))
    first = np.max(np.abs(found["first"][0] - full["first"][0])) / most
    cells = [f"{first:.1%}"]
    for name in full:
        if name != "first":
            force = found[name][0] - full[name][0]
            heat, expected = (each[name][1][-1] - each[name][1][STEPS - 1] for each in (found, full))
            cells += [f"{np.max(np.abs(force)) / most:.1%}", f"{heat / expected:.3f}"]
    return cells


def load_sequences() -> dict[str, Array]:
    """Load sequences: first loading, and cycles."""
    return {"first": np.array(LEVELS)} | {f"{level:g}": cycle_loads(level) for level in CYCLES}


def compare_friction(name: str, variants: bool, refinement: float) -> None:
    """Print the rows of one joint in the table of friction; `refinement`: of the finite element mesh."""
    attached, drawing, wrench = JOINTS[name]
    joint = PlateJoint.of(attached, drawing, refinement, elements=True)
    elements = FrictionElements.clamped(joint, wrench)
    sequences = load_sequences()
    full = {key: elements.follow(list(loads)) for key, loads in sequences.items()}
    slips = np.max(np.abs(full["first"][0])) / elements.stiffness
    firsts: dict[str, Array] = {}
    for label, (modes, count) in [*VARIANTS.items()][: None if variants else 1]:
        with reduction_size(modes, count):
            if label == "as it is":
                spring = joint.spring
            else:
                rigid = BoltedJointSpring.from_joint(joint.rigid.values)
                made = reduction.reduce_bodies(joint.linear, rigid, joint.normal, joint.preload)
                spring = BoltedJointSpring.from_joint(set_elastic_bodies(joint.rigid, made, attached).values)
            found = {
                key: follow_loads(spring, joint.preload, elements.motion, list(loads))
                for key, loads in sequences.items()
            }
        element_count = elements.loops.beam.area.size
        print_table_row(name, label, element_count, f"{slips:.2f}", *friction_deviations(full, found))
        firsts[label] = found["first"][0]
    for count in CELL_COUNTS if variants else ():
        states = joint_on_cells(joint, count)
        unit = states.rigid_displacement @ elements.motion
        firsts[f"{count} cells"] = np.array([unit @ states.solve_forces(x * elements.motion) for x in LEVELS])
    for label, force in firsts.items() if variants else ():
        ratios = ", ".join(f"{x:.3f}" for x in force / full["first"][0])
        print(f"{name}, {label}: force on the first way over that of the elements {ratios}", flush=True)


def print_friction(options: argparse.Namespace) -> None:
    """Print force and loss of the reduced joint compared with finite elements with friction."""
    cells = [f"{what} at {level:g}" for level in CYCLES for what in ("force", "loss")]
    print_table_head("", "joint", "reduction", "patches", "most force", "first way", *cells)
    for name in options.joint or JOINTS:
        compare_friction(name, options.variants, options.refinement or 1.0)


def print_points(options: argparse.Namespace) -> None:
    """Print force and loss of reduced joints with nine points in each element, compared with one point."""
    cells = [f"{what} at {level:g}" for level in CYCLES for what in ("force", "loss")]
    print_table_head("", "joint", "first way", *cells)
    for name in options.joint or JOINTS:
        attached, drawing, wrench = JOINTS[name]
        one, nine = (PlateJoint.of(attached, drawing, elements=each) for each in (True, False))
        motion = np.linalg.solve(one.linear.stiffness_matrix, wrench) * one.load()[0]
        found, expected = (
            {
                key: follow_loads(joint.spring, joint.preload, motion, list(loads))
                for key, loads in load_sequences().items()
            }
            for joint in (nine, one)
        )
        print_table_row(name, *friction_deviations(expected, found))


# calculix

LAP_LENGTH = 4.0
"""Length of the lap over length of shear lag [1]."""
MAX_MOTION, LAP_STEPS = 1.0, 6
"""Largest motion over that at which the linear lap reaches the friction limit [1]; steps from one end to the
other."""
STATIC_STEP = "*STEP, INC=50\n*STATIC\n1., 1."


def deck(lap: Lap, spring: BoltedJointSpring, motion: float, levels: Sequence[float]) -> Iterator[str]:
    """CalculiX deck: side 2 moves by `levels` of a motion [m] from the pressed state; units N and mm."""
    joint, mu, curve = lap.bodies, lap.values.mu, spring.curve
    pressure = LAP_LOAD / lap.values.A_0
    normal = float(curve.derivatives(curve.inverse(pressure), 1)[1])
    first = joint.bodies[0]
    starts = (0, first.finite_element_basis.N)
    for k, body in enumerate(joint.bodies):
        yield from body_lines(body, k + 1, starts[k], k * first.mesh.nelements, k * pressure / normal)
    yield "*SURFACE INTERACTION, NAME=LAW\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield (
        f"{normal * 1e-9:.12g}\n*FRICTION\n{mu:.12g}, "
        f"{normal * spring.friction_law.foundation().stiffness_ratio * 1e-9:.12g}"
    )
    yield "*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE\nFACE2, FACE1\n*NSET, NSET=MOVED"
    yield from (f"{starts[1] + i // 3 + 1}," for i in joint.attachment_unknowns[1] if i % 3 == 0)
    yield "*BOUNDARY"
    for side, held in enumerate(joint.attachment_unknowns):
        still = held[held % 3 > 0] if side else held
        yield from (f"{starts[side] + i // 3 + 1}, {i % 3 + 1}, {i % 3 + 1}" for i in still)
    yield f"{STATIC_STEP}\n*CLOAD"
    for start, body, sign in zip(starts, joint.bodies, (1.0, -1.0), strict=True):
        face = body.mesh.facets_satisfying(lambda x: np.abs(x[2]) < 1e-9, boundaries_only=True)
        load = sign * LAP_LOAD * body.distribute_unit_force(face)[2::3]
        yield from (f"{start + i + 1}, 3, {load[i]:.12g}" for i in np.flatnonzero(load))
    for number, level in enumerate((0.0, *levels)):
        yield f"{STATIC_STEP}\n*BOUNDARY" if number else "*BOUNDARY"
        yield f"MOVED, 1, 1, {level * motion * 1e3:.12g}\n*NODE PRINT, NSET=MOVED, TOTALS=ONLY\nRF\n*END STEP"


def read_forces(printed: str) -> Array:
    """Total forces along x [N] of all steps."""
    rows = [line.split() for line in printed.splitlines()]
    return np.array([float(printed_row[0]) for printed_row in rows if len(printed_row) == 3])


def loop_area(force: Array, shift: Array) -> float:
    """Area [J] of the closed loop at the end of a path up, down and up again."""
    f, x = force[-2 * LAP_STEPS - 1 :], shift[-2 * LAP_STEPS - 1 :]
    return float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))


def compare_with_calculix(refinement: float, top: float) -> tuple[Array, dict[str, Array]]:
    """Motions [m] and forces [N]: by CalculiX, with friction at every element, and of the reduced joint."""
    lap = Lap.of(refinement)
    shear, spring, linear = lap.linear(LAP_LENGTH)
    normal, friction = shear / spring.friction_law.foundation().stiffness_ratio, lap.values.mu * LAP_LOAD
    bodies = replace(lap.bodies, contact_interface=patches(lap.bodies.contact_interface))
    at = bodies.contact_interface.quadrature_area
    elements = FrictionElements.of(
        bodies, np.full(at.size, LAP_LOAD / at.sum()), spring, friction, np.eye(6)[0]
    )
    motion = np.eye(6)[0] * elements.motion[0]
    down = np.linspace(1.0, -1.0, LAP_STEPS + 1)[1:]
    levels = top * np.concatenate([np.linspace(0.0, 1.0, LAP_STEPS // 2 + 1)[1:], down, -down])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lap.inp"
        path.write_text("\n".join(deck(lap, spring, motion[0], levels.tolist())) + "\n")
        found = {"CalculiX": read_forces(solve_deck(path, 3600.0))[1:]}
    found["friction at every element"] = elements.follow(levels.tolist())[0] / motion[0]
    reduced = lap.reduced(spring, linear, normal)
    found["reduced joint"] = follow_loads(reduced, LAP_LOAD, motion, levels.tolist())[0] / motion[0]
    return levels * motion[0], found


def print_calculix(options: argparse.Namespace) -> None:
    """Print force and loss of the loop compared with CalculiX."""
    motion, found = compare_with_calculix(options.refinement or 0.5, MAX_MOTION)
    reference = found["CalculiX"]
    largest = np.max(np.abs(reference))
    loss = loop_area(reference, motion)
    print(f"largest motion {motion.max() * 1e6:.1f} um, force {largest:.0f} N, loss {loss:.4g} J")
    print_table_head("", "beside CalculiX", "force", "loss")
    for name, force in list(found.items())[1:]:
        deviation = np.max(np.abs(force - reference)) / largest
        print_table_row(name, f"{deviation:.1%}", f"{loop_area(force, motion) / loss:.3f}")


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "vdi": lambda _: print_vdi(),
            "shear-lag": lambda _: print_shear_lag(),
            "friction": print_friction,
            "points": print_points,
            "calculix": print_calculix,
            "brake-reuss": lambda options: lapped_beams.print_plane_faces(options.images),
            "brake-reuss-form": lambda _: lapped_beams.print_scanned_form(),
            "brake-reuss-meshes": lambda _: lapped_beams.print_meshes(),
            "measured-beam": lambda _: lapped_beams.print_measured_beam(),
        },
        on_request=("calculix", "brake-reuss-meshes"),
        options={
            "--joint": {
                "action": "append",
                "choices": [*JOINTS],
                "help": "friction, points: joint to compute (default: all)",
            },
            "--variants": {"action": "store_true", "help": "friction: also with more modes and patches"},
            "--refinement": {
                "type": float,
                "help": "factor that divides the element sizes (default: 1 for friction, 0.5 for calculix)",
            },
            "--images": {"action": "store_true", "help": "draw the picture of brake-reuss into docs/images"},
        },
    )
