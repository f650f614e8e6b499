"""The importers that execute an experiment: fmpy, ecos, libcosim; each in a process of its own, see `worker`.

In co-simulation a step holds the inputs of its begin; outputs are read at its end.
"""

from collections.abc import Mapping
from typing import Any

from jointfmu_fmu_src.proof.standard import CO_SIMULATION, MODEL_EXCHANGE

from ..host import description, opened
from . import exchange
from .task import Execute, Rows, Task, reader


def fmpy(task: Task, messages: list[str]) -> Rows:
    """By fmpy, FMI 2.0 and 3.0."""
    with opened(task.folder, description(task.fmu), task.fmu, messages) as slave:
        slave.begin(task.times[0])
        slave.set({**task.settings, **task.given(0)})
        slave.fmu.exitInitializationMode()
        read = reader(slave, task.outputs)
        rows: Rows = [read()]
        for i, time in enumerate(task.times[:-1]):
            slave.set(task.given(i))
            slave.advance(time, task.times[i + 1] - time)
            rows.append(read())
    return rows


def start_values(task: Task, messages: list[str]) -> list[list[Any]]:
    """What the FMU starts the variables `task.outputs` of any type with, by fmpy; one row."""
    exchanged = task.interface == MODEL_EXCHANGE
    with opened(task.folder, description(task.fmu), task.fmu, messages, exchanged) as slave:
        slave.begin()
        return [[slave.value(name) for name in task.outputs]]


def ecos(task: Task, messages: list[str]) -> Rows:
    """By ecos, FMI 2.0 and 3.0; what an FMU refuses stands in its log only, see `worker`."""
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
    from ecospy.EcosParameterSet import EcosParameterSet

    size = task.step
    _known(task)
    EcosLib.set_log_level("debug")
    structure, start = EcosSimulationStructure(), EcosParameterSet()
    structure.add_model("fmu", task.fmu)
    for name, value in {**task.settings, **task.given(0)}.items():
        add = {bool: start.add_bool, int: start.add_int, str: start.add_string}.get(
            type(value), start.add_real
        )
        add(f"fmu::{name}", value)
    structure.add_parameter_set("start", start)
    with EcosSimulation(structure=structure, step_size=size) as simulation:
        short = {"real": "real", "integer": "integer", "boolean": "bool"}
        give = {name: getattr(simulation, f"set_{short[task.kinds[name]]}") for name in task.inputs}
        read = {name: getattr(simulation, f"get_{short[task.kinds[name]]}") for name in task.outputs}
        if not simulation.init(parameter_set="start"):
            raise RuntimeError(EcosLib.get_last_error())
        rows: Rows = [[float(get(f"fmu::{name}")) for name, get in read.items()]]
        for i in range(len(task.times) - 1):
            for name, value in task.given(i).items():
                give[name](f"fmu::{name}", value)
            simulation.step(1)
            rows.append([float(get(f"fmu::{name}")) for name, get in read.items()])
        simulation.terminate()
    return rows


def libcosim(task: Task, messages: list[str]) -> Rows:
    """By libcosim, FMI 2.0; it shows nothing before the first step, and counts time in nanoseconds."""
    from libcosimpy._internal import get_last_error_message
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    _known(task)
    nanoseconds = round(task.step * 1e9)
    if nanoseconds < 1 or abs(nanoseconds - task.step * 1e9) > 1e-3:
        raise ValueError(f"has a step of {task.step!r} s, libcosim takes whole nanoseconds")
    execution = CosimExecution.from_step_size(step_size=nanoseconds)
    one = execution.add_local_slave(CosimLocalSlave(fmu_path=task.fmu, instance_name="fmu"))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    if not (execution.add_observer(observer) and execution.add_manipulator(manipulator)):
        raise RuntimeError(get_last_error_message())
    reference = {v.name.decode(): v.reference for v in execution.slave_variables(one)}
    for name, value in {**task.settings, **task.given(0)}.items():
        kinds = {bool: "boolean", int: "integer", str: "string"}
        give = getattr(execution, f"{kinds.get(type(value), 'real')}_initial_value")
        if not give(one, reference[name], value):
            raise RuntimeError(f"{name} = {value!r}: {get_last_error_message()}")
    rows: Rows = [None]
    for i in range(len(task.times) - 1):
        given = task.given(i)
        for kind in set(task.kinds.values()):
            if chosen := [name for name in given if task.kinds[name] == kind]:
                give = getattr(manipulator, f"slave_{kind}_values")
                give(one, [reference[name] for name in chosen], [given[name] for name in chosen])
        if not execution.step():
            raise RuntimeError(get_last_error_message())
        row: dict[str, float] = {}
        for kind in set(task.kinds.values()):
            if chosen := [name for name in task.outputs if task.kinds[name] == kind]:
                read = getattr(observer, f"last_{kind}_values")
                row |= zip(chosen, map(float, read(one, [reference[name] for name in chosen])), strict=True)
        rows.append([row[name] for name in task.outputs])
    return rows


def load(importer: str) -> None:
    """Load the library of an importer; raises ImportError or OSError if a library is missing."""
    if importer == "ecos":
        from ecospy import EcosSimulationStructure

        EcosSimulationStructure()
    elif importer == "libcosim":
        from libcosimpy.CosimExecution import CosimExecution

        CosimExecution.from_step_size(step_size=1e9)


def _known(task: Task) -> None:
    """Raise ValueError for a variable of a type that ecos leaves as it is and libcosim does not list."""
    variables = {v.name: v for v in description(task.fmu).modelVariables}
    for name in (*task.settings, *task.inputs, *task.outputs):
        if variables[name].type in ("Enumeration", "Int64"):
            raise ValueError(f"{name} is of type {variables[name].type}, which this importer does not take")


IMPORTERS: Mapping[str, Mapping[str, Execute]] = {
    "fmpy": {CO_SIMULATION: fmpy, MODEL_EXCHANGE: exchange.fmpy},
    "ecos": {CO_SIMULATION: ecos},
    "libcosim": {CO_SIMULATION: libcosim},
}
"""{importer: {interface: what executes an experiment}}."""
PACKAGES = {"fmpy": "fmpy", "ecos": "ecospy", "libcosim": "libcosimpy"}
"""{importer: its package}."""
SYSTEM_LIBRARIES = {"ecos": "libtbb12", "libcosim": "libatomic1"}
"""{importer: package of Debian with a library that the importer loads}."""
VERSIONS = {"fmpy": "23", "ecos": "23", "libcosim": "2"}
"""{importer: versions of FMI, first digits}; libcosim crashes on others."""


def interfaces(importer: str) -> list[str]:
    """Interfaces in which an importer runs FMUs here: fmpy has its solver not for every platform."""
    return [name for name in IMPORTERS[importer] if name != MODEL_EXCHANGE or exchange.available()]
