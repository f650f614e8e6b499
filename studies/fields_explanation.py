"""Figures of docs/fields_explanation.md: points, patches and sliders of a bolted contact against all its
nodes.

    python studies/fields_explanation.py [SECTION ...]

reduction  : points for a nodal field: number, deviation, processor time; `jointfmu footprint import` of 1e5
             nodes
normal     : force and stiffness of few points compared with all nodes
friction   : friction of few patches compared with all nodes with many sliders
poles      : force in gross slip about poles inside the contact
sliders    : number of slider heights of Mindlin's sphere, for backbone, loops and combined motions
foundation : friction of the joint's patches and sliders compared with Jaeger and Ciavarella on all nodes

Times are processor times of all threads: let BLAS have one (OPENBLAS_NUM_THREADS=1).
"""

import contextlib
import io
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from common import print_table_head, print_table_row, run_study
from jointfmu_tools import cli
from jointfmu_tools.inputs.fields import nodal_result
from jointfmu_tools.inputs.fields.joint_parameters import normalise_pressure_field
from jointfmu_tools.inputs.fields.nodal_result import ContactPressureField
from jointfmu_tools.inputs.fields.reduction import reduce_field
from numpy.typing import NDArray
from oracles import contact_patches as contacts
from oracles import sphere_friction as sphere
from scipy.optimize import brentq

from jointfmu.joints.bolted_joint import joint as joint_module
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import AnyBoltedJoint, get_bolted_frame, preload_pressure
from jointfmu.mechanics import sliders as slider_module
from jointfmu.mechanics.footprint import bolts
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import FrictionPatches, PressureDistribution
from jointfmu.mechanics.footprint.patch_reduction import reduce_patches
from jointfmu.mechanics.footprint.point_reduction import reduce_points
from jointfmu.parameters import load_default

Array = NDArray[np.float64]


def make_default_spring() -> BoltedJointSpring:
    """Spring of the default bolted joint in Python."""
    return BoltedJointSpring.from_joint(load_default("bolted_joint").values)


# reduction

PRELOAD = 9e3
"""Preload of a bolt [N]."""
CELLS_ACROSS_FLANGE = (10, 20, 66)
"""Number of cells across the flange of the frame; 66 gives 104 052 nodes."""
OPEN_PRESSURE = 0.45
"""Pressure below which nodes are open, over the mean pressure [1]."""
UNEVENNESS = 0.1
"""Increase of the pressure along the bolt rows [1], so that the field has no symmetry."""


def make_nodal_field(cells: int, open_pressure: float) -> ContactPressureField:
    """Nodal pressure field of the default frame; nodes below `open_pressure` [1] are open."""
    joint = load_default("bolted_joint").values
    bolts.CELLS_ACROSS_FLANGE = cells
    shape = get_bolted_frame(joint).pressure_distribution()
    x = shape.position[:, 0]
    p = np.maximum(shape.preload_pressure_ratio * (1.0 + UNEVENNESS * x / np.ptp(x)) - open_pressure, 0.0)
    p *= PRELOAD * joint.n_bolts / joint.A_0 / (shape.area_share @ p)
    return ContactPressureField(shape.area_share * joint.A_0, shape.position, p)


def print_reduction() -> None:
    """Number of points, deviation and time of the reduction of a nodal field."""
    joint = load_default("bolted_joint").values
    print_table_head("", "nodes", "open", "points", "deviation", "s", "s of the command")
    for cells in CELLS_ACROSS_FLANGE:
        for open_pressure in (0.0, OPEN_PRESSURE):
            field = make_nodal_field(cells, open_pressure)
            start = time.process_time()
            shape = normalise_pressure_field(joint, field, PRELOAD)
            joint_of_field = replace(joint, A_0=float(field.nodal_area.sum()))
            found = reduce_field(joint_of_field, shape, PRELOAD, preload_pressure)
            seconds = time.process_time() - start
            with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
                path = Path(folder) / "field.csv"
                path.write_text(nodal_result.format_field_csv(field))
                start = time.process_time()
                words = ["footprint", "import", str(path), "--preload", f"{PRELOAD:g}", "--open", "keep"]
                cli.main([*words, "--out", str(path.with_suffix(".toml"))])
                command_seconds = time.process_time() - start
            open_share = float(np.mean(field.nodal_pressure == 0.0))
            print_table_row(
                found.node_count,
                f"{open_share:.0%}",
                found.point_count,
                f"{found.largest_deviation:.1e}",
                f"{seconds:.1f}",
                f"{command_seconds:.1f}",
            )


