"""Simulation of a system: co-simulation of its FMUs (FMI 2.0), or an arm by the equations of its one FMU."""

from contextlib import ExitStack
from itertools import accumulate
from pathlib import Path

import numpy as np

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .fit.compiled_system import CompiledSystem
from .fmu.assembly import assemble_system
from .master import Slave
from .ssp import MASTER_KINDS, MasterKind, find_fmu_names, list_archive_values
from .system import System, load_systems
from .wiring import find_lag_parameters, find_signals


def simulate_system(
    system: System,
    fmu_folder: Path,
    master_kind: MasterKind = MASTER_KINDS[0],
    communication_step: float | None = None,
    stop_time: float | None = None,
) -> dict[str, Array]:
    """Simulate a system; returns {COMPONENT.OUTPUT: values} of all connected outputs, and `time` [s].

    fmu_folder         : folder of the FMUs (FMI 2.0)
    master_kind        : parallel (all components step together) or sequential (joints step after the bodies)
    communication_step : communication step [s]; None: interval of the system
    stop_time          : stop time [s]; None: stop time of the system

    Raises ValueError if an FMU is missing or returns an error.
    """
    communication_step = system.output_interval if communication_step is None else communication_step
    count = round((system.stop_time if stop_time is None else stop_time) / communication_step)
    signals, names, lag_parameters = find_signals(system), find_fmu_names(system), find_lag_parameters(system)
    inputs = {name: [w for w in signals if w.target_component == name] for name in system.components}
    outputs_read = {
        name: list(dict.fromkeys(w.source_output for w in signals if w.source_component == name))
        for name in system.components
    }
    columns = [f"{name}.{output}" for name in outputs_read for output in outputs_read[name]]
    position = {column: k for k, column in enumerate(columns)}
    rows = np.empty((count + 1, len(columns)))
    with ExitStack() as stack:
        slaves: dict[str, Slave] = {}
        for name, component in system.components.items():
            start = {key: entry.parameter_value for key, entry in list_archive_values(component).items()}
            start |= dict.fromkeys(lag_parameters.get(name, ()), master_kind.force_lag_steps)
            path = fmu_folder / f"{names[name]}.fmu"
            input_names = [w.target_input for w in inputs[name]]
            slaves[name] = stack.enter_context(Slave(path, start, input_names, outputs_read[name]))
        joints = [name for name, component in system.components.items() if component.parameter_file]
        others = [name for name in slaves if name not in joints]
        sources = {
            name: [position[f"{w.source_component}.{w.source_output}"] for w in inputs[name]]
            for name in slaves
        }
        ends = dict(zip(outputs_read, accumulate(map(len, outputs_read.values())), strict=True))
        spans = {name: slice(ends[name] - len(outputs), ends[name]) for name, outputs in outputs_read.items()}
        current = [0.0] * len(columns)

        def set_inputs(component_names: list[str]) -> None:
            """Set the inputs of components from the outputs of the components connected to them."""
            for name in component_names:
                slaves[name].set_inputs(*[current[k] for k in sources[name]])

        def get_outputs(component_names: list[str]) -> None:
            """Read the outputs of components."""
            for name in component_names:
                current[spans[name]] = slaves[name].get_outputs()

        get_outputs(others)
        set_inputs(joints)
        get_outputs(joints)
        rows[0] = current
        groups = [others, joints] if master_kind.is_sequential else [[*others, *joints]]
        for k in track_progress(range(count), f"run {system.name}", count):
            for group in groups:
                set_inputs(group)
                for name in group:
                    slaves[name].do_step(k * communication_step, communication_step)
                get_outputs(group)
            rows[k + 1] = current
    time = np.asarray(communication_step * np.arange(count + 1), dtype=np.float64)
    return {"time": time} | {column: rows[:, k] for column, k in position.items()}


def simulate_arm(system: System) -> dict[str, Array]:
    """Simulate an arm with coupled links by the compiled equations of the system's FMU.

    Returns {COMPONENT.OUTPUT: values} of all connected outputs except loads, position of the tip `tip.x`,
    `tip.y`, `tip.z` [m], and `time` [s].

    Raises ValueError if the motion cannot be computed, and as `CompiledSystem`.
    """
    compiled = CompiledSystem(assemble_system(system))
    loads = {f"{name}_load" for name in system.arm.axis_names}
    names = dict.fromkeys(
        f"{s.source_component}.{s.source_output}"
        for s in find_signals(system)
        if s.source_component not in loads
    )
    names |= dict.fromkeys(f"tip.{x}" for x in "xyz")
    time = system.output_interval * np.arange(
        round(system.stop_time / system.output_interval) + 1, dtype=np.float64
    )
    rows = compiled.simulate({}, time, {}, [*names])
    return {"time": time} | dict(zip(names, rows.T, strict=True))


def simulate_arms() -> dict[str, tuple[System, dict[str, Array]]]:
    """Simulate the shipped systems that are arms, {name: (system, results)}."""
    return {name: (system, simulate_arm(system)) for name, system in load_systems().items() if system.arm}
