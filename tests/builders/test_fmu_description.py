"""Model descriptions of FMUs: public variables, units, and requirements of the standard."""

import ast
import math
import os
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.validation import validate_fmu
from joint_cases import CASES, NAMES, PUBLIC
from jointfmu_fmu_src.building import build_fmus
from lxml import etree
from scipy.constants import zero_Celsius
from surroundings import Enter, environment

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_parameters

DEGREE = math.pi / 180.0
SHOWN = {
    "deg": DEGREE,
    "arcmin": DEGREE / 60.0,
    "rev/min": 2.0 * math.pi / 60.0,
    "um2": 1e-12,
    "mm2": 1e-6,
    "degC": 1.0,
}
"""Display units whose SI value does not follow from the prefixes below."""
PREFIX = {"M": 1e6, "G": 1e9, "k": 1e3, "m": 1e-3, "u": 1e-6}
BASE: dict[str, dict[str, int]] = {
    "m": {"m": 1}, "s": {"s": 1}, "kg": {"kg": 1}, "rad": {"rad": 1}, "1": {}, "K": {"K": 1},
    "N": {"kg": 1, "m": 1, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
}  # fmt: skip


def si_value(shown: str) -> float:
    """SI value of one display unit: 1e6 for N/um."""
    top, _, bottom = shown.partition("/")
    if shown in SHOWN:
        return SHOWN[shown]
    if bottom:
        return math.prod(map(si_value, top.split("."))) / si_value(bottom)
    if "." in top:
        return math.prod(map(si_value, top.split(".")))
    if top.endswith("2") and len(top) > 1:
        return si_value(top[:-1]) ** 2
    return 1.0 if top in BASE else PREFIX[top[0]] * (si_value(top[1:]))


def dimension(unit: str) -> dict[str, int]:
    """Exponents of the SI base units of an SI unit, e.g. N.m/rad."""
    found: dict[str, int] = {}
    for part, sign in zip(unit.partition("/")[::2], (1, -1), strict=True):
        for factor in filter(None, part.split(".")):
            squared = factor.endswith("2")
            for base, power in BASE[factor.removesuffix("2")].items():
                found[base] = found.get(base, 0) + sign * power * (2 if squared else 1)
    return {base: power for base, power in found.items() if power}


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def root(fmus: Path, name: str) -> Any:
    with zipfile.ZipFile(fmus / f"{name}.fmu") as file:
        return etree.fromstring(file.read("modelDescription.xml"))


def variables(root: Any, causality: str | None = None) -> dict[str, Any]:
    found = root.findall("ModelVariables/ScalarVariable")
    return {v.get("name"): v for v in found if causality in (None, v.get("causality"))}


def test_all_fmus_of_the_contract_are_built_and_no_other(fmus: Path) -> None:
    assert {p.stem for p in fmus.glob("*.fmu")} == set(CASES) == set(MODELS)


def test_fmpy_finds_no_problem(fmus: Path, name: str) -> None:
    assert validate_fmu(str(fmus / f"{name}.fmu")) == []


def test_the_description_follows_the_schema(root: Any) -> None:
    folder = Path(fmpy.__file__).parent / "schema" / "fmi2"
    schema = etree.XMLSchema(etree.parse(folder / "fmi2ModelDescription.xsd"))
    schema.assertValid(root)
    root.find("CoSimulation").set("needsExecutionTool", "maybe")
    assert not schema.validate(root)


def test_public_variables_have_their_causality_and_unit(root: Any, name: str) -> None:
    for causality, expected in PUBLIC[name].items():
        found = {
            k: v.find("Real").get("unit") for k, v in variables(root, causality).items() if k in expected
        }
        assert found == expected
    assert set(variables(root, "input")) == set(PUBLIC[name]["input"])  # a further one would stay at zero


def test_every_variable_is_described_and_every_unit_defined(root: Any) -> None:
    units = {u.get("name"): u for u in root.findall("UnitDefinitions/Unit")}
    used = set()
    for v in variables(root).values():
        assert len(v.get("description")) > 5, v.get("name")
        real = v.find("Real")
        if real is None:
            assert v.find("Boolean") is not None
            continue
        unit = units[real.get("unit")]
        assert real.get("displayUnit") in {d.get("name") for d in unit.findall("DisplayUnit")}, v.get("name")
        used.add(real.get("unit"))
    assert used == set(units)


def test_base_units_and_display_factors_say_what_the_names_say(root: Any) -> None:
    for unit in root.findall("UnitDefinitions/Unit"):
        base = {k: int(v) for k, v in unit.find("BaseUnit").attrib.items()}
        assert base == dimension(unit.get("name")), unit.get("name")
        for shown in unit.findall("DisplayUnit"):
            # FMI 2.0, 2.2.2: display value = factor * value; 1e-12 is a few times the round-off of the table
            zero = zero_Celsius if shown.get("name") == "degC" else 0.0
            assert float(shown.get("offset", "0")) == -zero
            assert float(shown.get("factor")) * si_value(shown.get("name")) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    ("fmu_name", "variable", "shown"),
    [(name, *shown) for name, case in CASES.items() for shown in case.description.shown.items()],
)
def test_display_units_are_common_units(fmus: Path, fmu_name: str, variable: str, shown: str) -> None:
    found = {v.name: v for v in fmpy.read_model_description(str(fmus / f"{fmu_name}.fmu")).modelVariables}
    assert found[variable].displayUnit == shown