# normal, friction, poles

POINT_COUNTS = (48, 120, 160)
PATCH_COUNTS = (16, 22)
RANDOM_PLATES = 12
REDUCTIONS = {
    "22 nodes": (22, reduce_points),
    "22": (22, reduce_patches),
    "40": (40, reduce_patches),
    "60": (60, reduce_patches),
    "120 nodes": (120, reduce_points),
}
"""Reductions {label: (number of patches, function)}: patches fitted to all nodes, or some of the nodes."""


def print_normal() -> None:
    """Print the deviation of forces and stiffnesses at few points from the results at all nodes."""
    spring = make_default_spring()
    mean = contacts.mean_pressure(spring)
    print_table_head("", "contact", "nodes", "points", "s", *contacts.ranges(1.0))
    for name, shape in contacts.contacts():
        for count in POINT_COUNTS:
            start = time.perf_counter()
            points = reduce_points(shape, count)
            seconds = time.perf_counter() - start
            cells = [
                "{:.0e}, {:.0e}".format(*contacts.deviation(spring.curve, mean, shape, points, states))
                for states in contacts.ranges(contacts.opening_moment(shape)).values()
            ]
            print_table_row(name, shape.area_share.size, points.area_share.size, f"{seconds:.1f}", *cells)


def list_sheared_contacts() -> Iterator[tuple[str, list[PressureDistribution]]]:
    """Groups of contacts in the table of friction; the table has the largest deviation of each group."""
    yield from ((name, [shape]) for name, shape in contacts.contacts())
    yield f"{RANDOM_PLATES} random plates", [contacts.random_plate(seed) for seed in range(RANDOM_PLATES)]


def friction_deviations(spring: BoltedJointSpring, shape: PressureDistribution) -> Array:
    """Largest deviations (counts, motions, 2) [1]: of the force over gross slip, and of the loop areas."""
    mean = contacts.mean_pressure(spring)
    largest = float(np.max(contacts.preloaded_approaches(spring.curve, shape, (mean, 0.0))))
    largest -= float(spring.curve.displacement[0])
    motions = contacts.MOTIONS.values()
    exact = [contacts.friction_and_losses(spring, shape, True, largest, motion) for motion in motions]
    found = []
    for count in PATCH_COUNTS:
        patches = reduce_patches(shape, count)
        for (force, loss), motion in zip(exact, motions, strict=True):
            few, few_loss = contacts.friction_and_losses(spring, patches, False, largest, motion)
            worst = np.max(np.abs(few - force)) / np.max(np.abs(force))
            found.append((worst, np.max(np.abs(few_loss / loss - 1.0))))
    return np.reshape(found, (len(PATCH_COUNTS), len(contacts.MOTIONS), 2))


def print_friction() -> None:
    """Print the deviation of friction force and loop areas from all nodes with many sliders."""
    spring = make_default_spring()
    print_table_head("", "contact", "patches", *contacts.MOTIONS, "any pole: 95 %, all")
    for name, shapes in list_sheared_contacts():
        found = [friction_deviations(spring, shape) for shape in shapes]
        for count, worst in zip(PATCH_COUNTS, np.max(found, axis=0), strict=True):
            poles = [contacts.pole_deviations(shape, reduce_patches(shape, count)) for shape in shapes]
            cells = [f"{force:.1e}, {area:.1%}" for force, area in worst]
            print_table_row(name, count, *cells, "{:.1%}, {:.1%}".format(*np.max(poles, axis=0)))


def print_poles() -> None:
    """Print the deviation of the force in gross slip about random poles: 95 % quantile and largest.

    The last column has the same patches without their radius, as single points.
    """
    print_table_head("", "contact", "patches", "", "points")
    for name, shape in contacts.contacts():
        for label, (count, reduction) in REDUCTIONS.items():
            patches = reduction(shape, count)
            points = patches.make_friction_patches()
            both = (patches if isinstance(patches, FrictionPatches) else points), points
            print_table_row(
                name, label, *("{:.1%}, {:.1%}".format(*contacts.pole_deviations(shape, x)) for x in both)
            )


