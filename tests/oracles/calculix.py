"""CalculiX (`ccx`): exported joints compared with the package, and finite-element bodies as its input.

Cases: two rigid bodies on the springs of the joint's nodes; two elastic blocks on springs between the nodes
of their meshes; two elastic blocks in contact by the tabulated law. CalculiX prints seven digits.
"""

import os
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

import numpy as np
from jointfmu_tools import cli
from jointfmu_tools.exchange.export.target_model import AXIS_ORDER
from jointfmu_tools.fem.elasticity import ElasticBody

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.parameters import load_default

DECKS = Path(__file__).resolve().parents[2] / "models/calculix"
MM = "mm-N-MPa-t"
STATES = ((9e3, 0.0), (15e3, 4500.0))
"""Preload [N] per bolt and moment [N.m] of the springs: Zhao 2018, Table 3."""
PRESSURES = (0.1, 2.0, 8.0, 50.0)
"""Pressures [MPa] of the contact."""
E, NU = 150e3, 0.28
"""Cast iron [MPa], as in the decks."""
PLAN, HEIGHT, CELLS = (200.0, 191.0), 50.0, (4, 4, 2)
"""Width, depth and height [mm] of a meshed block, and its elements along them; the joint's A_0."""
FORCE = 10e3
"""Tensile force on the meshed blocks [N]."""
Case = tuple[str, float, float]
"""Comparison: description, value by CalculiX, value by the package."""


def find_calculix() -> str | None:
    """Path of the solver, if it is installed."""
    return shutil.which("ccx")


def run_deck(deck: Path) -> dict[int, np.ndarray]:
    """Run a deck; returns {node: displacements (3)} printed last."""
    tables = re.split(r"displacements .*", solve_deck(deck))
    rows = [line.split() for line in tables[-1].splitlines() if line.strip()]
    return {int(row[0]): np.array(row[1:], dtype=float) for row in rows}


def solve_deck(deck: Path, patience: float = 300.0) -> str:
    """Run a deck for at most `patience` [s]; returns what it printed.

    Raises RuntimeError with the last printed lines if CalculiX did not finish.
    """
    done = subprocess.run(
        [find_calculix() or "ccx", "-i", deck.stem],
        cwd=deck.parent,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=patience,
    )
    if done.returncode or "*ERROR" in done.stdout or "Job finished" not in done.stdout:
        raise RuntimeError(f"{deck.name}: {done.stdout[-500:]}")
    return deck.with_suffix(".dat").read_text()


def export(*arguments: object) -> None:
    """Run `jointfmu export` with these arguments."""
    assert cli.main(["export", *map(str, arguments), "--units", MM]) == 0


