"""Importers that execute an experiment: fmpy, ecos and libcosim; each in a process of its own, see `worker`.

In co-simulation the inputs are constant during a step, with their values at its start. Outputs are read at
the end of the step.
"""

from collections.abc import Mapping
from typing import Any

from jointfmu_fmu_src.proof.standard import CO_SIMULATION, MODEL_EXCHANGE

from ..host import open_instance, read_description
from . import exchange
from .task import ExecuteFunction, ExperimentTask, OutputRows, make_output_reader


def run_fmpy(experiment_task: ExperimentTask, fmu_messages: list[str]) -> OutputRows:
    """Execute an experiment for co-simulation in fmpy (FMI 2.0 and 3.0).

    Returns the outputs at all communication points.

    fmu_messages : list to which the warnings and errors of the FMU are appended
    """
    with open_instance(
        experiment_task.fmu_folder,
        read_description(experiment_task.fmu_path),
        experiment_task.fmu_path,
        fmu_messages,
    ) as slave:
        slave.enter_initialization(experiment_task.communication_points[0])
        slave.set_values({**experiment_task.start_values, **experiment_task.inputs_at(0)})
        slave.fmu.exitInitializationMode()
        read = make_output_reader(slave, experiment_task.output_names)
        rows: OutputRows = [read()]
        for i, time in enumerate(experiment_task.communication_points[:-1]):
            slave.set_values(experiment_task.inputs_at(i))
            slave.do_step(time, experiment_task.communication_points[i + 1] - time)
            rows.append(read())
    return rows


def read_start_values(experiment_task: ExperimentTask, fmu_messages: list[str]) -> list[list[Any]]:
    """Read the start values of the variables `experiment_task.output_names` in fmpy: one row."""
    exchanged = experiment_task.fmi_interface == MODEL_EXCHANGE
    with open_instance(
        experiment_task.fmu_folder,
        read_description(experiment_task.fmu_path),
        experiment_task.fmu_path,
        fmu_messages,
        exchanged,
    ) as slave:
        slave.enter_initialization()
        return [[slave.get_value(name) for name in experiment_task.output_names]]


def run_ecos(experiment_task: ExperimentTask, fmu_messages: list[str]) -> OutputRows:
    """Execute an experiment for co-simulation in ecos (FMI 2.0 and 3.0).

    Returns the outputs at all communication points. Errors of the FMU appear only in the log of ecos.
    """
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
    from ecospy.EcosParameterSet import EcosParameterSet

    size = experiment_task.step_size
    _check_variable_types(experiment_task)
    EcosLib.set_log_level("debug")
    structure, start = EcosSimulationStructure(), EcosParameterSet()
    structure.add_model("fmu", experiment_task.fmu_path)
    for name, value in {**experiment_task.start_values, **experiment_task.inputs_at(0)}.items():
        add = {bool: start.add_bool, int: start.add_int, str: start.add_string}.get(
            type(value), start.add_real
        )
        add(f"fmu::{name}", value)
    structure.add_parameter_set("start", start)
    with EcosSimulation(structure=structure, step_size=size) as simulation:
        suffixes = {"real": "real", "integer": "integer", "boolean": "bool"}
        setters = {
            name: getattr(simulation, f"set_{suffixes[experiment_task.variable_data_types[name]]}")
            for name in experiment_task.input_values
        }
        getters = {
            name: getattr(simulation, f"get_{suffixes[experiment_task.variable_data_types[name]]}")
            for name in experiment_task.output_names
        }
        if not simulation.init(parameter_set="start"):
            raise RuntimeError(EcosLib.get_last_error())
        rows: OutputRows = [[float(get(f"fmu::{name}")) for name, get in getters.items()]]
        for i in range(len(experiment_task.communication_points) - 1):
            for name, value in experiment_task.inputs_at(i).items():
                setters[name](f"fmu::{name}", value)
            simulation.step(1)
            rows.append([float(get(f"fmu::{name}")) for name, get in getters.items()])
        simulation.terminate()
    return rows