# sliders

LEVEL_STEPS = (0.8, 0.4, 0.2, 0.1, 0.05)
"""Steps between the slider heights in the logarithm of the load."""
APPROACH = 0.4
"""Approach [m] of the loops under constant load."""
SPHERE_AMPLITUDES = (0.1, 0.2, 0.5, 0.9)
"""Force amplitudes of the loops over the friction limit [1]."""
TURNS, CIRCLE, STEPS_PER_TURN = 3, 1.5, (6, 12, 24, 48, 96, 4096)
"""Number of turns of a circle, its radius over gross slip, and steps per turn; the largest number is the
reference."""


def print_sliders() -> None:
    """Print the tables of Mindlin's sphere."""
    print_loops()
    print_motions()
    print_turns()


def print_loops() -> None:
    """Print the deviation of the backbone over the friction limit, and of the loop areas."""
    friction = sphere.FRICTION * float(sphere.load(APPROACH))
    print_table_head("", "sliders", "backbone", *(f"loop {part:g}" for part in SPHERE_AMPLITUDES))
    x = np.linspace(0.0, 1.2 * sphere.FRICTION * APPROACH / sphere.RATIO, 121)
    for step in LEVEL_STEPS:
        sliders = sphere.foundation(step)
        straight = np.column_stack([np.full_like(x, APPROACH), x, 0.0 * x])
        found = sphere.follow_path(sliders, straight)[0][:, 0]
        worst = np.max(np.abs(found - sphere.backbone(APPROACH, x[1:]))) / friction
        areas = []
        for part in SPHERE_AMPLITUDES:
            u = float(sphere.displacement(APPROACH, part))
            path = np.array([[APPROACH, place, 0.0] for place in (0.0, u, -u, u)])
            loss = np.sum(sphere.follow_path(sliders, path)[1][1:])
            areas.append(loss / sphere.loop_area(APPROACH, part) - 1.0)
        print_table_row(sliders.slider_count, f"{worst:.1e}", *(f"{a:+.1%}" for a in areas))


def print_motions() -> None:
    """Print the deviations for combined motions: of the force over the largest friction limit, and of the
    loss."""
    print_table_head("", "sliders", *(what for name in sphere.MOTIONS for what in (f"{name}: force", "loss")))
    exact = {name: sphere.follow_springs(path) for name, path in sphere.MOTIONS.items()}
    for step in LEVEL_STEPS:
        sliders, cells = sphere.foundation(step), []
        for name, path in sphere.MOTIONS.items():
            tractions, losses, _ = sphere.follow_path(sliders, path)
            largest = sphere.FRICTION * float(sphere.load(np.max(path[:, 0])))
            worst = np.max(np.abs(tractions - exact[name][0])) / largest
            cells += [f"{worst:.1e}", f"{np.sum(losses) / exact[name][1] - 1.0:+.1%}"]
        print_table_row(sliders.slider_count, *cells)


def print_turns() -> None:
    """Print loss per turn and force over friction limit, for circles of 1.5 times gross slip in the steady
    state."""
    print_table_head("", "steps a turn", "loss", "force")
    sliders, gross = sphere.foundation(0.2), sphere.FRICTION * APPROACH / sphere.RATIO

    def last_turn(steps: int) -> tuple[Array, float]:
        angle = np.linspace(0.0, 2.0 * np.pi * TURNS, TURNS * steps + 1)
        x, y = CIRCLE * gross * np.array([np.cos(angle) - 1.0, np.sin(angle)])
        path = np.column_stack([np.full_like(x, APPROACH), x, y])
        tractions, losses, _ = sphere.follow_path(sliders, path)
        return tractions[-1], float(np.sum(losses[-steps:]))

    force, loss = last_turn(STEPS_PER_TURN[-1])
    for steps in STEPS_PER_TURN[:-1]:
        found, found_loss = last_turn(steps)
        deviation = np.hypot(*(found - force)) / (sphere.FRICTION * sphere.load(APPROACH))
        print_table_row(steps, f"{found_loss / loss - 1.0:+.2%}", f"{deviation:.1e}")


# foundation

