"""Systems of joints: partners, SSP archives in two simulators, and proof of the coupling."""

import ctypes
import io
import json
import math
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any
from xml.etree.ElementTree import fromstring, tostring

import fmpy
import numpy as np
import pytest
from clients import needs
from conftest import Fmu, refused_line
from fmpy import read_model_description, simulate_fmu
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv
from fmpy.validation import validate_fmu
from jointfmu_fmu_src.native.terminals import find_terminals
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_fmu_src.partners.laws import (
    GRAVITY,
    ForceProfile,
    RotationalInertia,
    TorqueProfile,
    TranslationalMass,
)
from jointfmu_fmu_src.ssv import REAL_NUMBER_ELEMENT_NAMES
from jointfmu_tools import cli
from jointfmu_tools.inputs.fitting import decay
from jointfmu_tools.joints.harmonic_drive.job import VIBRATION_TORQUES_OVER_RATED
from jointfmu_tools.pages.report.systems import wind_up_and_tip_error
from jointfmu_tools.systems import decays, ringing, ssp
from jointfmu_tools.systems.cosimulation import simulate_system as simulate_system
from jointfmu_tools.systems.master import Slave, simulate_body_on_joint
from jointfmu_tools.systems.ssp import MASTER_KINDS, MasterKind
from jointfmu_tools.systems.system import list_system_names, load_system
from jointfmu_tools.systems.wiring import find_model, find_signals
from lxml import etree
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson, solve_ivp
from scipy.interpolate import CubicSpline
from test_modelica import simulate, top

from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import preload_pressure
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import format_parameter_file, load_default
from jointfmu.quantity import flatten_parameters, replace_values

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
Values = dict[str, float]

DRIVE = HarmonicDriveSpring.tabulate(load_default("harmonic_drive").values)
ROBOT = HarmonicDriveSpring.tabulate(load_system("robot_joint").joints["drive"].parameter_file.values)
LINK = load_system("robot_joint").stated_values["link.J"]
ROBOT_AXES = ("base", "shoulder", "elbow", "forearm", "wrist", "hand")
SCHEMAS = {"1.0": Path(fmpy.__file__).parent / "ssp" / "schema", "2.0": Path(__file__).parent / "ssp2"}
"""Schemas of SSP 2.0 as published (2.0.1-rc.2)."""


@cache
def bolted() -> BoltedJointSpring:
    """Bolted column; a function, because its friction patches take a second to compute."""
    return BoltedJointSpring.from_joint(load_default("bolted_joint").values)


@pytest.fixture(scope="session")
def built(system_files: Path) -> Path:
    """Shorter name of the fixture `system_files`."""
    return system_files


@pytest.fixture
def make(built: Path) -> Any:
    made: list[Fmu] = []

    def instance(name: str, version: str = "2", exchange: bool = False) -> Fmu:
        made.append(Fmu(built / f"fmi{version}" / f"{name}.fmu", exchange=exchange))
        return made[-1]

    yield instance
    for one in made:
        one.free_instance()


Make = Callable[..., Fmu]
BOTH = pytest.mark.parametrize("version", ["2", "3"])
ALL = pytest.mark.parametrize("name", list(PARTNERS))


# Partners


@BOTH
@ALL
def test_a_partner_is_a_valid_fmu(built: Path, name: str, version: str) -> None:
    path = built / f"fmi{version}" / f"{name}.fmu"
    assert validate_fmu(str(path)) == []
    description = read_model_description(str(path))
    assert [v.name for v in description.modelVariables if v.causality == "output"] == [
        v.name for v in PARTNERS[name].outputs
    ]
    assert description.numberOfContinuousStates == PARTNERS[name].state_count


