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

_LIBRARY_LOCK = Lock()
"""Lock that is held while a library is loaded: loading changes the working folder of all threads."""


class LogMessage(NamedTuple):
    """Log message of an FMU; status 0: event, 1: warning, 2: discarded call, 3: error."""

    status: int
    text: str
    category: str


class Instance:
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
        folder: str,
        description: "ModelDescription",
        instance_name: str,
        model_exchange: bool,
        log_lines: list[str] | None = None,
    ) -> None:
        from fmpy import fmi2, fmi3

        self.description = description
        self.variables = {v.name: v for v in description.modelVariables}
        self.version = int(description.fmiVersion[0])
        self.is_model_exchange = model_exchange
        self.messages: list[LogMessage] = []
        self._log_lines = [] if log_lines is None else log_lines
        kinds = {2: (fmi2.FMU2Slave, fmi2.FMU2Model), 3: (fmi3.FMU3Slave, fmi3.FMU3Model)}
        interface = description.modelExchange if model_exchange else description.coSimulation
        with (
            _LIBRARY_LOCK,
            chdir("."),
        ):  # fmpy changes to the library's folder, and stays there after a failure
            self.fmu: Any = kinds[self.version][model_exchange](
                guid=description.guid,
                unzipDirectory=folder,
                modelIdentifier=interface.modelIdentifier,
                instanceName=instance_name,
            )

    def instantiate(self, logging: bool = True) -> None:
        """Instantiate the FMU. Errors and warnings are logged even if logging is off."""
        from fmpy import calloc, fmi2, free

        if self.version == 3:
            self.fmu.instantiate(
                loggingOn=logging,
                logMessage=lambda env, status, category, text: self._log(status, category, text),
            )
            return
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda env, instance, status, category, text: self._log(status, category, text)
        )
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.fmu.instantiate(callbacks=callbacks, loggingOn=logging)

    def _log(self, status: int, message_category: bytes | None, message: bytes) -> None:
        """Callback of the FMU: store a log message."""
        shown = message.decode("utf-8", "replace")
        self.messages.append(LogMessage(status, shown, (message_category or b"").decode("utf-8", "replace")))
        if status:
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
            getattr(self.fmu, f"set{self._fmi_type(name)}")([self.variables[name].valueReference], [value])

    def get_value(self, variable_name: str) -> Any:
        """Read the value of a variable of the FMU, of any type."""
        return getattr(self.fmu, f"get{self._fmi_type(variable_name)}")(
            [self.variables[variable_name].valueReference]
        )[0]

    def _fmi_type(self, variable_name: str) -> str:
        """FMI type by which a variable is set and read. Values of an enumeration are whole numbers."""
        declared = str(self.variables[variable_name].type)
        return declared if declared != "Enumeration" else "Integer" if self.version == 2 else "Int64"

    def group_real_variables(self, names: Sequence[str]) -> "RealVariables":
        """Group real variables, so that one call sets or reads all of them."""
        return RealVariables(self, names)

    def do_step(self, time: float, step_size: float) -> None:
        """Do one co-simulation step: from `time` [s], with a step size [s]."""
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step_size)

    def update_discrete_states(self) -> tuple[Any, ...]:
        """Do one event iteration: update the discrete states of the FMU.

        Returns the results of FMI in their order: first whether another iteration is needed, second whether
        to terminate, last the time of the next event [s].
        """
        return tuple(self.fmu.newDiscreteStates() if self.version == 2 else self.fmu.updateDiscreteStates())

    def free_instance(self) -> None:
        """Free the instance of the FMU."""
        self.fmu.freeInstance()


class RealVariables:
    """Group of real variables of an instance that are set or read in one call. The arrays are reused."""

    def __init__(self, instance: Instance, names: Sequence[str]) -> None:
        n = len(names)
        references = (c_uint * n)(*(instance.variables[name].valueReference for name in names))
        self._values = (c_double * n)()
        fmu, lengths = instance.fmu, () if instance.version == 2 else (n,)
        self._arguments = (fmu.component, references, n, self._values, *lengths)
        self._set, self._get = (
            (fmu.fmi2SetReal, fmu.fmi2GetReal)
            if instance.version == 2
            else (fmu.fmi3SetFloat64, fmu.fmi3GetFloat64)
        )

    def set_values(self, *value_by_name: float) -> None:
        """Set all variables of the group."""
        self._values[:] = list(value_by_name)
        self._set(*self._arguments)

    def get_values(self) -> list[float]:
        """Read all variables of the group."""
        self._get(*self._arguments)
        return list(self._values)


