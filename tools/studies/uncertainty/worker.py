"""Evaluation of one run of a study, in a worker process: a joint or an FMU along its load ramp."""

import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import local
from typing import Any, ClassVar, Protocol, TypeAlias
from uuid import uuid4

import numpy as np

from jointfmu.files import archives
from jointfmu.files.text import MAX_TEXT_LENGTH, replace_unprintable
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Interval, assemble_parameter_set

from ...run.engine import VariableJoint
from ...run.host import is_needed_to_run
from ...run.ramps import ramp
from .curves import LoadCurves, find_load_curves, spline_weights

KILLED_RUN_MESSAGE = "the process of the run died"
"""Error message in the journal for a run whose process died."""
LOAD_INTERVAL_MEANING = "up to the end of the tabulated law"
"""Meaning of the load interval, for error messages."""

Settings: TypeAlias = Mapping[str, Any]
"""{name: value} of a run: its sampled parameters and inputs, and others that the study sets."""
Run: TypeAlias = tuple[int, Settings]
"""Index of a run in its study, and its settings."""
Entry: TypeAlias = dict[str, Any]
"""Journal entry of a run: `run`, `parameters`, and `columns` {variable: values (m)} or `error`."""


class RampEvaluator(Protocol):
    """Evaluator of the runs of a study. It can be pickled.

    runs_per_job     : number of runs that a worker process executes as one job
    runs_per_process : least number of runs for each worker process that is started; with fewer runs, the
        process of the command executes them. 0: the process of the command executes none
    """

    @property
    def runs_per_job(self) -> int: ...

    @property
    def runs_per_process(self) -> int: ...

    def include_files(self) -> "RampEvaluator":
        """Copy of the evaluator that contains its files, to be sent to another machine."""

    def install_files(self, folder: Path) -> "RampEvaluator":
        """Copy of the evaluator whose files are in a folder of this machine."""

    def run(self, run_number: int, settings: Settings) -> Entry:
        """Evaluate a run of the study; return its journal entry."""


def run_job(job: tuple[RampEvaluator, Path, Sequence[Run]]) -> list[Entry]:
    """Execute some runs of a study in a worker process of this machine; return their journal entries.

    job : evaluator, folder of temporary files, runs
    """
    evaluator, folder, runs = job
    tempfile.tempdir = str(folder)
    return [evaluator.run(index, settings) for index, settings in runs]


def _failed_entry(run_number: int, settings: Settings, error: str) -> Entry:
    """Journal entry of a run that failed: its settings and the error message."""
    return {
        "run": run_number,
        "parameters": dict(settings),
        "error": replace_unprintable(error)[:MAX_TEXT_LENGTH],
    }


def killed_entry(run_number: int, settings: Settings) -> Entry:
    """Journal entry of a run whose process died."""
    return _failed_entry(run_number, settings, KILLED_RUN_MESSAGE)


@dataclass(frozen=True, slots=True)
class LoadRamp:
    """Load ramp of all runs of an FMU: name of the driven input, end and step [unit of the input].

    The FMU runs along it as in `ramp.run_ramp`.
    """

    input: str
    to: float
    step: float


@dataclass(frozen=True)
class FmuRamp:
    """Evaluator that runs an FMU along its load ramp, see `RampEvaluator`.

    fmu_content : bytes of the FMU, if it is to be sent to another machine
    """

    runs_per_job: ClassVar[int] = 1
    runs_per_process: ClassVar[int] = 0

    fmu: Path
    load_ramp: LoadRamp
    fmu_content: bytes | None = None

    def include_files(self) -> "FmuRamp":
        """Copy of the evaluator with the bytes of its FMU."""
        return replace(self, fmu_content=self.fmu.read_bytes())

    def install_files(self, folder: Path) -> "FmuRamp":
        """Write a copy of the FMU with only the files that a run needs; each run then unpacks it faster."""
        full, slim = self.fmu, folder / self.fmu.name
        if self.fmu_content is not None:
            full = folder / f"{slim.name}.full"
            full.write_bytes(self.fmu_content)
        write_slim_fmu(full, slim)
        if self.fmu_content is not None:
            full.unlink()
        return replace(self, fmu=slim, fmu_content=None)

    def run(self, run_number: int, settings: Settings) -> Entry:
        """Run the FMU along the ramp; the settings are start values of parameters and inputs."""
        drive = self.load_ramp
        try:
            result = ramp.run_ramp(self.fmu, drive.input, drive.to, drive.step, settings)
        except (ValueError, RuntimeError) as error:
            return _failed_entry(run_number, settings, str(error).replace(str(self.fmu), self.fmu.name))
        if not_finite := [key for key, column in result.columns.items() if not np.all(np.isfinite(column))]:
            return _failed_entry(run_number, settings, f"{not_finite[0]} is not finite")
        columns = {key: column.tolist() for key, column in result.columns.items()}
        return {"run": run_number, "parameters": dict(settings), "columns": columns}


