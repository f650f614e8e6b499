"""Model exchange in fmpy: its CVode leads an FMU through continuous time, with events of all kinds.

Between two communication points inputs go along straight lines. An event is where one jumps, at a time that
the FMU announces, where an indicator changes its sign, and where a completed step asks for it.
"""

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jointfmu_fmu_src.proof.standard import FLOOR

from ..host import Instance, description, opened
from .task import Rows, Task, reader

MOST_STEPS = 100_000
"""Of the solver between two communication points."""
NEAR = 1e-9
"""Part of an interval [1] by which an event may differ from a communication point that it meets."""


def available() -> bool:
    """Whether fmpy has its solver for this platform."""
    from fmpy import __file__ as package
    from fmpy import platform_tuple

    return Path(package).parent.joinpath("sundials", platform_tuple).is_dir()


def fmpy(task: Task, messages: list[str]) -> Rows:
    """By fmpy and CVode, FMI 2.0 and 3.0."""
    with opened(task.folder, description(task.fmu), task.fmu, messages, exchange=True) as instance:
        instance.begin(task.times[0])
        instance.set({**task.settings, **task.given(0)})
        instance.fmu.exitInitializationMode()
        motion = _Motion(instance, task)
        read = reader(instance, task.outputs)
        rows: Rows = [read()]
        for i in range(len(task.times) - 1):
            motion.over(i)
            rows.append(read())
    return rows


class _Motion:
    """An FMU in continuous time."""

    def __init__(self, instance: Instance, task: Task) -> None:
        from fmpy.sundials import CVodeSolver

        self.instance, self.fmu, self.task = instance, instance.fmu, task
        model, variables = instance.description, instance.variables
        self.accepts = model.modelExchange.needsCompletedIntegratorStep
        self.continuous = [
            name
            for name in task.inputs
            if task.kinds[name] == "real" and variables[name].variability != "discrete"
        ]
        self.interval, self.time = 0, task.times[0]
        self.failure: Exception | None = None
        self._settle()
        rates = "Derivatives" if instance.version == 2 else "ContinuousStateDerivatives"
        self.solver = CVodeSolver(
            nx=model.numberOfContinuousStates,
            nz=model.numberOfEventIndicators,
            get_x=self._direct("GetContinuousStates"),
            set_x=self._direct("SetContinuousStates"),
            get_dx=self._direct(f"Get{rates}"),
            get_z=self._direct("GetEventIndicators"),
            get_nominals=self._nominals,
            set_time=self._kept(self._at) if self.continuous else self._direct("SetTime"),
            input=_Nothing,
            startTime=task.times[0],
            relativeTolerance=task.tolerance,
            maxNumSteps=MOST_STEPS,
        )

    def over(self, interval: int) -> None:
        """From a communication point to the next one, and over the events there."""
        self.interval = interval
        begin, end = self.task.times[interval : interval + 2]
        near = NEAR * (end - begin)
        while end - self.time > near:
            if self.event <= self.time:
                raise RuntimeError(f"announces an event at {self.event:g} s when it is {self.time:g} s")
            until = self.event if self.event < end + near else end
            _stop_at(self.solver, until)
            _, roots, self.time = self.solver.step(self.time, until)
            if self.failure:
                raise self.failure
            self._at(self.time)
            wanted, ends = self.fmu.completedIntegratorStep() if self.accepts else (False, False)
            self._check(ends)
            jumps = end - self.time <= near and self._jumps(interval + 1)
            if wanted or jumps or np.any(roots) or self.time >= self.event:
                self.fmu.enterEventMode()
                if jumps:
                    self.instance.set(self.task.given(interval + 1))
                self._settle()
                self.solver.reset(self.time)

    def _check(self, ends: bool) -> None:
        if ends:
            raise RuntimeError(f"the FMU ends the simulation at {self.time:g} s")

    def _settle(self) -> None:
        """Iterate an event until nothing changes, and go on in continuous time."""
        again = True
        while again:
            again, ends, *_, announced, event = self.instance.update()
            self._check(ends)
        self.event = float(event) if announced else np.inf
        self.fmu.enterContinuousTimeMode()

    def _jumps(self, i: int) -> bool:
        """Whether an input that moves in events only has another value, or any one jumps."""
        old, new = self.task.given(i - 1), self.task.given(i)
        before = {**old, **{name: self.task.before[name][i] for name in self.continuous}}
        return before != new

    def _at(self, time: float) -> None:
        """Set time and continuous inputs."""
        self.fmu.setTime(time)
        i = self.interval
        begin, end = self.task.times[i : i + 2]
        part = (time - begin) / (end - begin)
        for name in self.continuous:
            first, last = self.task.inputs[name][i], self.task.before[name][i + 1]
            value = first if first == last else (1.0 - part) * first + part * last
            self.instance.set({name: value})

    def _nominals(self, values: object, count: int) -> None:
        """Sizes below which round-off counts, as for what is compared."""
        self.fmu.getNominalsOfContinuousStates(values, count)
        np.ctypeslib.as_array(values, (count,))[:] *= FLOOR

    def _direct(self, name: str) -> Callable[..., None]:
        """A function of the FMU itself: fmpy's way there takes longer than most laws. Its first failure is
        kept, as below."""
        from fmpy.fmi1 import FMICallException, fmi1Warning

        name = f"fmi{self.instance.version}{name}"
        function, component = getattr(self.fmu.dll, name), self.fmu.component

        def call(*arguments: object) -> None:
            status = function(component, *arguments)
            if status > fmi1Warning:
                self.failure = self.failure or FMICallException(function=name, status=status)

        return call

    def _kept(self, call: Callable[..., object]) -> Callable[..., None]:
        """A call whose first failure is kept: C, which calls it, does not hand on exceptions."""

        def kept(*arguments: object) -> None:
            try:
                call(*arguments)
            except Exception as failure:  # fmpy raises bare Exception
                self.failure = self.failure or failure

        return kept


class _Nothing:
    """Inputs are set together with the time."""

    @staticmethod
    def apply(time: float) -> None:
        pass


def _stop_at(solver: Any, time: float) -> None:
    """Let the solver not go beyond a time: there the inputs are others."""
    from fmpy.sundials.libraries import sundials_cvode

    set_stop = sundials_cvode.CVodeSetStopTime
    set_stop.argtypes = [ctypes.c_void_p, ctypes.c_double]
    set_stop(solver.cvode_mem, time)
