"""Importer of FMUs, based on fmpy: FMI 2.0 and 3.0, co-simulation and model exchange, variables by name."""

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager
from ctypes import c_double, c_uint
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

from jointfmu.files import archives

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

_ERROR_STATUSES = (3, 4)
"""Statuses of log messages that state the reason of a failed call: error, then fatal."""
_LIBRARY_LOADING_LOCK = Lock()
"""Lock that is held while a library is loaded: loading changes the working folder of all threads."""


class LogMessage(NamedTuple):
    """Log message of an FMU; status 0: event, 1: warning, 2: discarded call, 3: error."""

    fmi_status: int
    message_text: str
    message_category: str


class FmuInstance:
    """Running instance of an FMU that is unpacked in a folder.

    description : model description of fmpy
    variables   : {name: variable of the model description}
    fmu         : instance of fmpy, for calls that this class does not wrap
    messages    : all log messages
    log_lines   : list to which warnings and errors are appended as they come, one line each

    Raises the exceptions of fmpy and ctypes if the library cannot be loaded, and if a call fails.
    """

    def __init__(
        self,
        fmu_folder: str,
        model_description: "ModelDescription",
        instance_name: str,
        uses_model_exchange: bool,
        log_lines: list[str] | None = None,
    ) -> None:
        from fmpy import fmi2, fmi3

        self.description = model_description
        self.variables = {v.name: v for v in model_description.modelVariables}
        self.version = int(model_description.fmiVersion[0])
        self.is_model_exchange = uses_model_exchange
        self.messages: list[LogMessage] = []
        self._log_lines = [] if log_lines is None else log_lines
        kinds = {2: (fmi2.FMU2Slave, fmi2.FMU2Model), 3: (fmi3.FMU3Slave, fmi3.FMU3Model)}
        interface = model_description.modelExchange if uses_model_exchange else model_description.coSimulation
        with (
            _LIBRARY_LOADING_LOCK,
            chdir("."),
        ):  # fmpy changes to the library's folder, and stays there after a failure
            self.fmu: Any = kinds[self.version][uses_model_exchange](
                guid=model_description.guid,
                unzipDirectory=fmu_folder,
                modelIdentifier=interface.modelIdentifier,
                instanceName=instance_name,
            )

    def instantiate(self, is_logging_on: bool = True) -> None:
        """Instantiate the FMU. Errors and warnings are logged even if logging is off."""
        from fmpy import calloc, fmi2, free

        if self.version == 3:
            self.fmu.instantiate(
                loggingOn=is_logging_on,
                logMessage=lambda env, status, category, text: self._store_log_message(
                    status, category, text
                ),
            )
            return
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda env, instance, status, category, text: self._store_log_message(status, category, text)
        )
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.fmu.instantiate(callbacks=callbacks, loggingOn=is_logging_on)

    def _store_log_message(
        self, fmi_status: int, message_category: bytes | None, message_text: bytes
    ) -> None:
        """Callback of the FMU: store a log message."""
        shown = message_text.decode("utf-8", "replace")
        self.messages.append(
            LogMessage(fmi_status, shown, (message_category or b"").decode("utf-8", "replace"))
        )
        if fmi_status:
            self._log_lines.append(" ".join(shown.split()))

    def enter_initialization(self, start_time: float = 0.0, stop_time: float | None = None) -> None:
        """Enter initialization mode at a start time [s]."""
        if self.version == 2:
            self.fmu.setupExperiment(startTime=start_time, stopTime=stop_time)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=start_time, stopTime=stop_time)

    def set_values(self, value_by_name: Mapping[str, object]) -> None:
        """Set variables of the FMU, of any type, with one call for each."""
        for name, value in value_by_name.items():
            getattr(self.fmu, f"set{self._find_fmi_type(name)}")(
                [self.variables[name].valueReference], [value]
            )

    def get_value(self, variable_name: str) -> Any:
        """Read the value of a variable of the FMU, of any type."""
        return getattr(self.fmu, f"get{self._find_fmi_type(variable_name)}")(
            [self.variables[variable_name].valueReference]
        )[0]

    def _find_fmi_type(self, variable_name: str) -> str:
        """Name of the FMI type of a variable, which selects the functions that set and read it.

        Values of an enumeration are whole numbers.
        """
        declared = str(self.variables[variable_name].type)
        return declared if declared != "Enumeration" else "Integer" if self.version == 2 else "Int64"

    def group_real_variables(self, variable_names: Sequence[str]) -> "RealVariableGroup":
        """Group real variables of the FMU, so that one FMI call sets or reads all of them."""
        return RealVariableGroup(self, variable_names)

    def do_step(self, step_start_time: float, step_size: float) -> None:
        """Do one co-simulation step: from `step_start_time` [s], with a step size [s]."""
        self.fmu.doStep(currentCommunicationPoint=step_start_time, communicationStepSize=step_size)

    def update_discrete_states(self) -> tuple[Any, ...]:
        """Do one event iteration: update the discrete states of the FMU.

        Returns the results of FMI in their order: first whether another iteration is needed, second whether
        to terminate, last the time of the next event [s].
        """
        return tuple(self.fmu.newDiscreteStates() if self.version == 2 else self.fmu.updateDiscreteStates())

    def explain_failure(self, failure: Exception) -> str:
        """Reason of a failed call, one line: the last error in the log of the FMU, else the exception.

        Warnings are no reason. After the error, pythonfmu logs a fatal message without the reason.
        """
        for status in _ERROR_STATUSES:
            texts = [message.message_text for message in self.messages if message.fmi_status == status]
            if texts:
                return " ".join(texts[-1].split())
        return " ".join(str(failure).split())

    def free_instance(self) -> None:
        """Free the instance of the FMU."""
        self.fmu.freeInstance()