def write_slim_fmu(fmu: Path, slim_path: Path) -> None:
    """Write a copy `slim_path` of an FMU without sources, documentation and binaries of other platforms."""
    with archives.open_archive(fmu) as full, zipfile.ZipFile(slim_path, "w") as reduced:
        for item in full.infolist():
            if is_needed_to_run(item.filename) and not item.is_dir():
                reduced.writestr(item, archives.read_member(full, item.filename))


@dataclass(frozen=True)
class JointRamp:
    """Evaluator that computes the joint of a parameter file along a load ramp, see `RampEvaluator`.

    loads                  : load ramp (m), ascending
    load_is_relative       : whether a sample of the load is a factor on the ramp, else it replaces the last
    opens_joint_per_sample : whether each sample opens the joint, for parameters that the FMU does not expose;
        this takes seconds
    load_indices           : indices of the loads that are evaluated; None: all
    study_key              : text that identifies the study
    """

    file: ParameterFile
    loads: Array
    load_is_relative: bool = False
    opens_joint_per_sample: bool = False
    load_indices: Array | None = None
    study_key: str = field(default_factory=lambda: str(uuid4()))

    @property
    def runs_per_job(self) -> int:
        """Number of runs that a worker process executes as one job: 1 if each run opens the joint."""
        return 1 if self.opens_joint_per_sample else 32

    @property
    def runs_per_process(self) -> int:
        """Number of runs for which one more process is started.

        For a joint that is registered only in this process, the number is unlimited: no process is started.
        """
        if not KINDS[self.file.joint].package.startswith("jointfmu."):
            return sys.maxsize
        return 4 if self.opens_joint_per_sample else 512

    def __getstate__(self) -> dict[str, Any]:
        """Attributes for pickle, with a new parameter set that has no cached properties.

        Cached properties may be functions, which pickle rejects.
        """
        stated = self.file.values_by_name
        values = assemble_parameter_set(type(self.file.values), stated, _make_unchecked)
        return {**self.__dict__, "file": replace(self.file, values=values)}

    @property
    def curves(self) -> LoadCurves:
        """Quantities of the joint along the load ramp."""
        return find_load_curves(KINDS[self.file.joint])

    def include_files(self) -> "JointRamp":
        """Return this evaluator unchanged: it needs no files (the evaluator of an FMU packs the FMU)."""
        return self

    def install_files(self, folder: Path) -> "JointRamp":
        """Return this evaluator unchanged: it needs no files (the evaluator of an FMU unpacks the FMU)."""
        return self

    def run(self, run_number: int, settings: Settings) -> Entry:
        """Compute the joint along the ramp; the settings are values of parameters and of the load."""
        try:
            with np.errstate(all="ignore"):
                columns = self.evaluate(settings)
        except (ValueError, RuntimeError) as error:
            return _failed_entry(run_number, settings, str(error))
        if not all(np.all(np.isfinite(column)) for column in columns.values()):
            return _failed_entry(run_number, settings, "the law gives no finite value")
        return {"run": run_number, "parameters": dict(settings), "columns": columns}

    def evaluate(self, settings: Settings) -> dict[str, Array]:
        """Loads and all quantities of a sample of the joint, at the loads that are evaluated.

        Raises ValueError, one line, if the law refuses the sample.
        """
        curves = self.curves
        values = {name: value for name, value in settings.items() if name != curves.load.name}
        load = settings.get(curves.load.name)
        factor = 1.0 if load is None else load if self.load_is_relative else load / self.loads[-1]
        loads = factor * self.loads
        sample = _Sample(self, values)
        allowed = Interval.from_bounds(gt=0.0, le=curves.max_load(sample.parameters))
        if not allowed.contains(loads[-1]):
            sample.follow({curves.load.name: np.zeros(1)})  # a refused parameter is stated first
            text = f"{curves.load.name} = {loads[-1]:g} {curves.load.unit}"
            raise ValueError(f"{text} is outside {allowed}: {LOAD_INTERVAL_MEANING}")
        rows = np.arange(loads.size) if self.load_indices is None else self.load_indices
        outputs = self._evaluate_outputs(sample, loads, rows)
        columns = {curves.load.name: loads[rows], **outputs}
        is_loaded = loads[rows] > 0.0
        for quantity in curves.derived_outputs:
            column = np.zeros(rows.size)
            column[is_loaded] = quantity.compute_values(sample, loads[rows][is_loaded])
            columns[quantity.variable.name] = column
        return columns

    def _evaluate_outputs(self, sample: "_Sample", loads: Array, load_indices: Array) -> dict[str, Array]:
        """Outputs of the FMU at the selected loads; along a long ramp they are interpolated by splines.

        The splines interpolate log(output) over log(load), or output/load if the output has zeros.
        """
        name, count = self.curves.load.name, self.curves.knot_count
        loaded = loads[loads > 0.0]
        if count is None or loaded.size <= count:
            found = sample.follow({name: loads[load_indices]})
            return {v.name: found[v.name] for v in self.curves.outputs}
        knots = np.geomspace(loaded[0], loaded[-1], count)
        found = sample.follow({name: np.append(0.0, knots)})
        is_loaded, columns = loads[load_indices] > 0.0, {}
        weights = spline_weights(
            np.log(knots / knots[-1]), np.log(loads[load_indices][is_loaded] / knots[-1])
        )
        for variable in self.curves.outputs:
            values = found[variable.name]
            column = np.full(load_indices.size, values[0])
            if np.all(values[1:] > 0.0):
                column[is_loaded] = np.exp(weights @ np.log(values[1:]))
            else:
                column[is_loaded] = loads[load_indices][is_loaded] * (weights @ (values[1:] / knots))
            columns[variable.name] = column
        return columns