PRELOADS = (2e3, 4.3e3, 9e3, 13e3, 25e3)
"""Preloads of a bolt [N]."""
MOMENTS = (0.0, 1200.0)
"""Moments on the joint [N.m]."""
FIRST_PRELOADS = (1.0, 0.8, 1.25, 0.5, 2.0)
"""Preload at which the joint slipped first, over the present preload [1]."""
JOINT_AMPLITUDES = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.999)
"""Force amplitudes of the loops over the friction limit [1]."""
SWING_PRELOAD, SWING, CYCLES = 9e3, 0.3, (1, 2, 20, 100)
"""Oscillating normal load: preload [N], relative decrease of the normal force [1], number of cycles."""
SLIDER_COUNTS = ((22, 10, 7), (40, 5, 3), (60, 3, 2))
"""Numbers of patches, and of slider heights below and above the reference height, with about equal total
numbers of sliders. The joint has the first row."""
FORCE_POINTS = 20
"""Displacements over gross slip at which the force is compared."""


@dataclass(frozen=True, slots=True)
class AllNodes:
    """Friction of a preloaded joint from the normal curve at all its nodes (Jaeger 1995, Ciavarella 1998).

    Under constant load the force along one direction is mu [F_N(s_z) - F_N(s_z + K_T/K_N u/mu)]; the loop
    area follows by Masing's rule.

    share, approach : (n) area shares [1], approaches [m]
    """

    spring: BoltedJointSpring
    share: Array
    approach: Array

    @classmethod
    def preloaded(cls, spring: BoltedJointSpring, preload: float, moment: float) -> "AllNodes":
        """Friction of a joint under a preload [N] and a moment [N.m]."""
        shape = pressure_distribution(spring.joint.pattern)
        pressure = preload_pressure(spring.joint, shape, preload, moment)
        return cls(spring, shape.area_share, spring.curve.inverse(pressure))

    def force(self, displacement: float) -> float:
        """Force per area [Pa] at a displacement [m] from rest."""
        law = self.spring.friction_law.foundation()
        return float(self.share @ law.virgin_traction(self.approach, displacement))

    @property
    def gross_slip(self) -> float:
        """Displacement [m] of gross slip."""
        law = self.spring.friction_law.foundation()
        reach = np.max(self.approach) - self.spring.curve.displacement[0]
        return float(law.friction_coefficient * reach / law.stiffness_ratio)

    def displacement(self, part: float) -> float:
        """Displacement [m] at which the force is a fraction `part` of the friction limit."""
        limit = self.force(self.gross_slip)
        return float(brentq(lambda u: self.force(u) - part * limit, 0.0, self.gross_slip))

    def loop_area(self, amplitude: float) -> float:
        """Loss per area [J/m2] of a loop of an amplitude [m]."""
        law = self.spring.friction_law.foundation()
        return float(self.share @ law.cycle_energies(self.approach, amplitude)[0])


def foundation_deviations(
    spring: BoltedJointSpring, preload: float, moment: float, first: float = 1.0
) -> tuple[float, Array]:
    """Largest deviation of the force over the friction limit [1], and of the loop areas (m) [1].

    first : preload at which the joint slipped for the first time, over the present preload [1]
    """
    exact, patches = AllNodes.preloaded(spring, preload, moment), spring.patches
    approach = spring.curve.inverse(preload_pressure(spring.joint, patches, preload, moment))
    before = spring.curve.inverse(preload_pressure(spring.joint, patches, first * preload, first * moment))
    law = spring.friction_law.foundation(before)

    def follow(*increments: float) -> tuple[float, float]:
        force, loss = law.virgin_forces(approach.size), 0.0
        for increment in increments:
            moved = law.advance(force, approach, approach, np.tile([increment, 0.0], (approach.size, 1)))
            force, loss = moved.force, float(patches.area_share @ moved.dissipated_energy)
        return float(patches.area_share @ moved.traction[:, 0]), loss

    displacements = np.linspace(0.0, exact.gross_slip, FORCE_POINTS + 1)[1:]
    worst = max(abs(follow(u)[0] - exact.force(u)) for u in displacements.tolist())
    amplitudes = [exact.displacement(part) for part in JOINT_AMPLITUDES]
    areas = [2.0 * follow(u, -2.0 * u, 2.0 * u)[1] / exact.loop_area(u) for u in amplitudes]
    return worst / exact.force(exact.gross_slip), np.abs(np.array(areas) - 1.0)


