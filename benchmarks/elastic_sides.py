"""Elastic sides of the bolted joint of the README's example, reduced to modes, beside finite elements.

Three tables: the tightened joint's stiffness, of the reduced joint over that of finite elements, each motion
alone; the force on the first way into slip and opening, of the reduced joint less that of all compliances of
some cells, over the force at which all slips or opens; and what calls of its FMU take in C beside those of
the interface alone, in one run. Before the last, gross slip about poles inside the contact. Then closed paths
in six directions through the FMU: the least work over the heat.

Run: python benchmarks/elastic_sides.py [--cells N] [--paths N]
"""

import argparse
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

import native_fmus
import numpy as np
from fmpy.fmi1 import FMICallException
from jointfmu_fmu_src.native.build import build
from jointfmu_fmu_src.native.code import generate
from jointfmu_fmu_src.native.compiled import compiler
from jointfmu_tools.fem.reduction.states import CellJoint, CellLoads
from jointfmu_tools.fem.whole_joint import JointFiniteElements, LinearJoint
from jointfmu_tools.joints.bolted_joint.new import NEW, plate_finite_elements
from jointfmu_tools.run.host import Instance, open_instance, unpack_fmu
from lap_beam_reduction import patches as one_each
from numpy.typing import NDArray
from patch_reduction import gross_slip, poles_inside
from whole_joint import EXAMPLE

from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, JointInputs
from jointfmu.joints.bolted_joint.law import preload_pressure
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.mechanics.footprint.point_reduction import reduce_points
from jointfmu.parameters import ParameterFile

Array = NDArray[np.float64]
CELLS, PATHS, POLES = 300, 1000, 200
WAYS = ((0.7, 48), (7.0, 48), (7.0, 16), (7.0, 8))
"""Closed paths: motions over those of the load in a linear joint [1], steps."""
FINE = 48
"""Fewest steps by which the trapezoidal rule tells the work."""
TURNS = (2e-3, 4e-3, 8e-3, 1.6e-2)
"""Ways about a pole [rad], far beyond what the sides give way by."""
ATTACHED = ("faces", "heads", "edge")
AXES = ("K_xx", "K_yy", "K_zz", "K_rx", "K_ry", "K_rz")
FORCES = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z")
MOTIONS = ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
LEVELS = (0.1, 0.3, 0.5, 0.8, 1.0, 1.3)
"""Motions over that at which the linear joint carries all friction, or loses all clamping force [1]."""


@dataclass(frozen=True)
class Joint:
    """A joint between its attachments: with elastic sides and rigid ones, and its finite elements.

    normal  : (q) [Pa/m] stiffness of the interface at the points of the finite elements
    members : [N/m] stiffness of what a bolt clamps, VDI 2230
    """

    file: ParameterFile
    rigid: ParameterFile
    linear: LinearJoint
    normal: Array
    preload: float
    members: float

    @classmethod
    def of(
        cls,
        attached: str,
        example: Mapping[str, object] = EXAMPLE,
        refinement: float = 1.0,
        elements: bool = False,
    ) -> "Joint":
        """Made as the command makes it, beside finite elements of sizes divided by `refinement` [1].

        elements : the contact has a point for each element in place of nine
        """
        seen: dict[str, object] = {}
        real = plate_finite_elements.compute_joint

        def watched(
            file: ParameterFile,
            plates: plate_finite_elements.BoltedPlates,
            to: str,
            shape: PressureDistribution | None,
        ) -> plate_finite_elements.ComputedJoint:
            joint = JointFiniteElements.from_assembly(plates.make_assembly(file), to, refinement)
            if elements:
                joint = replace(joint, interface=one_each(joint.interface))
            springs = plate_finite_elements._interface_stiffness(file, plates.preload, joint, shape)
            linear = joint.linearize(springs, file.values.bolt_stiffness)
            seen.update(rigid=file, preload=plates.preload, normal=springs[:, 2], linear=linear)
            if refinement != 1.0:
                return real(file, plates, to, shape)
            with (  # the command's own finite elements are these
                patch.object(JointFiniteElements, "from_assembly", lambda *_: joint),
                patch.object(JointFiniteElements, "linearize", lambda *_: linear),
            ):
                return real(file, plates, to, shape)

        plate_finite_elements.compute_joint = watched
        try:
            given = dict.fromkeys(option.name for option in NEW.options) | dict(example)
            given["attached"] = attached
            made = NEW.make_joint(given)
        finally:
            plate_finite_elements.compute_joint = real
        facts: dict[str, tuple[float, str, str]] = dict(made.facts)
        return cls(file=made.file, members=facts["member_stiffness"][0], **seen)  # type: ignore[arg-type]

    @property
    def spring(self) -> BoltedJointSpring:
        """With elastic sides."""
        return BoltedJointSpring.of(self.file.values)

    def load(self) -> Array:
        """Forces and moments (6) at which all slips, or the clamping force is lost."""
        values, spring = self.file.values, self.spring
        clamping = values.n_bolts * self.preload
        radius = float(np.sqrt(spring.points.area_share @ np.sum(spring.points.position**2, axis=1)))
        mu = values.mu
        return clamping * np.array([mu, mu, 1.0, radius, radius, mu * radius])


