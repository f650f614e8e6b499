"""Cases of all joints (tests/joints/KIND/cases.py), and the package's joints behind the FMUs."""

from dataclasses import dataclass, replace
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
from case import Case, Inputs, Joint

from jointfmu.joints import KINDS, MODELS
from jointfmu.mechanics.curve import MAX_INTERPOLATION_ERROR
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set as make
from jointfmu.quantity import flatten_parameters

SAME = 1e-12
"""Relative tolerance [1] of the python flavour, which runs the package's code: round-off of sums in another
order."""
TABLE = 5.0 * MAX_INTERPOLATION_ERROR
"""Relative tolerance [1] of an FMU against a law without table: five times the error of a table."""


def load(kind: str) -> Joint:
    """`JOINT` of tests/joints/KIND/cases.py; fails if a joint has none."""
    path = Path(__file__).parents[1] / "joints" / kind / "cases.py"
    assert path.is_file(), f"{path} is missing: the shared tests need it"
    spec = spec_from_file_location(f"{kind}_cases", path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    joint = module.JOINT
    assert [case.name for case in joint.cases] == [model.name for model in KINDS[kind].models]
    return joint


JOINTS: dict[str, Joint] = {kind: load(kind) for kind in KINDS}
"""{joint: its properties for the tests}."""
CASES: dict[str, Case] = {case.name: case for joint in JOINTS.values() for case in joint.cases}
"""{FMU: its properties for the tests}."""
NAMES = list(MODELS)
GOOD: dict[str, Inputs] = {name: case.numbers.good for name, case in CASES.items()}
STATE: dict[str, Inputs] = {name: case.numbers.state for name, case in CASES.items()}
RANGES = {name: dict(case.numbers.ranges) for name, case in CASES.items()}
PUBLIC: dict[str, dict[str, dict[str, str]]] = {
    name: {
        "input": dict(case.description.inputs),
        "output": dict(case.description.results),
        "parameter": dict(case.description.parameters),
    }
    for name, case in CASES.items()
}
"""Public contract: {FMU: {causality: {variable: unit}}}; an FMU may have more variables."""
BEYOND = [(name, beyond) for name, case in CASES.items() for beyond in case.refusals.beyond]
TUNED = {name: case.tuning.tuned for name, case in CASES.items()}


def random_inputs(name: str, count: int, seed: int) -> list[Inputs]:
    """Random inputs inside the tables."""
    rng, ranges = np.random.default_rng(seed), CASES[name].numbers.ranges
    drawn = [{k: float(rng.uniform(*limits)) for k, limits in ranges.items()} for _ in range(count)]
    return [CASES[name].numbers.place(inputs) for inputs in drawn]


def parameters(name: str, changes: dict[str, Any] | None = None) -> Any:
    """Default parameter set of an FMU, with changes."""
    values = load_default(MODELS[name].joint).values
    return make(type(values), flatten_parameters(values) | (changes or {}))


@cache
def _tabulated(joint: str, p: Any) -> Any:
    return KINDS[joint].tabulate(p)


@dataclass(frozen=True)
class Law:
    """Outputs of the package's joint behind an FMU, as a function of inputs, from a history."""

    name: str
    spring: Any
    memory: Any = None

    def __call__(self, inputs: Inputs) -> dict[str, float]:
        if self.memory is None:
            found = CASES[self.name].numbers.outputs(self.spring, inputs)
        else:
            found = MODELS[self.name].advance(self.spring, inputs, self.memory)[0]
        return {k: float(x) for k, x in found.items()}

    def after(self, inputs: Inputs | None = None) -> "Law":
        """The same joint after these inputs were accepted (others zero), as at the end of initialization or
        of a step."""
        model = MODELS[self.name]
        if model.advance is None:
            return self
        before = model.initial_history(self.spring) if self.memory is None else self.memory
        given = dict.fromkeys((v.name for v in model.inputs), 0.0) | (inputs or {})
        return replace(self, memory=model.advance(self.spring, given, before)[1])


def law(name: str, p: Any) -> Law:
    """Joint of the package behind an FMU, in the virgin state."""
    return Law(name, _tabulated(MODELS[name].joint, p))