class RealVariableGroup:
    """Group of real variables of an instance that are set or read in one call. The arrays are reused."""

    def __init__(self, fmu_instance: FmuInstance, variable_names: Sequence[str]) -> None:
        n = len(variable_names)
        references = (c_uint * n)(*(fmu_instance.variables[name].valueReference for name in variable_names))
        self._values = (c_double * n)()
        fmu, lengths = fmu_instance.fmu, () if fmu_instance.version == 2 else (n,)
        self._arguments = (fmu.component, references, n, self._values, *lengths)
        self._set, self._get = (
            (fmu.fmi2SetReal, fmu.fmi2GetReal)
            if fmu_instance.version == 2
            else (fmu.fmi3SetFloat64, fmu.fmi3GetFloat64)
        )

    def set_values(self, *variable_values: float) -> None:
        """Set all real variables of the group, in one FMI call."""
        self._values[:] = list(variable_values)
        self._set(*self._arguments)

    def get_values(self) -> list[float]:
        """Read the values of all real variables of the group, in one FMI call."""
        self._get(*self._arguments)
        return list(self._values)


@contextmanager
def open_instance(
    fmu_folder: str,
    model_description: "ModelDescription",
    fmu_label: str,
    log_lines: list[str],
    uses_model_exchange: bool = False,
) -> Iterator[FmuInstance]:
    """Context with an instance of an unpacked FMU, which is freed at the end.

    fmu_label           : name of the FMU in error messages
    log_lines           : list to which warnings and errors of the FMU are appended
    uses_model_exchange : whether to use model exchange; default co-simulation

    Raises ValueError if the library cannot be loaded, RuntimeError if it does not instantiate, both with one
    line. If a call inside the context fails, the RuntimeError has the reason that the FMU logged.
    """
    from fmpy.fmi1 import FMICallException

    try:
        instance = FmuInstance(fmu_folder, model_description, "host", uses_model_exchange, log_lines)
    except Exception as error:  # fmpy raises bare Exception, ctypes its own
        reason = " ".join(str(error.__context__ or error).replace(f"{fmu_folder}{os.sep}", "").split())
        raise ValueError(
            f"{fmu_label}: the library in the FMU cannot be loaded ({reason.rstrip('.')})"
        ) from None
    try:
        instance.instantiate()
    except Exception as error:  # fmpy raises bare Exception
        raise RuntimeError(f"{fmu_label}: {instance.explain_failure(error)}") from None
    try:
        yield instance
    except (FMICallException, RuntimeError) as error:
        raise RuntimeError(instance.explain_failure(error)) from None
    finally:
        instance.free_instance()