@ALL
def test_flanges_of_a_partner_fit_those_of_the_joints(built: Path, name: str) -> None:
    """The flanges have the same members, so that a tool connects complete flanges; a partner's input is a
    joint's output."""
    with zipfile.ZipFile(built / "fmi3" / f"{name}.fmu") as archive:
        root = fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    schema = etree.XMLSchema(file=str(Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"))
    schema.assertValid(etree.fromstring(tostring(root)))
    listed = {v.name: v.unit for v in (*PARTNERS[name].inputs, *PARTNERS[name].outputs)}
    found = {}
    for terminal in root.iter("Terminal"):
        members = {m.get("memberName"): m.attrib for m in terminal.iter("TerminalMemberVariable")}
        found[terminal.get("name")] = {k: m["variableName"] for k, m in members.items()}
        assert {listed[m["variableName"]] for m in members.values()} <= set(listed.values())
        (flow,) = [m for m in members.values() if m["variableKind"] != "signal"]
        assert flow["variableKind"] == "inflow"
        joint = {"phi": "HarmonicDriveSpring", "s": "BoltedJoint"}[next(iter(members))]
        assert any(t.member_variables.keys() == members.keys() for t in find_terminals(MODELS[joint]))
    motion, rate, load = {"RotationalInertia": ("phi", "w", "tau")}.get(name, ("s", "v", "f"))
    expected = {f"flange_{x}": {motion: motion, rate: rate, load: f"{load}_{x}"} for x in "ab"}
    assert found == (expected if PARTNERS[name].state_count else {})


@BOTH
@ALL
def test_a_partner_computes_the_packages_equations(make: Make, name: str, version: str) -> None:
    model, rng = PARTNERS[name], np.random.default_rng(1)
    fmu = make(name, version)
    lags = {"lag_a", "lag_b"} & set(model.parameter_fields())
    given = {n: float(rng.uniform(0.1, 2.0)) for n in model.parameter_fields()} | dict.fromkeys(lags, 0.0)
    values = {v.name: float(rng.normal()) for v in (*model.inputs, *model.outputs[: model.state_count])}
    fmu.enter_initialization(0.7)
    fmu.set_values(given | values)
    expected = model.evaluate(model.parameter_class(**given), values | {"time": 0.7})
    assert fmu.get() == pytest.approx(dict(expected), rel=1e-14)  # at once, without a step
    assert not fmu.messages or not fmu.warnings


@BOTH
def test_a_source_follows_time_in_both_interfaces(make: Make, version: str) -> None:
    given = {
        "ramp_height": 2.0,
        "ramp_duration": 1.0,
        "pulse_height": 3.0,
        "pulse_start": 1.5,
        "pulse_rise": 0.5,
    }
    parameters = TorqueProfile(**(flatten_parameters(ssp.partner_parameters("TorqueProfile").values) | given))

    def expected(time: float) -> float:
        return float(parameters.evaluate_outputs({"time": time, "tau_in": 0.25})["tau"])

    slave = make("TorqueProfile", version).start(given | {"tau_in": 0.25})
    for k in range(30):
        assert slave.get("tau")["tau"] == pytest.approx(expected(0.1 * k), rel=1e-12, abs=1e-12)
        slave.step(0.1)
    model = make("TorqueProfile", version, True).start(given | {"tau_in": 0.25})
    for time in (2.0, 0.3, 1.8):
        model.fmu.setTime(time)
        assert model.get("tau")["tau"] == pytest.approx(expected(time), rel=1e-12)


def test_loads_have_no_corner() -> None:
    load = TorqueProfile(
        ramp_height=1.0, ramp_start=0.1, ramp_duration=0.3, pulse_height=0.0, pulse_start=9.0, pulse_rise=1.0,
        pulse_hold=0.0,
    )  # fmt: skip
    t = np.linspace(0.0, 0.5, 5001)
    y = np.array([float(load.evaluate_outputs({"time": x, "tau_in": 0.0})["tau"]) for x in t])
    assert (y[0], y[-1]) == (0.0, 1.0)
    second = np.diff(y, 2) / (t[1] - t[0]) ** 2
    assert np.max(np.abs(np.diff(second))) < 1e-2 * np.max(np.abs(second))


@BOTH
def test_states_are_set_before_they_move_and_not_after(make: Make, version: str) -> None:
    fmu = make("RotationalInertia", version)
    fmu.enter_initialization()
    fmu.set_values({"phi": 0.3, "w": -2.0, "J": 2.0, "m": 1.0, "l": 0.5, "tau_a": 1.0, "tau_b": 3.0})
    expected = (4.0 - GRAVITY * 0.5 * math.sin(0.3)) / 2.0
    assert fmu.get() == pytest.approx({"phi": 0.3, "w": -2.0, "a": expected}, rel=1e-14)
    fmu.fmu.exitInitializationMode()
    assert "is an output" in fmu.refused(fmu.set_values, {"phi": 0.0})


@BOTH
def test_a_constant_force_moves_a_mass_exactly(make: Make, version: str) -> None:
    fmu = make("TranslationalMass", version).start({"m": 2.0, "f_a": 3.0, "f_b": 1.0, "s": 1.0, "v": -1.0})
    for size in (0.1, 0.3, 0.05, 0.05):
        fmu.step(size)
    assert fmu.get() == pytest.approx({"s": 1.0 - 0.5 + 0.25, "v": -1.0 + 1.0, "a": 2.0}, rel=1e-14)


@BOTH
def test_derivatives_take_states_as_knowns(make: Make, version: str) -> None:
    fmu = make("RotationalInertia", version, True).start({"J": 0.5, "m": 2.0, "l": 0.1, "phi": 0.4, "w": 1.0})
    ref = {n: v.valueReference for n, v in fmu.variables.items()}
    unknowns, knowns = [ref[n] for n in ("phi", "w", "a")], [ref[n] for n in ("tau_a", "phi", "w")]
    if version == "2":
        found = [fmu.fmu.getDirectionalDerivative(unknowns, [k], [1.0]) for k in knowns]
    else:
        found = [fmu.fmu.getDirectionalDerivative(unknowns, [k], [1.0], 3) for k in knowns]
    stiffness = -2.0 * GRAVITY * 0.1 * math.cos(0.4) / 0.5
    np.testing.assert_allclose(found, [[0, 0, 2.0], [1, 0, stiffness], [0, 1, 0]], rtol=1e-13)


@BOTH
def test_a_refused_step_changes_nothing(make: Make, version: str) -> None:
    fmu = make("TranslationalMass", version).start({"m": 1.0, "f_a": 1.0})
    fmu.step(0.1)
    before = fmu.get()
    fmu.set_values({"f_a": 1e308, "f_b": 1e308})
    assert "too large, the output a is not finite" in fmu.refused(fmu.fmu.doStep, 0.1, 0.1)
    fmu.set_values({"f_a": 1.0, "f_b": 0.0})
    assert fmu.get() == before
    fmu.step(0.1)
    assert fmu.get()["s"] == pytest.approx(0.5 * 0.2**2, rel=1e-13)


def test_a_saved_state_goes_on_bit_by_bit(make: Make) -> None:
    fmu = make("RotationalInertia").start({"m": 1.0, "l": 0.3, "phi": 0.5, "lag_b": 1.0})
    rest = [(0.01, 0.3), (0.02, -0.5), (0.01, 0.2)]

    def run() -> list[Values]:
        found = []
        for size, torque in rest:
            fmu.set_values({"tau_b": torque})
            fmu.step(size)
            found.append(fmu.get())
        return found

    run()
    time, state = fmu.time, fmu.fmu.getFMUstate()
    saved = fmu.fmu.serializeFMUstate(state)
    first = run()
    fmu.fmu.setFMUstate(fmu.fmu.deSerializeFMUstate(saved))
    fmu.time = time
    assert run() == first


@BOTH
@pytest.mark.parametrize(("kind", "error"), [("ModelExchange", 1e-6), ("CoSimulation", 3e-5)])
def test_a_pendulum_swings(built: Path, version: str, kind: str, error: float) -> None:
    """The motion of a pendulum agrees with the exact solution, integrated by CVode and by the steps of the
    FMU."""
    start = {"J": 0.05, "m": 1.0, "l": 0.2, "phi": 1.0, "w": 0.0}
    found = simulate_fmu(
        str(built / f"fmi{version}" / "RotationalInertia.fmu"),
        fmi_type=kind,
        stop_time=2.0,
        start_values=start,
        relative_tolerance=1e-8,
        output_interval=1e-3,
        output=["phi", "w"],
    )[-1]

    def rates(time: float, x: Array) -> list[float]:
        return [x[1], -GRAVITY * 0.2 / 0.05 * math.sin(x[0])]

    exact = solve_ivp(rates, (0.0, 2.0), [1.0, 0.0], rtol=1e-11, atol=1e-12).y[:, -1]
    assert [found["phi"], found["w"]] == pytest.approx(exact, rel=error)


# Archives


ARCHIVES = pytest.mark.parametrize("version", list(ssp.ARCHIVE_FOLDERS))
MASTER = pytest.mark.parametrize("master", MASTER_KINDS, ids=["side by side", "in turn"])


@ARCHIVES
@MASTER
@pytest.mark.parametrize("name", list_system_names())
def test_an_archive_is_complete_and_its_connections_fit(
    built: Path, name: str, version: str, master: MasterKind
) -> None:
    found, folder = load_system(name), ssp.ARCHIVE_FOLDERS[version][0]
    with zipfile.ZipFile(built / folder / f"{name}{master.archive_suffix}.ssp") as archive:
        members = {n: archive.read(n) for n in archive.namelist()}
    for suffix, schema in ((".ssd", "Description"), (".ssv", "ParameterValues")):
        file = SCHEMAS[version] / f"SystemStructure{schema}.xsd"
        valid = etree.XMLSchema(file=str(file))
        for content in (content for n, content in members.items() if n.endswith(suffix)):
            valid.assertValid(etree.fromstring(content))
    root = etree.fromstring(members["SystemStructure.ssd"])
    space = {"ssd": root.nsmap["ssd"], "ssc": root.nsmap["ssc"]}
    assert root.get("version") == version
    assert master.force_lag_reason in root.get("description")
    fmus = ssp.find_fmu_names(found)
    units = {}
    for component in root.iterfind(".//ssd:Component", space):
        own = component.get("name")
        model = find_model(found.components[own])
        assert component.get("source") == f"resources/{fmus[own]}.fmu"
        assert component.get("source") in members
        listed = {v.name: (kind, v.unit) for kind in ("input", "output") for v in getattr(model, f"{kind}s")}
        for connector in component.iterfind(".//ssd:Connector", space):
            key, typed = (
                connector.get("name"),
                connector.find(f"ssc:{REAL_NUMBER_ELEMENT_NAMES[version]}", space),
            )
            assert listed[key] == (connector.get("kind"), typed.get("unit"))
            units[f"{own}.{key}"] = typed.get("unit")
    ends = []
    for c in root.iterfind(".//ssd:Connection", space):
        start, end = (f"{c.get(f'{side}Element')}.{c.get(f'{side}Connector')}" for side in ("start", "end"))
        assert units[start] == units[end]
        ends.append(end)
    assert len(ends) == len(set(ends))
    assert set(ends) == {f"{w.target_component}.{w.target_input}" for w in find_signals(found)}
    assert {u.get("name") for u in root.iterfind("ssd:Units/ssc:Unit", space)} == set(units.values())
    described = {n: content for n, content in members.items() if n.endswith(".fmu")}
    assert {f"resources/{fmu}.fmu" for fmu in fmus.values()} == set(described)
    fmi = {"1.0": b'fmiVersion="2.0"', "2.0": b'fmiVersion="3.0"'}[version]
    variables = {}
    for n, content in described.items():
        with zipfile.ZipFile(io.BytesIO(content)) as fmu:
            description = fmu.read("modelDescription.xml")
        assert fmi in description
        read = read_model_description(io.BytesIO(content))
        variables[Path(n).stem] = {v.name: v for v in read.modelVariables}
    for own, fmu_name in fmus.items():
        for parameter in etree.fromstring(members[f"parameters/{own}.ssv"]).iter("{*}Parameter"):
            typed, variable = parameter[0], variables[fmu_name][parameter.get("name")]
            assert etree.QName(typed).localname == variable.type
            assert (typed.get("unit") or None) == (variable.unit or None)


@ARCHIVES
def test_omsimulator_is_told_the_kind_of_a_system_that_updates_in_turn(built: Path, version: str) -> None:
    """Without this annotation OMSimulator's import fails with an internal error. It reads prefixes, not
    namespaces."""
    kind = re.compile(
        rb'<ssd:Annotations>\s*<ssc:Annotation type="org.openmodelica">\s*<oms:Annotations [^>]*>\s*'
        rb'<oms:SimulationInformation>\s*<oms:FixedStepMaster description="oms-ma" stepSize="0.0005" />'
    )
    for master in MASTER_KINDS:
        path = built / ssp.ARCHIVE_FOLDERS[version][0] / f"robot_joint{master.archive_suffix}.ssp"
        with zipfile.ZipFile(path) as archive:
            assert bool(kind.search(archive.read("SystemStructure.ssd"))) == master.is_sequential
            values = fromstring(archive.read("parameters/robot_joint.ssv")).iter()
            lags = [n for n in values if (n.get("name") or "").endswith(".lag_b")]
        assert [n.get("name") for n in lags] == ["motor.lag_b", "link.lag_b"]
        assert {float(n[0].get("value") or "nan") for n in lags} == {master.force_lag_steps}


@ARCHIVES
@MASTER
@pytest.mark.parametrize("name", list_system_names())
def test_a_reader_of_both_versions_opens_the_archives(
    built: Path, name: str, version: str, master: MasterKind
) -> None:
    """pyssp_standard, with its own schemas, reads connections, numbers and descriptions of the FMUs."""
    from pyssp_standard.ssp import SSP
    from pyssp_standard.ssv import SSV

    found = load_system(name)
    with SSP(
        built / ssp.ARCHIVE_FOLDERS[version][0] / f"{name}{master.archive_suffix}.ssp", mode="r"
    ) as archive:
        with archive.system_structure as ssd:
            ssd.__check_compliance__()
            ends = ("start_element", "start_connector", "end_element", "end_connector")
            read = [tuple(getattr(c, end) for end in ends) for c in ssd.connections()]
            assert (ssd.version, read) == (version, [tuple(wire) for wire in find_signals(found)])
            assert [element.name for element in ssd.system.elements] == list(found.components)
            assert ssd.check_connections() == []
        with SSV(archive.unpacked_path / "parameters" / f"{name}.ssv") as ssv:
            ssv.__check_compliance__()
            kinds = {p["name"]: p["type_name"] for p in ssv.parameters}
            numbers = [p for p in ssv.parameters if p["type_name"] == "Real"]  # of Float64 it has none
            given = {p["name"]: float(p["type_value"].parameter["value"]) for p in numbers}
        assert set(kinds.values()) <= {REAL_NUMBER_ELEMENT_NAMES[version], "Boolean"}
        written = {
            f"{n}.{v}": x.parameter_value
            for n, c in found.components.items()
            for v, x in ssp.list_archive_values(c).items()
        }
        assert written.keys() <= kinds.keys()
        assert given == ({n: given[n] for n in given} | written if version == "1.0" else {})
        assert {p.name for p in archive.ssp_resource_path.iterdir()} == {
            f"{fmu}.fmu" for fmu in ssp.find_fmu_names(found).values()
        }


def stated(text: str) -> float:
    """Value of a parameter set in text: a number, or a Boolean."""
    return float(text == "true") if text in ("true", "false") else float(text)


@pytest.mark.parametrize("name", list_system_names())
def test_parameters_come_from_the_files(built: Path, name: str) -> None:
    path, found = str(built / "ssp" / f"{name}.ssp"), load_system(name)
    every = {p.name: stated(p.value) for p in read_ssv(path, f"parameters/{name}.ssv").parameters}
    for joint, component in found.joints.items():
        assert component.parameter_file
        for key, value in component.parameter_file.values_by_name.items():
            if isinstance(value, bool):
                assert f"{joint}.{key}" not in every  # a start value of the FMU
            elif key in MODELS[component.model_name].parameter_fields():
                assert every[f"{joint}.{key}"] == value
    baked = {n for n in found.stated_values if n.partition(".")[2] == "max_torque"}
    assert {n: v for n, v in found.stated_values.items() if n not in baked}.items() <= every.items()
    for component in found.components:
        own = read_ssv(path, f"parameters/{component}.ssv").parameters
        prefix = f"{component}."
        assert {prefix + p.name: stated(p.value) for p in own} == {
            k: v for k, v in every.items() if k.startswith(prefix)
        }


def test_another_joint_goes_into_the_archive(built: Path, tmp_path: Path) -> None:
    changed = load_default("bolted_joint").with_values({"mu": 0.11}, "user", "test")
    for fmu in ("ForceProfile", "TranslationalMass", "BoltedJoint"):
        for version in ("fmi2", "fmi3"):
            (tmp_path / version).mkdir(exist_ok=True)
            shutil.copy(built / version / f"{fmu}.fmu", tmp_path / version)
    column = load_system("bolted_column").with_joint_parameter_file(changed)
    paths = ssp.write_system_archives(column, tmp_path)
    every = {p.name: p.value for p in read_ssv(str(paths[0]), "parameters/bolted_column.ssv").parameters}
    assert float(every["joint.mu"]) == 0.11
    first = [path.read_bytes() for path in paths]
    assert [path.read_bytes() for path in ssp.write_system_archives(column, tmp_path)] == first


def test_a_joint_without_system_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "gear.toml"
    file.write_text(format_parameter_file(load_default("gear_contact")))
    line = refused_line(capsys, "build", "--systems", "--params", file, "--out", tmp_path)
    assert "no system has a joint 'gear_contact', allowed are bolted_joint, harmonic_drive" in line


# Simulators


def simulated(
    built: Path, name: str, step: float, stop: float, changes: Mapping[str, float] = MappingProxyType({})
) -> Any:
    return simulated_once(str(built / "ssp" / f"{name}.ssp"), step, stop, tuple(changes.items()))


@cache
def simulated_once(path: str, step: float, stop: float, changes: tuple[tuple[str, float], ...]) -> Any:
    parameters = read_ssv(path, f"parameters/{Path(path).stem}.ssv")
    for p in parameters.parameters:
        p.value = dict(changes).get(p.name, p.value)
    return simulate_ssp(path, stop_time=stop, step_size=step, parameter_set=parameters)


STEPS = 800
"""Number of steps in which importers are compared; the robot's axes are in motion then."""


def in_fmpy(built: Path, name: str) -> Any:
    """Rows of a system in fmpy, for a number of the system's own steps."""
    step = load_system(name).output_interval
    return simulated(built, name, step, (STEPS - 0.5) * step)


ECOS = """
import sys, numpy as np
from ecospy import EcosSimulation
path, name, step, count, out, *wanted = sys.argv[1:]
rows = []
with EcosSimulation(ssp_path=path, step_size=float(step)) as sim:
    sim.init(parameter_set=name)
    for _ in range(int(count)):
        sim.step()
        rows.append([sim.get_real(v) for v in wanted])
    sim.terminate()
np.save(out, np.array(rows))
"""


COSIM = """
import sys, numpy as np
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
path, name, step, count, out, *wanted = sys.argv[1:]
execution = CosimExecution.from_ssp_file(path, step_size=round(1e9 * float(step)))  # nanoseconds
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
index = {one.name.decode(): one.index for one in execution.slave_infos()}
places = []
for component, _, variable in (v.partition("::") for v in wanted):
    references = {v.name.decode(): v.reference for v in execution.slave_variables(index[component])}
    places.append((index[component], references[variable]))
rows = []
for _ in range(int(count)):
    assert execution.step()
    rows.append([observer.last_real_values(i, [r])[0] for i, r in places])
np.save(out, np.array(rows))
"""


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(ECOS, marks=needs("ecos"), id="ecos"),
        pytest.param(COSIM, marks=needs("libcosim"), id="libcosim"),
    ],
)
@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("robot_joint", ["link::phi", "motor::phi", "load::tau"]),
        ("bolted_column", ["column::s", "load::f"]),
        ("six_axis_robot", [f"{axis}_{part}::phi" for axis in ROBOT_AXES for part in ("link", "motor")]),
    ],
)
def test_other_simulators_run_the_archive_as_fmpy_does(
    built: Path, tmp_path: Path, script: str, name: str, wanted: list[str]
) -> None:
    """The same equations in each step: results differ by round-off, which the motion does not amplify."""
    out, path = tmp_path / "rows.npy", built / "ssp" / f"{name}.ssp"
    arguments = [path, name, load_system(name).output_interval, STEPS, out, *wanted]
    subprocess.run([sys.executable, "-c", script, *map(str, arguments)], check=True, timeout=100)
    rows = np.load(out)
    other = in_fmpy(built, name)
    for k, column in enumerate(wanted):
        expected = other[column.replace("::", ".")]
        np.testing.assert_allclose(rows[:, k], expected, rtol=1e-9, atol=1e-12 * np.max(np.abs(expected)))