def test_angles_are_offered_in_degrees_and_arc_minutes_too(fmus: Path) -> None:
    units = fmpy.read_model_description(str(fmus / "HarmonicDriveSpring.fmu")).unitDefinitions
    offered = {u.name: {d.name for d in u.displayUnits} for u in units}
    assert {"deg", "arcmin"} <= offered["rad"]


def test_initial_unknowns_are_the_outputs(root: Any) -> None:
    order = list(variables(root))
    structure = root.find("ModelStructure")
    listed = {
        part: [order[int(u.get("index")) - 1] for u in structure.find(part)]
        for part in ("Outputs", "InitialUnknowns")
    }
    assert listed["Outputs"] == listed["InitialUnknowns"] == list(variables(root, "output"))


def test_declared_dependencies_name_inputs_and_initially_parameters_as_well(root: Any) -> None:
    order = list(variables(root))
    inputs, parameters = set(variables(root, "input")), set(variables(root, "parameter"))
    structure = root.find("ModelStructure")
    for output, initial in zip(structure.find("Outputs"), structure.find("InitialUnknowns"), strict=True):
        later = {order[int(i) - 1] for i in output.get("dependencies").split()}
        first = {order[int(i) - 1] for i in initial.get("dependencies").split()}
        assert later <= inputs
        assert first == later | parameters


def test_bounds_are_those_of_the_parameters(root: Any, name: str) -> None:
    fields = MODELS[name].parameter_fields()
    for variable, node in variables(root, "parameter").items():
        real, meta = node.find("Real"), fields[variable].metadata
        if real is None:
            continue
        low, high = float(real.get("min", "-inf")), float(real.get("max", "inf"))
        start = float(real.get("start"))
        assert low <= start <= high
        allowed = meta["interval"]
        assert allowed.low <= low
        assert high <= allowed.high
        for bound, end, is_open in (
            (low, allowed.low, allowed.low_open),
            (high, allowed.high, allowed.high_open),
        ):
            assert (bound == end) != is_open or math.isinf(bound), variable  # an open end is not allowed


def test_bounds_are_numbers_that_every_reader_takes(root: Any) -> None:
    for variable, node in variables(root).items():
        for bound in ("min", "max", "nominal"):
            value = float(node[0].get(bound, "0"))
            # std::stod of C++ throws at a denormal number
            assert value == 0.0 or sys.float_info.min <= abs(value) < math.inf, f"{variable}: {bound}"


def test_start_values_are_the_default_parameters(root: Any, name: str) -> None:
    values = flatten_parameters(load_default(MODELS[name].joint).values)
    for variable, node in variables(root, "parameter").items():
        start = (node.find("Real") if node.find("Real") is not None else node.find("Boolean")).get("start")
        expected = values[variable]
        read = start == "true" if isinstance(expected, bool) else float(start)
        assert read == expected, variable  # to the last bit: importers set start values back
    for i in MODELS[name].inputs:
        assert float(variables(root, "input")[i.name].find("Real").get("start")) == i.start


