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

from ...run.engine import ParametricJoint
from ...run.host import is_member_needed_to_run
from ...run.ramps import ramp
from .curves import LoadCurves, find_load_curves, spline_weights

KILLED_RUN_MESSAGE = "the process of the run died"
"""Error message in the journal for a run whose process died."""
LOAD_INTERVAL_DESCRIPTION = "up to the end of the tabulated law"
"""Meaning of the load interval, for error messages."""

Settings: TypeAlias = Mapping[str, Any]
"""{name: value} of a run: its sampled parameters and inputs, and others that the study sets."""
Run: TypeAlias = tuple[int, Settings]
"""Index of a run in its study, and its settings."""
Entry: TypeAlias = dict[str, Any]
"""Journal entry of a run: `run`, `parameters`, and `columns` {variable: values (m)} or `error`."""


class RampEvaluator(Protocol):
    """Object that computes the runs of an uncertainty study along the load ramp. It can be pickled.

    runs_per_job     : number of runs that a worker process executes as one job
    runs_per_process : least number of runs for each worker process that is started; with fewer runs, the
        process of the command executes them. 0: the process of the command executes none
    """

    @property
    def runs_per_job(self) -> int: ...

    @property
    def runs_per_process(self) -> int: ...

    def embed_files(self) -> "RampEvaluator":
        """Copy of the evaluator that contains its files, to be sent to another machine."""

    def install_files(self, target_folder: Path) -> "RampEvaluator":
        """Copy of the evaluator whose files are in a folder of this machine."""

    def execute_run(self, run_number: int, run_settings: Settings) -> Entry:
        """Evaluate a run of the study; return its journal entry."""


def run_job(job: tuple[RampEvaluator, Path, Sequence[Run]]) -> list[Entry]:
    """Execute some runs of a study in a worker process of this machine; return their journal entries.

    job : evaluator, folder of temporary files, runs
    """
    evaluator, folder, runs = job
    tempfile.tempdir = str(folder)
    return [evaluator.execute_run(index, settings) for index, settings in runs]


def _make_failed_run_entry(run_number: int, run_settings: Settings, error_message: str) -> Entry:
    """Journal entry of a run that failed: its settings and the error message."""
    return {
        "run": run_number,
        "parameters": dict(run_settings),
        "error": replace_unprintable(error_message)[:MAX_TEXT_LENGTH],
    }


def make_killed_run_entry(run_number: int, run_settings: Settings) -> Entry:
    """Journal entry of a run whose process died."""
    return _make_failed_run_entry(run_number, run_settings, KILLED_RUN_MESSAGE)


@dataclass(frozen=True, slots=True)
class LoadRamp:
    """Load ramp of all runs of an FMU: name of the driven input, end and step [unit of the input].

    The FMU runs along it as in `ramp.run_ramp`.
    """

    input: str
    to: float
    step: float


@dataclass(frozen=True)
class FmuRampEvaluator:
    """Evaluator that runs an FMU along its load ramp, see `RampEvaluator`.

    fmu_content : bytes of the FMU, if it is to be sent to another machine
    """

    runs_per_job: ClassVar[int] = 1
    runs_per_process: ClassVar[int] = 0

    fmu_path: Path
    load_ramp: LoadRamp
    fmu_content: bytes | None = None

    def embed_files(self) -> "FmuRampEvaluator":
        """Copy of the evaluator with the bytes of its FMU."""
        return replace(self, fmu_content=self.fmu_path.read_bytes())

    def install_files(self, target_folder: Path) -> "FmuRampEvaluator":
        """Write a copy of the FMU with only the files that a run needs; each run then unpacks it faster."""
        full, slim = self.fmu_path, target_folder / self.fmu_path.name
        if self.fmu_content is not None:
            full = target_folder / f"{slim.name}.full"
            full.write_bytes(self.fmu_content)
        write_slim_fmu(full, slim)
        if self.fmu_content is not None:
            full.unlink()
        return replace(self, fmu_path=slim, fmu_content=None)

    def execute_run(self, run_number: int, run_settings: Settings) -> Entry:
        """Run the FMU along the ramp; the settings are start values of parameters and inputs."""
        drive = self.load_ramp
        try:
            result = ramp.run_ramp(self.fmu_path, drive.input, drive.to, drive.step, run_settings)
        except (ValueError, RuntimeError) as error:
            return _make_failed_run_entry(
                run_number, run_settings, str(error).replace(str(self.fmu_path), self.fmu_path.name)
            )
        if not_finite := [
            key for key, column in result.variable_columns.items() if not np.all(np.isfinite(column))
        ]:
            return _make_failed_run_entry(run_number, run_settings, f"{not_finite[0]} is not finite")
        columns = {key: column.tolist() for key, column in result.variable_columns.items()}
        return {"run": run_number, "parameters": dict(run_settings), "columns": columns}


