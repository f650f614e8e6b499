"""A lap in slip by CalculiX: its own elements, contact and `*FRICTION`, beside the package's.

The lap of whole_joint_forms.py, REACH times as long as shear lag, under an even pressure, its interface
linear up to Coulomb's limit: what `PRESSURE-OVERCLOSURE=LINEAR` and `*FRICTION` can say. Slip walks in from
both ends. One end moves along x until much slips, and back to where it began, where friction leaves a force.
Prints both forces by CalculiX, by finite elements with friction at every element and by the reduced joint.

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
from whole_joint_nodes import Elements, along_motion

Array = NDArray[np.float64]

REACH = 4.0
LOADS = (0.9, 0.0)
"""Motions over that at which a linear interface would carry all friction [1]."""
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
    with tempfile.TemporaryDirectory() as name:
        lines = deck(lap.bodies, normal, shear, values.mu, np.array(LOADS) * elements.motion[0])
        rows = {"CalculiX": by_calculix(Path(name), lines)}
    rows["friction at every element"] = elements.along(LOADS)[0] / elements.motion[0]
    rows["reduced joint"] = along_motion(one, PRESS, elements.motion, LOADS)[0] / elements.motion[0]
    print(f"{at.interface.area.size} elements of the contact, friction {values.mu * PRESS:g} N; forces [N]\n")
    print("| | " + " | ".join(f"at {load:g}" for load in LOADS) + " |\n|---|" + "---|" * len(LOADS))
    for name, forces in rows.items():
        print(f"| {name} | " + " | ".join(f"{force:.1f}" for force in forces) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