@pytest.mark.parametrize("name", list_system_names())
def test_the_own_master_runs_an_archive_as_fmpy_does(built: Path, name: str) -> None:
    """The package's parallel master solves the same equations in each step as fmpy."""
    found = load_system(name)
    own = simulate_system(found, built / "fmi2", stop_time=STEPS * found.output_interval)
    rows = in_fmpy(built, name)
    for column in own.keys() - {"time"}:
        expected = rows[column]
        scale = np.max(np.abs(expected))
        np.testing.assert_allclose(own[column][1:], expected, rtol=1e-9, atol=1e-11 * scale)


@pytest.mark.parametrize(
    ("name", "shown", "step", "least"),
    [("robot_joint", "drive.tau2", 2.5e-4, 0.1), ("bolted_column", "column.s", 2.5e-6, 0.1)],
)
def test_sequential_and_parallel_masters_need_different_force_lags(
    built: Path, name: str, shown: str, step: float, least: float
) -> None:
    """Compared with a step of a quarter: each archive converges in its own master; extrapolating an undelayed
    force does not."""
    found, (_, in_turn) = load_system(name), MASTER_KINDS
    stop = 0.6 * found.stop_time

    def run(master: MasterKind, h: float) -> Array:
        thin = round(step / h)
        return simulate_system(found, built / "fmi2", master, communication_step=h, stop_time=stop)[shown][
            ::thin
        ]

    exact = run(in_turn, 0.25 * step)
    scale = np.max(np.abs(exact))
    errors = [
        np.max(np.abs(run(master, step) - exact)) / scale
        for master in (*MASTER_KINDS, in_turn._replace(force_lag_steps=1.0))
    ]
    late, now, wrong = errors
    assert wrong > least
    assert now < 0.2 * wrong
    assert late < 0.4 * wrong


