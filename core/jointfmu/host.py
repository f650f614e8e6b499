"""fmpy's co-simulation slaves of FMI 2.0 and 3.0 behind one face: start, set, get."""

from collections.abc import Callable, Sequence
from typing import Any

from fmpy import calloc, fmi2, fmi3, free

Log = Callable[[bytes], None]


class Fmi2:
    """A slave of FMI 2.0."""

    def __init__(self, **options: Any) -> None:
        self.fmu = fmi2.FMU2Slave(**options)

    def start(self, log: Log) -> None:
        """Instantiate with logging on; `log` gets what is more than an event."""
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda env, instance, status, category, message: log(message) if status else None
        )
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.fmu.instantiate(callbacks=callbacks, loggingOn=True)

    def begin(self) -> None:
        """Enter initialization at time zero."""
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()

    def set(self, variable: Any, value: Any) -> None:
        """Set a Real or Boolean variable."""
        setter = self.fmu.setBoolean if variable.type == "Boolean" else self.fmu.setReal
        setter([variable.valueReference], [value])

    def get(self, references: Sequence[int]) -> list[float]:
        """Values of Real variables."""
        return list(self.fmu.getReal(references))


class Fmi3:
    """A slave of FMI 3.0."""

    def __init__(self, **options: Any) -> None:
        self.fmu = fmi3.FMU3Slave(**options)

    def start(self, log: Log) -> None:
        """Instantiate; errors and warnings are logged."""
        self.fmu.instantiate(
            logMessage=lambda env, status, category, message: log(message) if status else None
        )

    def begin(self) -> None:
        """Enter initialization at time zero."""
        self.fmu.enterInitializationMode(startTime=0.0)

    def set(self, variable: Any, value: Any) -> None:
        """Set a Float64 or Boolean variable."""
        setter = self.fmu.setBoolean if variable.type == "Boolean" else self.fmu.setFloat64
        setter([variable.valueReference], [value])

    def get(self, references: Sequence[int]) -> list[float]:
        """Values of Float64 variables."""
        return list(self.fmu.getFloat64(references))
