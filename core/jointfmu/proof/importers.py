"""The importers that execute an experiment: fmpy, ecos, libcosim; each in a process of its own, see `worker`.

A step holds the inputs of its begin; outputs are read at its end.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Task:
    """An experiment, ready to be executed.

    fmu, folder : path of the FMU, and of the folder where it is unpacked
    settings : {variable: start value}
    times    : (n) communication points [s]
    inputs   : {variable: (n) values}
    outputs  : real variables that are read
    """

    fmu: str
    folder: str
    settings: Mapping[str, Any]
    times: Sequence[float]
    inputs: Mapping[str, Sequence[float]]
    outputs: Sequence[str]

    def given(self, i: int) -> dict[str, float]:
        """Inputs at a communication point."""
        return {name: values[i] for name, values in self.inputs.items()}

    @property
    def step(self) -> float:
        """The step [s], for importers that know one step only.

        Raises ValueError if steps differ or do not begin at zero.
        """
        if self.times[0] != 0.0:
            raise ValueError(f"begins at {self.times[0]:g} s, this importer begins at 0")
        size = (self.times[-1] - self.times[0]) / max(len(self.times) - 1, 1)
        if any(abs(time - i * size) > 1e-6 * size for i, time in enumerate(self.times)):
            raise ValueError("has steps of different size, this importer has one")
        return size


Rows = list[list[float] | None]
"""Outputs at each communication point; None where the importer does not show them."""
Execute = Callable[[Task, list[str]], Rows]
"""(task, messages, to which those of the FMU are added) -> outputs."""


def fmpy(task: Task, messages: list[str]) -> Rows:
    """By fmpy, FMI 2.0 and 3.0."""
    from .. import ramp

    description, variables = _description(task.fmu)
    references = [variables[name].valueReference for name in task.outputs]
    with ramp.slave(task.folder, description, messages, task.fmu) as slave:
        slave.begin(task.times[0])
        for name, value in {**task.settings, **task.given(0)}.items():
            slave.set(variables[name], value)
        slave.fmu.exitInitializationMode()
        rows: Rows = [slave.get(references)]
        for i, time in enumerate(task.times[:-1]):
            for name, value in task.given(i).items():
                slave.set(variables[name], value)
            slave.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=task.times[i + 1] - time)
            rows.append(slave.get(references))
    return rows


def start_values(task: Task, messages: list[str]) -> list[list[Any]]:
    """What the FMU starts the variables `task.outputs` of any type with, by fmpy; one row."""
    from .. import ramp

    description, variables = _description(task.fmu)
    with ramp.slave(task.folder, description, messages, task.fmu) as slave:
        slave.begin()
        return [[slave.read(variables[name]) for name in task.outputs]]


def ecos(task: Task, messages: list[str]) -> Rows:
    """By ecos, FMI 2.0 and 3.0; what an FMU refuses stands in its log only, see `worker`."""
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
    from ecospy.EcosParameterSet import EcosParameterSet

    size = task.step
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
        if not simulation.init(parameter_set="start"):
            raise RuntimeError(EcosLib.get_last_error())
        rows: Rows = [[simulation.get_real(f"fmu::{name}") for name in task.outputs]]
        for i in range(len(task.times) - 1):
            for name, value in task.given(i).items():
                simulation.set_real(f"fmu::{name}", value)
            simulation.step(1)
            rows.append([simulation.get_real(f"fmu::{name}") for name in task.outputs])
        simulation.terminate()
    return rows


def libcosim(task: Task, messages: list[str]) -> Rows:
    """By libcosim, FMI 2.0; it shows nothing before the first step, and counts time in nanoseconds."""
    from libcosimpy._internal import get_last_error_message
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

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
        if given := task.given(i):
            manipulator.slave_real_values(one, [reference[name] for name in given], list(given.values()))
        if not execution.step():
            raise RuntimeError(get_last_error_message())
        rows.append(list(observer.last_real_values(one, [reference[name] for name in task.outputs])))
    return rows


def _description(fmu: str) -> tuple[Any, dict[str, Any]]:
    from fmpy import read_model_description

    description = read_model_description(fmu, validate=False)
    return description, {v.name: v for v in description.modelVariables}


IMPORTERS: dict[str, Execute] = {"fmpy": fmpy, "ecos": ecos, "libcosim": libcosim}
PACKAGES = {"fmpy": "fmpy", "ecos": "ecospy", "libcosim": "libcosimpy"}
"""{importer: its package}."""
VERSIONS = {"fmpy": "23", "ecos": "23", "libcosim": "2"}
"""{importer: versions of FMI, first digits}; libcosim crashes on others."""
