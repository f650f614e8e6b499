"""A lap in slip by CalculiX: its own elements, contact and `*FRICTION`, beside the package's.

The lap of whole_joint_forms.py, REACH times as long as shear lag, under an even pressure, its interface
linear up to Coulomb's limit: what `PRESSURE-OVERCLOSURE=LINEAR` and `*FRICTION` can say. Slip walks in from
both ends. One end moves along x until all slips, back and again; prints the largest difference of the force
over the friction, and the loss of the cycle, of finite elements with friction at every element and of the
reduced joint, both over CalculiX.

Run: python benchmarks/calculix_friction.py
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from calculix import calculix, solved
from calculix_meshes import body_lines
from jointfmu_tools.fem.whole_joint import WholeJoint
from lap_beam_reduction import patches
from numpy.typing import NDArray
from whole_joint_forms import PRESS, Lap
from whole_joint_nodes import STEPS, Elements, along_motion, way

Array = NDArray[np.float64]

REACH = 4.0
AMPLITUDES = (0.6, 1.2)
"""Of the motion at which a linear interface would carry all friction [1]."""
ALONG_X = np.eye(6)[0]


def deck(joint: WholeJoint, normal: float, shear: float, friction: float, loads: Array) -> Iterator[str]:
    """Steps of the motion along x of side 2's end, loads (n) [m]."""
    at, first = joint.interface, joint.bodies[0].basis.N
    pressure = PRESS / at.area.sum()
    for k, body in enumerate(joint.bodies):
        elements = k * joint.bodies[0].mesh.nelements
        yield from body_lines(body, k + 1, k * first, elements, k * pressure / normal)
    end = joint.bodies[1].nodes[0]
    yield "*NSET, NSET=END"
    yield from (f"{first + i + 1}," for i in np.flatnonzero(end > end.max() - 1e-9))
    yield "*SURFACE INTERACTION, NAME=LAW\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield f"{normal * 1e-9:.12g}\n*FRICTION\n{friction:g}, {shear * 1e-9:.12g}"
    yield "*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE\nFACE2, FACE1\n*BOUNDARY"
    for number, held in zip((0, first), joint.held, strict=True):
        yield from (f"{number + i // 3 + 1}, {i % 3 + 1}, {i % 3 + 1}" for i in held)
    pushed = joint.apart(2).T @ (at.area * pressure)  # what the contact does at rest, taken off again
    for number, load in enumerate(loads):
        yield "*STEP, INC=100\n*STATIC, DIRECT\n1., 1."
        if not number:
            yield "*CLOAD"
            strong = np.flatnonzero(np.abs(pushed) > 1e-12 * np.abs(pushed).max())
            yield from (f"{i // 3 + 1}, {i % 3 + 1}, {-pushed[i]:.12g}" for i in strong)
        yield f"*BOUNDARY\nEND, 1, 1, {load * 1e3:.12g}"
        yield "*NODE PRINT, NSET=END, TOTALS=ONLY\nRF\n*END STEP"


def by_calculix(folder: Path, lines: Iterator[str]) -> Array:
    """Force (n) [N] of each step."""
    path = folder / "lap.inp"
    path.write_text("\n".join(lines) + "\n")
    rows = [line.split() for line in solved(path, 1500).splitlines()]
    return np.array([float(row[0]) for row in rows if len(row) == 3 and row[0][-4] == "E"])


def heat(force: Array, motion: Array) -> float:
    """Of the cycle [J], by trapezia."""
    f, x = force[STEPS - 1 :], motion[STEPS - 1 :]
    return float(0.5 * np.sum((f[1:] + f[:-1]) * np.diff(x)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    if not calculix():
        raise SystemExit("ccx is not installed; on Debian: apt-get install calculix-ccx")
    lap = Lap.of(0.5)
    values = lap.values
    shear, spring, linear = lap.linear(REACH)
    normal = shear / spring.foundation().ratio
    one = lap.reduced(spring, linear, normal)
    area = lap.bodies.interface.area.sum()
    at = replace(lap.bodies, interface=patches(lap.bodies.interface))
    even = np.full(at.interface.area.size, PRESS / area)
    elements = Elements.of(at, even, spring, values.mu * PRESS, ALONG_X)
    print(f"{at.interface.area.size} elements of the contact")
    print("| motion | force, every element | loss, every element | force, reduced | loss, reduced |")
    print("|---|---|---|---|---|")
    for amplitude in AMPLITUDES:
        loads = way(amplitude)
        motion = loads * elements.motion[0]
        with tempfile.TemporaryDirectory() as name:
            lines = deck(lap.bodies, normal, shear, values.mu, motion)
            expected = by_calculix(Path(name), lines)
        cells = []
        for energy, _ in (
            elements.along(list(loads)),
            along_motion(one, PRESS, elements.motion, list(loads)),
        ):
            force = energy / elements.motion[0]
            cells.append(f"{np.max(np.abs(force - expected)) / (values.mu * PRESS):.2%}")
            cells.append(f"{heat(force, motion) / heat(expected, motion):.4f}")
        print(f"| {amplitude:g} | " + " | ".join(cells) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