# The robot


@cache
def moved(folder: Path) -> dict[str, Array]:
    """Folder with results of the robot with six axes along its motion."""
    return simulate_system(load_system("six_axis_robot"), folder)


def until(stop: float, run: dict[str, Array]) -> dict[str, Array]:
    """Rows of a run up to a time [s]."""
    count = np.searchsorted(run["time"], stop, "right")
    return {name: column[:count] for name, column in run.items()}


def test_drives_of_the_robot_carry_its_inverse_dynamics(built: Path) -> None:
    """Torques of the rigid arm plus vibrations of six inertias about it; at rest the weight only, with the
    midline's wind-up within the hysteresis."""
    found, run = load_system("six_axis_robot"), moved(built / "fmi2")
    q, speed, acceleration = found.arm.compute_motion(run["time"])
    torque = found.arm.inverse_dynamics(q, speed, acceleration)
    commanded, wound, error = wind_up_and_tip_error(found, run)
    np.testing.assert_allclose(commanded, q, atol=1e-12)
    largest = np.max(np.abs(torque))
    for k, axis in enumerate(found.arm.axis_names):
        carried = run[f"{axis}_drive.tau2"]
        assert np.max(np.abs(carried - torque[:, k])) < 0.12 * np.max(np.abs(torque[:, k])) + 1e-4 * largest
        assert np.mean(carried[-3000:]) == pytest.approx(torque[-1, k], abs=2e-3 * largest)
        file = found.joints[f"{axis}_drive"].parameter_file
        assert file is not None
        free = HarmonicDriveSpring.tabulate(replace_values(file.values, {"hysteresis_loss": 0.0}))
        held = float(free.evaluate_torque(abs(torque[-1, k]))["phi_rel"])
        lag = file.values.hysteresis_loss
        assert abs(abs(np.mean(wound[-3000:, k])) - held) < lag
    assert 1e-3 < error[-1] < np.max(error) < 3e-3


def test_the_tips_error_is_what_the_arms_jacobian_makes_of_the_wind_up(built: Path) -> None:
    found = load_system("six_axis_robot")
    run = until(0.9, moved(built / "fmi2"))
    commanded, wound, error = wind_up_and_tip_error(found, run)
    q, dq = commanded[-1], wound[-1]
    step = 1e-6
    tip = found.arm.compute_tip_position
    slope = [(tip(q + step * e)[0] - tip(q - step * e)[0]) / (2.0 * step)
             for e in np.eye(6)[:, None, :]]  # fmt: skip
    assert np.linalg.norm(dq @ np.array(slope)) == pytest.approx(error[-1], rel=5e-3)  # of second order


def sliding(force: Array, stiffness: Array, limit: Array, rate: float) -> Array:
    """Rates of the slider forces: stiffness times rate, or zero at the friction limit."""
    held = (np.abs(force) < limit) | (force * rate < 0.0)
    return np.where(held, stiffness * rate, 0.0)


def column_sliders(spring: BoltedJointSpring, preload: float) -> tuple[Array, Array]:
    """Stiffness and friction limits of the sliders in contact at a preload, of all patches."""
    joint, patches = spring.joint, spring.patches
    approach = spring.curve.inverse(preload_pressure(joint, patches, preload, 0.0))
    carried = spring.friction_law.foundation(approach).slider_properties(approach)
    area = joint.A_0 * patches.area_share[:, None]
    stiffness, limit = ((area * each).ravel() for each in (carried.stiffness, carried.friction_limit))
    some = stiffness > 0.0
    return stiffness[some], limit[some]


