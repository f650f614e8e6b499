"""A whole system run by an own master, of either kind, on its FMUs of FMI 2.0."""

from contextlib import ExitStack
from itertools import accumulate
from pathlib import Path

import numpy as np

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .master import Slave
from .ssp import MASTERS, Master, fmu_names, values
from .system import System, systems
from .wiring import lags, wires


def simulate(
    system: System,
    folder: Path,
    master: Master = MASTERS[0],
    step: float | None = None,
    stop: float | None = None,
) -> dict[str, Array]:
    """{COMPONENT.OUTPUT: values} of all outputs that are connected, and `time` [s].

    folder     : of the FMUs (FMI 2.0)
    master     : whether all components step side by side, or the joints after what moves them
    step, stop : [s]; None: those of the system

    Raises ValueError for an FMU that is missing or refuses.
    """
    step = system.interval if step is None else step
    count = round((system.stop_time if stop is None else stop) / step)
    signals, names, late = wires(system), fmu_names(system), lags(system)
    fed = {name: [w for w in signals if w.target == name] for name in system.components}
    read = {
        name: list(dict.fromkeys(w.output for w in signals if w.source == name)) for name in system.components
    }
    columns = [f"{name}.{output}" for name in read for output in read[name]]
    place = {column: k for k, column in enumerate(columns)}
    rows = np.empty((count + 1, len(columns)))
    with ExitStack() as opened:
        parts: dict[str, Slave] = {}
        for name, component in system.components.items():
            start = {key: entry.value for key, entry in values(component).items()}
            start |= dict.fromkeys(late.get(name, ()), master.lag)
            path = folder / f"{names[name]}.fmu"
            parts[name] = opened.enter_context(Slave(path, start, [w.input for w in fed[name]], read[name]))
        joints = [name for name, part in system.components.items() if part.file]
        others = [name for name in parts if name not in joints]
        at = {name: [place[f"{w.source}.{w.output}"] for w in fed[name]] for name in parts}
        ends = dict(zip(read, accumulate(len(outputs) for outputs in read.values()), strict=True))
        span = {name: slice(ends[name] - len(outputs), ends[name]) for name, outputs in read.items()}
        now = [0.0] * len(columns)

        def feed(group: list[str]) -> None:
            for name in group:
                parts[name].set(*[now[k] for k in at[name]])

        def look(group: list[str]) -> None:
            for name in group:
                now[span[name]] = parts[name].get()

        look(others)
        feed(joints)
        look(joints)
        rows[0] = now
        groups = [others, joints] if master.in_turn else [[*others, *joints]]
        for k in track_progress(range(count), f"run {system.name}", count):
            for group in groups:
                feed(group)
                for name in group:
                    parts[name].step(k * step, step)
                look(group)
            rows[k + 1] = now
    time = np.asarray(step * np.arange(count + 1), dtype=np.float64)
    return {"time": time} | {column: rows[:, k] for column, k in place.items()}


def arms(folder: Path) -> dict[str, tuple[System, dict[str, Array]]]:
    """The shipped systems that are arms, and what they do; `folder` has the FMUs (FMI 2.0)."""
    return {name: (one, simulate(one, folder)) for name, one in systems().items() if one.arm}
