"""Importers that execute an experiment: fmpy, ecos and libcosim; each in a process of its own, see `worker`.

In co-simulation the inputs are constant during a step, with their values at its start. Outputs are read at
the end of the step.
"""

from collections.abc import Mapping
from typing import Any

from jointfmu_fmu_src.proof.standard import CO_SIMULATION, MODEL_EXCHANGE

from ..host import open_instance, read_description
from . import exchange
from .task import ExecuteFunction, Rows, Task, make_output_reader


def run_fmpy(task: Task, messages: list[str]) -> Rows:
    """Execute an experiment for co-simulation in fmpy (FMI 2.0 and 3.0).

    messages : list to which the warnings and errors of the FMU are appended
    """
    with open_instance(task.folder, read_description(task.fmu), task.fmu, messages) as slave:
        slave.enter_initialization(task.times[0])
        slave.set_values({**task.settings, **task.inputs_at(0)})
        slave.fmu.exitInitializationMode()
        read = make_output_reader(slave, task.outputs)
        rows: Rows = [read()]
        for i, time in enumerate(task.times[:-1]):
            slave.set_values(task.inputs_at(i))
            slave.do_step(time, task.times[i + 1] - time)
            rows.append(read())
    return rows


def read_start_values(task: Task, messages: list[str]) -> list[list[Any]]:
    """Read the start values of the variables `task.outputs`, of any type, in fmpy: one row."""
    exchanged = task.interface == MODEL_EXCHANGE
    with open_instance(task.folder, read_description(task.fmu), task.fmu, messages, exchanged) as slave:
        slave.enter_initialization()
        return [[slave.get_value(name) for name in task.outputs]]


def run_ecos(task: Task, messages: list[str]) -> Rows:
    """Execute an experiment for co-simulation in ecos (FMI 2.0 and 3.0).

    Errors of the FMU appear only in the log of ecos, see `worker`.
    """
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
    from ecospy.EcosParameterSet import EcosParameterSet

    size = task.step
    _check_types(task)
    EcosLib.set_log_level("debug")
    structure, start = EcosSimulationStructure(), EcosParameterSet()
    structure.add_model("fmu", task.fmu)
    for name, value in {**task.settings, **task.inputs_at(0)}.items():
        add = {bool: start.add_bool, int: start.add_int, str: start.add_string}.get(
            type(value), start.add_real
        )
        add(f"fmu::{name}", value)
    structure.add_parameter_set("start", start)
    with EcosSimulation(structure=structure, step_size=size) as simulation:
        suffixes = {"real": "real", "integer": "integer", "boolean": "bool"}
        setters = {
            name: getattr(simulation, f"set_{suffixes[task.variable_kinds[name]]}") for name in task.inputs
        }
        getters = {
            name: getattr(simulation, f"get_{suffixes[task.variable_kinds[name]]}") for name in task.outputs
        }
        if not simulation.init(parameter_set="start"):
            raise RuntimeError(EcosLib.get_last_error())
        rows: Rows = [[float(get(f"fmu::{name}")) for name, get in getters.items()]]
        for i in range(len(task.times) - 1):
            for name, value in task.inputs_at(i).items():
                setters[name](f"fmu::{name}", value)
            simulation.step(1)
            rows.append([float(get(f"fmu::{name}")) for name, get in getters.items()])
        simulation.terminate()
    return rows


def run_libcosim(task: Task, messages: list[str]) -> Rows:
    """Execute an experiment for co-simulation in libcosim (FMI 2.0).

    libcosim gives no outputs before the first step: the first row is None. Its step size is a whole number of
    nanoseconds.
    """
    from libcosimpy._internal import get_last_error_message
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    _check_types(task)
    nanoseconds = round(task.step * 1e9)
    if nanoseconds < 1 or abs(nanoseconds - task.step * 1e9) > 1e-3:
        raise ValueError(f"has a step of {task.step!r} s, libcosim takes whole nanoseconds")
    execution = CosimExecution.from_step_size(step_size=nanoseconds)
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=task.fmu, instance_name="fmu"))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    if not (execution.add_observer(observer) and execution.add_manipulator(manipulator)):
        raise RuntimeError(get_last_error_message())
    reference = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
    for name, value in {**task.settings, **task.inputs_at(0)}.items():
        kinds = {bool: "boolean", int: "integer", str: "string"}
        setter = getattr(execution, f"{kinds.get(type(value), 'real')}_initial_value")
        if not setter(slave, reference[name], value):
            raise RuntimeError(f"{name} = {value!r}: {get_last_error_message()}")
    rows: Rows = [None]
    for i in range(len(task.times) - 1):
        inputs = task.inputs_at(i)
        for kind in set(task.variable_kinds.values()):
            if names := [name for name in inputs if task.variable_kinds[name] == kind]:
                setter = getattr(manipulator, f"slave_{kind}_values")
                setter(slave, [reference[name] for name in names], [inputs[name] for name in names])
        if not execution.step():
            raise RuntimeError(get_last_error_message())
        row: dict[str, float] = {}
        for kind in set(task.variable_kinds.values()):
            if names := [name for name in task.outputs if task.variable_kinds[name] == kind]:
                getter = getattr(observer, f"last_{kind}_values")
                row |= zip(names, map(float, getter(slave, [reference[name] for name in names])), strict=True)
        rows.append([row[name] for name in task.outputs])
    return rows


def load_importer(importer: str) -> None:
    """Load the library of an importer; ImportError or OSError if it is missing."""
    if importer == "ecos":
        from ecospy import EcosSimulationStructure

        EcosSimulationStructure()
    elif importer == "libcosim":
        from libcosimpy.CosimExecution import CosimExecution

        CosimExecution.from_step_size(step_size=1e9)


def _check_types(task: Task) -> None:
    """Raise ValueError if a variable is an Enumeration or Int64: ecos and libcosim do not support them."""
    variables = {v.name: v for v in read_description(task.fmu).modelVariables}
    for name in (*task.settings, *task.inputs, *task.outputs):
        if variables[name].type in ("Enumeration", "Int64"):
            raise ValueError(f"{name} is of type {variables[name].type}, which this importer does not take")


IMPORTERS: Mapping[str, Mapping[str, ExecuteFunction]] = {
    "fmpy": {CO_SIMULATION: run_fmpy, MODEL_EXCHANGE: exchange.run_fmpy_exchange},
    "ecos": {CO_SIMULATION: run_ecos},
    "libcosim": {CO_SIMULATION: run_libcosim},
}
"""{importer: {interface: function that executes an experiment}}."""
IMPORTER_PACKAGES = {"fmpy": "fmpy", "ecos": "ecospy", "libcosim": "libcosimpy"}
"""{importer: Python package}."""
SYSTEM_LIBRARIES = {"ecos": "libtbb12", "libcosim": "libatomic1"}
"""{importer: Debian package of a library that the importer loads}."""
FMI_VERSIONS = {"fmpy": "23", "ecos": "23", "libcosim": "2"}
"""{importer: major versions of FMI that it supports}; libcosim crashes with other versions."""


def list_interfaces(importer: str) -> list[str]:
    """FMI interfaces that an importer supports on this platform; model exchange needs the solver of fmpy."""
    return [name for name in IMPORTERS[importer] if name != MODEL_EXCHANGE or exchange.has_solver()]
