"""Load ramps: any of the FMUs driven through fmpy from zero, every output read at every point."""

import os
import shutil
import sys
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..files import columns
from ..progress import track

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RampResult:
    """Result of a ramp: `columns` (n) by name, the driven input first; messages the FMU logged."""

    columns: dict[str, Array]
    units: dict[str, str]
    messages: tuple[str, ...]

    def csv(self) -> str:
        """The ramp as CSV text, header `name [unit]`, numbers exact."""
        heads = [(name, self.units[name]) for name in self.columns]
        return columns.text(heads, list(self.columns.values()))


def steps(to: float, step: float) -> Array:
    """Points 0, step, 2 step ... to; the last step may be shorter.

    Raises ValueError if a value is not finite, the step is zero, or it leads away from `to`.
    """
    for name, value in (("to", to), ("step", step)):
        if not np.isfinite(value):
            raise ValueError(f"{name} = {value:g} is outside (-inf, inf): must be finite")
    if step == 0.0 or to / step < 0.0:
        allowed = "(-inf, 0)" if to < 0.0 else "(0, inf)"
        raise ValueError(f"step = {step:g} is outside {allowed}: it must lead from 0 to {to:g}")
    count = to / step
    if count > 1e7:
        raise ValueError(f"step = {step:g} makes {count:.3g} points, allowed are 1e7")
    whole = np.arange(int(np.floor(count * (1.0 + 1e-12))) + 1) * step + 0.0
    reached = bool(np.isclose(whole[-1], to, rtol=1e-12, atol=0.0))
    return np.asarray(whole if reached else np.append(whole, to), dtype=np.float64)


def run(
    fmu: str | Path,
    input_name: str,
    to: float,
    step: float,
    settings: Mapping[str, object] | None = None,
) -> RampResult:
    """Drive one input from zero along a ramp, one step of one second each; all else stays.

    Parameters
    ----------
    fmu        : path of a co-simulation FMU, FMI 2.0 or 3.0
    input_name : the input that is driven
    to, step   : [unit of the input] end and step of the ramp
    settings   : start values of parameters and other inputs

    Raises
    ------
    ValueError   : the path is no FMU that can be driven (`unpacked`, `slave`), a name is unknown, a value
        is impossible, or the FMU refuses a value (the message is the FMU's own)
    RuntimeError : the FMU does not instantiate
    """
    return along(fmu, input_name, steps(to, step), settings)


def along(
    fmu: str | Path, input_name: str, points: Array, settings: Mapping[str, object] | None = None
) -> RampResult:
    """Drive one input along points (n), one step of one second each; all else stays. Raises as `run`."""
    with unpacked(fmu) as (folder, description):
        return _drive(folder, description, input_name, points, dict(settings or {}), str(fmu))


def units(fmu: str | Path) -> dict[str, str]:
    """{variable: its unit} of an FMU; ValueError as `unpacked`."""
    with unpacked(fmu) as (_, description):
        return {v.name: v.unit or "1" for v in description.modelVariables}


@contextmanager
def unpacked(fmu: str | Path, exchange: bool = False) -> Iterator[tuple[str, Any]]:
    """Folder and fmpy model description of an FMU, removed afterwards.

    exchange : whether it may be for model exchange only

    Raises ValueError if there is no such file, it is no FMU, or none that can be driven here: of another
    version of FMI, not for co-simulation, or for other platforms.
    """
    from fmpy import extract, read_model_description

    path = Path(fmu)
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file; expected an FMU")
    try:
        version = _fmi_version(path)
        if known := version.startswith(("2.", "3.")):
            description = read_model_description(str(path), validate=False)
            folder = extract(str(path))
    except (zipfile.BadZipFile, KeyError, OSError) as error:
        raise ValueError(f"{path}: is no FMU ({error}); expected a zip with modelDescription.xml") from None
    except Exception as error:  # fmpy raises bare Exception for a broken description
        raise ValueError(f"{path}: is no FMU ({str(error).splitlines()[0]})") from None
    if not known:
        raise ValueError(f"{path}: is an FMU of FMI {version}, allowed are 2.0 and 3.0")
    try:
        _check_interface(description, path, exchange)
        _check_python_flavour(Path(folder) / "resources", path)
        yield folder, description
    finally:
        while (resources := str(Path(folder) / "resources")) in sys.path:
            sys.path.remove(resources)
        shutil.rmtree(folder, ignore_errors=True)


def _fmi_version(path: Path) -> str:
    """The version of FMI, before fmpy reads the rest: it stumbles over what FMI 1.0 leaves out."""
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return root.get("fmiVersion", "none")


