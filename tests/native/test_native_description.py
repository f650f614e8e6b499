"""Descriptions of a native FMU: XML of FMI 2.0 and 3.0, terminals, icons and page."""

import csv
import io
import json
import os
import re
import subprocess
import sys
import zipfile
from contextlib import redirect_stdout
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import fmpy
import numpy as np
import pytest
from browser import browser
from clients import needs
from fmpy.model_description import read_build_description
from fmpy.validation import validate_fmu
from joint_cases import CASES, NAMES
from jointfmu_fmu_src.licence import read_licence
from jointfmu_fmu_src.native.description import (
    LOG_CATEGORIES,
    format_build_description,
    format_fmi2_description,
    format_fmi3_description,
)
from jointfmu_fmu_src.native.page import make_documentation
from jointfmu_fmu_src.native.terminals import make_terminal_files
from lxml import etree
from PIL import Image
from scipy.constants import zero_Celsius
from surroundings import Enter, environment
from test_fmu_description import dimension, si_value

from jointfmu import __version__
from jointfmu.joints import MODELS
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_parameters

TOKEN = "{01234567-89ab-5cde-8f01-23456789abcd}"
SOURCES = ("fmi2.c", "instance.c", "law.c")
SCHEMAS = Path(fmpy.__file__).parent / "schema"
XSD = {
    2: SCHEMAS / "fmi2" / "fmi2ModelDescription.xsd",
    3: SCHEMAS / "fmi3" / "fmi3ModelDescription.xsd",
}


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


def description(name: str, version: int) -> bytes:
    model = MODELS[name]
    parameters = load_default(model.joint)
    if version == 2:
        return format_fmi2_description(model, parameters, TOKEN, SOURCES)
    return format_fmi3_description(model, parameters, TOKEN)


@cache
def pages(name: str) -> dict[str, bytes]:
    return make_documentation(MODELS[name], load_default(MODELS[name].joint))


@cache
def pictures(name: str) -> dict[str, bytes]:
    return make_terminal_files(MODELS[name])