def write_slim_fmu(fmu_path: Path, slim_fmu_path: Path) -> None:
    """Write a copy of an FMU without sources, documentation and binaries of other platforms."""
    with archives.open_archive(fmu_path) as full, zipfile.ZipFile(slim_fmu_path, "w") as reduced:
        for item in full.infolist():
            if is_member_needed_to_run(item.filename) and not item.is_dir():
                reduced.writestr(item, archives.read_member(full, item.filename))


@dataclass(frozen=True)
class JointRampEvaluator:
    """Evaluator that computes the joint of a parameter file along a load ramp, see `RampEvaluator`.

    loads                  : load ramp (m), ascending
    load_is_relative       : whether the sampled load is a factor on all loads of the ramp; False: it is the
        last load, in whose proportion the other loads change
    opens_joint_per_sample : whether each sample opens the joint, for parameters that the FMU does not expose;
        this takes seconds
    evaluated_load_indices : indices of the loads that are evaluated; None: all
    study_key              : text that identifies the study
    """

    parameter_file: ParameterFile
    loads: Array
    load_is_relative: bool = False
    opens_joint_per_sample: bool = False
    evaluated_load_indices: Array | None = None
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
        if not KINDS[self.parameter_file.joint].package.startswith("jointfmu."):
            return sys.maxsize
        return 4 if self.opens_joint_per_sample else 512

    def __getstate__(self) -> dict[str, Any]:
        """Attributes for pickle, with a new parameter set that has no cached properties.

        Cached properties may be functions, which pickle rejects.
        """
        stated = self.parameter_file.values_by_name
        values = assemble_parameter_set(
            type(self.parameter_file.values), stated, _make_unchecked_parameter_set
        )
        return {**self.__dict__, "parameter_file": replace(self.parameter_file, values=values)}

    @property
    def load_curves(self) -> LoadCurves:
        """What a study computes along a load ramp for this kind of joint."""
        return find_load_curves(KINDS[self.parameter_file.joint])

    def embed_files(self) -> "JointRampEvaluator":
        """Return this evaluator unchanged: it needs no files (the evaluator of an FMU packs the FMU)."""
        return self

    def install_files(self, target_folder: Path) -> "JointRampEvaluator":
        """Return this evaluator unchanged: it needs no files (the evaluator of an FMU unpacks the FMU)."""
        return self

    def execute_run(self, run_number: int, run_settings: Settings) -> Entry:
        """Compute the joint along the ramp; the settings are values of parameters and of the load."""
        try:
            with np.errstate(all="ignore"):
                columns = self.evaluate_sample(run_settings)
        except (ValueError, RuntimeError) as error:
            return _make_failed_run_entry(run_number, run_settings, str(error))
        if not all(np.all(np.isfinite(column)) for column in columns.values()):
            return _make_failed_run_entry(run_number, run_settings, "the law gives no finite value")
        return {"run": run_number, "parameters": dict(run_settings), "columns": columns}

    def evaluate_sample(self, run_settings: Settings) -> dict[str, Array]:
        """Return the ramped load and all quantities of one sample of the joint, {name: (n)}, at n loads.

        Raises ValueError, one line, if the law refuses the sample.
        """
        curves = self.load_curves
        values = {name: value for name, value in run_settings.items() if name != curves.ramped_input.name}
        load = run_settings.get(curves.ramped_input.name)
        factor = 1.0 if load is None else load if self.load_is_relative else load / self.loads[-1]
        loads = factor * self.loads
        sample = _SampledJoint(self, values)
        allowed = Interval.from_bounds(gt=0.0, le=curves.max_load(sample.parameter_set))
        if not allowed.contains(loads[-1]):
            sample.evaluate_outputs(
                {curves.ramped_input.name: np.zeros(1)}
            )  # a refused parameter is stated first
            text = f"{curves.ramped_input.name} = {loads[-1]:g} {curves.ramped_input.unit}"
            raise ValueError(f"{text} is outside {allowed}: {LOAD_INTERVAL_DESCRIPTION}")
        rows = np.arange(loads.size) if self.evaluated_load_indices is None else self.evaluated_load_indices
        outputs = self._evaluate_outputs(sample, loads, rows)
        columns = {curves.ramped_input.name: loads[rows], **outputs}
        is_loaded = loads[rows] > 0.0
        for quantity in curves.derived_outputs:
            column = np.zeros(rows.size)
            column[is_loaded] = quantity.compute_values(sample, loads[rows][is_loaded])
            columns[quantity.output_variable.name] = column
        return columns

    def _evaluate_outputs(
        self, joint_sample: "_SampledJoint", loads: Array, load_indices: Array
    ) -> dict[str, Array]:
        """Outputs of the FMU at the selected loads; along a long ramp they are interpolated by splines.

        The splines interpolate log(output) over log(load), or output/load if the output has zeros.
        """
        name, count = self.load_curves.ramped_input.name, self.load_curves.knot_count
        loaded = loads[loads > 0.0]
        if count is None or loaded.size <= count:
            found = joint_sample.evaluate_outputs({name: loads[load_indices]})
            return {v.name: found[v.name] for v in self.load_curves.outputs}
        knots = np.geomspace(loaded[0], loaded[-1], count)
        found = joint_sample.evaluate_outputs({name: np.append(0.0, knots)})
        is_loaded, columns = loads[load_indices] > 0.0, {}
        weights = spline_weights(
            np.log(knots / knots[-1]), np.log(loads[load_indices][is_loaded] / knots[-1])
        )
        for variable in self.load_curves.outputs:
            values = found[variable.name]
            column = np.full(load_indices.size, values[0])
            if np.all(values[1:] > 0.0):
                column[is_loaded] = np.exp(weights @ np.log(values[1:]))
            else:
                column[is_loaded] = loads[load_indices][is_loaded] * (weights @ (values[1:] / knots))
            columns[variable.name] = column
        return columns


