"""The experiments of an FMU: smoke test, load ramp, loop, shipped models, neighbours of refusals, samples."""

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
from jointfmu.parameters import ParameterFile, load, read_document
from jointfmu.quantity import changed

from .neighbours import neighbours
from .reference import Stimulus, results, rounded, start_of
from .series import TimeSeries

RAMP, FEW, LEAST = 20, 4, 2
"""Levels of the load ramp [1], of the smoke test and shipped models, of neighbours and samples."""
QUARTER, CYCLES = 6, 1
"""Levels of a quarter of a loop [1], and its cycles after first loading."""
FRACTION = 0.25
"""Interval of a model that moves by itself, over that of its ramp [1]: its profile has many instants."""
SAMPLES = 6
_REFUSALS = (ValueError, RuntimeError, ArithmeticError)
SPREAD = 0.01
"""Half width of the uncertainty experiment [1]: a test plan; it does not say how well numbers are known."""


@dataclass(frozen=True, slots=True)
class ReferenceExperiment:
    """An experiment; `settings` are those that differ from the FMU's start values."""

    purpose: str
    name: str
    doc: str
    settings: Mapping[str, object]
    drive: Stimulus
    results: TimeSeries


def experiments(model: Model, parameters: ParameterFile) -> list[ReferenceExperiment]:
    """All experiments, the smoke test first.

    Raises ValueError or RuntimeError if the joint refuses its own parameter file.
    """
    model = model.loaded(model.spring(parameters.values), start_of(model, parameters))
    return [
        _experiment(model, parameters, "smoke-test", "smoke test", "a few loads", {}, FEW),
        _experiment(model, parameters, "validation", "load ramp", "the default experiment", {}, RAMP),
        *_loop(model, parameters),
        *(
            _experiment(model, parameters, "validation", f"model {file.name}", "a shipped model", own, FEW)
            for file, own in models(model, parameters)[1:]
        ),
        *_neighbours(model, parameters),
        *_samples(model, parameters),
    ]


def models(model: Model, parameters: ParameterFile) -> list[tuple[ParameterFile, dict[str, object]]]:
    """The parameter file, and the shipped ones of the same joint, law and structure, each with what differs.

    Numbers that the FMU does not expose stay those of the parameter file; groups of them are structure.
    """
    found = [(parameters, dict[str, object]())]
    if model.joint not in KINDS:
        return found
    fields = model.parameter_fields()
    for file in _shipped(model.joint, KINDS[model.joint].default_file().parent):
        if type(file.values) is not type(parameters.values) or file.flat.keys() != parameters.flat.keys():
            continue
        differing = {name for name, value in file.flat.items() if value != parameters.flat[name]}
        settings = {name: file.flat[name] for name in fields if name in differing}
        if settings and differing <= fields.keys() | set(model.hidden):
            found.append((file, settings))
    return found


@cache
def _shipped(joint: str, folder: Path) -> tuple[ParameterFile, ...]:
    """The parameter files of a joint in a folder, and bought ones."""
    folders = [folder, Path(str(files("jointfmu_models") / "catalogue"))]
    paths = sorted(path for one in folders if one.is_dir() for path in one.glob("*.toml"))
    own = [path for path in paths if read_document(path, "a parameter file").get("joint") == joint]
    return tuple(load(path, joint) for path in own)


def study(model: Model, parameters: ParameterFile) -> dict[str, str]:
    """{parameter: its distribution} of the uncertainty experiment, as study files have them."""
    return dict.fromkeys(_uncertain(model, parameters), f"+-{SPREAD:.0%}")


def _uncertain(model: Model, parameters: ParameterFile) -> list[str]:
    """Parameters that are real numbers other than zero."""
    return [
        name
        for name, item in model.parameter_fields().items()
        if isinstance(value := parameters.flat[name], float) and value and not item.metadata["whole"]
    ]


def _experiment(
    model: Model,
    parameters: ParameterFile,
    purpose: str,
    name: str,
    doc: str,
    settings: Mapping[str, object],
    levels: int,
) -> ReferenceExperiment:
    """The load ramp in some levels, but the first where it loads; a model with states rests under its end."""
    settings = {**model.ramp.settings, **settings}
    start, end = start_of(model, parameters)[model.ramp.input], model.ramp.end
    if model.states:
        places = np.full(levels + 1, end)
        settings = {**settings, model.ramp.input: end}
    else:
        loading = np.linspace(max(start, model.ramp.begin), end, levels + 1)[1:]
        places = np.array([rounded(x) for x in (start, *loading)])
    interval = model.ramp.interval * (FRACTION if model.moves else 1.0)
    drive = Stimulus(model.ramp.input, places, interval)
    return ReferenceExperiment(
        purpose, name, doc, settings, drive, _results(model, parameters, settings, drive)
    )


def _results(
    model: Model, parameters: ParameterFile, settings: Mapping[str, Any], drive: Stimulus
) -> TimeSeries:
    start = start_of(model, parameters)
    own = {name: value for name, value in settings.items() if name not in start}
    values = changed(parameters.values, own) if own else parameters.values
    return results(model, values, start | {n: v for n, v in settings.items() if n in start}, drive)


def _loop(model: Model, parameters: ParameterFile) -> Iterator[ReferenceExperiment]:
    """From rest to the amplitude, and to and fro, in a triangle."""
    if (loop := model.loop) is None:
        return
    middle = dict(loop.settings).get(loop.input, start_of(model, parameters)[loop.input])
    phase = np.arange(QUARTER * (1 + 4 * CYCLES) + 1) / (4.0 * QUARTER)
    turned = 1.0 - 4.0 * np.abs((phase + 0.25) % 1.0 - 0.5)
    levels = np.array([rounded(middle + loop.amplitude * x) for x in turned])
    drive = Stimulus(loop.input, levels, model.ramp.interval)
    doc = f"{loop.input} to and fro by {loop.amplitude:g}, from rest"
    with suppress(*_REFUSALS):
        found = _results(model, parameters, loop.settings, drive)
        yield ReferenceExperiment("validation", "loop", doc, loop.settings, drive, found)


def _neighbours(model: Model, parameters: ParameterFile) -> Iterator[ReferenceExperiment]:
    found: dict[tuple[str, object], ReferenceExperiment] = {}

    def taken(name: str, value: object) -> bool:
        shown = str(value).lower() if isinstance(value, bool) else f"{value:.9g}"
        with suppress(*_REFUSALS):
            found[name, value] = _experiment(
                model, parameters, "validation", f"{name} = {shown}", "", {name: value}, LEAST
            )
        return (name, value) in found

    for name, value, doc in neighbours(model, parameters, taken):
        yield replace(found[name, value], doc=doc)


def _samples(model: Model, parameters: ParameterFile) -> Iterator[ReferenceExperiment]:
    """Points of an additive recurrence by square roots of primes, but those that the joint refuses."""
    names = _uncertain(model, parameters)
    steps = np.sqrt(list(islice(_primes(), len(names))))
    doc = f"all real parameters within {SPREAD:.0%}"
    for number in range(1, SAMPLES + 1 if names else 1):
        place = 2.0 * ((number * steps) % 1.0) - 1.0
        settings = {
            name: rounded(parameters.flat[name] * (1.0 + SPREAD * x))
            for name, x in zip(names, place, strict=True)
        }
        with suppress(*_REFUSALS):
            yield _experiment(
                model, parameters, "uncertainty-analysis", f"sample {number}", doc, settings, LEAST
            )


def _primes() -> Iterator[int]:
    return (n for n in count(2) if all(n % m for m in range(2, n)))