def fmu(path: Path, xml: bytes, **files: bytes) -> str:
    """FMU without binaries."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", xml)
        for inside, content in files.items():
            archive.writestr(inside, content)
    return str(path)


def listed(name: str, version: int) -> dict[str, dict[str, str]]:
    """All attributes of every variable by name, with `type`; in the same form for both versions."""
    nodes = etree.fromstring(description(name, version)).find("ModelVariables")
    if version == 2:
        return {n.get("name"): {**n.attrib, **n[0].attrib, "type": n[0].tag} for n in nodes}
    kinds = {"Float64": "Real", "Boolean": "Boolean"}
    return {n.get("name"): {**n.attrib, "type": kinds[n.tag]} for n in nodes}


def structure(name: str, version: int, part: str) -> dict[str, dict[str, str]]:
    """{unknown: {known: dependenciesKind}} of `Output` or `InitialUnknown`."""
    root = etree.fromstring(description(name, version))
    names = {v["valueReference"]: k for k, v in listed(name, version).items()}
    path, key = (f"{part}s/Unknown", "index") if version == 2 else (part, "valueReference")
    found = {}
    for unknown in root.find("ModelStructure").findall(path):
        knowns, kinds = unknown.get("dependencies").split(), unknown.get("dependenciesKind").split()
        assert knowns == sorted(knowns, key=int)
        found[names[unknown.get(key)]] = {names[k]: kind for k, kind in zip(knowns, kinds, strict=True)}
    return found


def test_the_description_follows_the_schema_of_its_version(name: str, version: int) -> None:
    root = etree.fromstring(description(name, version))
    schema = etree.XMLSchema(etree.parse(XSD[version]))
    schema.assertValid(root)
    assert not etree.XMLSchema(etree.parse(XSD[5 - version])).validate(root)
    root.find("CoSimulation").set("needsExecutionTool", "maybe")
    assert not schema.validate(root)


def test_fmpy_finds_no_problem_and_would_find_one(name: str, version: int, tmp_path: Path) -> None:
    xml = description(name, version)
    assert validate_fmu(fmu(tmp_path / "good.fmu", xml)) == []
    root = etree.fromstring(xml)
    outputs = root.find("ModelStructure/Outputs" if version == 2 else "ModelStructure")
    outputs.remove(outputs[0])
    assert validate_fmu(fmu(tmp_path / "bad.fmu", etree.tostring(root)))


def test_the_description_says_what_it_is(name: str, version: int) -> None:
    root = etree.fromstring(description(name, version))
    assert root.get("fmiVersion") == {2: "2.0", 3: "3.0"}[version]
    assert root.get({2: "guid", 3: "instantiationToken"}[version]) == TOKEN
    assert root.get("modelName") == name
    assert root.get("version") == __version__
    assert root.get("license") == "MIT"
    assert root.get("copyright") in read_licence()
    assert root.get("author")
    assert root.get("generationTool") == f"jointfmu {__version__}"
    assert root.get("variableNamingConvention") == "structured"
    assert {c.get("name") for c in root.find("LogCategories")} == set(LOG_CATEGORIES)
    assert {"logEvents", "logStatusWarning", "logStatusError"} == set(LOG_CATEGORIES)
    assert all(c.get("description") for c in root.find("LogCategories"))
    experiment = root.find("DefaultExperiment")
    ramp = MODELS[name].ramp
    assert float(experiment.get("startTime")) == 0.0
    assert float(experiment.get("stepSize")) == 1.0
    assert float(experiment.get("stopTime")) == pytest.approx(ramp.end_value / ramp.value_step, rel=1e-12)


@pytest.mark.parametrize(
    ("version", "interface", "expected"),
    [
        (2, "ModelExchange", {}),
        (
            2,
            "CoSimulation",
            {
                "canHandleVariableCommunicationStepSize": "true",
                "canInterpolateInputs": "true",
                "maxOutputDerivativeOrder": "0",
                "canRunAsynchronuously": "false",
            },
        ),
        (3, "ModelExchange", {}),
        (
            3,
            "CoSimulation",
            {
                "canHandleVariableCommunicationStepSize": "true",
                "maxOutputDerivativeOrder": "0",
                "hasEventMode": "false",
                "mightReturnEarlyFromDoStep": "false",
                "providesIntermediateUpdate": "false",
            },
        ),
    ],
)
def test_the_description_declares_the_capabilities_of_the_fmu(
    name: str, version: int, interface: str, expected: dict[str, str]
) -> None:
    common = {
        2: {
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": "true",
            "canNotUseMemoryManagementFunctions": "true",
        },
        3: {
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "providesDirectionalDerivatives": "true",
            "providesAdjointDerivatives": "true",
            "providesPerElementDependencies": "true",
        },
    }[version] | {
        "modelIdentifier": name,
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
    }
    if MODELS[name].initial_history and interface == "ModelExchange":  # it has to be told what is accepted
        opposite = {"true": "false", "false": "true"}
        expected = {k: opposite[v] for k, v in expected.items()}
    flags = etree.fromstring(description(name, version)).find(interface).attrib
    assert {k: flags.get(k) for k in common | expected} == common | expected


def test_value_references_count_the_list_of_variables(name: str, version: int) -> None:
    model = MODELS[name]
    time = ["time"] if version == 3 else []
    expected = [*time, *(v.name for v in (*model.inputs, *model.outputs)), *model.parameter_fields()]
    found = listed(name, version)
    assert list(found) == expected
    first = 0 if version == 3 else 1
    assert [int(v["valueReference"]) for v in found.values()] == [first + i for i in range(len(expected))]


def test_only_fmi_3_lists_the_time(name: str) -> None:
    time = listed(name, 3)["time"]
    assert (time["causality"], time["variability"], time["unit"]) == ("independent", "continuous", "s")
    assert "start" not in time
    assert "initial" not in time
    assert "time" not in listed(name, 2)


def test_both_versions_list_the_same_names_and_numbers(name: str) -> None:
    third = listed(name, 3)
    del third["time"]
    assert listed(name, 2) == third


def test_inputs_and_outputs_are_those_of_the_list(name: str, version: int) -> None:
    found = listed(name, version)
    for causality, group in (("input", MODELS[name].inputs), ("output", MODELS[name].outputs)):
        for v in group:
            node = found[v.name]
            assert (node["causality"], node["variability"]) == (causality, "continuous")
            assert node["type"] == "Real"
            assert (node["unit"], node["description"]) == (v.unit, v.doc)
            assert float(node["nominal"]) == v.nominal > 0.0
            assert float(node.get("min", "-inf")) == v.minimum
            assert "max" not in node
            assert node.get("start") == {"input": repr(v.start), "output": None}[causality]
            assert node.get("initial") == {"input": None, "output": "calculated"}[causality]


def test_parameters_are_tunable_and_start_at_the_baked_in_values(name: str, version: int) -> None:
    values, found = flatten_parameters(load_default(MODELS[name].joint).values), listed(name, version)
    for variable, item in MODELS[name].parameter_fields().items():
        node, value = found[variable], values[variable]
        assert (node["causality"], node["variability"]) == ("parameter", "tunable")
        assert node["initial"] == "exact"
        assert node["description"].startswith(item.metadata["doc"])
        if isinstance(value, bool):
            assert (node["type"], node["start"]) == ("Boolean", str(value).lower())
            continue
        assert node["type"] == "Real"
        assert float(node["start"]) == value  # to the last bit: importers set start values back
        assert node["unit"] == item.metadata["unit"]
        assert ("nominal" in node) == (value != 0.0)
        assert float(node.get("nominal", "1")) == abs(value) or value == 0.0


def test_bounds_are_those_of_the_parameters(name: str, version: int) -> None:
    found = listed(name, version)
    for variable, item in MODELS[name].parameter_fields().items():
        meta, node = item.metadata, found[variable]
        if node["type"] == "Boolean":
            continue
        low, high = float(node.get("min", "-inf")), float(node.get("max", "inf"))
        allowed = meta["interval"]
        assert (low, high) == pytest.approx((allowed.low, allowed.high), rel=1e-15, abs=sys.float_info.min)
        for bound, end, is_open in (
            (low, allowed.low, allowed.low_open),
            (high, allowed.high, allowed.high_open),
        ):
            assert (bound == end) != is_open or np.isinf(bound), variable  # an open end is not allowed
        assert low <= float(node["start"]) <= high
        # std::stod of C++ throws at a denormal number
        assert all(v == 0.0 or abs(v) >= sys.float_info.min for v in (low, high))


def test_fixed_parameters_are_fixed_and_nothing_else_changes(name: str, version: int) -> None:
    model, file = MODELS[name], load_default(MODELS[name].joint)
    xml = (
        format_fmi2_description(model, file, TOKEN, SOURCES, "fixed")
        if version == 2
        else format_fmi3_description(model, file, TOKEN, "fixed")
    )
    assert xml == description(name, version).replace(b"tunable", b"fixed")
    assert b'causality="parameter" variability="fixed"' in xml


def test_another_parameter_file_changes_the_start_values_only(version: int) -> None:
    model = MODELS["GearContact"]
    file = load_default(model.joint).with_values({"e": 0.125, "rigid_flat": False}, "user", "test")
    xml = (
        format_fmi2_description(model, file, TOKEN, SOURCES)
        if version == 2
        else format_fmi3_description(model, file, TOKEN)
    )
    changed = {
        ours.strip()
        for ours, theirs in zip(xml.splitlines(), description(model.name, version).splitlines(), strict=True)
        if ours != theirs
    }
    assert len(changed) == 2
    assert any(b'start="0.125"' in line for line in changed)
    assert any(b'start="false"' in line for line in changed)


def test_units_say_what_their_names_say(name: str, version: int) -> None:
    root = etree.fromstring(description(name, version))
    units = {u.get("name"): u for u in root.find("UnitDefinitions")}
    for unit in units.values():
        base = {k: int(v) for k, v in unit.find("BaseUnit").attrib.items()}
        assert base == dimension(unit.get("name"))
        for shown in unit.findall("DisplayUnit"):
            # display value = factor * value; 1e-12 is a few times the round-off of the table
            assert float(shown.get("offset", "0")) == -(zero_Celsius if shown.get("name") == "degC" else 0.0)
            assert float(shown.get("factor")) * si_value(shown.get("name")) == pytest.approx(1.0, rel=1e-12)
    used = {v["unit"] for v in listed(name, version).values() if "unit" in v}
    assert used == set(units)
    for v in listed(name, version).values():
        if "unit" in v:
            shown_in = {d.get("name") for d in units[v["unit"]].findall("DisplayUnit")}
            assert v["displayUnit"] in shown_in


def test_every_number_has_the_type_of_its_quantity(name: str, version: int) -> None:
    root = etree.fromstring(description(name, version))
    types = {t.get("name"): (t[0] if version == 2 else t).attrib for t in root.find("TypeDefinitions")}
    variables = listed(name, version)
    for v in variables.values():
        if v["type"] == "Boolean":
            assert "declaredType" not in v
        else:
            assert types[v["declaredType"]]["unit"] == v["unit"]
    assert {v["declaredType"] for v in variables.values() if "declaredType" in v} == set(types)
    assert (
        len({t["unit"] for t in types.values()}) == len({t["quantity"] for t in types.values()}) == len(types)
    )
    assert not set(types) & set(variables)  # the standards ask for different names


def test_outputs_depend_on_the_inputs_of_the_list(name: str, version: int) -> None:
    model = MODELS[name]
    found = structure(name, version, "Output")
    assert list(found) == [v.name for v in model.outputs]
    for output, knowns in found.items():
        assert set(knowns) == set(model.list_dependencies(output))


def test_initial_unknowns_are_the_outputs_and_know_the_parameters_too(name: str, version: int) -> None:
    model = MODELS[name]
    found = structure(name, version, "InitialUnknown")
    later = structure(name, version, "Output")
    assert list(found) == [v.name for v in model.outputs]
    for output, knowns in found.items():
        assert set(knowns) == set(model.list_dependencies(output)) | set(model.parameter_fields())
        for known, kind in knowns.items():  # parameters still change, so a factor of them is not known yet
            assert kind == ("constant" if later[output].get(known) == "constant" else "dependent")


def samples(name: str, n: int) -> list[dict[str, float]]:
    """Random inputs inside the range of the law, some of them with shear."""
    model, rng = MODELS[name], np.random.default_rng(7)
    scale = {v.name: v.nominal for v in model.inputs} | {model.ramp.input_name: model.ramp.end_value}
    scale |= {"phi1": 0.1, "phi2": 1e-3}
    return [
        {v.name: scale[v.name] * rng.uniform(0.0 if v.minimum == 0.0 else -1.0, 1.0) for v in model.inputs}
        for _ in range(n)
    ]


def outputs(name: str, inputs: dict[str, float], **parameters: float) -> dict[str, float]:
    model = MODELS[name]
    file = load_default(model.joint).with_values(parameters, "user", "test")
    return {k: float(v) for k, v in model.evaluate(model.tabulate(file.values), inputs).items()}


@pytest.mark.slow
def test_an_input_that_is_not_listed_has_no_influence(name: str) -> None:
    model = MODELS[name]
    for inputs, other in zip(samples(name, 3), samples(name, 4)[1:], strict=True):
        before = outputs(name, inputs)
        for v in model.inputs:
            after = outputs(name, inputs | {v.name: other[v.name]})
            for output, knowns in structure(name, 3, "Output").items():
                assert v.name in knowns or after[output] == before[output], (output, v.name)


@pytest.mark.slow
def test_where_a_factor_is_declared_the_output_is_linear_with_it(name: str) -> None:
    checked = 0
    kinds = structure(name, 2, "Output")
    assert kinds == structure(name, 3, "Output")
    for output, knowns in kinds.items():
        for known, kind in knowns.items():
            if kind == "dependent":
                continue
            assert kind in ("constant", "tunable")
            sets: list[dict[str, float]] = [{}]
            if kind == "constant":  # the same for other parameters too
                sets += [dict(CASES[name].description.others)]
            factors = []
            for parameters in sets:
                for inputs in samples(name, 3):
                    for step in (1e-4, 3e-4):
                        ends = [
                            outputs(name, inputs | {known: inputs[known] + s}, **parameters)[output]
                            for s in (0.0, step)
                        ]
                        factors.append((ends[1] - ends[0]) / step)
            # differences of numbers up to 10 over 1e-4: eight digits remain
            assert factors == pytest.approx([factors[0]] * len(factors), rel=1e-8, abs=1e-9)
            checked += 1
    assert (checked > 0) == CASES[name].description.linear


def test_fmi_2_names_the_sources_to_compile(name: str) -> None:
    root = etree.fromstring(description(name, 2))
    for interface in ("ModelExchange", "CoSimulation"):
        files = root.find(f"{interface}/SourceFiles")
        assert tuple(f.get("name") for f in files) == SOURCES


def test_fmi_3_says_how_to_compile_the_sources(name: str, tmp_path: Path) -> None:
    xml = format_build_description(MODELS[name], SOURCES)
    etree.XMLSchema(etree.parse(SCHEMAS / "fmi3" / "fmi3BuildDescription.xsd")).assertValid(
        etree.fromstring(xml)
    )
    path = fmu(tmp_path / "x.fmu", description(name, 3), **{"sources/buildDescription.xml": xml})
    assert validate_fmu(path) == []
    first = read_build_description(path)[0]  # the one that fmpy compiles
    assert first.modelIdentifier == name
    (files,) = first.sourceFileSets
    assert (files.language, tuple(files.sourceFiles)) == ("C11", SOURCES)
    assert files.preprocessorDefinitions == files.includeDirectories == []
    configurations = etree.fromstring(xml).findall("BuildConfiguration")
    platforms = [c.get("platform") for c in configurations]
    assert platforms[0] is None
    assert len(set(platforms)) == len(platforms)
    for c in configurations:
        libraries = [library.get("name") for library in c.findall("Library")]
        assert libraries == (["m"] if "linux" in str(c.get("platform")) else [])


def test_there_is_a_date_only_if_it_is_given(name: str, version: int, enter: Enter) -> None:
    enter(environment(SOURCE_DATE_EPOCH=None))
    undated = description(name, version)
    assert etree.fromstring(undated).get("generationDateAndTime") is None
    enter(environment(SOURCE_DATE_EPOCH="1700000000"))
    dated = etree.fromstring(description(name, version))
    assert dated.get("generationDateAndTime") == "2023-11-14T22:13:20Z"
    enter(environment(SOURCE_DATE_EPOCH="yesterday"))
    with pytest.raises(ValueError, match="SOURCE_DATE_EPOCH = 'yesterday' is not a date"):
        description(name, version)


DIGEST = """
import hashlib
from jointfmu.parameters import load_default
from jointfmu_fmu_src.native.description import (
    format_build_description,
    format_fmi2_description,
    format_fmi3_description,
)
from jointfmu_fmu_src.native.page import make_documentation
from jointfmu_fmu_src.native.terminals import make_terminal_files
from jointfmu.joints import MODELS

