"""What a system does over time: loads of its joints; of an arm also wind-up and the tip's error."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure as Canvas

from jointfmu.joints import KINDS
from jointfmu.quantity import Array

from ..systems.system import System
from ..systems.wiring import model_of, wires
from .figure import Figure, Panel, Series, drawn

SIZE = (11.4, 3.8)
_THIN = 20
"""Points of a run from one that is drawn to the next."""
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


def panels(system: System, run: Run) -> list[Panel]:
    """Loads of the joints over time; of an arm wind-up and the tip's error beside them."""
    time, over = run["time"][::_THIN], "time [s]"
    shown = loads(system)
    unit = " or ".join(dict.fromkeys(unit for _, unit in shown.values()))
    carried = [
        Series(name.removesuffix("_drive"), time, run[output][::_THIN]) for name, (output, _) in shown.items()
    ]
    found = [Panel("Loads of the joints", over, f"load [{unit}]", carried)]
    if system.arm:
        _, wound, error = windup(system, run)
        turned = [
            Series(name, time, 1e3 * values[::_THIN])
            for name, values in zip(system.arm.names, wound.T, strict=True)
        ]
        found.append(Panel("Wind-up of the drives", over, "wind-up [mrad]", turned))
        tip = [Series("tip", time, 1e3 * error[::_THIN])]
        found.append(Panel("Error of the tip", over, "error [mm]", tip))
    return found


def draw(canvas: Canvas, system: System, run: Run) -> None:
    """The same as a picture."""
    drawn(canvas, panels(system, run))


def motions(runs: Mapping[str, tuple[System, Run]], joint: str) -> list[Figure]:
    """A figure for each arm with such joints."""
    return [
        _motion(system, run)
        for system, run in runs.values()
        if joint in {part.kind for part in system.joints.values()}
    ]


def _motion(system: System, run: Run) -> Figure:
    _, wound, error = windup(system, run)
    (largest, worst) = np.max(np.abs(wound), axis=0), float(np.max(error))
    soft = system.arm.names[int(np.argmax(largest))]
    return Figure(
        f"In a system: the {system.name.replace('_', ' ')}",
        f"The motors turn from upright to the end of the motion within {system.arm.duration:g} s. Torques of "
        "the drives on their links; what the drives wind up; distance of the tip from where rigid drives "
        f"would bring it, at most {1e3 * worst:.2f} mm, {1e3 * error[-1]:.2f} mm at the end, under the "
        f"weight. The {soft} winds up most, by {1e3 * np.max(largest):.2f} mrad. Motion and weight of the "
        "rigid arm load the drives; that the wind-up of one moves the others is left out.",
        panels(system, run),
    )
