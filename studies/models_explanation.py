"""Figures of docs/models_explanation.md on elastic plates: reduced joint of the README against finite
elements.

    python studies/models_explanation.py [SECTION ...] [--cells N] [--paths N]

stiffness     : reduced joint over finite elements, each motion alone, other motions held
first-loading : force up to slip and opening, less the force with all compliances of the cells, over the
                largest force
poles         : force in gross slip about poles inside the contact, compared with all nodes
closed-paths  : smallest work over heat on closed paths in six directions, through the FMU
"""

import argparse
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from common import print_table_head, print_table_row, run_study
from fmpy.fmi1 import FMICallException
from jointfmu_fmu_src.native.build import build_native_fmu
from jointfmu_tools.run.host import FmuInstance, open_instance, unpack_fmu
from numpy.typing import NDArray
from oracles.joint_elements import (
    AXES,
    FORCES,
    PlateJoint,
    follow_motions,
    joint_on_cells,
    pole_deviations,
    stiffnesses,
)

Array = NDArray[np.float64]
POLE_COUNT = 200
PATHS = ((0.7, 48), (7.0, 48), (7.0, 16), (7.0, 8))
"""Closed paths: (motion over motion at the largest force in a linear joint [1], number of steps)."""
MIN_STEPS = 48
"""Smallest number of steps for which the trapezoidal rule gives the work."""
ATTACHMENTS = ("faces", "heads", "edge")
MOTIONS = ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
LEVELS = (0.1, 0.3, 0.5, 0.8, 1.0, 1.3)
"""Motions over motion at which the linear joint reaches the friction limit or loses the clamping force [1].
"""

plate_joint = cache(PlateJoint.of)


def print_stiffness(_: argparse.Namespace) -> None:
    """Print the stiffness of the reduced joint over the stiffness of finite elements."""
    print_table_head("", "attached", *AXES)
    for attached in ATTACHMENTS:
        found, expected = stiffnesses(plate_joint(attached))
        print_table_row(f"`{attached}`", *(f"{x:.3f}" for x in found / expected))


def first_loading(joint: PlateJoint, count: int) -> Array:
    """Deviation (5, levels) [1] of the force from a joint with all compliances of `count` cells.

    Along x, y, z, about y, z; over the force of gross slip or opening.
    """
    states = joint_on_cells(joint, count)
    unit, rows = joint.load() / stiffnesses(joint)[0], []
    for axis in (0, 1, 2, 4, 5):
        motions = [level * unit * (np.arange(6) == axis) for level in LEVELS]
        expected = [states.rigid_displacement.T @ states.solve_forces(six) for six in motions]
        found = follow_motions(joint.spring, motions, joint.preload)
        rows.append([(-f[axis] - e[axis]) / joint.load()[axis] for f, e in zip(found, expected, strict=True)])
    return np.array(rows)


def print_first_loading(options: argparse.Namespace) -> None:
    """Print the largest deviation of the force on first loading."""
    print_table_head("", "attached", "along x", "along y", "along z", "about y", "about z")
    for attached in ATTACHMENTS[:2]:
        worst = np.max(np.abs(first_loading(plate_joint(attached), options.cells)), axis=1)
        print_table_row(f"`{attached}`", *(f"{x:.1%}" for x in worst))


def print_poles(_: argparse.Namespace) -> None:
    """Print the deviation of the force in gross slip about poles, over the friction limit."""
    joint = plate_joint("faces")
    deviations = pole_deviations(joint.spring, joint.preload, POLE_COUNT)
    print("{} poles: 95 % within {:.1%}, all within {:.1%}".format(POLE_COUNT, *deviations))


def print_closed_paths(options: argparse.Namespace) -> None:
    """Print the smallest work of closed paths over their heat, and how many paths the FMU refuses."""
    joint = plate_joint("faces")
    unit = joint.load() / stiffnesses(joint)[0]
    with tempfile.TemporaryDirectory() as folder:
        path = build_native_fmu("BoltedJoint", joint.file, Path(folder), "3")
        print(f"FMU {path.stat().st_size / 1e3:.0f} kB; {options.paths} closed paths")
        print_table_head("", "of the load", "steps", "refused", "least work over heat")
        with unpack_fmu(path) as (unpacked, description):
            for scale, steps in PATHS:
                rng, refused, least = np.random.default_rng(1), 0, np.inf
                for _ in range(options.paths):
                    a, b = scale * rng.uniform(-1.0, 1.0, (2, 6)) * unit
                    angles = np.linspace(0.0, 2.0 * np.pi, steps + 1)
                    motions = np.sin(angles)[:, None] * a + (1.0 - np.cos(angles))[:, None] * b
                    with open_instance(unpacked, description, path.name, []) as fmu:
                        try:
                            force = np.array(follow_in_fmu(fmu, motions, joint.preload))
                        except FMICallException:
                            refused += 1
                            continue
                    work = -0.5 * np.sum((force[1:, :6] + force[:-1, :6]) * np.diff(motions, axis=0))
                    least = min(least, work / force[-1, 6])
                print_table_row(f"{scale:g}", steps, refused, f"{least:.3f}" if steps >= MIN_STEPS else "")


def follow_in_fmu(fmu: FmuInstance, motions: Array, preload: float) -> list[list[float]]:
    """Forces, moments and heat of the FMU along motions (n, 6)."""
    fmu.enter_initialization()
    fmu.set_values({"preload": preload})
    fmu.fmu.exitInitializationMode()
    inputs, outputs, rows = (
        fmu.group_real_variables(MOTIONS),
        fmu.group_real_variables((*FORCES, "E_loss")),
        [],
    )
    for time, six in enumerate(motions):
        inputs.set_values(*six.tolist())
        fmu.do_step(float(time), 1.0)
        rows.append(outputs.get_values())
    return rows


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "stiffness": print_stiffness,
            "first-loading": print_first_loading,
            "poles": print_poles,
            "closed-paths": print_closed_paths,
        },
        options={
            "--cells": {"type": int, "default": 300, "help": "number of cells of the contact (default: 300)"},
            "--paths": {
                "type": int,
                "default": 1000,
                "help": "number of closed paths of each kind (default: 1000)",
            },
        },
    )
