"""Model exchange with fmpy: integrate an FMU with CVode, including time, state, step and input events.

Between two communication points continuous inputs are interpolated linearly. Events are: an input that jumps,
a time announced by the FMU, an event indicator that changes its sign, and a completed integrator step after
which the FMU requests an event.
"""

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jointfmu_fmu_src.proof.standard import MIN_TOLERANCE_SCALE_OVER_NOMINAL

from ..host import FmuInstance, open_instance, read_description
from .task import ExperimentTask, OutputRows, make_output_reader

MAX_SOLVER_STEPS = 100_000
"""Maximum number of solver steps between two communication points."""
EVENT_TIME_TOLERANCE = 1e-9
"""Distance of an event from a communication point, over the communication interval [1], below which both
coincide."""


def has_cvode_solver() -> bool:
    """Whether fmpy contains its solver CVode for this platform."""
    from fmpy import __file__ as package
    from fmpy import platform_tuple

    return Path(package).parent.joinpath("sundials", platform_tuple).is_dir()


def run_fmpy_model_exchange(experiment_task: ExperimentTask, fmu_messages: list[str]) -> OutputRows:
    """Execute an experiment for model exchange in fmpy with the solver CVode (FMI 2.0 and 3.0).

    Returns the outputs at all communication points.

    fmu_messages : list to which the warnings and errors of the FMU are appended
    """
    with open_instance(
        experiment_task.fmu_folder,
        read_description(experiment_task.fmu_path),
        experiment_task.fmu_path,
        fmu_messages,
        uses_model_exchange=True,
    ) as instance:
        instance.enter_initialization(experiment_task.communication_points[0])
        instance.set_values({**experiment_task.start_values, **experiment_task.inputs_at(0)})
        instance.fmu.exitInitializationMode()
        motion = _ModelExchangeSimulation(instance, experiment_task)
        read = make_output_reader(instance, experiment_task.output_names)
        rows: OutputRows = [read()]
        for i in range(len(experiment_task.communication_points) - 1):
            motion.advance_interval(i)
            rows.append(read())
    return rows


