"""WebAssembly modules of the laboratory give the native FMUs' numbers and refusals, in wasmtime and Chromium.

The same C with the same order of operations and no mathematical library: the same bits.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import browser
from clients import needs
from conftest import Fmu
from joint_cases import random_inputs
from jointfmu_tools.pages.laboratory.assemble import write_laboratory
from jointfmu_tools.pages.laboratory.describe import PageModule, list_modules
from webassembly import Instance, native_fmu, random_values, refused_values

pytestmark = pytest.mark.slow

needed = needs("Chromium")
SETS, REFUSED, STEPS = 22, 2, 4
"""Numbers of accepted parameter sets (a few of them may have no table), of refused ones, and of steps."""
ACCEPTED = 20
EVERY = {f"{m.fmu_model.name}, {m.parameter_files[0].law}": m for m in list_modules()}


@dataclass(frozen=True)
class Case:
    """Parameter set and path from rest, with the outputs of the native FMU along it, or its refusal."""

    values: dict[str, Any]
    path: list[dict[str, float]]
    outputs: list[dict[str, float]]
    refusal: str


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("laboratory")


@pytest.fixture(scope="module", params=EVERY)
def module(request: pytest.FixtureRequest) -> PageModule:
    """Every WebAssembly module of the page."""
    return EVERY[request.param]


@pytest.fixture(scope="module")
def fmu(module: PageModule, folder: Path) -> Iterator[Fmu]:
    made = Fmu(native_fmu(module, folder / module.parameter_files[0].law))
    yield made
    made.free_instance()


@pytest.fixture(scope="module")
def cases(module: PageModule, fmu: Fmu) -> list[Case]:
    """Cases with results of the native FMU: random numbers, then with random Booleans too."""
    rng = np.random.default_rng(15)
    values = [random_values(module, rng, switched=i % 3 == 2) for i in range(SETS)]
    values += [refused_values(module, rng) for _ in range(REFUSED)]
    found = []
    for i, each in enumerate(values):
        path = [module_inputs(module, given) for given in random_inputs(module.fmu_model.name, STEPS, seed=i)]
        found.append(native(fmu, each, path))
    assert sum(not case.refusal for case in found[:SETS]) >= ACCEPTED
    assert all(case.refusal for case in found[SETS:])
    return found


def module_inputs(module: PageModule, given: dict[str, float]) -> dict[str, float]:
    return dict.fromkeys((v.name for v in module.fmu_model.inputs), 0.0) | given


def native(fmu: Fmu, values: dict[str, Any], path: list[dict[str, float]]) -> Case:
    fmu.reset()
    seen = len(fmu.messages)
    try:
        fmu.start(values)
    except Exception:  # fmpy raises its own
        errors = [m.message_text for m in fmu.messages[seen:] if m.fmi_status == 3]
        return Case(values, path, [], errors[0])
    outputs = []
    for inputs in path:
        fmu.set_values(inputs)
        fmu.step()
        outputs.append(fmu.get())
    return Case(values, path, outputs, "")


def compare(case: Case, found: list[dict[str, float]]) -> None:
    for expected, row in zip(case.outputs, found, strict=True):
        assert row == expected, case.values


@pytest.fixture(scope="module")
def instance(module: PageModule) -> Instance:
    return Instance(module, module.compile_module())


def test_wasmtime_gives_the_numbers_and_refusals(
    module: PageModule, cases: list[Case], instance: Instance
) -> None:
    for case in cases:
        _ = instance.said
        accepted = instance.start(case.values)
        assert accepted == (not case.refusal)
        if case.refusal:
            assert instance.said == [f"3{case.refusal}"]
            continue
        found = []
        for inputs in case.path:
            instance.set(inputs)
            assert instance.step()
            found.append(instance.get())
        compare(case, found)


def test_wasmtime_gives_the_derivatives(module: PageModule, fmu: Fmu, instance: Instance) -> None:
    (given,) = random_inputs(module.fmu_model.name, 1, seed=5)
    inputs = module_inputs(module, given)
    fmu.reset()
    fmu.start(inputs)
    assert instance.start(inputs)
    v = fmu.variables
    for output in instance.outputs:
        for known in inputs:
            references = [v[output].valueReference], [v[known].valueReference]
            expected = fmu.fmu.getDirectionalDerivative(*references, [1.0])[0]
            assert instance.derivative(output, known) == expected, (output, known)


@pytest.fixture(scope="module")
def shown(folder: Path) -> Iterator[Any]:
    page = folder / "laboratory.html"
    write_laboratory(page)
    with browser() as one:
        one.open(page)
        one.run("laboratory.then(() => true)")
        yield one


_RUN = """(async () => {{
  const lab = await laboratory, cases = {cases};
  const about = lab.known.modules.find((m) => m.name === {name} && m.law === {law});
  const joint = await Joint.of(about), outputs = about.variables.filter((v) => v.causality === "output");
  return cases.map(({{ values, path, refusal }}) => {{
    joint.messages.clear();
    if (!joint.begin(new Map(Object.entries(values)))) return [[...joint.messages], [joint.asShown(refusal)]];
    return path.map((inputs) => {{
      joint.step(inputs);
      return Object.fromEntries(outputs.map((v) => [v.name, joint.get(v.name)]));
    }});
  }});
}})()"""


@needed
def test_chromium_gives_the_numbers_and_refusals(module: PageModule, cases: list[Case], shown: Any) -> None:
    """A refusal has the text of the package, in the units of the sliders."""
    asked = json.dumps([{"values": c.values, "path": c.path, "refusal": c.refusal} for c in cases])
    name, law = json.dumps(module.fmu_model.name), json.dumps(module.parameter_files[0].law)
    for case, found in zip(cases, shown.run(_RUN.format(cases=asked, name=name, law=law)), strict=True):
        if case.refusal:
            said, meant = found
            assert said == meant
        else:
            compare(case, found)