def robot(time: float, x: Array, found: Values, load: TorqueProfile) -> list[float]:
    """Rates of motor, link and drive sliders, from the package's midline and sliders."""
    ratio, friction = ROBOT.joint.ratio, x[4:]
    drive = DRIVE.evaluate_motion(x[0], x[1], x[2], x[3])
    drive = {"tau1": drive["tau1"] + friction.sum() / ratio, "tau2": drive["tau2"] - friction.sum()}
    slid = sliding(friction, ROBOT.hysteresis.stiffness, ROBOT.hysteresis.friction_limit, x[3] - x[1] / ratio)
    tau = float(load.evaluate_outputs({"time": time, "tau_in": 0.0})["tau"])
    motor = RotationalInertia(J=found["motor.J"], m=0.0, l=0.0, lag_a=0.0, lag_b=0.0)
    link = RotationalInertia(J=found["link.J"], m=found["link.m"], l=found["link.l"], lag_a=0.0, lag_b=0.0)
    a1 = motor.evaluate_outputs({"phi": x[0], "w": x[1], "tau_a": tau, "tau_b": float(drive["tau1"])})["a"]
    a2 = link.evaluate_outputs({"phi": x[2], "w": x[3], "tau_a": 0.0, "tau_b": float(drive["tau2"])})["a"]
    return [x[1], float(a1), x[3], float(a2), *slid]


def test_the_robot_joint_converges_to_the_packages_law(built: Path) -> None:
    found, stop = load_system("robot_joint").stated_values, 0.4
    load = TorqueProfile(**{k.removeprefix("load."): v for k, v in found.items() if k.startswith("load.")})
    sliders = ROBOT.hysteresis.friction_limit.size
    start, small = [0.0] * (4 + sliders), [1e-12] * 4 + [1e-8] * sliders  # rad, rad/s and N.m
    exact = solve_ivp(
        robot, (0.0, stop), start, "DOP853", rtol=1e-9, atol=small, max_step=0.02, args=(found, load)
    ).y[2, -1]
    steps = (8e-4, 4e-4, 2e-4)
    errors = [abs(simulated(built, "robot_joint", h, stop - 0.5 * h)["link.phi"][-1] - exact) for h in steps]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[-1] < 1e-5 * exact
    assert np.all(np.abs(orders - 2.0) < 0.15), (errors, orders)


