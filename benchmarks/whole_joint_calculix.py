"""A lap with friction in CalculiX (`*FRICTION`, its own elements and contact) beside the reduced whole joint
and finite elements with friction at every element.

Two thin plates, each held at one end and kept plane, pressed evenly, on an interface whose pressure is linear
in the approach: its friction is one spring at a place, which is the law of CalculiX. Side 2 is moved along
the lap and back again: force over the largest one, and the area of the loop.

Run: python benchmarks/whole_joint_calculix.py
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from calculix import solved
from calculix_meshes import body_lines
from lap_beam_reduction import patches
from numpy.typing import NDArray
from whole_joint_forms import PRESS, Lap
from whole_joint_nodes import Elements, along_motion

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring

Array = NDArray[np.float64]

REACH = 4.0
"""Length of the lap over that of shear lag [1]."""
TOP, STEPS = 1.0, 6
"""Largest motion over that at which the linear lap carries all friction [1]; steps from end to end."""
REFINEMENT = 0.5
"""Divides the sizes of elements [1]."""
STEP = "*STEP, INC=50\n*STATIC\n1., 1."


def deck(lap: Lap, spring: BoltedJointSpring, motion: float, levels: Sequence[float]) -> Iterator[str]:
    """Side 2 moved by levels of a motion [m], from the pressed state on; N and mm."""
    joint, mu, curve = lap.bodies, lap.values.mu, spring.curve
    pressure = PRESS / lap.values.A_0
    normal = float(curve.derivatives(curve.inverse(pressure), 1)[1])
    first = joint.bodies[0]
    starts = (0, first.basis.N)
    for k, body in enumerate(joint.bodies):
        yield from body_lines(body, k + 1, starts[k], k * first.mesh.nelements, k * pressure / normal)
    yield "*SURFACE INTERACTION, NAME=LAW\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield (
        f"{normal * 1e-9:.12g}\n*FRICTION\n{mu:.12g}, "
        f"{normal * spring.friction.foundation().stiffness_ratio * 1e-9:.12g}"
    )
    yield "*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE\nFACE2, FACE1\n*NSET, NSET=MOVED"
    yield from (f"{starts[1] + i // 3 + 1}," for i in joint.attachment_unknowns[1] if i % 3 == 0)
    yield "*BOUNDARY"
    for side, held in enumerate(joint.attachment_unknowns):
        still = held[held % 3 > 0] if side else held
        yield from (f"{starts[side] + i // 3 + 1}, {i % 3 + 1}, {i % 3 + 1}" for i in still)
    yield f"{STEP}\n*CLOAD"
    for start, body, sign in zip(starts, joint.bodies, (1.0, -1.0), strict=True):
        face = body.mesh.facets_satisfying(lambda x: np.abs(x[2]) < 1e-9, boundaries_only=True)
        load = sign * PRESS * body.uniform_load(face)[2::3]
        yield from (f"{start + i + 1}, 3, {load[i]:.12g}" for i in np.flatnonzero(load))
    for number, level in enumerate((0.0, *levels)):
        yield f"{STEP}\n*BOUNDARY" if number else "*BOUNDARY"
        yield f"MOVED, 1, 1, {level * motion * 1e3:.12g}\n*NODE PRINT, NSET=MOVED, TOTALS=ONLY\nRF\n*END STEP"


def forces(printed: str) -> Array:
    """Total forces along x [N], step by step."""
    rows = [line.split() for line in printed.splitlines()]
    return np.array([float(row[0]) for row in rows if len(row) == 3])


def area(force: Array, shift: Array) -> float:
    """Of the closed loop [J] at the end of a way up, down and up again."""
    f, x = force[-2 * STEPS - 1 :], shift[-2 * STEPS - 1 :]
    return float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))


def compared(refinement: float, top: float) -> tuple[Array, dict[str, Array]]:
    """Motions [m], and forces [N] by CalculiX, by friction at every element and of the reduced joint."""
    lap = Lap.of(refinement)
    shear, spring, linear = lap.linear(REACH)
    normal, friction = shear / spring.friction.foundation().stiffness_ratio, lap.values.mu * PRESS
    bodies = replace(lap.bodies, interface=patches(lap.bodies.interface))
    at = bodies.interface.quadrature_area
    elements = Elements.of(bodies, np.full(at.size, PRESS / at.sum()), spring, friction, np.eye(6)[0])
    motion = np.eye(6)[0] * elements.motion[0]
    down = np.linspace(1.0, -1.0, STEPS + 1)[1:]
    levels = top * np.concatenate([np.linspace(0.0, 1.0, STEPS // 2 + 1)[1:], down, -down])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lap.inp"
        path.write_text("\n".join(deck(lap, spring, motion[0], levels.tolist())) + "\n")
        found = {"CalculiX": forces(solved(path, 3600.0))[1:]}
    found["friction at every element"] = elements.along(levels.tolist())[0] / motion[0]
    one = lap.reduced(spring, linear, normal)
    found["reduced joint"] = along_motion(one, PRESS, motion, levels.tolist())[0] / motion[0]
    return levels * motion[0], found


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--refinement", type=float, default=REFINEMENT)
    parser.add_argument("--top", type=float, default=TOP)
    given = parser.parse_args(arguments)
    shift, found = compared(given.refinement, given.top)
    reference = found["CalculiX"]
    most = np.max(np.abs(reference))
    print(
        f"largest motion {shift.max() * 1e6:.1f} um, force {most:.0f} N, loss {area(reference, shift):.4g} J"
    )
    print("| beside CalculiX | force | loss |\n|---|---|---|")
    for name, force in list(found.items())[1:]:
        miss = np.max(np.abs(force - reference)) / most
        print(f"| {name} | {miss:.1%} | {area(force, shift) / area(reference, shift):.3f} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