class _Sample:
    """Joint with the parameters of one sample; implements `curves.JointSample`."""

    def __init__(self, ramp: JointRamp, values: Settings) -> None:
        curves, base = ramp.curves, ramp.file.values
        self._joint, self._values = _open_joint(ramp), {**values, **curves.settings}
        numbers = {
            name: np.float64(value) if type(value) is float else value for name, value in values.items()
        }
        self.parameters: Any = assemble_parameter_set(
            type(base), {**ramp.file.values_by_name, **numbers}, _make_unchecked
        )
        self._other_inputs = curves.other_inputs(self.parameters)

    def follow(self, inputs: Mapping[str, Array], settings: Settings | None = None) -> Mapping[str, Array]:
        """Evaluate the joint at inputs (n), each reached from the virgin state: all outputs (n) [SI]."""
        engine = self._joint.with_values({**self._values, **(settings or {})})
        return engine.follow({**self._other_inputs, **inputs}, each_from_rest=True).columns


def _make_unchecked(cls: type[Any], arguments: Mapping[str, Any]) -> Any:
    """Make an instance of a frozen dataclass without checking its values; the FMU checks them."""
    instance = object.__new__(cls)
    for name, value in arguments.items():
        object.__setattr__(instance, name, value)
    return instance


_thread_local_joint = local()
"""Joint that this thread has open: `key` of its study, and `joint`."""


def _open_joint(ramp: JointRamp) -> VariableJoint:
    """Open the joint of a study, once in a thread."""
    if getattr(_thread_local_joint, "key", None) != ramp.study_key:
        model = KINDS[ramp.file.joint].find_model(ramp.curves.model)
        _thread_local_joint.key, _thread_local_joint.joint = ramp.study_key, VariableJoint(model, ramp.file)
    joint: VariableJoint = _thread_local_joint.joint
    return joint
