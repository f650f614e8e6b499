"""Fits of lengths of the box specimen of Zhao 2018 to its six frequencies, with each choice of the law.

Part of finite_elements_explanation.py. Each fit starts at random lengths. The bricks are coarse, and the
pressure around the bolts decays as in the default parameters of the joint, so that a fit takes half a minute.
Six lengths are fitted: the lengths of oracles.box_specimen, and a ledge inside the walls. A closed box has a
seventh length, the thickness of its floor.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jointfmu_tools.fem.contact import ContactInterface, displacement_matrix
from jointfmu_tools.fem.elasticity import ElasticBody
from jointfmu_tools.fem.modes import NaturalModes, compute_modes
from numpy.typing import NDArray
from scipy.optimize import least_squares
from skfem import MeshHex, MeshQuad

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.bolted_joint.law import BoltedJointParameters
from jointfmu.parameters import load_default
from jointfmu.progress import track_progress

Array = NDArray[np.float64]
NAMES = ("length", "height", "wall", "flange", "overhang", "ledge", "floor")
MIN_LENGTHS = np.array([0.20, 0.08, 0.008, 0.010, 0.0285, 0.0005, 0.005])
MAX_LENGTHS = np.array([0.80, 0.80, 0.060, 0.080, 0.0900, 0.0800, 0.060])
"""Bounds [m]: a bolt head fits on the overhang, the flange is at least as thick as a washer is wide."""
E, NU, DENSITY, ROWS = 1.5e11, 0.28, 7800.0, 0.3
BRICKS_ACROSS_WALL, BRICKS_ALONG_HEIGHT, BRICKS_ALONG_HALF_OPENING = 1, 3, 2
"""Number of bricks across a wall or ledge, along the height, along half of the opening."""
SAMPLES = 5
"""Number of random draws; the best one starts a fit."""
STEP = 1e-3
CASES = [
    ("continuity", "family", "open"),
    ("continuity", "hertz", "open"),
    ("printed", "family", "open"),
    ("printed", "hertz", "open"),
    ("continuity", "family", "closed"),
    ("printed", "family", "closed"),
]


@dataclass(frozen=True)
class Box:
    """Half of the box specimen with its contact; `bolts` (8, 2) [m]: positions of the bolts."""

    body: ElasticBody
    interface: ContactInterface
    bolts: Array

    @classmethod
    def of(cls, lengths: Array) -> "Box":
        """Mesh of bricks for lengths (6 or 7) [m]; the number of bricks does not depend on the lengths."""
        length, height, wall, flange, overhang, ledge, *floor = lengths
        half = np.array([0.5 * length, 0.5 * (ROWS + overhang)])
        depth = np.array([overhang + wall + ledge, overhang + wall, overhang, 0.0])
        lines = [_line(end - depth) for end in half]
        levels = [0.0, flange, height - floor[0], height] if floor else [0.0, flange, height]
        z = _steps(np.array(levels), [1, BRICKS_ALONG_HEIGHT, 1][: len(levels) - 1])
        mesh = MeshHex.init_tensor(*lines, z)
        x, y, at = mesh.p[:, mesh.t].mean(axis=1)
        inside = (np.abs(x) < half[0] - overhang) & (np.abs(y) < half[1] - overhang)
        hollow = (np.abs(x) < half[0] - depth[1]) & (np.abs(y) < half[1] - depth[1])
        solid = np.where(at < flange, ~_opening(x, y, half - depth[0]), inside & ~hollow)
        solid |= inside & (at > height - floor[0]) if floor else False
        plan = MeshQuad.init_tensor(*lines)
        ring = ~_opening(*plan.p[:, plan.t].mean(axis=1), half - depth[0])
        ends = half - 0.5 * overhang
        bolts = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]) * ends
        return cls(
            ElasticBody(mesh.restrict(np.nonzero(solid)[0]), E, NU, DENSITY),
            ContactInterface.from_mesh(plan.restrict(np.nonzero(ring)[0])),
            bolts,
        )

    def pressure(self, joint: BoltedJointParameters, force: float) -> Array:
        """Pressure (q) [Pa] under a force [N] per bolt, with the pressure decay of the joint."""
        apart = self.interface.quadrature_position[:, None, :] - self.bolts
        each = joint.pattern.pressure_decay(np.hypot(*np.moveaxis(apart, -1, 0)))
        return np.asarray(np.sum(force * each / (self.interface.quadrature_area @ each), axis=1))

    def springs(self, joint: BoltedJointParameters, force: float) -> tuple[Array, Array]:
        """Normal and tangential stiffness per area (q) [N/m3] of the contact."""
        pressure = np.maximum(self.pressure(joint, force), 1e4)
        normal = np.maximum(stiffness_curve(joint, pressure)[0], 1e3)
        return normal, float(replace(joint, critical_area="continuity").shear_stiffness_ratio()) * normal

    def modes(self, joint: BoltedJointParameters, force: float) -> NaturalModes:
        """Six lowest modes of the whole box: two halves in contact."""
        return compute_modes((self.body,), self.interface, *self.springs(joint, force))

    def squares(self, joint: BoltedJointParameters, force: float, found: NaturalModes) -> Array:
        """Rayleigh quotients (6) [1/s2] of mode shapes."""
        normal, tangential = self.springs(joint, force)
        rows = [displacement_matrix(self.body, self.interface, axis) for axis in range(3)]
        values = []
        for below, above in found.mode_shapes:
            u, gap = above.ravel(), (below - above).ravel()
            opening = [row @ gap for row in rows]
            squares = tangential * (opening[0] ** 2 + opening[1] ** 2) + normal * opening[2] ** 2
            energy = 2.0 * u @ (self.body.stiffness_matrix @ u) + self.interface.quadrature_area @ squares
            values.append(energy / (2.0 * u @ (self.body.mass_matrix @ u)))
        return np.array(values)


def _line(places: Array) -> Array:
    """Ascending grid lines [m] at plus and minus the given distances, with the opening divided."""
    right = _steps(
        np.concatenate([[0.0], places]),
        [BRICKS_ALONG_HALF_OPENING, BRICKS_ACROSS_WALL, BRICKS_ACROSS_WALL, BRICKS_ACROSS_WALL],
    )
    return np.concatenate([-right[:0:-1], right])


def _steps(edges: Array, counts: list[int]) -> Array:
    parts = [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)]
    return np.concatenate([edges[:1], *parts])


def _opening(x: Array, y: Array, half: Array) -> NDArray[np.bool_]:
    return np.asarray((np.abs(x) < half[0]) & (np.abs(y) < half[1]))


def fit_lengths(
    joint: BoltedJointParameters, force: float, start: Array, target: Array
) -> tuple[Array, Array]:
    """Fit lengths [m] to measured frequencies; returns the lengths and the relative errors of the
    frequencies.

    The derivatives come from Rayleigh's quotient.
    """
    known: dict[bytes, NaturalModes] = {}

    def error(logs: Array) -> Array:
        known[logs.tobytes()] = found = Box.of(np.exp(logs)).modes(joint, force)
        return np.asarray(found.natural_frequencies / target - 1.0)

    def slope(logs: Array) -> Array:
        found = known[logs.tobytes()]
        first = Box.of(np.exp(logs)).squares(joint, force, found)
        columns = []
        for k in range(logs.size):
            moved = logs.copy()
            moved[k] += STEP
            change = Box.of(np.exp(moved)).squares(joint, force, found) / first - 1.0
            columns.append(0.5 * change / STEP * found.natural_frequencies / target)
        return np.stack(columns, axis=1)

    least, most = np.log(MIN_LENGTHS[: start.size]), np.log(MAX_LENGTHS[: start.size])
    found = least_squares(
        error, np.log(start), slope, bounds=(least, most), max_nfev=16, x_scale=0.15, ftol=1e-4
    )
    return np.exp(found.x), np.asarray(found.fun)


def random_starts(
    joint: BoltedJointParameters, force: float, count: int, closed: bool, seed: int, target: Array
) -> Iterator[Array]:
    """Random start lengths, each of them the best of SAMPLES draws."""
    rng, size = np.random.default_rng(seed), 7 if closed else 6
    for _ in track_progress(range(count), "fits", count):
        tried: list[tuple[float, Array]] = []
        while len(tried) < SAMPLES:
            lengths = MIN_LENGTHS[:size] * (MAX_LENGTHS[:size] / MIN_LENGTHS[:size]) ** rng.random(size)
            if lengths[0] < 2.0 * lengths[[2, 4, 5]].sum() + 0.04 or lengths[1] < lengths[3] + 0.1:
                continue
            found = Box.of(lengths).modes(joint, force).natural_frequencies
            tried.append((float(np.sum(np.log(found / target) ** 2)), lengths))
        yield min(tried, key=lambda one: one[0])[1]


def print_fits(target: Array, states: Sequence[tuple[float, float]], fit_count: int, seed: int) -> None:
    """Print the best fit of each case to the frequencies `target` (states, 6) [Hz]."""
    force, higher_force = states[0][0], states[1][0]
    for area, spot, ends in CASES:
        joint = replace(load_default("bolted_joint").values, critical_area=area, spot_stiffness=spot)
        found = []
        for start in random_starts(joint, force, fit_count, ends == "closed", seed, target[0]):
            try:
                found.append(fit_lengths(joint, force, start, target[0]))
            except (ValueError, RuntimeError):
                continue  # no body is left, or no contact holds
        lengths, error = min(found, key=lambda each: float(each[1] @ each[1]))
        errors = sorted(100 * float(np.sqrt(np.mean(e**2))) for _, e in found)
        fitted = target[0] * (1.0 + error)
        rise = Box.of(lengths).modes(joint, higher_force).natural_frequencies / fitted - 1.0
        print(f"{area}, {spot}, {ends}: rms errors [%]", *(f"{e:.1f}" for e in errors))
        print("  lengths [mm]", *(f"{n} {1e3 * v:.1f}" for n, v in zip(NAMES, lengths, strict=False)))
        print("  error at 9 kN [%]   ", *(f"{100 * e:6.1f}" for e in error))
        print("  rise to 15 kN [%]   ", *(f"{100 * r:6.1f}" for r in rise), flush=True)
    print("  measured rise [%]   ", *(f"{100 * r:6.1f}" for r in target[1] / target[0] - 1.0))