def test_the_default_experiment_is_the_load_ramp_one_step_per_second(fmus: Path, name: str) -> None:
    experiment = fmpy.read_model_description(str(fmus / f"{name}.fmu")).defaultExperiment
    ramp, steps = MODELS[name].ramp, CASES[name].description.steps
    assert float(experiment.startTime) == 0.0
    assert float(experiment.stepSize) == 1.0
    assert float(experiment.stopTime) == pytest.approx(ramp.end_value / ramp.value_step, rel=1e-12)
    assert steps is None or float(experiment.stopTime) == steps
    assert ramp.input_name in CASES[name].description.inputs


def test_the_description_declares_the_capabilities_of_the_fmu(root: Any, name: str) -> None:
    flags = root.find("CoSimulation").attrib
    expected = {
        "modelIdentifier": name,
        "needsExecutionTool": "false",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canHandleVariableCommunicationStepSize": "true",
    }
    assert {k: flags.get(k) for k in expected} == expected
    assert root.get("generationDateAndTime").endswith("Z")
    assert root.get("fmiVersion") == "2.0"
    assert root.get("variableNamingConvention") == "structured"


def test_calibration_parameters_say_so_and_no_other(root: Any, name: str) -> None:
    fields = MODELS[name].parameter_fields()
    described = {k for k, v in variables(root, "parameter").items() if "calibration" in v.get("description")}
    assert described == {k for k, f in fields.items() if f.metadata.get("calibration")}
    assert CASES[name].description.calibration <= described


def test_equal_content_gives_an_equal_guid_and_file(fmus: Path, tmp_path: Path, enter: Enter) -> None:
    names = ["GearContact", "BoltedJoint"]  # without and with a memory; all share the builder
    enter(environment(SOURCE_DATE_EPOCH="1700000000"))
    first = build_fmus(names, ["python"], None, tmp_path / "a")
    second = build_fmus(names, ["python"], None, tmp_path / "b")
    for a, b in zip(first, second, strict=True):
        assert a.read_bytes() == b.read_bytes()
        md = fmpy.read_model_description(str(a))
        assert md.generationDateAndTime == "2023-11-14T22:13:20Z"
        assert md.guid == fmpy.read_model_description(str(fmus / a.name)).guid


def test_every_fmu_and_every_parameter_set_has_its_own_guid(fmus: Path, tmp_path: Path) -> None:
    file = load_default("gear_contact").with_values({"e": 0.25}, "user", "test")
    (other,) = build_fmus(["GearContact"], ["python"], file, tmp_path)
    paths = [*fmus.glob("*.fmu"), other]
    assert len({fmpy.read_model_description(str(path)).guid for path in paths}) == len(PUBLIC) + 1


def imported(source: str) -> set[str]:
    """Top-level names of all absolute imports of a module, at any depth."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(str(node.module).split(".")[0])
    return found


def test_the_fmu_needs_numpy_and_nothing_else(fmus: Path, name: str) -> None:
    sources: Mapping[str, set[str]]
    with zipfile.ZipFile(fmus / f"{name}.fmu") as file:
        inside = [n for n in file.namelist() if n.startswith("resources/") and n.endswith(".py")]
        sources = {n: imported(file.read(n).decode()) for n in inside}
    package = {n.split("/")[1] for n in sources if n.split("/")[1].startswith("jointfmu_")}
    assert len(package) == 1
    for path, found in sources.items():
        if path.startswith("resources/pythonfmu/"):
            continue  # ships with itself; its builder is never imported by a slave
        foreign = found - set(sys.stdlib_module_names) - {"numpy", "pythonfmu"} - package
        # the package's own file imports its public interface on first access, which no slave asks for
        lazy = {"jointfmu_tools"} if path.count("/") == 2 and path.endswith("/__init__.py") else set()
        assert foreign == lazy, path
    assert any("numpy" in found for found in sources.values())


def test_no_stray_files_are_shipped(fmus: Path, name: str) -> None:
    with zipfile.ZipFile(fmus / f"{name}.fmu") as file:
        names = file.namelist()
        assert not [n for n in names if "__pycache__" in n or n.endswith((".pyc", "~"))]
        assert {f"binaries/linux64/{name}.so", f"binaries/win64/{name}.dll"} <= set(names)
        text = "\n".join(file.read(n).decode() for n in names if n.endswith((".py", ".toml", ".xml", ".txt")))
    assert os.path.expanduser("~") + "/" not in text
    assert str(Path(__file__).parents[2]) not in text
