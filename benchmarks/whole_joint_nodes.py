"""The whole bolted joint with elastic sides beside finite elements with friction at every element.

Joints of two plates: a flange (outer faces rigid, sheared along x), another with six bolts for which nothing
was chosen (sheared askew), a lap (ends rigid, sheared along x) and a bracket (ends rigid, a force along y off
the bolts' line; far: to four times its slip). The finite
elements are linear but for the contact, and reduce to the compliance of their elements' patches without loss:
about 300 to 500, each with the law's own p(delta) and 348 springs of Coulomb (`coulomb_springs.py`), no code
of the package's sliders, beside the joint's 120 points and 22 patches of 38 sliders. Quasi-static: up to
LEVELS of the motion at which a linear joint would carry all friction, then a whole cycle at CYCLES of it.

Run: python benchmarks/whole_joint_nodes.py [flange six lap bracket bracket-far] [--why] [--refinement 1.4]
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from coulomb_springs import Springs
from elastic_sides import Joint, along, on_cells
from jointfmu_tools.fem.elasticity import Cholesky
from jointfmu_tools.fem.reduction import elastic_bodies as reduction
from jointfmu_tools.fem.reduction.states import approach_at_stiffness
from jointfmu_tools.fem.whole_joint import JointFiniteElements
from jointfmu_tools.joints.bolted_joint.new.plate_finite_elements import set_elastic_bodies
from lap_beam_loops import Joint as Loops
from lap_beam_reduction import AT_ONCE, Reduced
from numpy.typing import NDArray
from scipy import sparse as sp

from jointfmu.joints.bolted_joint import friction, joint, law
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring

Array = NDArray[np.float64]

PLATES: dict[str, object] = {"grip": ["20"], "material": ["steel"], "Ra": ["0.8"], "embedding": "0"}
PLATES |= {"preload": "15e3"}
BRACKET = PLATES | {"plate": "80x60", "bolts": "2xM8", "at": ["-20,-15", "-20,15"]}
LEVER = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.06]) / 3.0
"""Of the bracket [1], [m]: with this lever it slips as a whole at about a third of its friction."""
JOINTS: dict[str, tuple[str, dict[str, object], Array]] = {
    "flange": (
        "faces",
        PLATES | {"plate": "80x80", "bolts": "4xM8", "at": ["50x50"]},
        np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ),
    "lap": (
        "edge",
        PLATES | {"plate": "90x40", "bolts": "2xM8", "at": ["40x0"]},
        np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ),
    "six": (
        "faces",
        PLATES
        | {
            "grip": ["24"],
            "plate": "100x80",
            "bolts": "6xM8",
            "at": ["70x50"],
            "grid": "3x2",
            "preload": "12e3",
        },
        np.array([0.3, 1.0, 0.0, 0.0, 0.0, 0.0]) / 1.05,
    ),
    "bracket": ("edge", BRACKET, LEVER),
    "bracket-far": ("edge", BRACKET, 3.0 * LEVER),
}
"""Attachment, drawing and force: along x and y [1], moments about the centre [m]."""
LEVELS = (0.2, 0.4, 0.6, 0.8, 1.0, 1.3)
"""Motions over that at which the linear joint would carry all friction [1]."""
CYCLES = (0.5, 1.0)
"""Those at which a whole cycle is followed [1]."""
STEPS = 8
"""From one end of a cycle to the other."""
WHY = {"as it is": (16, 22), "60 modes": (60, 22), "40 patches": (16, 40), "60 patches": (16, 60)}
WHY |= {"60 modes, 60 patches": (60, 60)}
"""Modes and patches of the reduced joint."""
CELLS = (120, 300)
"""Of a joint without modes and patches."""


@dataclass(frozen=True)
class Elements:
    """A joint by finite elements, moved along one motion.

    loops     : its patches on sliders, the load is the motion [1]
    motion    : (6) [m, rad] of side 2 per load; `stiffness` [N.m] of the linear joint along it
    """

    loops: Loops
    motion: Array
    stiffness: float

    @classmethod
    def of(
        cls,
        whole: JointFiniteElements,
        pressure: Array,
        spring: BoltedJointSpring,
        force: float,
        wrench: Array,
    ) -> "Elements":
        """Moved as small loads move it along forces and moments (6), until they are all of a force [N].

        pressure : (P) [Pa] at the points of its interface
        spring   : whose curve, friction and bolts it has
        """
        values, ratio = spring.joint, float(spring.joint.shear_stiffness_ratio())
        approach, at = spring.curve.inverse(pressure), whole.interface
        springs = np.outer(spring.curve.derivatives(approach, 1)[1], [ratio, ratio, 1.0])
        linear = whole.linearize(springs, values.bolt_stiffness)
        matrix = linear.body_matrix + linear.contact_matrix + linear.bolt_matrix
        apart = [
            sign * whole.relative_displacement_matrix(axis) for axis, sign in ((0, 1.0), (1, 1.0), (2, -1.0))
        ]
        K = linear.stiffness
        motion = np.linalg.solve(K, wrench) * force
        beam = Reduced(
            np.array([0.5 / np.pi]),  # unit square of the frequency: the load is the motion
            0.0,
            approach,
            springs,
            at.quadrature_area,
            at.quadrature_position,
            np.stack([rows @ (linear.unit_motion_displacement @ motion) for rows in apart], axis=1),
            compliance(matrix.tocsr(), apart, whole.attachment_unknowns, whole.bodies[0].unknown_count),
        )
        loops = Loops(beam, Springs.of(spring.curve, ratio, values.mu))
        return cls(loops, motion, float(motion @ K @ motion))

    @classmethod
    def clamped(cls, joint: Joint, wrench: Array) -> "Elements":
        """Of a joint under its bolts, to all friction."""
        spring = BoltedJointSpring.of(joint.rigid.values)
        pressure = spring.curve.derivatives(approach_at_stiffness(spring, joint.normal), 0)[0]
        return cls.of(joint.linear.joint, pressure, spring, joint.load()[0], wrench)

    def along(self, loads: Sequence[float]) -> tuple[Array, Array]:
        """Work per load (n) [N.m] of the force, and heat (n) [J] so far, on a way through loads from rest."""
        state, rows, heat = self.loops.at_rest(), [], 0.0
        for load in loads:
            state = self.loops.loaded(state, load)
            heat += 0.5 * state.loss
            rows.append((load * self.stiffness + 0.5 * (load - state.q), heat))
        force, loss = np.array(rows).T
        return force, loss


def compliance(
    matrix: sp.csr_matrix, apart: Sequence[sp.csr_matrix], held: tuple[Array, Array], first: int
) -> Array:
    """Shifts and approaches (3 P) [m] by pairs of forces (3 P) [N], patch by patch, attachments held."""
    count = apart[0].shape[0]
    free = np.setdiff1d(np.arange(matrix.shape[0]), np.concatenate([held[0], first + held[1]]))
    factor = Cholesky(matrix[free][:, free])
    rows = sp.vstack(apart).tocsr()[np.arange(3 * count).reshape(3, count).T.ravel()][:, free]
    columns = [rows @ factor.solve(rows[i : i + AT_ONCE].T.toarray()) for i in range(0, 3 * count, AT_ONCE)]
    return np.hstack(columns)


def along_motion(
    one: BoltedJointSpring, preload: float, motion: Array, loads: Sequence[float]
) -> tuple[Array, Array]:
    """What `Elements.along` tells, of the reduced joint."""
    names = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z", "E_loss")
    rows = np.array(along(one, [load * motion for load in loads], preload, names))
    return -rows[:, :6] @ motion, rows[:, 6]


@contextmanager
def finer(modes: int, count: int):
    """The reduction with so many modes and patches."""
    modules = law, friction, reduction, joint
    kept = [(module, "MAX_MODES", module.MAX_MODES) for module in modules]
    kept.append((joint, "MAX_PATCHES", joint.MAX_PATCHES))
    try:
        for module, name, _ in kept:
            setattr(module, name, count if name == "MAX_PATCHES" else modes)
        joint.friction_patches_of.cache_clear()
        yield
    finally:
        for module, name, value in kept:
            setattr(module, name, value)
        joint.friction_patches_of.cache_clear()


def way(amplitude: float) -> Array:
    """Loads of a whole cycle from its top on, after the way there."""
    down = amplitude * np.linspace(1.0, -1.0, STEPS + 1)[1:]
    return np.concatenate([amplitude * np.linspace(0.0, 1.0, STEPS + 1)[1:], down, -down])


def misses(full: Mapping[str, tuple[Array, Array]], found: Mapping[str, tuple[Array, Array]]) -> list[str]:
    """Cells of a table: force less that of `full` on the first way and on cycles, over the largest force of
    the first way; heat of each cycle over that of `full`."""
    most = np.max(np.abs(full["first"][0]))
    first = np.max(np.abs(found["first"][0] - full["first"][0])) / most
    cells = [f"{first:.1%}"]
    for name in full:
        if name != "first":
            force = found[name][0] - full[name][0]
            heat, expected = (each[name][1][-1] - each[name][1][STEPS - 1] for each in (found, full))
            cells += [f"{np.max(np.abs(force)) / most:.1%}", f"{heat / expected:.3f}"]
    return cells


def cases() -> dict[str, Array]:
    """Ways through loads."""
    return {"first": np.array(LEVELS)} | {f"{level:g}": way(level) for level in CYCLES}


def compared(name: str, why: bool, refinement: float) -> None:
    """Print rows of the table."""
    attached, drawing, wrench = JOINTS[name]
    joint = Joint.of(attached, drawing, refinement, elements=True)
    elements = Elements.clamped(joint, wrench)
    ways = cases()
    full = {key: elements.along(list(loads)) for key, loads in ways.items()}
    slips = np.max(np.abs(full["first"][0])) / elements.stiffness
    firsts: dict[str, Array] = {}
    for label, (modes, count) in (WHY if why else dict([next(iter(WHY.items()))])).items():
        with finer(modes, count):
            if label == "as it is":
                one = joint.spring
            else:
                base = BoltedJointSpring.of(joint.rigid.values)
                made = reduction.reduce_bodies(joint.linear, base, joint.normal, joint.preload)
                one = BoltedJointSpring.of(set_elastic_bodies(joint.rigid, made, attached).values)
            found = {
                key: along_motion(one, joint.preload, elements.motion, list(loads))
                for key, loads in ways.items()
            }
        patches_, row = elements.loops.beam.area.size, misses(full, found)
        print(f"| {name} | {label} | {patches_} | {slips:.2f} | " + " | ".join(row) + " |", flush=True)
        firsts[label] = found["first"][0]
    for count in CELLS if why else ():
        states = on_cells(joint, count)
        unit = states.rigid_displacement @ elements.motion
        firsts[f"{count} cells"] = np.array([unit @ states.solve_forces(x * elements.motion) for x in LEVELS])
    for label, force in firsts.items() if why else ():
        over = ", ".join(f"{x:.3f}" for x in force / full["first"][0])
        print(f"{name}, {label}: force on the first way over that of the elements {over}", flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("joints", nargs="*", choices=[*JOINTS, []])
    parser.add_argument("--why", action="store_true", help="more modes, more patches, neither; the first way")
    parser.add_argument("--refinement", type=float, default=1.0, help="divides the sizes of the elements")
    given = parser.parse_args(arguments)
    cells = [f"{what} at {level:g}" for level in CYCLES for what in ("force", "loss")]
    print("| joint | reduction | patches | most force | first way | " + " | ".join(cells) + " |")
    print("|---|" + "---|" * (4 + len(cells)))
    for name in given.joints or JOINTS:
        compared(name, given.why, given.refinement)
    return 0


if __name__ == "__main__":
    sys.exit(main())
