"""Plots of a robot with elastic axes: frequencies over poses, wind-up and tip error over payload, ringing."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array

from ...common import plots
from .elastic import ElasticAxis
from .poses import Ringing, compute_frequencies, compute_weight_deflection, compute_weight_torques

if TYPE_CHECKING:
    from mujoco import MjModel

ANGLES_PER_GRID_AXIS = 21
"""Number of angles of each axis in the grid of poses [1]."""
PAYLOAD_POINT_COUNT = 11
"""Number of payloads on the axis of the plot [1]."""
FIGURE_SIZE = (9.0, 3.8)
"""Width and height of a figure [inch]."""
RINGING_PANEL_HEIGHT = 1.4
"""Height of the panel of one axis in the picture of the ringing [inch]."""
MAX_CHANGE_OF_CONSTANT_FREQUENCY = 1e-6
"""Relative change [1] of a frequency over the poses below which it is drawn as constant: it is rounding."""
MIN_WEIGHT_OVER_RATED_TORQUE = 1e-9
"""Weight torque over the rated torque [1] below which an axis counts as not loaded: it is rounding."""


def select_grid_axes(robot_axes: Sequence[ElasticAxis]) -> Sequence[ElasticAxis]:
    """Axes of the pose grid: the second and third of an arm, which change weight torques and inertia most.

    An arm with two axes or one: all of them.
    """
    return robot_axes[1:3] if len(robot_axes) > 2 else robot_axes[-2:]


def list_grid_angles(robot_model: "MjModel", robot_axis: ElasticAxis) -> Array:
    """Angles [rad] of an axis in the grid of poses, over its range; a full turn for an unlimited axis."""
    joint = robot_model.joint(robot_axis.joint_name)
    low, high = robot_model.jnt_range[joint.id] if robot_model.jnt_limited[joint.id] else (-np.pi, np.pi)
    return np.linspace(low, high, ANGLES_PER_GRID_AXIS)


def compute_frequencies_over_grid(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
) -> tuple[list[Array], Array]:
    """Angles [rad] of the grid axes, and natural frequencies (..., n) [Hz] at each pose of the grid.

    The joints outside the grid keep their position in `robot_pose`.
    """
    grid = [list_grid_angles(robot_model, axis) for axis in select_grid_axes(robot_axes)]
    poses = list_grid_poses(robot_model, robot_axes, robot_pose, grid)
    rows = [
        compute_frequencies(robot_model, robot_axes, grid_pose, payload_mass, tip_body) for grid_pose in poses
    ]
    return grid, np.reshape(rows, (*map(len, grid), len(robot_axes)))


def list_grid_poses(
    robot_model: "MjModel", robot_axes: Sequence[ElasticAxis], robot_pose: Array, grid_angles: list[Array]
) -> Array:
    """Poses (k, n) of the robot on the grid; the last grid axis varies fastest.

    Joints outside the grid keep their position in `robot_pose`.
    """
    indices = [int(robot_model.joint(axis.joint_name).qposadr[0]) for axis in select_grid_axes(robot_axes)]
    mesh = np.stack(np.meshgrid(*grid_angles, indexing="ij"), axis=-1).reshape(-1, len(grid_angles))
    poses = np.tile(robot_pose, (len(mesh), 1))
    poses[:, indices] = mesh
    return poses


def find_worst_pose(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    grid_angles: list[Array],
    payload_mass: float,
    tip_body: int,
) -> Array:
    """Pose of the grid with the largest tip displacement under weight.

    Displacements that differ by less than 1 nm count as equal. Of several such
    poses: the one nearest to `robot_pose`. Joints outside the grid keep `robot_pose`.
    """
    poses = sorted(
        list_grid_poses(robot_model, robot_axes, robot_pose, grid_angles),
        key=lambda grid_pose: round(float(np.linalg.norm(grid_pose - robot_pose)), 9),
    )
    return max(
        poses,
        key=lambda grid_pose: round(
            compute_weight_deflection(robot_model, robot_axes, grid_pose, payload_mass, tip_body)[1], 9
        ),
    )


def compute_largest_torques(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    grid_angles: list[Array],
    payload_mass: float,
    tip_body: int,
) -> Array:
    """Largest magnitude (n) [N.m] of the weight torque of each axis, over the poses of the grid."""
    poses = list_grid_poses(robot_model, robot_axes, robot_pose, grid_angles)
    torques = [
        compute_weight_torques(robot_model, robot_axes, grid_pose, payload_mass, tip_body)[0]
        for grid_pose in poses
    ]
    return np.asarray(np.max(np.abs(torques), axis=0))


def is_loaded_by_weight(robot_axis: ElasticAxis, weight_torque: float) -> bool:
    """Whether a weight torque [N.m] of an axis is more than rounding."""
    return abs(weight_torque) > MIN_WEIGHT_OVER_RATED_TORQUE * robot_axis.drive.rated_torque


def draw_frequencies(
    picture_path: Path,
    robot_axes: Sequence[ElasticAxis],
    grid_angles: list[Array],
    natural_frequencies: Array,
) -> None:
    """Plot the lowest two natural frequencies over the pose grid."""
    names = [axis.joint_name for axis in select_grid_axes(robot_axes)]
    with plots.open_figure(picture_path, FIGURE_SIZE) as figure:
        for i in range(min(2, natural_frequencies.shape[-1])):
            panel = figure.add_subplot(1, min(2, natural_frequencies.shape[-1]), i + 1)
            panel.set(title=f"frequency {i + 1} [Hz]", xlabel=f"{names[0]} [deg]")
            values = natural_frequencies[..., i]
            mean = float(np.mean(values))
            if np.ptp(values) <= MAX_CHANGE_OF_CONSTANT_FREQUENCY * mean:
                panel.set_title(f"frequency {i + 1}: {mean:.4g} Hz in all poses")
                values = np.full_like(values, mean)
            if len(grid_angles) == 1:
                panel.plot(np.rad2deg(grid_angles[0]), values, color=plots.BLUE)
                panel.set(ylabel="frequency [Hz]", ylim=(0.0, 1.1 * float(np.max(values))))
                continue
            levels = 12 if np.ptp(values) else [0.99 * mean, 1.01 * mean]
            filled = panel.contourf(*map(np.rad2deg, grid_angles), values.T, levels=levels, cmap="viridis")
            figure.colorbar(filled, ax=panel)
            panel.set_ylabel(f"{names[1]} [deg]")


def draw_deflection_over_payload(
    picture_path: Path,
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
) -> tuple[Array, float]:
    """Plot wind-ups and tip error against payload; returns their values (n) [rad] and [m] at full payload."""
    loads = np.linspace(0.0, payload_mass, PAYLOAD_POINT_COUNT)
    rows = [
        compute_weight_deflection(robot_model, robot_axes, robot_pose, float(load), tip_body)
        for load in loads
    ]
    weights = compute_weight_torques(robot_model, robot_axes, robot_pose, payload_mass, tip_body)[0].tolist()
    with plots.open_figure(picture_path, FIGURE_SIZE) as figure:
        wind_up_axes, error_axes = figure.subplots(1, 2)
        if not any(map(is_loaded_by_weight, robot_axes, weights)):
            for axes_of_panel, quantity in ((wind_up_axes, "wind-up"), (error_axes, "tip error")):
                axes_of_panel.set_axis_off()
                text = f"no {quantity}: weight and payload\ndo not load the drives in this pose"
                axes_of_panel.text(0.5, 0.5, text, ha="center", va="center", fontsize=12)
            return rows[-1]
        for axis, line in zip(robot_axes, np.array([x for x, _ in rows]).T, strict=True):
            wind_up_axes.plot(loads, 1e3 * line, label=axis.joint_name)
        wind_up_axes.set(xlabel="payload [kg]", ylabel="wind-up [mrad]")
        wind_up_axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        error_axes.plot(loads, [1e3 * error for _, error in rows], color=plots.RED)
        error_axes.set(xlabel="payload [kg]", ylabel="tip error [mm]", ylim=(0.0, None))
    return rows[-1]


def draw_ringing(
    picture_path: Path, robot_axes: Sequence[ElasticAxis], ringing_results: Sequence[Ringing]
) -> None:
    """Plot the distance of the tip from its position at rest, after the stop of each motor."""
    height = RINGING_PANEL_HEIGHT * len(robot_axes) + 0.6
    with plots.open_figure(picture_path, (FIGURE_SIZE[0], height)) as figure:
        panels = figure.subplots(len(robot_axes), 1, sharex=True, squeeze=False).ravel()
        for panel, axis, result in zip(panels, robot_axes, ringing_results, strict=True):
            panel.plot(result.times_after_stop, 1e3 * result.tip_distance, color=plots.BLUE, linewidth=1.0)
            panel.set_title(f"stop of {axis.joint_name}", fontsize=8)
            panel.set_ylim(0.0, None)
        panels[-1].set_xlabel("time after the stop [s]")
        figure.supylabel("distance of the tip from rest [mm]", fontsize=10)