def test_the_bolted_column_converges_to_the_packages_law(built: Path) -> None:
    found, stop = load_system("bolted_column").stated_values, 1.6e-3
    defaults = flatten_parameters(ssp.partner_parameters("ForceProfile").values)
    pulse = {k.removeprefix("load."): v for k, v in found.items() if k.startswith("load.")}
    load = ForceProfile(**(defaults | pulse))
    mass = TranslationalMass(m=found["column.m"], lag_a=0.0, lag_b=0.0)
    stiffness, limit = column_sliders(bolted(), found["joint.preload"])

    def rates(time: float, x: Array) -> Array:
        f = float(load.evaluate_outputs({"time": time, "f_in": 0.0})["f"])
        moved = mass.evaluate_outputs({"s": x[0], "v": x[1], "f_a": f, "f_b": -x[2:].sum()})
        return np.append([x[1], float(moved["a"])], sliding(x[2:], stiffness, limit, x[1]))

    start, small = [0.0] * (2 + limit.size), [1e-12] * 2 + [1e-6] * limit.size  # m, m/s and N
    exact = solve_ivp(rates, (0.95e-3, stop), start, "DOP853", rtol=1e-7, atol=small).y[0, -1]
    steps = (4e-6, 2e-6, 1e-6)
    errors = [
        abs(simulated(built, "bolted_column", h, stop - 0.5 * h)["column.s"][-1] - exact) for h in steps
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[-1] < 1e-3 * 1.15e-6
    assert np.all(np.abs(orders - 2.0) < 0.2), (errors, orders)


@pytest.mark.parametrize(
    ("name", "model", "stop", "steps", "left"),
    [
        ("robot_joint", "RobotJoint", 1.2, (2e-4, 1e-4), 5e-4),
        ("bolted_column", "BoltedColumn", 3e-3, (2e-6, 1e-6), 0.015),
    ],
)
def test_the_modelica_example_moves_as_the_archive(
    built: Path, name: str, model: str, stop: float, steps: tuple[float, float], left: float
) -> None:
    """rumoca's solver on the Modelica text, fmpy's steps on the FMUs: the difference is of second order in
    the step.

    What the extrapolation to h = 0 leaves, is of the layer in which the component's sliders cease to stick
    (drive, 1.7e-4), and of the number of sliders (bolted joint, 0.5 %).
    """
    import rumoca

    found = simulate(rumoca, top(f"extends JointStiffness.Examples.{model};"), stop, stop / 300, rtol=1e-8)
    times, first = np.unique(found.time, return_index=True)

    def deflection(values: Any) -> Array:
        if name == "bolted_column":
            return np.asarray(values["column.s"])
        return np.asarray(values["link.phi"] - values["motor.phi"] / DRIVE.joint.ratio)

    expected, runs = deflection(found)[first], []
    for step in steps:
        rows = simulated(built, name, step, stop - 0.5 * step)
        end = np.append(0.0, rows["time"] + step)  # fmpy's rows carry the begin of their step
        runs.append(CubicSpline(end, np.append(0.0, deflection(rows)))(times))
    scale = np.max(np.abs(expected))
    limit = (4.0 * runs[1] - runs[0]) / 3.0
    assert np.max(np.abs(limit - expected)) < left * scale


# The coupling itself: a link on the drive, motor held


def ring(
    built: Path, step: float, count: int, angle: float, damping: float, late: bool = False, **more: float
) -> Array:
    """Free vibration of the link; `late` for masters that step all components at once."""
    start = {"J": LINK, "phi": angle, "lag_b": float(late)} | more
    drive, inertia = built / "fmi2" / "HarmonicDriveSpring.fmu", built / "fmi2" / "RotationalInertia.fmu"
    with (
        Slave(drive, {"d": damping}, ("phi2", "w2"), ("tau2",)) as joint,
        Slave(inertia, start, ("tau_a", "tau_b"), ("phi", "w")) as body,
    ):
        return simulate_body_on_joint(joint, body, 0.0, step, count, late)


def released(angle: float, damping: bool, stop: float) -> Array:
    def rates(time: float, x: Array) -> list[float]:
        return [x[1], float(DRIVE.evaluate_motion(0.0, 0.0, x[0], x[1] if damping else 0.0)["tau2"]) / LINK]

    return solve_ivp(rates, (0.0, stop), [angle, 0.0], "DOP853", rtol=1e-11, atol=1e-15).y[:, -1]


@pytest.mark.parametrize(
    ("late", "lag", "order"), [(False, 0.0, 2.0), (True, 1.0, 2.0), (True, 0.0, 1.0)], ids=str
)
def test_the_order_of_a_step(built: Path, late: bool, lag: float, order: float) -> None:
    stop, angle, d = 0.05, 1.3e-3, DRIVE.joint.d
    exact = released(angle, True, stop)
    errors = []
    for count in (1000, 2000, 4000):
        found = ring(built, stop / count, count, angle, d, late, lag_b=lag)[-1]
        errors.append(np.hypot(*((found - exact) / [angle, 300.0 * angle])))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(np.abs(orders - order) < 0.15), (errors, orders)


def energy(x: Array) -> Array:
    angle = np.linspace(0.0, 2e-3, 801)
    torque = [float(DRIVE.evaluate_motion(0.0, 0.0, a, 0.0)["tau"]) for a in angle]
    potential = cumulative_simpson(torque, x=angle, initial=0.0)
    return np.asarray(0.5 * LINK * x[:, 1] ** 2 + np.interp(np.abs(x[:, 0]), angle, potential))


def test_energy_stays_over_a_thousand_periods(built: Path) -> None:
    angle = 1.3e-3
    period = 2.0 * math.pi * math.sqrt(LINK / float(DRIVE.evaluate_torque(3.0)["K_WTS"]))
    largest = float(DRIVE.evaluate_motion(0.0, 0.0, angle, 0.0)["K_WTS"])
    for steps, periods in ((20, 1000), (40, 250)):
        band = 0.5 * largest / LINK * (period / steps) ** 2
        e = energy(ring(built, period / steps, periods * steps, angle, 0.0))
        assert np.max(np.abs(e / e[0] - 1.0)) < band  # within a period; no drift over them:
        assert abs(e[-100 * steps :].mean() / e[: 100 * steps].mean() - 1.0) < 1e-4
    late = energy(ring(built, period / 300, 15_000, angle, 0.0, True))
    omega = 2.0 * math.pi / 300  # a late force adds energy, as if damping were -omega^3/2
    assert 0.0 < late[-3000:].mean() / late[:3000].mean() - 1.0 < 2.0 * math.pi * omega**3 * 50 * 1.5


def working_point(torque: float) -> tuple[float, float]:
    found = DRIVE.evaluate_torque(torque)
    return float(found["phi_rel"]), float(found["K_WTS"])


def test_the_largest_stable_step_is_the_formulas(built: Path) -> None:
    angle, stiffness = working_point(5.0)  # the largest torque of the motion: there K is largest
    largest = 2.0 * math.sqrt(LINK / stiffness)

    def swing(factor: float) -> float:
        drive, inertia = built / "fmi2" / "HarmonicDriveSpring.fmu", built / "fmi2" / "RotationalInertia.fmu"
        start = {"J": LINK, "phi": angle * (1.0 - 1e-7)}
        with (
            Slave(drive, {"d": 0.0}, ("phi2", "w2"), ("tau2",)) as joint,
            Slave(inertia, start, ("tau_a", "tau_b"), ("phi", "w")) as body,
        ):
            found = simulate_body_on_joint(joint, body, 5.0, factor * largest, 400)[:, 0]
        return float(np.max(np.abs(found - angle)) / (1e-7 * angle))

    assert swing(0.995) < 30.0
    assert swing(1.01) > 1e3


def test_the_largest_stable_step_with_late_forces(built: Path) -> None:
    """h < (2 zeta)^(1/3) sqrt(J/K) with extrapolated delayed forces, d/K without extrapolation."""
    _, stiffness = working_point(0.0)
    frequency, zeta = math.sqrt(stiffness / LINK), 0.02
    d = 2.0 * zeta * math.sqrt(stiffness * LINK)

    def grows(step: float, lag: float) -> bool:
        count = 1000 if lag else 4000
        found = np.abs(ring(built, step, count, 1e-8, d, True, lag_b=lag)[:, 0])
        return bool(found[-200:].max() > found[:200].max())

    carried, plain = (2.0 * zeta) ** (1.0 / 3.0) / frequency, d / stiffness
    assert [grows(factor * carried, 1.0) for factor in (0.9, 1.15)] == [False, True]
    assert [grows(factor * plain, 0.0) for factor in (0.9, 1.15)] == [False, True]


def exchanged(fmus: dict[str, Fmu], wires: list[tuple[str, str, str, str]], stop: float) -> dict[str, Array]:
    """Final states of model-exchange FMUs integrated as one system by CVode.

    wires : (FMU, output, FMU, input), in the order in which values are passed on
    """
    from fmpy.sundials import CVodeSolver

    bodies = {n: f for n, f in fmus.items() if f.description.numberOfContinuousStates}
    for fmu in fmus.values():
        fmu.fmu.enterContinuousTimeMode()
    pair = (ctypes.c_double * 2)()

    def array(pointer: Any) -> Array:
        return np.ctypeslib.as_array(pointer, (2 * len(bodies),)).reshape(-1, 2)

    def read(getter: str) -> Callable[[Any, int], None]:
        def callback(pointer: Any, n: int) -> None:
            for row, body in zip(array(pointer), bodies.values(), strict=True):
                getattr(body.fmu, getter)(pair, 2)
                row[:] = pair

        return callback

    def put(pointer: Any, n: int) -> None:
        for row, body in zip(array(pointer), bodies.values(), strict=True):
            pair[:] = row
            body.fmu.setContinuousStates(pair, 2)

    second = next(iter(bodies.values())).version == 2
    rates = read("getDerivatives" if second else "getContinuousStateDerivatives")

    def pass_on(pointer: Any, n: int) -> None:
        for source, output, target, wire in wires:
            fmus[target].set_values({wire: fmus[source].get(output)[output]})
        rates(pointer, n)

    def put_time(time: float) -> None:
        for fmu in fmus.values():
            fmu.fmu.setTime(time)

    class Inputs:
        def apply(self, time: float) -> None: ...

    solver = CVodeSolver(
        2 * len(bodies), 0, read("getContinuousStates"), put, pass_on, lambda pointer, n: None,
        read("getNominalsOfContinuousStates"), put_time, Inputs(), 0.0,
        relativeTolerance=1e-10, maxNumSteps=100_000, maxStep=1e-3,
    )  # fmt: skip
    time = 0.0
    while time < stop - 1e-12:
        _, _, time = solver.step(time, stop)
    found = np.empty(2 * len(bodies))
    read("getContinuousStates")(found.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), 0)
    return dict(zip(bodies, found.reshape(-1, 2), strict=True))


@BOTH
def test_model_exchange_agrees_with_tight_co_simulation(built: Path, make: Make, version: str) -> None:
    """Drive and link as model-exchange FMUs, solved as one system by CVode, move as in co-simulation with
    small steps."""
    stop, angle, count = 0.03, 1.3e-3, 24_000
    fmus = {
        "drive": make("HarmonicDriveSpring", version, True).start(),
        "link": make("RotationalInertia", version, True).start({"J": LINK, "phi": angle}),
    }
    motion_out = [("link", "phi", "drive", "phi2"), ("link", "w", "drive", "w2")]
    exchange = exchanged(fmus, [*motion_out, ("drive", "tau2", "link", "tau_b")], stop)["link"]
    tight = ring(built, stop / count, count, angle, DRIVE.joint.d)[-1]
    scale = np.array([angle, 300.0 * angle])
    assert np.max(np.abs(exchange - tight) / scale) < 1e-6
    assert np.max(np.abs(exchange - released(angle, True, stop)) / scale) < 1e-6