class _ModelExchangeSimulation:
    """Simulation of an FMU for model exchange between communication points.

    interval_index  : index of the current communication interval
    time            : current time [s]
    next_event_time : time of the next event announced by the FMU [s], or infinity
    first_failure   : first exception in a call by the solver, or None
    """

    def __init__(self, fmu_instance: FmuInstance, experiment_task: ExperimentTask) -> None:
        from fmpy.sundials import CVodeSolver

        self.instance, self.fmu, self.task = fmu_instance, fmu_instance.fmu, experiment_task
        model, variables = fmu_instance.description, fmu_instance.variables
        self.needs_completed_step = model.modelExchange.needsCompletedIntegratorStep
        self.continuous_inputs = [
            name
            for name in experiment_task.input_values
            if experiment_task.variable_data_types[name] == "real"
            and variables[name].variability != "discrete"
        ]
        self.interval_index, self.time = 0, experiment_task.communication_points[0]
        self.first_failure: Exception | None = None
        self._iterate_event()
        rates = "Derivatives" if fmu_instance.version == 2 else "ContinuousStateDerivatives"
        self.solver = CVodeSolver(
            nx=model.numberOfContinuousStates,
            nz=model.numberOfEventIndicators,
            get_x=self._make_c_callback("GetContinuousStates"),
            set_x=self._make_c_callback("SetContinuousStates"),
            get_dx=self._make_c_callback(f"Get{rates}"),
            get_z=self._make_c_callback("GetEventIndicators"),
            get_nominals=self._write_state_nominals,
            set_time=self._wrap_callback(self._set_time_and_inputs)
            if self.continuous_inputs
            else self._make_c_callback("SetTime"),
            input=_EmptySolverInput,
            startTime=experiment_task.communication_points[0],
            relativeTolerance=experiment_task.solver_tolerance,
            maxNumSteps=MAX_SOLVER_STEPS,
        )

    def advance_interval(self, interval_index: int) -> None:
        """Integrate one communication interval, and handle the events up to and at its end."""
        self.interval_index = interval_index
        begin, end = self.task.communication_points[interval_index : interval_index + 2]
        time_tolerance = EVENT_TIME_TOLERANCE * (end - begin)
        while end - self.time > time_tolerance:
            if self.next_event_time <= self.time:
                raise RuntimeError(
                    f"the FMU sets its next event to {self.next_event_time:g} s, but the time is already "
                    f"{self.time:g} s; expected a later time (fault of the FMU)"
                )
            stop = self.next_event_time if self.next_event_time < end + time_tolerance else end
            _set_solver_stop_time(self.solver, stop)
            _, roots, self.time = self.solver.step(self.time, stop)
            if self.first_failure:
                raise self.first_failure
            self._set_time_and_inputs(self.time)
            step_event, terminates = (
                self.fmu.completedIntegratorStep() if self.needs_completed_step else (False, False)
            )
            self._check_termination(terminates)
            input_event = end - self.time <= time_tolerance and self._has_input_event(interval_index + 1)
            if step_event or input_event or np.any(roots) or self.time >= self.next_event_time:
                self.fmu.enterEventMode()
                if input_event:
                    self.instance.set_values(self.task.inputs_at(interval_index + 1))
                self._iterate_event()
                self.solver.reset(self.time)

    def _check_termination(self, is_termination_requested: bool) -> None:
        """Raise RuntimeError if the FMU requests the end of the simulation."""
        if is_termination_requested:
            raise RuntimeError(
                f"the FMU requests the end of the simulation at {self.time:g} s; the experiment ends at "
                f"{self.task.communication_points[-1]:g} s"
            )

    def _iterate_event(self) -> None:
        """Iterate an event until the FMU needs no further iteration, then enter continuous-time mode."""
        iterate = True
        while iterate:
            iterate, terminates, *_, has_next_event, next_event = self.instance.update_discrete_states()
            self._check_termination(terminates)
        self.next_event_time = float(next_event) if has_next_event else np.inf
        self.fmu.enterContinuousTimeMode()

    def _has_input_event(self, point_index: int) -> bool:
        """Whether an input jumps, or a discrete input changes, at a communication point with this index."""
        previous, new = self.task.inputs_at(point_index - 1), self.task.inputs_at(point_index)
        left_limits = {
            **previous,
            **{
                name: self.task.input_values_before_jump[name][point_index] for name in self.continuous_inputs
            },
        }
        return left_limits != new

    def _set_time_and_inputs(self, simulation_time: float) -> None:
        """Set the time [s] of the FMU, and its continuous inputs to their values at this time."""
        self.fmu.setTime(simulation_time)
        i = self.interval_index
        begin, end = self.task.communication_points[i : i + 2]
        fraction = (simulation_time - begin) / (end - begin)
        for name in self.continuous_inputs:
            first, last = self.task.input_values[name][i], self.task.input_values_before_jump[name][i + 1]
            value = first if first == last else (1.0 - fraction) * first + fraction * last
            self.instance.set_values({name: value})

    def _write_state_nominals(self, nominals_array: object, state_count: int) -> None:
        """Fill the solver's array with the sizes of the states below which its tolerances are absolute.

        The sizes are the nominal values times MIN_TOLERANCE_SCALE_OVER_NOMINAL.
        """
        self.fmu.getNominalsOfContinuousStates(nominals_array, state_count)
        np.ctypeslib.as_array(nominals_array, (state_count,))[:] *= MIN_TOLERANCE_SCALE_OVER_NOMINAL

    def _make_c_callback(self, c_function_name: str) -> Callable[..., None]:
        """Make a callback of the solver from an FMI function of the FMU; its first failure is stored.

        The function is called directly, because fmpy's wrapper takes longer than most laws.
        """
        from fmpy.fmi1 import FMICallException, fmi1Warning

        c_function_name = f"fmi{self.instance.version}{c_function_name}"
        function, component = getattr(self.fmu.dll, c_function_name), self.fmu.component

        def call_c_function(*arguments: object) -> None:
            """Call the C function; store its first failure."""
            status = function(component, *arguments)
            if status > fmi1Warning:
                self.first_failure = self.first_failure or FMICallException(
                    function=c_function_name, status=status
                )

        return call_c_function

    def _wrap_callback(self, python_function: Callable[..., object]) -> Callable[..., None]:
        """Make a callback of the solver from a Python function; its first exception is stored.

        The solver is C code and does not pass exceptions on.
        """

        def call_python_function(*arguments: object) -> None:
            """Call the Python function; store its first exception."""
            try:
                python_function(*arguments)
            except Exception as failure:  # fmpy raises bare Exception
                self.first_failure = self.first_failure or failure

        return call_python_function


class _EmptySolverInput:
    """Input object without effect for fmpy's solver, since `_set_time_and_inputs` already sets the inputs."""

    @staticmethod
    def apply(simulation_time: float) -> None:
        """Do nothing: `_set_time_and_inputs` has set the inputs."""


def _set_solver_stop_time(solver: Any, stop_time: float) -> None:
    """Limit the integration of a solver to a time [s]; the inputs change there."""
    from fmpy.sundials.libraries import sundials_cvode

    set_stop = sundials_cvode.CVodeSetStopTime
    set_stop.argtypes = [ctypes.c_void_p, ctypes.c_double]
    set_stop(solver.cvode_mem, stop_time)
