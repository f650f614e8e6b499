"""What a system does over time: loads of its joints; of an arm also wind-up and the tip's error."""

from collections.abc import Mapping
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from jointfmu.joints import KINDS
from jointfmu.systems import System

from ..drawing import svg
from ..master import Array
from ..wiring import model_of, wires
from .figure import Figure

SIZE = (9.6, 4.0)
Run = Mapping[str, Array]
"""{COMPONENT.OUTPUT: values} and `time` [s]."""


def units(system: System) -> dict[str, str]:
    """{COMPONENT.OUTPUT: unit} of all outputs, and of `time`."""
    outputs = {
        f"{name}.{v.name}": v.unit for name, part in system.components.items() for v in model_of(part).outputs
    }
    return {"time": "s"} | outputs


def loads(system: System) -> dict[str, tuple[str, str]]:
    """{joint: (name of its output, unit)} of the force or torque on the body behind it."""
    found = {}
    for wire in wires(system):
        if wire.source in system.joints:
            variable = KINDS[system.joints[wire.source].kind].variables[wire.output]
            found[wire.source] = (f"{wire.source}.{wire.output}", variable.unit)
    return found


def windup(system: System, run: Run) -> tuple[Array, Array, Array]:
    """Of an arm: commanded angles and wind-up (times, axes) [rad], and the tip's error (times) [m], the
    distance between its place at the links' angles and at the commanded ones."""
    commanded, links = [], []
    for name in system.arm.names:
        drive = system.joints[f"{name}_drive"]
        assert drive.file
        commanded.append(run[f"{name}_motor.phi"] / drive.file.flat["ratio"])
        links.append(run[f"{name}_link.phi"])
    q, real = np.stack(commanded, axis=1), np.stack(links, axis=1)
    error = np.linalg.norm(system.arm.tip(real) - system.arm.tip(q), axis=1)
    return q, real - q, error


def draw(canvas: Canvas, system: System, run: Run) -> None:
    """Loads of the joints over time; of an arm wind-up and the tip's error beside them."""
    count = 3 if system.arm else 1
    axes = canvas.subplots(1, count, squeeze=False)[0]
    _draw_loads(axes[0], system, run)
    if system.arm:
        _, wound, error = windup(system, run)
        for name, values in zip(system.arm.names, wound.T, strict=True):
            axes[1].plot(run["time"], 1e3 * values, lw=1.0, label=name)
        axes[1].set_ylabel("wind-up [mrad]")
        axes[1].legend(fontsize=8)
        axes[2].plot(run["time"], 1e3 * error, lw=1.0)
        axes[2].set_ylabel("error of the tip [mm]")
        axes[2].set_ylim(bottom=0.0)
    for one in axes:
        one.set_xlabel("time [s]")
        one.set_xlim(run["time"][0], run["time"][-1])


def _draw_loads(axes: Axes, system: System, run: Run) -> None:
    shown = loads(system)
    for name, (output, _) in shown.items():
        axes.plot(run["time"], run[output], lw=1.0, label=name.removesuffix("_drive"))
    axes.set_ylabel(f"load [{' or '.join(dict.fromkeys(unit for _, unit in shown.values()))}]")
    axes.legend(fontsize=8)


def motions(runs: Mapping[str, tuple[System, Run]]) -> list[Figure]:
    """A figure for each arm."""
    return [_motion(system, run) for system, run in runs.values()]


def _motion(system: System, run: Run) -> Figure:
    _, wound, error = windup(system, run)
    (largest, worst) = np.max(np.abs(wound), axis=0), float(np.max(error))
    soft = system.arm.names[int(np.argmax(largest))]
    return Figure(
        f"In a system: the {system.name.replace('_', ' ')}",
        f"The motors turn from upright to the end of the motion within {system.arm.duration:g} s. Left: "
        "the torques of the drives on their links; middle: what the drives wind up; right: the distance of "
        f"the tip from where rigid drives would bring it, at most {1e3 * worst:.2f} mm, "
        f"{1e3 * error[-1]:.2f} mm at the end, under the weight. The {soft} winds up most, by "
        f"{1e3 * np.max(largest):.2f} mrad. Motion and weight of the rigid arm load the drives; that the "
        "wind-up of one moves the others is left out.",
        svg(partial(draw, system=system, run=run), SIZE),
    )