@BOTH
def test_the_whole_robot_joint_in_model_exchange(built: Path, make: Make, version: str) -> None:
    """All four FMUs connected as in the archive, in CVode, against the archive's co-simulation extrapolated
    to zero step (fourth-order error). Without friction, whose slip reduces the order of both solvers."""
    path, stop = str(built / "ssp" / "robot_joint.ssp"), 0.12
    early = {"load.pulse_start": 0.01, "drive.hysteresis_loss": 0.0}
    parameters = {p.name: p.value for p in read_ssv(path, "parameters/robot_joint.ssv").parameters} | early
    fmus = {}
    for name, part in load_system("robot_joint").components.items():
        mine = {n.partition(".")[2]: float(v) for n, v in parameters.items() if n.startswith(f"{name}.")}
        fmus[name] = make(part.model_name, version, True).start(mine)
    connections = read_ssd(path).system.connections
    wires = [(c.startElement, c.startConnector, c.endElement, c.endConnector) for c in connections]
    wires.sort(key=lambda wire: wire[0] == "drive")  # its outputs follow its inputs at once
    exchange = exchanged(fmus, wires, stop)
    steps = (5e-5, 2.5e-5)
    rows = [simulated(built, "robot_joint", h, stop - 0.5 * h, early)[-1] for h in steps]
    for name in ("motor", "link"):
        for k, state in enumerate(("phi", "w")):
            coarse, fine = (row[f"{name}.{state}"] for row in rows)
            limit = (4.0 * fine - coarse) / 3.0
            assert exchange[name][k] == pytest.approx(limit, rel=1e-6)


# Files of one's own