@contextmanager
def open_instance(
    fmu_folder: str,
    model_description: "ModelDescription",
    fmu_label: str,
    log_lines: list[str],
    uses_model_exchange: bool = False,
) -> Iterator[Instance]:
    """Context with an instance of an unpacked FMU, which is freed at the end.

    fmu_label           : name of the FMU in error messages
    log_lines           : list to which warnings and errors of the FMU are appended
    uses_model_exchange : whether to use model exchange; default co-simulation

    Raises ValueError if the library cannot be loaded, RuntimeError if it does not instantiate, both with one
    line.
    """
    try:
        instance = Instance(fmu_folder, model_description, "host", uses_model_exchange, log_lines)
    except Exception as error:  # fmpy raises bare Exception, ctypes its own
        reason = " ".join(str(error.__context__ or error).replace(f"{fmu_folder}{os.sep}", "").split())
        raise ValueError(
            f"{fmu_label}: the library in the FMU cannot be loaded ({reason.rstrip('.')})"
        ) from None
    try:
        instance.instantiate()
    except Exception as error:  # fmpy raises bare Exception
        raise RuntimeError(f"{fmu_label}: {log_lines[-1] if log_lines else error}") from None
    try:
        yield instance
    finally:
        instance.free_instance()


def read_description(fmu: str | Path) -> "ModelDescription":
    """Read the model description of an FMU with fmpy, without validation. Results are cached per file.

    Raises ValueError, one line, if the file does not exist, cannot be opened safely, or is no FMU of FMI 2.0
    or 3.0.
    """
    try:
        file = os.stat(fmu)
    except OSError:
        raise ValueError(f"{fmu}: there is no such file; expected an FMU") from None
    return _read_cached_description(str(fmu), (file.st_ino, file.st_size, file.st_mtime_ns))


@lru_cache(16)
def _read_cached_description(fmu: str, file_version: tuple[int, ...]) -> "ModelDescription":
    """Read a model description; cached by file and version of the file."""
    from fmpy import read_model_description

    with archives.open_archive(fmu) as archive:
        text = archives.read_member(archive, archives.MODEL_DESCRIPTION_NAME)
    try:  # fmpy fails on descriptions of FMI 1.0, which lack some attributes
        version = ElementTree.fromstring(text).get("fmiVersion", "none")
        if version.startswith(("2.", "3.")):
            return read_model_description(fmu, validate=False)
    except Exception as error:  # fmpy raises bare Exception for a broken description
        raise ValueError(f"{fmu}: is not an FMU ({str(error).splitlines()[0]})") from None
    raise ValueError(f"{fmu}: is an FMU of FMI {version}, allowed are 2.0 and 3.0")


@contextmanager
def unpack_fmu(fmu: str | Path, model_exchange: bool = False) -> "Iterator[tuple[str, ModelDescription]]":
    """Context with the folder of an unpacked FMU and its model description; the folder is removed at the end.

    model_exchange : whether an FMU for model exchange only is accepted

    Raises ValueError if the file does not exist or is no FMU, or if the FMU cannot run here: another version
    of FMI, no co-simulation, or binaries for other platforms only.
    """
    path = Path(fmu)
    described = read_description(path)
    _check_interface(described, path, model_exchange)
    folder = tempfile.mkdtemp()
    resources = Path(folder) / "resources"
    try:
        with archives.open_archive(path) as archive:
            archives.extract_members(archive, folder, is_needed_to_run)
        _check_pythonfmu_files(resources, path)
        yield folder, described
    finally:
        while str(resources) in sys.path:
            sys.path.remove(str(resources))
        shutil.rmtree(folder, ignore_errors=True)


def is_needed_to_run(member_path: str) -> bool:
    """Whether a file inside an FMU is needed to run it here: description, resources, binaries."""
    from fmpy import platform, platform_tuple

    needed = ("modelDescription.xml", "resources/", f"binaries/{platform}/", f"binaries/{platform_tuple}/")
    return member_path.startswith(needed)


def _check_interface(model_description: "ModelDescription", fmu_path: Path, model_exchange: bool) -> None:
    """Raise ValueError if the FMU has no co-simulation, or no binary for this platform."""
    from fmpy import platform, supported_platforms

    if model_description.coSimulation is None and not (model_exchange and model_description.modelExchange):
        raise ValueError(f"{fmu_path}: has no co-simulation; expected an FMU for co-simulation")
    if platform not in (built_for := supported_platforms(str(fmu_path))):
        raise ValueError(
            f"{fmu_path}: has no binary for {platform}, only for {', '.join(built_for) or 'none'}"
        )


def _check_pythonfmu_files(resources_folder: Path, fmu_path: Path) -> None:
    """Raise ValueError if files of a pythonfmu FMU are missing; its library would crash without them."""
    if not (resources_folder / "pythonfmu").is_dir():
        return
    entry = resources_folder / "slavemodule.txt"
    if not entry.is_file():
        raise ValueError(f"{fmu_path}: is not a complete FMU; resources/slavemodule.txt is missing")
    script = resources_folder / f"{entry.read_text(encoding='utf-8').strip()}.py"
    if not script.is_file():
        raise ValueError(f"{fmu_path}: is not a complete FMU; resources/{script.name} is missing")
