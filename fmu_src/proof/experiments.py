"""Reference experiments of an FMU: smoke test, load ramp, loop, shipped models, boundary values, samples."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
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
from .reference import Stimulus, compute_results, list_start_values, round_to_digits
from .series import TimeSeries

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
SAMPLING_OVER_RAMP_INTERVAL = 0.25
"""Sampling interval of a time-dependent model over the interval of its ramp [1]."""
SAMPLE_COUNT = 6
"""Number of experiments in which all parameters are varied [1]."""
_REFUSAL_ERRORS = (ValueError, RuntimeError, ArithmeticError)
"""Errors by which a joint refuses parameters or inputs."""
PARAMETER_VARIATION_HALF_WIDTH = 0.01
"""Half width of the parameter variation over the parameter's value [1]: a test plan, no uncertainty."""


@dataclass(frozen=True, slots=True)
class ReferenceExperiment:
    """Reference experiment of an FMU, with its results.

    purpose         : one of `standard.EXPERIMENT_PURPOSES`
    variable_values : {variable: value} that differ from the start values of the FMU
    stimulus        : levels of the driven input
    """

    purpose: str
    name: str
    doc: str
    variable_values: Mapping[str, object]
    stimulus: Stimulus
    results: TimeSeries


def compute_experiments(model: Model, parameters: ParameterFile) -> list[ReferenceExperiment]:
    """Compute all experiments of an FMU, the smoke test first.

    Raises ValueError or RuntimeError if the joint refuses its own parameter file.
    """
    model = model.with_load_range(model.tabulate(parameters.values), list_start_values(model, parameters))
    return [
        _compute_ramp(
            model, parameters, "smoke-test", "smoke test", "a few loads", {}, SMOKE_TEST_INPUT_LEVEL_COUNT
        ),
        _compute_ramp(
            model, parameters, "validation", "load ramp", "the default experiment", {}, RAMP_INPUT_LEVEL_COUNT
        ),
        *_compute_hysteresis_loops(model, parameters),
        *(
            _compute_ramp(
                model,
                parameters,
                "validation",
                f"model {file.name}",
                "a shipped model",
                settings,
                SMOKE_TEST_INPUT_LEVEL_COUNT,
            )
            for file, settings in list_shipped_variants(model, parameters)[1:]
        ),
        *_compute_boundary_experiments(model, parameters),
        *_compute_sampled_experiments(model, parameters),
    ]


def list_shipped_variants(
    model: Model, parameters: ParameterFile
) -> list[tuple[ParameterFile, dict[str, object]]]:
    """List (parameter file, {variable: value}) of the given file and the shipped files with the same C code.

    Hidden numbers (no FMU variables) keep the values of the parameter file. Shipped files that differ in
    other values, on which the C code depends, are left out.
    """
    files_and_settings = [(parameters, dict[str, object]())]
    if model.joint not in KINDS:
        return files_and_settings
    fields = model.parameter_fields()
    for file in _load_shipped_files(model.joint, KINDS[model.joint].default_file().parent):
        if (
            type(file.values) is not type(parameters.values)
            or file.values_by_name.keys() != parameters.values_by_name.keys()
        ):
            continue
        differing = {
            name for name, value in file.values_by_name.items() if value != parameters.values_by_name[name]
        }
        settings = {name: file.values_by_name[name] for name in fields if name in differing}
        if settings and differing <= fields.keys() | set(model.fixed_parameters):
            files_and_settings.append((file, settings))
    return files_and_settings


@cache
def _load_shipped_files(joint_name: str, folder: Path) -> tuple[ParameterFile, ...]:
    """Read the parameter files of a joint in a folder, and in the catalogue of bought joints."""
    folders = [folder, Path(str(files("jointfmu_models") / "catalogue"))]
    paths = sorted(path for source in folders if source.is_dir() for path in source.glob("*.toml"))
    joint_paths = [
        path for path in paths if read_document(path, "a parameter file").get("joint") == joint_name
    ]
    return tuple(load_parameter_file(path, joint_name) for path in joint_paths)


def make_uncertainty_study(model: Model, parameters: ParameterFile) -> dict[str, str]:
    """{parameter: distribution} of the experiments with varied parameters, in the notation of study files."""
    return dict.fromkeys(
        _list_varied_parameters(model, parameters), f"+-{PARAMETER_VARIATION_HALF_WIDTH:.0%}"
    )


def _list_varied_parameters(model: Model, parameters: ParameterFile) -> list[str]:
    """Names of the parameters that are varied: real numbers other than zero."""
    return [
        name
        for name, item in model.parameter_fields().items()
        if isinstance(value := parameters.values_by_name[name], float)
        and value
        and not item.metadata["whole"]
    ]