def largest_deviations(spring: BoltedJointSpring, first: float = 1.0) -> tuple[float, Array]:
    """Largest deviations over all PRELOADS and MOMENTS."""
    found = [foundation_deviations(spring, preload, m, first) for preload in PRELOADS for m in MOMENTS]
    return max(force for force, _ in found), np.max([areas for _, areas in found], axis=0)


def print_foundation() -> None:
    """Print the tables of the joint's patches and sliders."""
    loops = [f"loop {x:g}" for x in JOINT_AMPLITUDES]
    print_table_head("", "law", "first", "force", *loops)
    joints: dict[str, AnyBoltedJoint] = {
        "zhao2018": load_default("bolted_joint").values,
        "roughness": load_default("bolted_joint", "roughness").values,
    }
    for name, joint in joints.items():
        spring = BoltedJointSpring.from_joint(joint)
        for first in FIRST_PRELOADS:
            force, areas = largest_deviations(spring, first)
            print_table_row(name, f"{first:g}", f"{force:.2%}", *(f"{a:.1%}" for a in areas))
    per_patch = spring.friction_law.foundation().slider_count
    print(f"{spring.patches.area_share.size} patches, {per_patch} sliders each")

    shape = pressure_distribution(load_default("bolted_joint").values.pattern)
    print_table_head("", "patches", "sliders each", "force", *loops, "any pole: 95 %, all")
    for counts in SLIDER_COUNTS:
        set_slider_counts(*counts)
        spring = make_default_spring()
        force, areas = largest_deviations(spring)
        poles = "{:.1%}, {:.1%}".format(*contacts.pole_deviations(shape, spring.patches))
        per_patch = spring.friction_law.foundation().slider_count
        print_table_row(counts[0], per_patch, f"{force:.2%}", *(f"{x:.1%}" for x in areas), poles)
    set_slider_counts(*SLIDER_COUNTS[0])
    print_swings()


def set_slider_counts(patches: int, below: int, above: int) -> None:
    """Set the number of patches and slider heights of all joints made afterwards."""
    joint_module.MAX_PATCHES = patches
    slider_module.HEIGHTS_BELOW_REFERENCE, slider_module.HEIGHTS_ABOVE_REFERENCE = (
        below,
        above,
    )
    joint_module.find_friction_patches.cache_clear()


def print_swings() -> None:
    """Print the shear force at constant displacement under an oscillating normal force, over the first shear
    force."""
    spring = make_default_spring()
    share, reference = spring.patches.area_share, spring.friction_law.foundation()
    start = spring.curve.inverse(preload_pressure(spring.joint, spring.patches, SWING_PRELOAD, 0.0))

    def load(opening: float) -> float:
        return float(share @ spring.curve.derivatives(start - opening, 0)[0])

    opening = brentq(lambda x: load(x) - (1.0 - SWING) * load(0.0), 0.0, float(np.ptp(start)) + 1e-6)
    low, sliders = start - opening, spring.friction_law.foundation(start)
    print_table_head("", "shear over friction", "by the theorem", *(f"{n} cycles" for n in CYCLES))
    for part in (0.5, 0.7, 0.9):
        target = part * spring.joint.mu * load(0.0)
        u = brentq(lambda u, f=target: share @ reference.virgin_traction(start, u) - f, 0.0, 1e-5)
        exact = share @ reference.virgin_traction(low, u) / (share @ reference.virgin_traction(start, u))
        increment = np.outer(np.ones(share.size), [u, 0.0])
        moved = sliders.advance(sliders.virgin_forces(share.size), start, start, increment)
        first, found, lowest = share @ moved.traction[:, 0], [], start
        for cycle in range(1, CYCLES[-1] + 1):
            for before, after in ((start, low), (low, start)):
                lowest = np.minimum(lowest, before)
                law = spring.friction_law.foundation(start, lowest)
                moved = law.advance(moved.force, before, after, 0.0 * increment)
            if cycle in CYCLES:
                found.append(share @ moved.traction[:, 0] / first)
        print_table_row(f"{part:g}", f"{exact:.4f}", *(f"{x:.4f}" for x in found))


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "reduction": print_reduction,
            "normal": print_normal,
            "friction": print_friction,
            "poles": print_poles,
            "sliders": print_sliders,
            "foundation": print_foundation,
        },
    )
