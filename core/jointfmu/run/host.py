"""fmpy's instances of FMI 2.0 and 3.0 behind one face: start, set, get."""

from collections.abc import Callable, Sequence
from typing import Any

from fmpy import calloc, fmi2, fmi3, free

Log = Callable[[bytes], None]


class Fmi2:
    """An instance of FMI 2.0, for co-simulation or model exchange."""

    def __init__(self, exchange: bool = False, **options: object) -> None:
        self.fmu = (fmi2.FMU2Model if exchange else fmi2.FMU2Slave)(**options)

    def start(self, log: Log) -> None:
        """Instantiate with logging on; `log` gets what is more than an event."""
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda env, instance, status, category, message: log(message) if status else None
        )
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.fmu.instantiate(callbacks=callbacks, loggingOn=True)

    def begin(self, start: float = 0.0) -> None:
        """Enter initialization at a time [s]."""
        self.fmu.setupExperiment(startTime=start)
        self.fmu.enterInitializationMode()

    def set(self, variable: Any, value: Any) -> None:
        """Set a variable."""
        getattr(self.fmu, f"set{_plain(variable)}")([variable.valueReference], [value])

    def read(self, variable: Any) -> Any:
        """Value of a variable."""
        return getattr(self.fmu, f"get{_plain(variable)}")([variable.valueReference])[0]

    def get(self, references: Sequence[int]) -> list[float]:
        """Values of Real variables."""
        return list(self.fmu.getReal(references))

    @property
    def rates(self) -> Callable[..., object]:
        """What gives the derivatives of the continuous states."""
        return self.fmu.getDerivatives  # type: ignore[no-any-return]

    def update(self) -> tuple[object, ...]:
        """One event iteration: whether another is needed, whether to end, ... the next event's time."""
        return tuple(self.fmu.newDiscreteStates())


class Fmi3:
    """An instance of FMI 3.0, for co-simulation or model exchange."""

    def __init__(self, exchange: bool = False, **options: object) -> None:
        self.fmu = (fmi3.FMU3Model if exchange else fmi3.FMU3Slave)(**options)

    def start(self, log: Log) -> None:
        """Instantiate; errors and warnings are logged."""
        self.fmu.instantiate(
            logMessage=lambda env, status, category, message: log(message) if status else None
        )

    def begin(self, start: float = 0.0) -> None:
        """Enter initialization at a time [s]."""
        self.fmu.enterInitializationMode(startTime=start)

    def set(self, variable: Any, value: Any) -> None:
        """Set a variable."""
        getattr(self.fmu, f"set{_plain(variable, 'Int64')}")([variable.valueReference], [value])

    def read(self, variable: Any) -> Any:
        """Value of a variable."""
        return getattr(self.fmu, f"get{_plain(variable, 'Int64')}")([variable.valueReference])[0]

    def get(self, references: Sequence[int]) -> list[float]:
        """Values of Float64 variables."""
        return list(self.fmu.getFloat64(references))

    @property
    def rates(self) -> Callable[..., object]:
        """What gives the derivatives of the continuous states."""
        return self.fmu.getContinuousStateDerivatives  # type: ignore[no-any-return]

    def update(self) -> tuple[object, ...]:
        """One event iteration: whether another is needed, whether to end, ... the next event's time."""
        return tuple(self.fmu.updateDiscreteStates())


def _plain(variable: Any, whole: str = "Integer") -> str:
    """The type by which a variable is set; values of an enumeration are whole numbers."""
    return whole if variable.type == "Enumeration" else str(variable.type)
