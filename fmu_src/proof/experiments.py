"""Reference experiments of an FMU: smoke test, load ramp, loop, shipped models, boundary values, samples."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, load_parameter_file, read_document
from jointfmu.quantity import replace_values

from .boundary_values import find_boundary_values
from .reference import Stimulus, compute_reference_results, list_start_values, round_to_significant_digits
from .series import TimeSeries
from .standard import MIN_TOLERANCE_SCALE_OVER_NOMINAL

RAMP_INPUT_LEVEL_COUNT = 20
"""Number of levels of the driven input on the load ramp [1]."""
SMOKE_TEST_INPUT_LEVEL_COUNT = 4
"""Number of levels of the driven input in the smoke test and for shipped parameter files [1]."""
MIN_INPUT_LEVEL_COUNT = 2
"""Number of levels of the driven input for boundary values and random parameters [1]."""
QUARTER_CYCLE_INPUT_LEVEL_COUNT = 6
"""Number of levels of the driven input in a quarter cycle of the loop [1]."""
LOOP_CYCLE_COUNT = 1
"""Number of cycles of the loop after first loading [1]."""
SAMPLING_INTERVAL_OVER_RAMP_STEP = 0.25
"""Sampling interval of a time-dependent model over the interval of its ramp [1]."""
SAMPLED_EXPERIMENT_COUNT = 6
"""Number of experiments in which all parameters are varied [1]."""
_PARAMETER_REFUSAL_ERRORS = (ValueError, RuntimeError, ArithmeticError)
"""Errors by which a joint refuses parameters or inputs."""
PARAMETER_VARIATION_HALF_WIDTH = 0.01
"""Half width of the parameter variation over the parameter's value [1]: a test plan, no uncertainty."""


@dataclass(frozen=True, slots=True)
class ReferenceExperiment:
    """Reference experiment of an FMU: one input varied over time, and the outputs that the package computes.

    experiment_purpose : one of `standard.EXPERIMENT_PURPOSES`
    variable_values    : {variable: value} that differ from the start values of the FMU
    input_stimulus     : levels of the driven input
    output_scales      : {output: size to which its tolerance is relative, instead of each reference value}
    """

    experiment_purpose: str
    experiment_name: str
    experiment_description: str
    variable_values: Mapping[str, object]
    input_stimulus: Stimulus
    reference_results: TimeSeries
    output_scales: Mapping[str, float] = field(default_factory=dict)


def compute_reference_experiments(
    fmu_model: Model, parameter_file: ParameterFile
) -> list[ReferenceExperiment]:
    """Compute all reference experiments of an FMU, the smoke test first.

    Raises ValueError or RuntimeError if the joint refuses the values of the parameter file.
    """
    fmu_model = fmu_model.with_load_range(
        fmu_model.tabulate(parameter_file.values), list_start_values(fmu_model, parameter_file)
    )
    return [
        _compute_load_ramp_experiment(
            fmu_model,
            parameter_file,
            "smoke-test",
            "smoke test",
            "a few loads",
            {},
            SMOKE_TEST_INPUT_LEVEL_COUNT,
        ),
        _compute_load_ramp_experiment(
            fmu_model,
            parameter_file,
            "validation",
            "load ramp",
            "the default experiment",
            {},
            RAMP_INPUT_LEVEL_COUNT,
        ),
        *_compute_hysteresis_loops(fmu_model, parameter_file),
        *(
            _compute_load_ramp_experiment(
                fmu_model,
                parameter_file,
                "validation",
                f"model {file.name}",
                "a shipped model",
                settings,
                SMOKE_TEST_INPUT_LEVEL_COUNT,
            )
            for file, settings in list_shipped_variants(fmu_model, parameter_file)[1:]
        ),
        *_compute_boundary_experiments(fmu_model, parameter_file),
        *_compute_sampled_experiments(fmu_model, parameter_file),
    ]