def _check_interface(description: Any, source: Path, exchange: bool) -> None:
    """Refuse what cannot be driven: no such interface, no binary for this platform."""
    from fmpy import platform, supported_platforms

    if description.coSimulation is None and not (exchange and description.modelExchange):
        raise ValueError(f"{source}: has no co-simulation; expected an FMU for co-simulation")
    if platform not in (built_for := supported_platforms(str(source))):
        raise ValueError(f"{source}: has no binary for {platform}, only for {', '.join(built_for) or 'none'}")


def _check_python_flavour(resources: Path, source: Path) -> None:
    """Refuse a pythonfmu FMU without the files whose absence its library answers with a crash."""
    if not (resources / "pythonfmu").is_dir():
        return
    entry = resources / "slavemodule.txt"
    if not entry.is_file():
        raise ValueError(f"{source}: is no complete FMU; resources/slavemodule.txt is missing")
    script = resources / f"{entry.read_text(encoding='utf-8').strip()}.py"
    if not script.is_file():
        raise ValueError(f"{source}: is no complete FMU; resources/{script.name} is missing")


def _drive(
    folder: str, md: Any, input_name: str, points: Array, settings: dict[str, Any], source: str
) -> RampResult:
    variables = {v.name: v for v in md.modelVariables}
    inputs = [v.name for v in md.modelVariables if v.causality == "input"]
    outputs = [v for v in md.modelVariables if v.causality == "output"]
    if input_name not in inputs:
        raise ValueError(f"{source}: unknown input {input_name!r}, allowed are {', '.join(inputs)}")
    if input_name in settings:
        raise ValueError(f"{source}: {input_name} is driven by the ramp and cannot be set as well")
    settable = [v.name for v in md.modelVariables if v.causality in ("input", "parameter")]
    for name, value in settings.items():
        if name not in settable:
            raise ValueError(f"{source}: unknown name {name!r}, allowed are {', '.join(settable)}")
        wanted = bool if variables[name].type == "Boolean" else float
        if not isinstance(value, wanted):
            expected = "true or false" if wanted is bool else "a number"
            raise ValueError(f"{source}: {name} = {value!r} is not {expected}")
    messages: list[str] = []
    rows: list[list[float]] = []
    with slave(folder, md, messages, source) as fmu:
        try:
            fmu.begin()
            for name, value in settings.items():
                fmu.set(variables[name], value)
            fmu.set(variables[input_name], points[0])
            fmu.fmu.exitInitializationMode()
            references = [v.valueReference for v in outputs]
            for i, value in enumerate(track(points, Path(source).stem, len(points))):
                fmu.set(variables[input_name], value)
                if i:
                    fmu.fmu.doStep(currentCommunicationPoint=float(i - 1), communicationStepSize=1.0)
                rows.append(fmu.get(references))
        except Exception as error:
            raise ValueError(f"{source}: {messages[0] if messages else error}") from None
    table = np.asarray(rows).reshape(len(points), len(outputs))
    columns = {input_name: points} | {v.name: table[:, i] for i, v in enumerate(outputs)}
    units = {name: variables[name].unit or "1" for name in columns}
    return RampResult(columns, units, tuple(messages))


@contextmanager
def slave(folder: str, md: Any, messages: list[str], source: str, exchange: bool = False) -> Iterator[Any]:
    """An instance for co-simulation or model exchange; what it logs is appended to `messages`.

    Both errors are one line that begins with `source`: ValueError if the library cannot be loaded,
    RuntimeError if it does not instantiate.
    """
    from . import host

    flavour = host.Fmi2 if md.fmiVersion.startswith("2") else host.Fmi3
    interface = md.modelExchange if exchange else md.coSimulation
    before = Path.cwd()
    try:
        fmu = flavour(
            exchange,
            guid=md.guid,
            unzipDirectory=folder,
            modelIdentifier=interface.modelIdentifier,
            instanceName="ramp",
        )
    except Exception as error:  # fmpy raises bare Exception, ctypes its own
        os.chdir(before)  # where fmpy has left it
        reason = " ".join(str(error.__context__ or error).replace(f"{folder}{os.sep}", "").split())
        raise ValueError(f"{source}: its library cannot be loaded ({reason.rstrip('.')})") from None
    try:
        fmu.start(lambda text: messages.append(" ".join(text.decode("utf-8", "replace").split())))
    except Exception as error:  # fmpy raises bare Exception
        raise RuntimeError(f"{source}: {messages[-1] if messages else error}") from None
    try:
        yield fmu
    finally:
        fmu.fmu.freeInstance()
