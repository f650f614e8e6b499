"""A small master: an inertia or mass on a joint to the ground, as co-simulation of two FMUs (FMI 2.0)."""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from fmpy.fmi1 import FMICallException
from numpy.typing import NDArray

from jointfmu.run.ramp import slave, unpacked

Array = NDArray[np.float64]


class Slave:
    """An instance of an FMU with the inputs and outputs that are wired; to be used with `with`.

    Raises ValueError if the file is no FMU for this platform, a name is unknown or the FMU refuses a value
    (the message is the FMU's own). What it logs besides is in `messages`.
    """

    def __init__(
        self, path: Path, start: Mapping[str, float], inputs: Sequence[str], outputs: Sequence[str]
    ) -> None:
        self.messages: list[str] = []
        self._path = path
        with ExitStack() as opened:
            folder, description = opened.enter_context(unpacked(path))
            self._refs = {v.name: v.valueReference for v in description.modelVariables}
            for name in (*start, *inputs, *outputs):
                if name not in self._refs:
                    raise ValueError(f"{path}: unknown name {name!r}, allowed are {', '.join(self._refs)}")
            instance = opened.enter_context(slave(folder, description, self.messages, str(path)))
            self._fmu = instance.fmu
            try:
                instance.begin()
                flags = {n: value for n, value in start.items() if isinstance(value, bool)}
                numbers = {n: value for n, value in start.items() if n not in flags}
                self._fmu.setReal([self._refs[n] for n in numbers], list(numbers.values()))
                self._fmu.setBoolean([self._refs[n] for n in flags], list(flags.values()))
                self._fmu.exitInitializationMode()
            except FMICallException as error:
                raise ValueError(f"{path}: {self.messages[0] if self.messages else error}") from None
            self._in, self._out = self._wires(inputs), self._wires(outputs)
            self._opened = opened.pop_all()

    def _wires(self, names: Sequence[str]) -> tuple[Any, int, Any]:
        n = len(names)
        return (ctypes.c_uint * n)(*(self._refs[name] for name in names)), n, (ctypes.c_double * n)()

    def set(self, *values: float) -> None:
        """Give the inputs their values."""
        refs, n, room = self._in
        room[:] = values
        self._call(self._fmu.fmi2SetReal, refs, n, room)

    def get(self) -> list[float]:
        """The outputs at the present inputs."""
        refs, n, room = self._out
        self._call(self._fmu.fmi2GetReal, refs, n, room)
        return list(room)

    def step(self, time: float, size: float) -> None:
        """One step."""
        self._call(self._fmu.fmi2DoStep, time, size, 1)

    def _call(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Call a function of the FMU; ValueError with the FMU's reason if it refuses."""
        try:
            function(self._fmu.component, *arguments)
        except FMICallException as error:
            raise ValueError(f"{self._path}: {self.messages[-1] if self.messages else error}") from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, error_type: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._opened.close()


def motion(joint: Slave, body: Slave, load: float, step: float, count: int, late: bool = False) -> Array:
    """Position and speed (count + 1, 2) of a body on a joint under a constant load [N or N.m].

    joint : inputs position and speed, output the force on the body
    body  : inputs load and force, outputs position and speed
    late  : the body gets the force of the communication point before, as in masters that step all
            FMUs side by side; else the present one
    """
    states = np.empty((count + 1, 2))
    states[0] = body.get()
    joint.set(*states[0])
    (force,) = joint.get()
    for k in range(count):
        body.set(load, force)
        body.step(k * step, step)
        if late:
            (force,) = joint.get()
        states[k + 1] = body.get()
        joint.set(*states[k + 1])
        joint.step(k * step, step)
        if not late:
            (force,) = joint.get()
    return states


def peak(signal: Array, step: float) -> float:
    """Frequency [rad/s] of the highest peak of a signal's spectrum besides its mean."""
    n = signal.size
    windowed = (signal - signal.mean()) * np.hanning(n)
    size = 16 * (1 << (n - 1).bit_length())
    spectrum = np.log(np.abs(np.fft.rfft(windowed, size)) + np.finfo(float).tiny)
    k = int(np.argmax(spectrum[1:-1])) + 1
    left, top, right = spectrum[k - 1 : k + 2]
    return float(2.0 * np.pi * (k + 0.5 * (left - right) / (left - 2.0 * top + right)) / (size * step))


def damping_ratio(signal: Array) -> float:
    """Damping ratio [1] of a free decay about zero, from the logarithmic decrement of its maxima."""
    middle = signal[1:-1]
    tops = np.flatnonzero((middle > signal[:-2]) & (middle >= signal[2:]) & (middle > 0.0)) + 1
    left, top, right = signal[tops - 1], signal[tops], signal[tops + 1]
    heights = top + (left - right) ** 2 / (8.0 * (2.0 * top - left - right))
    slope = -np.polyfit(np.arange(heights.size), np.log(heights), 1)[0]
    return float(slope / np.hypot(2.0 * np.pi, slope))
