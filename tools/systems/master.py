"""Co-simulation of two FMUs (FMI 2.0): an inertia or mass on a joint to the ground."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self, TypeVar

import numpy as np
from fmpy.fmi1 import FMICallException

from jointfmu.quantity import Array

from ..run.host import open_instance, unpack_fmu

FmuReturnType = TypeVar("FmuReturnType")


class Slave:
    """Initialized instance of an FMU with selected inputs and outputs, as a context manager.

    start_values : {variable: start value}
    log_messages : log messages of the FMU

    Raises ValueError if the file is no FMU for this platform, a name is unknown, or the FMU returns an error
    (with the message of the FMU).
    """

    def __init__(
        self,
        fmu_path: Path,
        start_values: Mapping[str, float],
        input_names: Sequence[str],
        output_names: Sequence[str],
    ) -> None:
        self.log_messages: list[str] = []
        self._path = fmu_path
        with ExitStack() as entered:
            folder, description = entered.enter_context(unpack_fmu(fmu_path))
            known = [v.name for v in description.modelVariables]
            for name in (*start_values, *input_names, *output_names):
                if name not in known:
                    raise ValueError(f"{fmu_path}: unknown name {name!r}, allowed are {', '.join(known)}")
            self._fmu = entered.enter_context(
                open_instance(folder, description, str(fmu_path), self.log_messages)
            )
            try:
                self._fmu.enter_initialization()
                self._fmu.set_values(start_values)
                self._fmu.fmu.exitInitializationMode()
            except FMICallException as error:
                raise ValueError(f"{fmu_path}: {self._fmu.explain_failure(error)}") from None
            self._in, self._out = (
                self._fmu.group_real_variables(input_names),
                self._fmu.group_real_variables(output_names),
            )
            self._entered = entered.pop_all()

    def set_inputs(self, *values: float) -> None:
        """Set the FMU's inputs that were named on opening, with one value each in the same order."""
        self._call_fmu_function(self._in.set_values, *values)

    def get_outputs(self) -> list[float]:
        """Values of the FMU's outputs that were named on opening, in the same order."""
        return self._call_fmu_function(self._out.get_values)

    def do_step(self, start_time: float, step_size: float) -> None:
        """Do one co-simulation step from a time [s] with a step size [s]."""
        self._call_fmu_function(self._fmu.do_step, start_time, step_size)

    def _call_fmu_function(
        self, fmu_function: Callable[..., FmuReturnType], *arguments: float
    ) -> FmuReturnType:
        """Call a function of the FMU; raises ValueError with the FMU's message if it returns an error."""
        try:
            return fmu_function(*arguments)
        except FMICallException as error:
            raise ValueError(f"{self._path}: {self._fmu.explain_failure(error)}") from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._entered.close()


def simulate_body_on_joint(
    joint_slave: Slave,
    body_slave: Slave,
    constant_load: float,
    time_step: float,
    step_count: int,
    is_force_delayed: bool = False,
) -> Array:
    """Simulate position and speed (step_count + 1, 2) of a body on a joint under a constant load [N or N.m].

    joint_slave      : inputs position and speed, output the force on the body
    body_slave       : inputs load and force, outputs position and speed
    time_step        : communication step [s]
    is_force_delayed : whether the body gets the force of the previous communication point, as with a parallel
        master; otherwise the current force
    """
    states = np.empty((step_count + 1, 2))
    states[0] = body_slave.get_outputs()
    joint_slave.set_inputs(*states[0])
    (force,) = joint_slave.get_outputs()
    for k in range(step_count):
        body_slave.set_inputs(constant_load, force)
        body_slave.do_step(k * time_step, time_step)
        if is_force_delayed:
            (force,) = joint_slave.get_outputs()
        states[k + 1] = body_slave.get_outputs()
        joint_slave.set_inputs(*states[k + 1])
        joint_slave.do_step(k * time_step, time_step)
        if not is_force_delayed:
            (force,) = joint_slave.get_outputs()
    return states


def find_peak_frequency(vibration_signal: Array, time_step: float) -> float:
    """Angular frequency [rad/s] of the highest peak in the spectrum of a signal without its mean."""
    n = vibration_signal.size
    windowed = (vibration_signal - vibration_signal.mean()) * np.hanning(n)
    size = 16 * (1 << (n - 1).bit_length())
    spectrum = np.log(np.abs(np.fft.rfft(windowed, size)) + np.finfo(float).tiny)
    k = int(np.argmax(spectrum[1:-1])) + 1
    left, top, right = spectrum[k - 1 : k + 2]
    return float(2.0 * np.pi * (k + 0.5 * (left - right) / (left - 2.0 * top + right)) / (size * time_step))


def damping_ratio(vibration_signal: Array) -> float:
    """Damping ratio [1] of a free decay about zero, by the logarithmic decrement of its maxima."""
    middle = vibration_signal[1:-1]
    tops = (
        np.flatnonzero((middle > vibration_signal[:-2]) & (middle >= vibration_signal[2:]) & (middle > 0.0))
        + 1
    )
    left, top, right = vibration_signal[tops - 1], vibration_signal[tops], vibration_signal[tops + 1]
    heights = top + (left - right) ** 2 / (8.0 * (2.0 * top - left - right))
    slope = -np.polyfit(np.arange(heights.size), np.log(heights), 1)[0]
    return float(slope / np.hypot(2.0 * np.pi, slope))