def rigid_bodies(folder: Path, preload: float, moment: float, normal: str = "z") -> list[Case]:
    """Motion [mm, rad] of two rigid bodies on the springs, for one displacement or rotation at a time.

    normal : axis of the model along the joint's normal; x, y, z of what is returned are the joint's
    """
    export(
        *("calculix", "springs", "--preload", preload, "--moment", moment),
        *("--normal", normal, "--out", folder / "springs.inp"),
    )
    x, y, z = AXIS_ORDER[normal]
    spring = BoltedJointSpring.from_interface_nodes(load_default("bolted_joint").values)
    K = spring.evaluate(preload, moment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    deck = (DECKS / "two_bodies.inp").read_text()
    for axis, place in ((1, x), (3, z)):
        deck = deck.replace(f"900002, {axis}, 1000.\n", f"900002, {place + 1}, 1e3\n")
    for name, held in (("shifted", "900004"), ("turned", "900002")):
        (folder / f"{name}.inp").write_text(deck.replace("*STEP", f"{held}, 1, 3\n*STEP"))
    shift, turn = run_deck(folder / "shifted.inp")[900002], run_deck(folder / "turned.inp")[900004]
    state = f"{preload / 1e3:g} kN, {moment:g} N m"
    return [
        (f"springs, {state}: 1 kN along x [mm]", shift[x], 1e6 / K["K_xx"]),
        (f"springs, {state}: 1 kN along z [mm]", shift[z], 1e6 / K["K_zz"]),
        (f"springs, {state}: 100 N m about x [rad]", turn[x], 100.0 / K["K_rx"]),
        (f"springs, {state}: 100 N m about y [rad]", turn[y], 100.0 / K["K_ry"]),
        (f"springs, {state}: 100 N m about z [rad]", turn[z], 100.0 / K["K_rz"]),
    ]


def meshed_blocks(folder: Path) -> list[Case]:
    """Results of two elastic blocks on springs between their meshes, pulled apart by a uniform traction.

    The traction is uniform, so the force F moves the top by F/K_zz plus the elongation F 2 h/(E A) of the
    blocks.
    """
    deck, pairs, area = mesh_blocks()
    pressure = 8.0 * STATES[0][0] / area.sum()
    rows = [f"{a},{b},{x},{y},{s},{pressure}" for (a, b, x, y), s in zip(pairs, area, strict=True)]
    heading = "node_1 [1],node_2 [1],x [mm],y [mm],area [mm2],pressure [MPa]"
    (folder / "pairs.csv").write_text("\n".join([heading, *rows]) + "\n")
    export(
        *("calculix", "springs", "--nodes", folder / "pairs.csv", "--first", 1001),
        *("--out", folder / "springs.inp"),
    )
    (folder / "meshed.inp").write_text(deck)
    top = [row[2] for node, row in run_deck(folder / "meshed.inp").items()]
    assert np.ptp(top) < 1e-4 * np.mean(top)
    joint = load_default("bolted_joint").values
    spring = BoltedJointSpring.from_interface_nodes(joint)
    k = spring.curve.derivatives(spring.curve.inverse(pressure * 1e6), 1)[1]
    expected = FORCE / (joint.A_0 * float(k)) * 1e3 + FORCE * 2.0 * HEIGHT / (E * area.sum())
    return [("springs on a mesh: two elastic blocks [mm]", float(np.mean(top)), expected)]


def mesh_blocks() -> tuple[str, list[tuple[int, int, float, float]], np.ndarray]:
    """A deck of two meshed blocks, its node pairs (labels, x, y [mm]) and their areas [mm2]."""
    ticks = [np.linspace(0.0, size, n + 1) for size, n in zip((*PLAN, HEIGHT), CELLS, strict=True)]
    many = [t.size for t in ticks]
    number = np.arange(np.prod(many)).reshape(many) + 1
    count = number.size
    nodes, elements = [], []
    for body in (0, 1):
        for i, j, k in product(*map(range, many)):
            z = ticks[2][k] + body * HEIGHT
            nodes.append(f"{number[i, j, k] + body * count}, {ticks[0][i]}, {ticks[1][j]}, {z}")
        for i, j, k in product(*map(range, CELLS)):
            face = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            corners = [number[a, b, c] + body * count for c in (k, k + 1) for a, b in face]
            elements.append(f"{len(elements) + 1}, " + ", ".join(map(str, corners)))
    sides = {
        "BOTTOM": number[:, :, 0].ravel(),
        "TOP": number[:, :, -1].ravel() + count,
        "LEFT": np.concatenate([number[0].ravel(), number[0].ravel() + count]),
        "FRONT": np.concatenate([number[:, 0].ravel(), number[:, 0].ravel() + count]),
    }
    width = [np.convolve(np.diff(t), [0.5, 0.5]) for t in ticks[:2]]
    area = np.outer(*width)
    loads = [f"{n}, 3, {FORCE * a / area.sum()}" for n, a in zip(sides["TOP"], area.ravel(), strict=True)]
    deck = [
        *("*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=BODIES", *elements),
        *("*MATERIAL, NAME=CAST_IRON", "*ELASTIC", f"{E}, {NU}"),
        "*SOLID SECTION, ELSET=BODIES, MATERIAL=CAST_IRON",
        *(
            line
            for name, found in sides.items()
            for line in (f"*NSET, NSET={name}", *(f"{n}," for n in found))
        ),
        *("*INCLUDE, INPUT=springs.inp", "*BOUNDARY", "BOTTOM, 3, 3", "LEFT, 1, 1", "FRONT, 2, 2"),
        *("*STEP", "*STATIC", "*CLOAD", *loads, "*NODE PRINT, NSET=TOP", "U", "*END STEP"),
    ]
    place = product(ticks[0], ticks[1])
    lower, upper = number[:, :, -1].ravel(), number[:, :, 0].ravel() + count
    pairs = [(int(a), int(b), x, y) for a, b, (x, y) in zip(lower, upper, place, strict=True)]
    return "\n".join(deck) + "\n", pairs, area.ravel()


def contact_blocks(folder: Path, joint: str, pressures: Sequence[float] = PRESSURES) -> list[Case]:
    """Results of two elastic blocks pressed together [MPa] with the tabulated contact law between them.

    The top moves by the compression p 2 h/E and by the law's approach from first touch.
    """
    export("calculix", "contact", "--joint", joint, "--out", folder / "contact.inp")
    curve = tabulate_approach(load_default(joint).values)
    deck, found = (DECKS / "two_blocks.inp").read_text(), []
    for p in pressures:
        (folder / "pressed.inp").write_text(deck.replace("2, P2, 2.", f"2, P2, {p}"))
        moved = run_deck(folder / "pressed.inp")
        law = float(curve.inverse(p * 1e6) - curve.displacement[0]) * 1e3
        top = float(np.mean([moved[node][2] for node in (13, 14, 15, 16)]))
        found.append((f"contact of {joint}, {p:g} MPa [mm]", -top, law + p * 2.0 * HEIGHT / E))
    return found


def cases(folder: Path) -> list[Case]:
    """All comparisons of CalculiX with the package."""
    found = [case for state in STATES for case in rigid_bodies(folder, *state)]
    found += meshed_blocks(folder)
    return found + [
        case for joint in ("bolted_joint", "gear_contact") for case in contact_blocks(folder, joint)
    ]


# Bodies of the finite elements

CORNERS = [7, 4, 1, 5, 6, 2, 0, 3]  # of C3D20 among scikit-fem's
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


def c3d20(body: ElasticBody) -> np.ndarray:
    """Nodes (20, n) of the elements in the order of CalculiX: corners, then the middles of EDGES."""
    corners, others = np.split(np.asarray(body.finite_element_basis.element_dofs), [8])
    rows = list(corners[CORNERS])
    for i, j in EDGES:
        middle = 0.5 * (body.node_positions[:, rows[i]] + body.node_positions[:, rows[j]])
        away = np.abs(body.node_positions[:, others] - middle[:, None]).sum(axis=0)
        assert away.min(axis=0).max() < 1e-12
        rows.append(np.take_along_axis(others, away.argmin(axis=0)[None], axis=0)[0])
    return np.array(rows)


def body_lines(body: ElasticBody, name: int, nodes: int, elements: int, down: float) -> Iterator[str]:
    """Lines of the deck for a body in mm and MPa, displaced by `down` [m]; 12 digits, because CalculiX reads
    20 characters."""
    yield f"*NODE, NSET=N{name}"
    for i, (x, y, z) in enumerate(body.node_positions.T * 1e3):
        yield f"{nodes + i + 1}, {x:.12g}, {y:.12g}, {z - 1e3 * down:.12g}"
    cells = c3d20(body)
    yield f"*ELEMENT, TYPE=C3D20, ELSET=E{name}"
    for i, cell in enumerate((cells + nodes + 1).T.tolist()):
        yield f"{elements + i + 1}, {', '.join(map(str, cell[:15]))},"
        yield ", ".join(map(str, cell[15:]))
    face, corner = (2, 4) if name == 1 else (1, 0)
    yield f"*SURFACE, NAME=FACE{name}, TYPE=ELEMENT"
    for i in np.flatnonzero(np.abs(body.node_positions[2, cells[corner]]) < 1e-9):
        yield f"{elements + i + 1}, S{face}"
    yield f"*MATERIAL, NAME=M{name}\n*ELASTIC\n{body.E / 1e6:g}, {body.nu:g}"
    yield f"*SOLID SECTION, ELSET=E{name}, MATERIAL=M{name}"


def displacements(path: Path) -> np.ndarray:
    """Read the printed displacements (n, 3) [m]."""
    rows = (line.split() for line in path.read_text().splitlines())
    return np.array([[float(v) for v in r[1:]] for r in rows if len(r) == 4 and r[0].isdigit()]) * 1e-3