def run_libcosim(experiment_task: ExperimentTask, fmu_messages: list[str]) -> OutputRows:
    """Execute an experiment for co-simulation in libcosim (FMI 2.0).

    Returns the outputs at all communication points; the first row is None, as libcosim gives no outputs
    before the first step. Its step size is a whole number of nanoseconds.
    """
    from libcosimpy._internal import get_last_error_message
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    _check_variable_types(experiment_task)
    nanoseconds = round(experiment_task.step_size * 1e9)
    if nanoseconds < 1 or abs(nanoseconds - experiment_task.step_size * 1e9) > 1e-3:
        raise ValueError(f"its step is {experiment_task.step_size!r} s, libcosim takes whole nanoseconds")
    execution = CosimExecution.from_step_size(step_size=nanoseconds)
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=experiment_task.fmu_path, instance_name="fmu"))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    if not (execution.add_observer(observer) and execution.add_manipulator(manipulator)):
        raise RuntimeError(get_last_error_message())
    reference = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
    for name, value in {**experiment_task.start_values, **experiment_task.inputs_at(0)}.items():
        kinds = {bool: "boolean", int: "integer", str: "string"}
        setter = getattr(execution, f"{kinds.get(type(value), 'real')}_initial_value")
        if not setter(slave, reference[name], value):
            raise RuntimeError(f"{name} = {value!r}: {get_last_error_message()}")
    rows: OutputRows = [None]
    for i in range(len(experiment_task.communication_points) - 1):
        inputs = experiment_task.inputs_at(i)
        for kind in set(experiment_task.variable_data_types.values()):
            if names := [name for name in inputs if experiment_task.variable_data_types[name] == kind]:
                setter = getattr(manipulator, f"slave_{kind}_values")
                setter(slave, [reference[name] for name in names], [inputs[name] for name in names])
        if not execution.step():
            raise RuntimeError(get_last_error_message())
        row: dict[str, float] = {}
        for kind in set(experiment_task.variable_data_types.values()):
            if names := [
                name
                for name in experiment_task.output_names
                if experiment_task.variable_data_types[name] == kind
            ]:
                getter = getattr(observer, f"last_{kind}_values")
                row |= zip(names, map(float, getter(slave, [reference[name] for name in names])), strict=True)
        rows.append([row[name] for name in experiment_task.output_names])
    return rows


def load_importer(importer_name: str) -> None:
    """Load the library of an importer; ImportError or OSError if it is missing."""
    if importer_name == "ecos":
        from ecospy import EcosSimulationStructure

        EcosSimulationStructure()
    elif importer_name == "libcosim":
        from libcosimpy.CosimExecution import CosimExecution

        CosimExecution.from_step_size(step_size=1e9)


def _check_variable_types(experiment_task: ExperimentTask) -> None:
    """Raise ValueError if a variable is an Enumeration or Int64: ecos and libcosim do not support them."""
    variables = {v.name: v for v in read_description(experiment_task.fmu_path).modelVariables}
    for name in (*experiment_task.start_values, *experiment_task.input_values, *experiment_task.output_names):
        if variables[name].type in ("Enumeration", "Int64"):
            raise ValueError(
                f"{name} is of type {variables[name].type}, which this importer does not take; use fmpy"
            )


IMPORTERS: Mapping[str, Mapping[str, ExecuteFunction]] = {
    "fmpy": {CO_SIMULATION: run_fmpy, MODEL_EXCHANGE: exchange.run_fmpy_model_exchange},
    "ecos": {CO_SIMULATION: run_ecos},
    "libcosim": {CO_SIMULATION: run_libcosim},
}
"""{importer: {interface: function that executes an experiment}}."""
PYTHON_PACKAGES_OF_IMPORTERS = {"fmpy": "fmpy", "ecos": "ecospy", "libcosim": "libcosimpy"}
"""{importer: Python package}."""
DEBIAN_PACKAGES_OF_IMPORTERS = {"ecos": "libtbb12", "libcosim": "libatomic1"}
"""{importer: Debian package of a library that the importer loads}."""
SUPPORTED_FMI_VERSIONS = {"fmpy": "23", "ecos": "23", "libcosim": "2"}
"""{importer: major versions of FMI that it supports}; libcosim crashes with other versions."""


def list_supported_interfaces(importer_name: str) -> list[str]:
    """FMI interfaces (co-simulation, model exchange) that an importer supports on this platform.

    Model exchange needs the solver of fmpy.
    """
    return [
        name for name in IMPORTERS[importer_name] if name != MODEL_EXCHANGE or exchange.has_cvode_solver()
    ]