def list_shipped_variants(
    fmu_model: Model, parameter_file: ParameterFile
) -> list[tuple[ParameterFile, dict[str, object]]]:
    """List (parameter file, {parameter: value}) of the given file and the shipped files with the same C code.

    The values are those of FMU variables that differ from the given file. Parameters that are no FMU
    variables keep the values of the given file. Shipped files with other C code are left out.
    """
    files_and_settings = [(parameter_file, dict[str, object]())]
    if fmu_model.joint not in KINDS:
        return files_and_settings
    fields = fmu_model.parameter_fields()
    for file in _load_shipped_files(fmu_model.joint, KINDS[fmu_model.joint].default_file().parent):
        if (
            type(file.values) is not type(parameter_file.values)
            or file.values_by_name.keys() != parameter_file.values_by_name.keys()
        ):
            continue
        differing = {
            name
            for name, value in file.values_by_name.items()
            if value != parameter_file.values_by_name[name]
        }
        settings = {name: file.values_by_name[name] for name in fields if name in differing}
        if settings and differing <= fields.keys() | set(fmu_model.fixed_parameters):
            files_and_settings.append((file, settings))
    return files_and_settings


@cache
def _load_shipped_files(joint_name: str, parameter_file_folder: Path) -> tuple[ParameterFile, ...]:
    """Load the parameter files of a joint in a folder, and in the shipped catalogue of bought joints."""
    folders = [parameter_file_folder, Path(str(files("jointfmu_models") / "catalogue"))]
    paths = sorted(path for source in folders if source.is_dir() for path in source.glob("*.toml"))
    joint_paths = [
        path for path in paths if read_document(path, "a parameter file").get("joint") == joint_name
    ]
    return tuple(load_parameter_file(path, joint_name) for path in joint_paths)


def make_uncertainty_study(fmu_model: Model, parameter_file: ParameterFile) -> dict[str, str]:
    """Distributions of the experiments with varied parameters: {parameter: text as in files of studies}."""
    return dict.fromkeys(
        _list_varied_parameters(fmu_model, parameter_file), f"+-{PARAMETER_VARIATION_HALF_WIDTH:.0%}"
    )


def _list_varied_parameters(fmu_model: Model, parameter_file: ParameterFile) -> list[str]:
    """List the parameters that the sampled experiments vary: real numbers other than zero."""
    return [
        name
        for name, item in fmu_model.parameter_fields().items()
        if isinstance(value := parameter_file.values_by_name[name], float)
        and value
        and not item.metadata["whole"]
    ]


def _compute_load_ramp_experiment(
    fmu_model: Model,
    parameter_file: ParameterFile,
    experiment_purpose: str,
    experiment_name: str,
    experiment_description: str,
    variable_values: Mapping[str, object],
    input_level_count: int,
) -> ReferenceExperiment:
    """Compute the reference experiment of a load ramp with equidistant load levels.

    For a model with states the load is constant: the end of the ramp.
    """
    variable_values = {**fmu_model.ramp.parameter_values, **variable_values}
    start, end = (
        list_start_values(fmu_model, parameter_file)[fmu_model.ramp.input_name],
        fmu_model.ramp.end_value,
    )
    if fmu_model.state_count:
        ramp_levels = np.full(input_level_count + 1, end)
        variable_values = {**variable_values, fmu_model.ramp.input_name: end}
    else:
        loading = np.linspace(max(start, fmu_model.ramp.onset_value), end, input_level_count + 1)[1:]
        ramp_levels = np.array([round_to_significant_digits(x) for x in (start, *loading)])
    interval = fmu_model.ramp.step_duration * (
        SAMPLING_INTERVAL_OVER_RAMP_STEP if fmu_model.is_time_dependent else 1.0
    )
    drive = Stimulus(fmu_model.ramp.input_name, ramp_levels, interval)
    return ReferenceExperiment(
        experiment_purpose,
        experiment_name,
        experiment_description,
        variable_values,
        drive,
        _compute_experiment_outputs(fmu_model, parameter_file, variable_values, drive),
    )


def _compute_experiment_outputs(
    fmu_model: Model,
    parameter_file: ParameterFile,
    variable_values: Mapping[str, Any],
    input_stimulus: Stimulus,
) -> TimeSeries:
    """Compute the outputs of the package for an experiment with given parameters and start values."""
    start = list_start_values(fmu_model, parameter_file)
    changes = {name: value for name, value in variable_values.items() if name not in start}
    values = replace_values(parameter_file.values, changes) if changes else parameter_file.values
    return compute_reference_results(
        fmu_model, values, start | {n: v for n, v in variable_values.items() if n in start}, input_stimulus
    )