def read_description(fmu_path: str | Path) -> "ModelDescription":
    """Read the model description of an FMU with fmpy, without validation. Results are cached per file.

    Raises ValueError, one line, if the file does not exist, cannot be opened safely, or is no FMU of FMI 2.0
    or 3.0.
    """
    try:
        file = os.stat(fmu_path)
    except OSError:
        raise ValueError(f"{fmu_path}: there is no such file; expected an FMU") from None
    return _read_cached_description(str(fmu_path), (file.st_ino, file.st_size, file.st_mtime_ns))


@lru_cache(16)
def _read_cached_description(fmu_path: str, file_version: tuple[int, ...]) -> "ModelDescription":
    """Read a model description; cached by file and version of the file."""
    from fmpy import read_model_description

    with archives.open_archive(fmu_path) as archive:
        text = archives.read_member(archive, archives.MODEL_DESCRIPTION_NAME)
    try:  # fmpy fails on descriptions of FMI 1.0, which lack some attributes
        version = ElementTree.fromstring(text).get("fmiVersion", "none")
        if version.startswith(("2.", "3.")):
            return read_model_description(fmu_path, validate=False)
    except Exception as error:  # fmpy raises bare Exception for a broken description
        raise ValueError(f"{fmu_path}: is not an FMU ({str(error).splitlines()[0]})") from None
    raise ValueError(f"{fmu_path}: is an FMU of FMI {version}, allowed are 2.0 and 3.0")


@contextmanager
def unpack_fmu(
    fmu_path: str | Path, accepts_model_exchange: bool = False
) -> "Iterator[tuple[str, ModelDescription]]":
    """Context with the folder of an unpacked FMU and its model description; the folder is removed at the end.

    accepts_model_exchange : whether an FMU for model exchange only is accepted

    Raises ValueError if the file does not exist or is no FMU, or if the FMU cannot run here: another version
    of FMI, no co-simulation, or binaries for other platforms only.
    """
    checked_path = Path(fmu_path)
    described = read_description(checked_path)
    _check_interface_and_platform(described, checked_path, accepts_model_exchange)
    folder = tempfile.mkdtemp()
    resources = Path(folder) / "resources"
    try:
        with archives.open_archive(checked_path) as archive:
            archives.extract_members(archive, folder, is_member_needed_to_run)
        _check_pythonfmu_files(resources, checked_path)
        yield folder, described
    finally:
        while str(resources) in sys.path:
            sys.path.remove(str(resources))
        shutil.rmtree(folder, ignore_errors=True)


def is_member_needed_to_run(member_path: str) -> bool:
    """Whether a file inside an FMU is needed to run it here: description, resources, binaries."""
    from fmpy import platform, platform_tuple

    needed = ("modelDescription.xml", "resources/", f"binaries/{platform}/", f"binaries/{platform_tuple}/")
    return member_path.startswith(needed)


def _check_interface_and_platform(
    model_description: "ModelDescription", fmu_path: Path, accepts_model_exchange: bool
) -> None:
    """Raise ValueError if the FMU has no co-simulation, or no binary for this platform."""
    from fmpy import platform, supported_platforms

    if model_description.coSimulation is None and not (
        accepts_model_exchange and model_description.modelExchange
    ):
        raise ValueError(f"{fmu_path}: has no co-simulation; expected an FMU for co-simulation")
    if platform not in (built_for := supported_platforms(str(fmu_path))):
        others = f", only for {', '.join(built_for)}" if built_for else ", and none for another platform"
        raise ValueError(f"{fmu_path}: has no binary for {platform}{others}")


def _check_pythonfmu_files(resources_folder: Path, fmu_path: Path) -> None:
    """Raise ValueError if files of a pythonfmu FMU are missing; its library would crash without them."""
    if not (resources_folder / "pythonfmu").is_dir():
        return
    entry = resources_folder / "slavemodule.txt"
    if not entry.is_file():
        raise ValueError(
            f"{fmu_path}: is not a complete FMU; resources/slavemodule.txt is missing: build it again"
        )
    script = resources_folder / f"{entry.read_text(encoding='utf-8').strip()}.py"
    if not script.is_file():
        raise ValueError(
            f"{fmu_path}: is not a complete FMU; resources/{script.name} is missing: build it again"
        )
