"""Pictures of a robot with elastic axes: lowest frequency over poses, wind-up and tip error over payload."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array

from .. import plots
from .elastic import ElasticAxis
from .poses import frequencies, sag

if TYPE_CHECKING:
    from mujoco import MjModel

POINTS, LOADS = 21, 11
"""Angles of an axis in the grid, and payloads."""
SIZE = (9.0, 3.8)
"""[inch]."""


def swept(axes: Sequence[ElasticAxis]) -> Sequence[ElasticAxis]:
    """The axes of the grid: the second and the third of an arm, whose weight and inertia turn most with them;
    of fewer the last ones.
    """
    return axes[1:3] if len(axes) > 2 else axes[-2:]


def angles(model: "MjModel", axis: ElasticAxis) -> Array:
    """Angles (POINTS) [rad] over the range of an axis, a whole turn without limits."""
    joint = model.joint(axis.joint)
    low, high = model.jnt_range[joint.id] if model.jnt_limited[joint.id] else (-np.pi, np.pi)
    return np.linspace(low, high, POINTS)


def over_poses(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> tuple[list[Array], Array]:
    """Angles [rad] of the swept axes, and all frequencies (..., n) [Hz] over their grid; the others stay."""
    grid = [angles(model, axis) for axis in swept(axes)]
    poses = turned(model, axes, pose, grid)
    found = [frequencies(model, axes, one, payload, tip) for one in poses]
    return grid, np.reshape(found, (*map(len, grid), len(axes)))


def turned(model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, grid: list[Array]) -> Array:
    """Poses (k, n) of the whole grid of the swept axes, the last one fastest; the other joints stay."""
    places = [int(model.joint(axis.joint).qposadr[0]) for axis in swept(axes)]
    mesh = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, len(grid))
    poses = np.tile(pose, (len(mesh), 1))
    poses[:, places] = mesh
    return poses


def lowest(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, grid: list[Array], payload: float, tip: int
) -> Array:
    """The pose of the grid at which the tip sinks most, to 1 nm, and of such poses the nearest to the given
    one; the other joints stay."""
    poses = sorted(
        turned(model, axes, pose, grid), key=lambda one: round(float(np.linalg.norm(one - pose)), 9)
    )
    return max(poses, key=lambda one: round(sag(model, axes, one, payload, tip)[1], 9))


def draw_frequencies(path: Path, axes: Sequence[ElasticAxis], grid: list[Array], found: Array) -> None:
    """The lowest two frequencies over the grid."""
    names = [axis.joint for axis in swept(axes)]
    with plots.drawing(path, SIZE) as figure:
        for i in range(min(2, found.shape[-1])):
            panel = figure.add_subplot(1, min(2, found.shape[-1]), i + 1)
            panel.set(title=f"frequency {i + 1} [Hz]", xlabel=f"{names[0]} [deg]")
            if len(grid) == 1:
                panel.plot(np.rad2deg(grid[0]), found[:, i], color=plots.BLUE)
                continue
            filled = panel.contourf(*map(np.rad2deg, grid), found[..., i].T, levels=12, cmap="viridis")
            figure.colorbar(filled, ax=panel)
            panel.set_ylabel(f"{names[1]} [deg]")


def draw_payload(
    path: Path, model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> tuple[Array, float]:
    """Wind-ups and tip error up to a payload; what they are there, [rad] (n) and [m]."""
    loads = np.linspace(0.0, payload, LOADS)
    rows = [sag(model, axes, pose, float(load), tip) for load in loads]
    with plots.drawing(path, SIZE) as figure:
        wound, moved = figure.subplots(1, 2)
        for axis, line in zip(axes, np.array([x for x, _ in rows]).T, strict=True):
            wound.plot(loads, 1e3 * line, label=axis.joint)
        wound.set(xlabel="payload [kg]", ylabel="wind-up [mrad]")
        wound.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        moved.plot(loads, [1e3 * error for _, error in rows], color=plots.RED)
        moved.set(xlabel="payload [kg]", ylabel="tip error [mm]", ylim=(0.0, None))
    return rows[-1]