def _compute_hysteresis_loops(
    fmu_model: Model, parameter_file: ParameterFile
) -> Iterator[ReferenceExperiment]:
    """Yield the hysteresis loop of an FMU, if its model has one: triangular cycles of an input."""
    if (loop := fmu_model.load_cycle) is None:
        return
    middle = dict(loop.variable_values).get(
        loop.input_name, list_start_values(fmu_model, parameter_file)[loop.input_name]
    )
    phase = np.arange(QUARTER_CYCLE_INPUT_LEVEL_COUNT * (1 + 4 * LOOP_CYCLE_COUNT) + 1) / (
        4.0 * QUARTER_CYCLE_INPUT_LEVEL_COUNT
    )
    triangle = 1.0 - 4.0 * np.abs((phase + 0.25) % 1.0 - 0.5)
    levels = np.array([round_to_significant_digits(middle + loop.input_amplitude * x) for x in triangle])
    drive = Stimulus(loop.input_name, levels, fmu_model.ramp.step_duration)
    doc = f"{loop.input_name} to and fro by {loop.input_amplitude:g}, from rest"
    with suppress(*_PARAMETER_REFUSAL_ERRORS):
        outputs = _compute_experiment_outputs(fmu_model, parameter_file, loop.variable_values, drive)
        scales = (
            loop.find_output_scales(parameter_file.values, outputs.columns) if loop.find_output_scales else {}
        )
        nominal = {output.name: output.nominal for output in fmu_model.outputs}
        scales = {
            name: max(scale, MIN_TOLERANCE_SCALE_OVER_NOMINAL * nominal[name])
            for name, scale in scales.items()
        }
        yield ReferenceExperiment("validation", "loop", doc, loop.variable_values, drive, outputs, scales)


def _compute_boundary_experiments(
    fmu_model: Model, parameter_file: ParameterFile
) -> Iterator[ReferenceExperiment]:
    """Yield an experiment for each end of each parameter's allowed interval, just inside the interval."""
    computed: dict[tuple[str, object], ReferenceExperiment] = {}

    def is_parameter_value_accepted(parameter_name: str, parameter_value: object) -> bool:
        """Whether the joint computes finite outputs with a parameter at a given value."""
        value_text = (
            str(parameter_value).lower() if isinstance(parameter_value, bool) else f"{parameter_value:.9g}"
        )
        with suppress(*_PARAMETER_REFUSAL_ERRORS):
            computed[parameter_name, parameter_value] = _compute_load_ramp_experiment(
                fmu_model,
                parameter_file,
                "validation",
                f"{parameter_name} = {value_text}",
                "",
                {parameter_name: parameter_value},
                MIN_INPUT_LEVEL_COUNT,
            )
        return (parameter_name, parameter_value) in computed

    for name, value, doc in find_boundary_values(fmu_model, parameter_file, is_parameter_value_accepted):
        yield replace(computed[name, value], experiment_description=doc)


def _compute_sampled_experiments(
    fmu_model: Model, parameter_file: ParameterFile
) -> Iterator[ReferenceExperiment]:
    """Yield experiments with all real parameters varied, except samples that the joint refuses.

    The samples are quasi-random: multiples of the square roots of primes, modulo 1 (low discrepancy).
    """
    names = _list_varied_parameters(fmu_model, parameter_file)
    steps = np.sqrt(list(islice(_generate_primes(), len(names))))
    doc = f"all real parameters within {PARAMETER_VARIATION_HALF_WIDTH:.0%}"
    for number in range(1, SAMPLED_EXPERIMENT_COUNT + 1 if names else 1):
        point = 2.0 * ((number * steps) % 1.0) - 1.0
        settings = {
            name: round_to_significant_digits(
                parameter_file.values_by_name[name] * (1.0 + PARAMETER_VARIATION_HALF_WIDTH * x)
            )
            for name, x in zip(names, point, strict=True)
        }
        with suppress(*_PARAMETER_REFUSAL_ERRORS):
            yield _compute_load_ramp_experiment(
                fmu_model,
                parameter_file,
                "uncertainty-analysis",
                f"sample {number}",
                doc,
                settings,
                MIN_INPUT_LEVEL_COUNT,
            )


def _generate_primes() -> Iterator[int]:
    """Yield the prime numbers."""
    return (n for n in count(2) if all(n % m for m in range(2, n)))