def _compute_ramp(
    model: Model,
    parameters: ParameterFile,
    purpose: str,
    experiment_name: str,
    doc: str,
    variable_values: Mapping[str, object],
    level_count: int,
) -> ReferenceExperiment:
    """Compute a load ramp with a number of levels; a model with states gets the end load throughout."""
    variable_values = {**model.ramp.parameter_values, **variable_values}
    start, end = list_start_values(model, parameters)[model.ramp.input_name], model.ramp.end_value
    if model.state_count:
        ramp_levels = np.full(level_count + 1, end)
        variable_values = {**variable_values, model.ramp.input_name: end}
    else:
        loading = np.linspace(max(start, model.ramp.onset_value), end, level_count + 1)[1:]
        ramp_levels = np.array([round_to_digits(x) for x in (start, *loading)])
    interval = model.ramp.step_duration * (SAMPLING_OVER_RAMP_INTERVAL if model.is_time_dependent else 1.0)
    drive = Stimulus(model.ramp.input_name, ramp_levels, interval)
    return ReferenceExperiment(
        purpose,
        experiment_name,
        doc,
        variable_values,
        drive,
        _compute_outputs(model, parameters, variable_values, drive),
    )


def _compute_outputs(
    model: Model, parameters: ParameterFile, variable_values: Mapping[str, Any], stimulus: Stimulus
) -> TimeSeries:
    """Outputs of the package for an experiment with given parameters and start values."""
    start = list_start_values(model, parameters)
    changes = {name: value for name, value in variable_values.items() if name not in start}
    values = replace_values(parameters.values, changes) if changes else parameters.values
    return compute_results(
        model, values, start | {n: v for n, v in variable_values.items() if n in start}, stimulus
    )


def _compute_hysteresis_loops(model: Model, parameters: ParameterFile) -> Iterator[ReferenceExperiment]:
    """Yield the loop experiment of the model, if it has one: triangular cycles about the start value."""
    if (loop := model.load_cycle) is None:
        return
    middle = dict(loop.variable_values).get(
        loop.input_name, list_start_values(model, parameters)[loop.input_name]
    )
    phase = np.arange(QUARTER_CYCLE_INPUT_LEVEL_COUNT * (1 + 4 * LOOP_CYCLE_COUNT) + 1) / (
        4.0 * QUARTER_CYCLE_INPUT_LEVEL_COUNT
    )
    triangle = 1.0 - 4.0 * np.abs((phase + 0.25) % 1.0 - 0.5)
    levels = np.array([round_to_digits(middle + loop.amplitude * x) for x in triangle])
    drive = Stimulus(loop.input_name, levels, model.ramp.step_duration)
    doc = f"{loop.input_name} to and fro by {loop.amplitude:g}, from rest"
    with suppress(*_REFUSAL_ERRORS):
        outputs = _compute_outputs(model, parameters, loop.variable_values, drive)
        yield ReferenceExperiment("validation", "loop", doc, loop.variable_values, drive, outputs)


def _compute_boundary_experiments(model: Model, parameters: ParameterFile) -> Iterator[ReferenceExperiment]:
    """Yield an experiment for each parameter value just inside its allowed interval."""
    computed: dict[tuple[str, object], ReferenceExperiment] = {}

    def is_accepted(name: str, value: object) -> bool:
        """Whether the joint computes finite outputs with the parameter at this value."""
        value_text = str(value).lower() if isinstance(value, bool) else f"{value:.9g}"
        with suppress(*_REFUSAL_ERRORS):
            computed[name, value] = _compute_ramp(
                model,
                parameters,
                "validation",
                f"{name} = {value_text}",
                "",
                {name: value},
                MIN_INPUT_LEVEL_COUNT,
            )
        return (name, value) in computed

    for name, value, doc in find_boundary_values(model, parameters, is_accepted):
        yield replace(computed[name, value], doc=doc)


def _compute_sampled_experiments(model: Model, parameters: ParameterFile) -> Iterator[ReferenceExperiment]:
    """Yield experiments with all real parameters varied, except points that the joint refuses.

    The points are an additive recurrence with the square roots of primes (low discrepancy).
    """
    names = _list_varied_parameters(model, parameters)
    steps = np.sqrt(list(islice(_generate_primes(), len(names))))
    doc = f"all real parameters within {PARAMETER_VARIATION_HALF_WIDTH:.0%}"
    for number in range(1, SAMPLE_COUNT + 1 if names else 1):
        point = 2.0 * ((number * steps) % 1.0) - 1.0
        settings = {
            name: round_to_digits(
                parameters.values_by_name[name] * (1.0 + PARAMETER_VARIATION_HALF_WIDTH * x)
            )
            for name, x in zip(names, point, strict=True)
        }
        with suppress(*_REFUSAL_ERRORS):
            yield _compute_ramp(
                model,
                parameters,
                "uncertainty-analysis",
                f"sample {number}",
                doc,
                settings,
                MIN_INPUT_LEVEL_COUNT,
            )


def _generate_primes() -> Iterator[int]:
    """Yield the prime numbers."""
    return (n for n in count(2) if all(n % m for m in range(2, n)))
