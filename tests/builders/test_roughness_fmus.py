"""FMUs with the laws `roughness` and `table`: both languages give the numbers of the package."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fmu, here_alone, made_once
from joint_cases import CASES, law, random_inputs
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools.inputs.laws import find_joints_with_law
from natives import Host, close

from jointfmu.joints import MODELS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import build_parameter_set as make
from jointfmu.quantity import flatten_parameters

NAMES = [
    (name, law)
    for law in ("roughness", "table")
    for name, model in MODELS.items()
    if model.joint in find_joints_with_law(law)
]
each_fmu = pytest.mark.parametrize(("name", "law_name"), NAMES)
SLOPE = 1e-5
"""Relative error of a central difference of the package's outputs [1]."""


def file_of(name: str, law_name: str) -> ParameterFile:
    """Parameter file of a law. `roughness`: so flat that part of the real area is elastic at usual loads."""
    file = load_default(MODELS[name].joint, law_name)
    if law_name == "table":
        return file
    return file.with_values({"slope": 0.4 * file.values_by_name["H"] / 2e11}, "user", "test")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with LAW/fmi3/NAME.fmu and LAW/python/NAME.fmu, for both laws."""

    def make_all(out: Path) -> None:
        with here_alone("3"):
            for name, law_name in NAMES:
                build_fmus([name], ["fmi3", "python"], file_of(name, law_name), out / law_name)

    return made_once(tmp_path_factory, "roughness", make_all)


@each_fmu
def test_native_code_gives_the_numbers_of_the_package(
    host: Host, built: Path, name: str, law_name: str
) -> None:
    values = flatten_parameters(file_of(name, law_name).values)
    rng, instance = np.random.default_rng(5), host(name, "fmi3", built / law_name)
    numbers = [n for n, item in instance.variables.items() if item.causality == "parameter"]
    real = [n for n in numbers if isinstance(values[n], float) and not values[n].is_integer()]
    for i in range(4):
        tuned = {n: float(values[n] * rng.uniform(0.9, 1.1)) for n in real if i}
        instance.reset()
        instance.start(tuned)
        expected = law(name, make(type(file_of(name, law_name).values), values | tuned)).after()
        for inputs in random_inputs(name, 10, seed=i):
            assert instance.at(inputs) == close(expected(inputs))


@each_fmu
def test_the_python_flavour_has_the_same_variables_and_numbers(
    host: Host, fmu: Callable[..., Fmu], built: Path, name: str, law_name: str
) -> None:
    python, native = (
        fmu(name, folder=built / law_name / "python").start(),
        host(name, "fmi3", built / law_name).start(),
    )
    assert python.variables.keys() == native.variables.keys() - {"time"}
    for inputs in random_inputs(name, 5, seed=9):
        assert python.at(inputs) == close(native.at(inputs))


@each_fmu
def test_directional_derivatives_are_the_slopes_of_the_outputs(
    host: Host, built: Path, name: str, law_name: str
) -> None:
    state = CASES[name].numbers.state
    instance, expected = (
        host(name, "fmi3", built / law_name).start(),
        law(name, file_of(name, law_name).values).after(),
    )
    references = {n: v.valueReference for n, v in instance.variables.items()}
    outputs = list(instance.at(state))  # a trial: once accepted, sliders at their limits have two slopes
    for moved, value in state.items():
        column = instance.fmu.getDirectionalDerivative(
            [references[n] for n in outputs], [references[moved]], [1.0], len(outputs)
        )
        found = dict(zip(outputs, column, strict=True))
        h = 1e-4 * abs((state | CASES[name].numbers.sizes)[moved])
        ends: list[dict[str, Any]] = [expected({**state, moved: value + d * h}) for d in (-1, 1)]
        for output, now in expected(state).items():
            slope = (ends[1][output] - ends[0][output]) / (2.0 * h)
            size = max(abs(slope), SLOPE * abs(now) / h)
            rough = 1e-3 if output in CASES[name].numbers.jumps else 1e-4
            if output in CASES[name].numbers.kinks:  # of single sliders
                rough = 1e-2
            assert found[output] == pytest.approx(slope, abs=rough * size), (output, moved)


@pytest.mark.parametrize("name", [name for name, law_name in NAMES if law_name == "roughness"])
def test_a_roughness_out_of_range_is_refused(host: Host, built: Path, name: str) -> None:
    instance = host(name, "fmi3", built / "roughness")
    assert instance.refused(instance.start, {"h": 0.0}).startswith("h = 0 m is outside (0, 0.1]")
    instance.reset()
    assert instance.refused(instance.start, {"hurst": 1.0}).startswith("hurst = 1 is outside (0, 1)")


def test_an_unknown_law_is_refused(tmp_path: Path) -> None:
    from jointfmu.parameters import format_parameter_file, load_parameter_file

    path = tmp_path / "joint.toml"
    path.write_text(
        format_parameter_file(load_default("bolted_joint")).replace('law = "zhao2018"', 'law = "hertz"')
    )
    with pytest.raises(ValueError, match="law = 'hertz', allowed are zhao2018, roughness, table"):
        load_parameter_file(path)
    path.write_text(
        format_parameter_file(load_default("bolted_joint")).replace('law = "zhao2018"', 'law = "roughness"')
    )
    with pytest.raises(ValueError, match=r"unknown name 'surface\.D'"):
        load_parameter_file(path)