class _SampledJoint:
    """Joint with the parameters of one sample of a study, and its outputs at given inputs."""

    def __init__(self, joint_evaluator: JointRampEvaluator, sampled_values: Settings) -> None:
        curves, base = joint_evaluator.load_curves, joint_evaluator.parameter_file.values
        self._joint, self._values = (
            _open_joint(joint_evaluator),
            {**sampled_values, **curves.fixed_parameters},
        )
        numbers = {
            name: np.float64(value) if type(value) is float else value
            for name, value in sampled_values.items()
        }
        self.parameter_set: Any = assemble_parameter_set(
            type(base),
            {**joint_evaluator.parameter_file.values_by_name, **numbers},
            _make_unchecked_parameter_set,
        )
        self._fixed_inputs = curves.fixed_inputs(self.parameter_set)

    def evaluate_outputs(
        self, input_values: Mapping[str, Array], parameter_changes: Settings | None = None
    ) -> Mapping[str, Array]:
        """Evaluate the joint at inputs (n), each reached from the virgin state: all outputs (n) [SI]."""
        engine = self._joint.open_with_values({**self._values, **(parameter_changes or {})})
        return engine.evaluate_path(
            {**self._fixed_inputs, **input_values}, restart_at_each_point=True
        ).variable_columns


def _make_unchecked_parameter_set(cls: type[Any], attributes: Mapping[str, Any]) -> Any:
    """Make a parameter set, or one of its groups, without checking the values; the FMU checks them.

    cls : frozen dataclass of the set or group
    """
    instance = object.__new__(cls)
    for name, value in attributes.items():
        object.__setattr__(instance, name, value)
    return instance


_thread_local_joint = local()
"""Joint that this thread has open: `key` of its study, and `joint`."""


def _open_joint(joint_evaluator: JointRampEvaluator) -> ParametricJoint:
    """Open the joint of a study, once in a thread."""
    if getattr(_thread_local_joint, "key", None) != joint_evaluator.study_key:
        model = KINDS[joint_evaluator.parameter_file.joint].find_model(joint_evaluator.load_curves.fmu_name)
        _thread_local_joint.key, _thread_local_joint.joint = (
            joint_evaluator.study_key,
            ParametricJoint(model, joint_evaluator.parameter_file),
        )
    joint: ParametricJoint = _thread_local_joint.joint
    return joint