for model in MODELS.values():
    file = load_default(model.joint)
    files = make_documentation(model, file) | make_terminal_files(model)
    files |= {"2": format_fmi2_description(model, file, "{}", ["a.c"])}
    files |= {"3": format_fmi3_description(model, file, "{}")}
    files |= {"build": format_build_description(model, ["a.c"])}
    for text in files.values():
        print(hashlib.sha256(text).hexdigest())
"""


@pytest.mark.slow
def test_two_processes_write_the_same_bytes() -> None:
    """The order of sets does not matter: the second process uses another hash seed."""
    variables = {k: v for k, v in os.environ.items() if k != "SOURCE_DATE_EPOCH"}
    run = subprocess.run(
        [sys.executable, "-c", DIGEST],
        env=variables | {"PYTHONHASHSEED": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    with environment(SOURCE_DATE_EPOCH=None), redirect_stdout(io.StringIO()) as out:
        exec(DIGEST, {})
    first = out.getvalue().split()
    assert first == run.stdout.split()
    assert len(set(first)) > 4 * 5  # the files of each FMU differ


def test_terminals_follow_the_schema_and_name_what_exists(name: str) -> None:
    files = pictures(name)
    root = etree.fromstring(files["terminalsAndIcons.xml"])
    schema = etree.XMLSchema(etree.parse(SCHEMAS / "fmi3" / "fmi3TerminalsAndIcons.xsd"))
    schema.assertValid(root)
    variables, used = listed(name, 3), []
    terminals = root.findall("Terminals/Terminal")
    assert len({t.get("name") for t in terminals}) == len(terminals)
    for terminal in terminals:
        members = terminal.findall("TerminalMemberVariable")
        assert len({m.get("memberName") for m in members}) == len(members)
        used += [m.get("variableName") for m in members]
        assert terminal.get("matchingRule") == "plug"
        picture = terminal.find("TerminalGraphicalRepresentation").get("iconBaseName")
        assert files[f"{picture}.png"]
        for member in members:
            unit = variables[member.get("variableName")]["unit"]
            flows = unit in ("N", "N.m")
            assert member.get("memberName") in (("tau", "f") if flows else ("phi", "w", "s", "v"))
            assert (member.get("variableKind") == "signal") == (not flows)
    assert len(set(used)) == len(used)
    assert set(used) <= set(variables)
    del root.find("Terminals/Terminal").attrib["matchingRule"]
    assert not schema.validate(root)


def test_the_flanges_of_each_joint(name: str) -> None:
    root, case = etree.fromstring(pictures(name)["terminalsAndIcons.xml"]), CASES[name]
    found = {
        t.get("name"): " ".join(m.get("variableName") for m in t.findall("TerminalMemberVariable"))
        for t in root.find("Terminals")
    }
    assert found == case.description.flanges
    assert {t.get("terminalKind").split(".")[2] for t in root.find("Terminals")} == set(
        case.description.domain.split()
    )


def test_flows_are_signed_as_the_standard_asks(name: str) -> None:
    """Flows have the sign of FMI 3.0: an inflow acts on the element and winds it up, an outflow is applied by
    the element against the motion."""
    rest = {v.name: 0.0 for v in MODELS[name].inputs} | CASES[name].numbers.rest
    for terminal in etree.fromstring(pictures(name)["terminalsAndIcons.xml"]).find("Terminals"):
        members = {m.get("memberName"): m for m in terminal.findall("TerminalMemberVariable")}
        motion = next(members[m].get("variableName") for m in ("phi", "s") if m in members)
        flow = next(members[m] for m in ("tau", "f") if m in members)
        variable = flow.get("variableName")
        if variable in rest:
            assert flow.get("variableKind") == "inflow"
            step = outputs(name, rest | {variable: 1.0})[motion] - outputs(name, rest)[motion]
            assert step > 0.0
        else:
            assert flow.get("variableKind") == "outflow"
            step = (
                outputs(name, rest | {motion: rest[motion] + 1e-7})[variable] - outputs(name, rest)[variable]
            )
            assert step < 0.0


def test_icons_are_small_and_tell_the_joints_apart() -> None:
    seen = set()
    for fmu_name in NAMES:
        png, svg = (pictures(fmu_name)[f"icon.{kind}"] for kind in ("png", "svg"))
        image = Image.open(io.BytesIO(png))
        assert image.size == (200, 200)
        corner = image.convert("RGBA").getpixel((0, 0))
        assert isinstance(corner, tuple)
        assert corner[3] == 0  # transparent, so that terminals show beside it
        assert len(png) < 6e3
        assert len(svg) < 10e3
        root = etree.fromstring(svg)
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert root.get("viewBox") == "0 0 144 144"
        seen |= {png, svg}
    assert len(seen) == 2 * len(NAMES)


def test_an_icon_that_is_missing_is_named() -> None:
    nameless = replace(MODELS["GearContact"], name="GearContact2")
    with pytest.raises(ValueError, match=r"^GearContact2: \S+GearContact2\.png is missing; it must be"):
        make_terminal_files(nameless)


class Page(HTMLParser):
    """Strict parser of a page: every element must be closed in order; collects the text of table rows."""

    VOID = ("meta", "img", "br", "link")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.rows: list[list[str]] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.links += [str(given[a]) for a in ("href", "src") if a in given]
        self.ids += [str(given["id"])] if "id" in given else []
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.ids += [str(value) for key, value in attrs if key == "id"]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.rows and {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data


def test_the_page_is_well_formed_small_and_complete_in_itself(name: str) -> None:
    text = pages(name)["index.html"].decode()
    assert len(text.encode()) < 64e3
    page = Page(text)
    assert len(set(page.ids)) == len(page.ids)
    local = {"../terminalsAndIcons/icon.svg", "licenses/license.txt", "fmi-ls-ref.txt"}
    assert local <= set(page.links)
    assert all(link.startswith("https://doi.org/") for link in set(page.links) - local)
    assert "licenses/license.txt" in pages(name)
    with pytest.raises(AssertionError):
        Page(text.replace("</table>", "", 1))


def test_the_page_lists_every_variable_and_every_parameter(name: str) -> None:
    model = MODELS[name]
    file = load_default(model.joint)
    rows = {row[0]: row[1:] for row in Page(pages(name)["index.html"].decode()).rows}
    units = listed(name, 3)
    for v in (*model.inputs, *model.outputs):
        unit, shown, doc = rows[v.name]
        assert (unit, shown) == (v.unit, units[v.name]["displayUnit"])
        assert doc.startswith(v.doc)
    for parameter, value in flatten_parameters(file.values).items():
        shown, _, allowed, _, kind, source = rows[parameter]
        assert allowed
        assert kind == file.origins.get(parameter, "default")
        assert source == file.sources.get(parameter, "default choice")
        if isinstance(value, float):
            assert float(shown) == pytest.approx(value, rel=1e-5)  # six digits
        else:
            assert shown == str(value).lower()


def test_the_page_shows_every_warning_and_typical_refusals(name: str) -> None:
    rows = Page(pages(name)["index.html"].decode()).rows
    warnings = [row[1] for row in rows if row[0] == "warning"]
    outside = MODELS[name].validity_limits
    assert len(warnings) == len(outside)
    for text, o in zip(warnings, outside, strict=True):
        assert text.startswith(f"{o.variable_name} = ")
        assert text.endswith(o.doc)
    errors = [row[1] for row in rows if row[0] == "error"]
    assert any(text.startswith(f"{next(iter(MODELS[name].parameter_fields()))} = nan") for text in errors)
    assert any(text.startswith(f"{MODELS[name].inputs[0].name} = nan") for text in errors)


def test_the_page_draws_the_ramp_of_its_own_parameters() -> None:
    model = MODELS["GearContact"]
    file = load_default(model.joint).with_values({"lambda": 0.5}, "user", "my own")
    usual = pages(model.name)["index.html"].decode()
    other = make_documentation(model, file)["index.html"].decode()

    def figure(text: str) -> str:
        return re.findall(r'<script type="application/json">(.*?)</script>', text)[0]

    axes = [(panel["x"], panel["y"]) for panel in json.loads(figure(usual))]
    assert axes == [("f [kN]", "s_rel [um]"), ("f [kN]", "K_N [N/um]")]
    assert figure(other) != figure(usual)
    assert next(r[:4] for r in Page(other).rows if r[0] == "lambda") == ["lambda", "0.5", "1", "(0, 1]"]
    assert "my own" in other


@pytest.mark.slow
@needs("Chromium")
def test_a_browser_draws_every_chart_of_the_page(tmp_path: Path, name: str) -> None:
    """Each chart has as many lines as the page has series and no missing number, also on the width of a
    phone."""
    text = pages(name)["index.html"].decode()
    found = re.findall(r'<script type="application/json">(.*?)</script>', text)
    lines = [len(panel["series"]) for panels in found for panel in json.loads(panels)]
    (tmp_path / "index.html").write_text(text, encoding="utf-8")
    with browser() as shown:
        shown.shape(390, 800, phone=True)
        shown.open(tmp_path / "index.html")
        drawn = "[...document.querySelectorAll('svg.plot')].map((s) => s.querySelectorAll('svg path').length)"
        assert shown.run(drawn) == lines
        assert not shown.run(
            "/NaN|Infinity/.test([...document.querySelectorAll('svg.plot')].map((s) => s.innerHTML))"
        )
        assert shown.run("document.documentElement.scrollWidth") <= 390
        header, *rows = csv.reader(io.StringIO(shown.run("charts[0][0].csv()")))
        panel = json.loads(found[0])[0]
        assert header[0] == "series"
        saved = [(s["name"], x, y) for s in panel["series"] for x, y in zip(s["x"], s["y"], strict=True)]
        assert [(label, float(x), float(y)) for label, x, y in rows] == saved
        picture = shown.run(
            "charts[0][0].png().then((blob) => blob.arrayBuffer()).then((b) => [...new Uint8Array(b)])"
        )
    colours = Image.open(io.BytesIO(bytes(picture))).convert("RGB").getcolors(1 << 24)
    assert colours is not None
    assert max(colours)[1] == (255, 255, 255)  # paper
    assert (31, 95, 168) in [colour for _, colour in colours]  # the first line's blue


def test_a_joint_may_say_nothing_of_flanges_and_plot() -> None:
    """Without flanges and panels, the page has no terminals, and its plot shows the first output over the
    ramped input."""
    model = MODELS["GearContact"]
    text = make_documentation(replace(model, name="Other"), load_default(model.joint))["index.html"].decode()
    assert "<h3>Terminals</h3>" not in text
    assert "<h3>Terminals</h3>" in pages(model.name)["index.html"].decode()
    assert ("s_rel [um]" in text, "K_N [N/um]" in text) == (True, False)


def test_the_licence_is_that_of_the_repository(name: str) -> None:
    text = (Path(__file__).parents[2] / "LICENSE").read_text(encoding="utf-8")
    assert pages(name)["licenses/license.txt"].decode() == text
    assert text.startswith("MIT License")
    for file, words in (
        ("fmi-headers", "Modelica Association Project"),
        ("mingw-w64", "Zope Public License"),
    ):
        assert words in pages(name)[f"licenses/{file}.txt"].decode()