def test_the_command_builds_a_system_of_ones_own(
    built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A system with its own drive gives an FMU that vibrates, archives that run, a Modelica model, table and
    picture."""
    text = (files("jointfmu_models") / "systems" / "robot_joint.toml").read_text(encoding="utf-8")
    model = 'model = "HarmonicDriveSpring"'
    own = text.replace(model, f'{model}\nparameters = "drives/my_drive.toml"').replace(
        "value = 2.0,", "value = 0.3,"
    )
    (tmp_path / "drives").mkdir()
    changes = {"ratio": 50.0, "radial_deformation": 2.3e-4}
    drive = load_default("harmonic_drive").with_values(changes, "user", "test")
    (tmp_path / "drives" / "my_drive.toml").write_text(format_parameter_file(drive), encoding="utf-8")
    (tmp_path / "my_arm.toml").write_text(own, encoding="utf-8")
    out, table, picture = tmp_path / "dist", tmp_path / "run.csv", tmp_path / "run.png"
    arguments = [tmp_path / "my_arm.toml", "--out", out, "--csv", table, "--plot", picture, "--json"]
    assert cli.main(["system", *map(str, arguments)]) == 0
    paths = [Path(path) for path in json.loads(capsys.readouterr().out)["built"]]
    assert all(path.is_file() for path in paths)
    assert {p.name for p in paths if p.parent.name == "fmi3"} == {
        "TorqueProfile.fmu", "RotationalInertia.fmu", "my_arm_drive.fmu",
    }  # fmt: skip
    for path in paths:  # for every platform
        if path.suffix == ".fmu":
            with zipfile.ZipFile(path) as archive:
                found = [n for n in archive.namelist() if n.startswith("binaries/") and n[-1] != "/"]
            assert len(found) >= 4
    assert picture.read_bytes().startswith(b"\x89PNG")
    header, *rows = table.read_text().splitlines()
    assert header.startswith("time [s],load.tau [N.m],motor.phi [rad],")
    assert len(rows) == 601
    archive = str(out / "ssp" / "my_arm.ssp")
    parameters = read_ssv(archive, "parameters/my_arm.ssv")
    assert float({p.name: p.value for p in parameters.parameters}["drive.ratio"]) == 50.0
    found = simulate_ssp(archive, stop_time=0.29975, step_size=5e-4, parameter_set=parameters)
    last = dict(zip(header.split(","), map(float, rows[-1].split(",")), strict=True))
    assert last["link.phi [rad]"] == pytest.approx(found["link.phi"][-1], rel=1e-9)
    assert last["link.phi [rad]"] > 1e-3
    written = (out / "modelica" / "MyArm.mo").read_text(encoding="utf-8")
    assert "final ratio=50" in written
    assert written.splitlines()[1] == 'model MyArm "Robot joint with a harmonic drive"'
    arguments = ["ring", tmp_path / "my_arm.toml", "--fmus", out / "fmi2", "--load", 5, "--json"]
    assert cli.main([*map(str, arguments)]) == 0
    shown = capsys.readouterr()
    (row,) = json.loads(shown.out)["rows"]
    assert "hysteresis_loss = 0 in this simulation" in shown.err  # the stiffness is that of the midline
    assert "those with motor held" in shown.err
    stiffness = HarmonicDriveSpring.tabulate(drive.values).evaluate_torque(5.0)["K_WTS"]
    expected = math.sqrt(stiffness / LINK) / math.tau  # 2 % from the default drive's
    assert row["expected_frequency"] == pytest.approx(expected, rel=1e-5)


def test_the_robot_in_modelica_winds_up_as_the_fmus_do(built: Path) -> None:
    """The wind-up agrees at the start of the motion; the layer of the sliders leaves an error of 1e-3 of the
    friction."""
    import rumoca

    stop = 0.3
    found = simulate(rumoca, top("extends JointStiffness.Examples.SixAxisRobot;"), stop, 1e-2, rtol=1e-8)
    own = load_system("six_axis_robot")
    run = until(stop, moved(built / "fmi2"))
    _, wound, _ = wind_up_and_tip_error(own, run)
    for k, axis in enumerate(ROBOT_AXES):
        expected = np.interp(found.time, run["time"], wound[:, k])
        scale = np.max(np.abs(wound[:, k]))
        assert np.max(np.abs(found[f"{axis}_drive.phi_rel"] - expected)) < 5e-3 * scale


# What the nonlinear joint does; its resonance and decays are looked at beside the main job's tests


def test_the_struck_column_rings_down_by_its_friction(built: Path) -> None:
    """Archive in fmpy: the pulse uses half of the friction limit. Afterwards frequency and damping depend on
    the amplitude as for the deflected column, whose forces have no delay."""
    rows = simulated(built, "bolted_column", 2e-6, 0.02)
    limit = bolted().joint.mu * 15e3 * bolted().joint.n_bolts
    assert 0.45 * limit < np.max(np.abs(rows["joint.f_x"])) < 0.6 * limit
    free = rows["time"] > 1.3e-3
    struck = decay.analyse_decay(rows["time"][free], rows["column.s"][free])
    column = ringing.find_vibrating_joints()["bolted_column"]
    (pulled,) = decays.simulate_decays(
        column,
        built / "fmi2",
        column.vibration_test.deflection_for_slip.deflection,
        [column.vibration_test.deflection_for_slip.joint_load],
    )
    order = np.argsort(pulled.amplitude)
    seen = struck.motion_amplitude > 1.2e-7
    assert np.count_nonzero(seen) >= 3
    for mine, other, allowed in (
        (math.tau * struck.frequency, pulled.frequency, 5e-3),
        (struck.damping_ratio, pulled.damping, 0.1),  # straight lines between the pulled column's windows
    ):
        expected = np.interp(struck.motion_amplitude, pulled.amplitude[order], other[order])
        np.testing.assert_allclose(mine[seen], expected[seen], rtol=allowed)


# The list of systems


def test_every_shipped_file_is_a_system() -> None:
    folder = Path(str(files("jointfmu_models"))) / "systems"
    assert set(list_system_names()) == {path.stem for path in folder.glob("*.toml")}


def test_a_joint_that_does_not_ring_is_refused() -> None:
    said = (
        "joint 'gear_contact' has no free vibration that can be simulated; allowed are harmonic_drive, "
        "bolted_joint"
    )
    with pytest.raises(ValueError, match=said):
        ringing.load_vibration_test("gear_contact")


# jointfmu ring


@pytest.fixture(scope="module")
def rung(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run of the vibration command, with table and picture."""
    out = tmp_path_factory.mktemp("ring")
    arguments = [
        "--fmus",
        built / "fmi2",
        "--load",
        2.0,
        -0.5,
        "--csv",
        out / "a.csv",
        "--plot",
        out / "a.png",
    ]
    assert cli.main(["ring", "robot_joint", *map(str, arguments)]) == 0
    return out


def test_ring_writes_a_table_and_a_picture(rung: Path) -> None:
    header, *rows = (rung / "a.csv").read_text().splitlines()
    assert header.startswith("load [N.m],frequency [Hz],expected_frequency [Hz],damping_ratio [1]")
    found = np.array([[float(x) for x in row.split(",")] for row in rows])
    expected = [math.sqrt(working_point(abs(t))[1] / LINK) / math.tau for t in (2.0, -0.5)]
    np.testing.assert_allclose(found[:, 0], [2.0, -0.5])
    np.testing.assert_allclose(found[:, 2], expected, rtol=1e-5)  # six digits printed
    np.testing.assert_allclose(found[:, 1], expected, rtol=ringing.RESONANCE_TOLERANCE)
    frequency, zeta = math.tau * found[:, 2], found[:, 4]
    at_once = 2.0 * (np.sqrt(1.0 + 4.0 * zeta**2) - 2.0 * zeta)  # docs/systems_reference.md
    late = (2.0 * zeta / (1.0 + (2.0 * zeta) ** 4 / 0.39**3)) ** (1 / 3)
    np.testing.assert_allclose(found[:, 5:7] * frequency[:, None], np.stack([at_once, late], 1), rtol=1e-5)
    assert (rung / "a.png").read_bytes().startswith(b"\x89PNG")


def test_ring_takes_a_joint_and_a_body(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = ["--fmus", str(built / "fmi2"), "--json"]
    assert cli.main(["ring", "robot_joint", *folder, "--inertia", "0.2"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [row["load"] for row in found["rows"]] == [
        x * DRIVE.joint.rated_torque for x in VIBRATION_TORQUES_OVER_RATED
    ]
    first = found["rows"][0]
    assert first["expected_frequency"] == pytest.approx(math.sqrt(working_point(0.0)[1] / 0.2) / math.tau)
    assert cli.main(["ring", "bolted_column", *folder, "--load", "20e3", "--inertia", "50"]) == 0
    stiffness = bolted().evaluate(20e3, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))["K_xx"]
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert row["expected_frequency"] == pytest.approx(math.sqrt(stiffness / 50.0) / math.tau)


def test_ring_prints_the_steps_that_the_guide_quotes(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    quoted = []
    for name, load in (("robot_joint", "5"), ("bolted_column", "15e3")):
        assert cli.main(["ring", name, "--fmus", str(built / "fmi2"), "--load", load, "--json"]) == 0
        (row,) = json.loads(capsys.readouterr().out)["rows"]
        quoted.append((1e3 * row["largest_step"], 1e3 * row["largest_step_late"]))
    (drive, late_drive), (column, late_column) = quoted
    page = (Path(__file__).parents[2] / "docs/tools/index.md").read_text(encoding="utf-8")
    assert f"{drive:.1f} and {late_drive:.2f} ms for the example drive at 5 N m" in page
    assert f"{column:.3f} ms for the shipped system of a column of 100 kg on a bolted joint at 15 kN" in page
    assert late_column == 0.0


def test_ring_says_where_the_law_ends(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fmus = str(built / "fmi2")
    assert cli.main(["ring", "robot_joint", "--fmus", fmus, "--load", "40", "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["missed"] == 0
    assert "outside the tabulated law" in err


HYSTERESIS = ["--set", "hysteresis_loss=3.5e-4", "hysteresis_stiffness=3000"]


@pytest.mark.parametrize("load", ["0", "2"])
def test_ring_down_of_a_drive_with_hysteresis(
    built: Path, tmp_path: Path, load: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Decrement over the amplitude against the energy of loops, within 2 %; the step changes the
    frequency."""
    picture = tmp_path / "decay.png"
    arguments = [
        "--fmus",
        built / "fmi2",
        "--amplitude",
        "1e-4",
        "--load",
        load,
        *HYSTERESIS,
        "--plot",
        picture,
    ]
    assert cli.main(["ring", "robot_joint", *map(str, arguments), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    amplitude, frequency, loop, damping, stated = (
        np.array([row[name] for row in rows])
        for name in ("amplitude", "frequency", "loop_frequency", "damping_ratio", "loop_damping_ratio")
    )
    assert np.all(np.diff(amplitude) < 0.0)
    assert amplitude[0] > 10.0 * amplitude[-1]
    np.testing.assert_allclose(damping[1:], stated[1:], rtol=0.02)
    np.testing.assert_allclose(frequency, loop, rtol=5e-3)
    assert damping[0] > 2.0 * damping[-1]
    assert frequency[0] < 0.97 * frequency[-1]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_ring_down_in_shear(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The frequency of small vibrations in shear belongs to K_xx at very small motion."""
    fmus = str(built / "fmi2")
    arguments = ["--amplitude", "1e-8", "--load", "9e3", "--inertia", "50"]
    assert cli.main(["ring", "bolted_column", "--fmus", fmus, *arguments, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    stiffness = bolted().evaluate(9e3, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))["K_xx"]
    assert rows[-1]["frequency"] == pytest.approx(math.sqrt(stiffness / 50.0) / math.tau, rel=5e-3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["robot_joint", "--amplitude", "-1"], "amplitude = -1 m or rad is outside (0, inf)"),
        (["robot_joint", *HYSTERESIS], "--set works with --amplitude only"),
        (["robot_joint", "--load", "nan"], "load = nan: expected a finite number"),
        (["robot_joint", "--load", "1e300"], "load = 1e+300 is too large: the vibration starts with "),
        (["robot_joint", "--inertia", "-1"], "inertia = -1 kg.m2 is outside (0, inf)"),
        (
            ["robot_joint", "--inertia", "1e-5"],
            "damping ratio 1.83 with the inertia 1e-05; allowed is less than 0.1",
        ),
        (["bolted_column", "--load", "0"], "load = 0 N: the joint has no stiffness there"),
        (["bolted_column", "--load", "-5"], "preload = -5 N is outside [0, inf)"),
        (
            ["bolted_column", "--fmus", "nowhere"],
            "--fmus nowhere: has no BoltedJoint.fmu; `jointfmu system bolted_column` writes it",
        ),
        (["robot_joint", "--plot", "a.pdf"], "suffix '.pdf' is not that of a picture"),
        (["gearbox"], "system 'gearbox': allowed are bolted_column, robot_joint, six_axis_robot, or a file"),
        (
            ["six_axis_robot"],
            "six_axis_robot has several joints; state one of base_drive, shoulder_drive",
        ),
        (
            ["six_axis_robot", "--joint", "knee"],
            "joint 'knee' is not in six_axis_robot, allowed are base_drive",
        ),
    ],
)
def test_ring_refuses(
    built: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = [] if "--fmus" in arguments else ["--fmus", built / "fmi2"]
    assert said in refused_line(capsys, "ring", *arguments, *folder)


# The page


@needs("ecos")
def test_the_examples_of_the_page_run(built: Path, tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "systems.md").read_text(encoding="utf-8")
    (tmp_path / "dist").symlink_to(built)
    blocks = page.split("```python\n")[1:]
    assert blocks
    for block in blocks:
        code = block.partition("```")[0]
        subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, timeout=100)