def along(
    spring: BoltedJointSpring, motions: Sequence[Array], preload: float, names: Sequence[str] = FORCES
) -> list[Array]:
    """Forces and moments, or other outputs, on the way through motions (6) from rest."""
    memory, rows = spring.initial_history(), []
    for six in motions:
        out, memory = spring.advance(JointInputs(preload, 0.0, six), memory)
        rows.append(np.array([float(out[name]) for name in names]))
    return rows


def stiffnesses(joint: Joint) -> tuple[Array, Array]:
    """(6) of the reduced joint and of finite elements, each motion alone."""
    out = joint.spring.evaluate(joint.preload, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return np.array([float(out[name]) for name in AXES]), joint.linear.stiffness.diagonal()


def on_cells(joint: Joint, count: int) -> CellJoint:
    """The joint with all compliances of some cells, without modes and patches."""
    fine = reduce_points(pressure_distribution(joint.rigid.values.pattern), count)
    spring = BoltedJointSpring.of(joint.rigid.values).on_nodes(fine)
    at = joint.linear.joint.interface
    bolts = (
        joint.linear.joint.bolt_positions
        - at.quadrature_area @ at.quadrature_position / at.quadrature_area.sum()
    )
    return CellJoint.from_cells(
        CellLoads.from_joint(joint.linear.joint, spring, joint.normal), bolts, joint.preload
    )


def first_way(joint: Joint, count: int) -> Array:
    """(5, levels) force less that of all compliances of `count` cells, over the load.

    Along x, y, z, about y, z.
    """
    states = on_cells(joint, count)
    unit, rows = joint.load() / stiffnesses(joint)[0], []
    for axis in (0, 1, 2, 4, 5):
        motions = [level * unit * (np.arange(6) == axis) for level in LEVELS]
        expected = [states.rigid_displacement.T @ states.solve_forces(six) for six in motions]
        found = along(joint.spring, motions, joint.preload)
        rows.append([(-f[axis] - e[axis]) / joint.load()[axis] for f, e in zip(found, expected, strict=True)])
    return np.array(rows)


def pole_deviations(spring: BoltedJointSpring, preload: float, count: int) -> Array:
    """(2) deviation of the force in gross slip about poles from that of all nodes as tightened, over the
    friction [1]: of 95 %, largest."""
    values, shape, found = spring.joint, pressure_distribution(spring.joint.pattern), []
    friction = values.mu * values.A_0 * shape.area_share * preload_pressure(values, shape, preload, 0.0)
    poles = poles_inside(shape, count)
    for (x, y), force in zip(poles, gross_slip(shape.as_patches(), friction, poles), strict=True):
        motions = [turn * np.array([y, -x, 0.0, 0.0, 0.0, 1.0]) for turn in TURNS]
        found.append(np.linalg.norm(along(spring, motions, preload)[-1][:2] + force) / np.sum(friction))
    return np.quantile(found, [0.95, 1.0])


def times(joint: Joint, folder: Path) -> None:
    """Print what calls of the FMUs take."""
    host, unit = native_fmus.build_host(folder), joint.load() / stiffnesses(joint)[0]
    part = 0.5 * np.array([1.0, 0.3, 0.1, 0.1, 0.1, 0.3])
    ends = dict(zip(MOTIONS, part * unit, strict=True))
    motions = {v.name: (-ends.get(v.name, 0.0), ends.get(v.name, 0.0)) for v in MODELS["BoltedJoint"].inputs}
    ranges = motions | {"preload": (joint.preload, joint.preload)}
    rounds: dict[str, list[dict[str, float]]] = {}
    jobs = {"elastic": joint.file, "rigid": joint.rigid}
    made = {}
    for name, file in jobs.items():
        files = generate.generate_sources("BoltedJoint", file)
        library = compiler.compile_libraries(
            "BoltedJoint", files, compiler.select_units(list(files), "3"), ["x86_64-linux"]
        )
        (folder / f"{name}.so").write_bytes(library["x86_64-linux"])
        model = MODELS["BoltedJoint"].with_parameters(file.joint, file.values)
        made[name] = folder / f"{name}.so", generate.read_token(files), len(model.outputs)
        native_fmus.RANGES[name] = ranges
    for _ in range(native_fmus.ROUNDS):
        for name, rest in made.items():
            rounds.setdefault(name, []).append(native_fmus.native_times(host, name, "fmi3", *rest))
    print("\n| sides | step | derivative | start |\n|---|---|---|---|")
    for name, found in rounds.items():
        middle = {key: np.median([each[key] for each in found]) for key in found[0]}
        step, rate, start = (middle[key] for key in ("step_smooth", "derivative", "start"))
        print(f"| {name} | {step * 1e6:.1f} us | {rate * 1e6:.1f} us | {start * 1e3:.2f} ms |")


def closed(joint: Joint, folder: Path, paths: int) -> None:
    """Print the least work of closed paths over their heat, and how many are refused, far and in long steps
    too."""
    path, unit = build("BoltedJoint", joint.file, folder, "3"), joint.load() / stiffnesses(joint)[0]
    print(f"\nFMU {size_of(path)}; {paths} closed paths\n")
    print("| of the load | steps | refused | least work over heat |\n|---|---|---|---|")
    with unpack_fmu(path) as (unzipped, described):
        for part, steps in WAYS:
            rng, refused, least = np.random.default_rng(1), 0, np.inf
            for _ in range(paths):
                a, b = part * rng.uniform(-1.0, 1.0, (2, 6)) * unit
                angles = np.linspace(0.0, 2.0 * np.pi, steps + 1)
                way = np.sin(angles)[:, None] * a + (1.0 - np.cos(angles))[:, None] * b
                with open_instance(unzipped, described, path.name, []) as fmu:
                    try:
                        force = np.array(followed(fmu, way, joint.preload))
                    except FMICallException:
                        refused += 1
                        continue
                work = -0.5 * np.sum((force[1:, :6] + force[:-1, :6]) * np.diff(way, axis=0))
                least = min(least, work / force[-1, 6])
            told = f"{least:.3f}" if steps >= FINE else ""
            print(f"| {part:g} | {steps} | {refused} | {told} |")


def size_of(path: Path) -> str:
    """In kB."""
    return f"{path.stat().st_size / 1e3:.0f} kB"


def followed(fmu: Instance, way: Array, preload: float) -> list[list[float]]:
    """Forces, moments and heat on a way (n, 6)."""
    fmu.enter_initialization()
    fmu.set_values({"preload": preload})
    fmu.fmu.exitInitializationMode()
    given, told, rows = fmu.group_reals(MOTIONS), fmu.group_reals((*FORCES, "E_loss")), []
    for now, six in enumerate(way):
        given.set_values(*six.tolist())
        fmu.do_step(float(now), 1.0)
        rows.append(told.get_values())
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, default=CELLS)
    parser.add_argument("--paths", type=int, default=PATHS)
    given = parser.parse_args(arguments)
    joints = {attached: Joint.of(attached) for attached in ATTACHED}
    print("| attached | " + " | ".join(AXES) + " |\n|---|" + "---|" * len(AXES))
    for attached, joint in joints.items():
        found, expected = stiffnesses(joint)
        print(f"| `{attached}` | " + " | ".join(f"{x:.3f}" for x in found / expected) + " |")
    print("\n| attached | along x | along y | along z | about y | about z |\n|---|---|---|---|---|---|")
    for attached in ATTACHED[:2]:
        worst = np.max(np.abs(first_way(joints[attached], given.cells)), axis=1)
        print(f"| `{attached}` | " + " | ".join(f"{x:.1%}" for x in worst) + " |")
    off = pole_deviations(joints["faces"].spring, joints["faces"].preload, POLES)
    print("\n{} poles: 95 % within {:.1%}, all within {:.1%}".format(POLES, *off))
    with tempfile.TemporaryDirectory() as folder:
        times(joints["faces"], Path(folder))
        closed(joints["faces"], Path(folder), given.paths)
    return 0


if __name__ == "__main__":
    sys.exit(main())
