"""FMUs with prescribed midlines, and drives with names of the user: the package's numbers in all flavours."""

import json
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from clients import needs
from conftest import Fmu, here_alone, made_once, run_host
from fmpy import read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu
from joint_cases import CASES, law, random_inputs
from jointfmu_fmu_src.archive import write_archive
from jointfmu_fmu_src.building import FLAVOUR_BUILDERS, build_fmus
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND
from natives import Host, close
from surroundings import Enter, missing_package

from jointfmu.joints.harmonic_drive.friction import REFERENCE_TEMPERATURE
from jointfmu.joints.harmonic_drive.prescribed_midline import MAX_TABLE_POINTS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import replace_values

SPRING, COMPLIANCE = NAMES = ("HarmonicDriveSpring", "HarmonicDriveCompliance")
STATED = 0.005
"""Accuracy of the whole curve with its corners, as stated in the documentation."""
SAME = 1e-12
TUNED = {
    "catalogue": {
        "K1": 8e3,
        "K2": 9e3,
        "K3": 2e4,
        "T1": 5.0,
        "T2": 40.0,
        "corner": 0.1,
        "hysteresis_loss": 2e-4,
    },
    "table": {"hysteresis_loss": 3e-4, "hysteresis_stiffness": 8e3, "ratio": 50.0},
}
LAWS = tuple(TUNED)


def file_of(name: str) -> ParameterFile:
    """Parameter file: CSG-17-100, or the shipped table."""
    if name == "table":
        return load_default("harmonic_drive", name)
    given = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options)
    file: ParameterFile = NEW_JOINT_COMMAND.make_joint(given | {"catalogue": "CSG-17-100"}).parameter_file
    return file


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders LAW/fmi3 and LAW/python with FMUs."""

    def make_all(out: Path) -> None:
        with here_alone("3"):
            for one in LAWS:
                build_fmus([SPRING], ["fmi3", "python"], file_of(one), out / one)
                build_fmus([COMPLIANCE], ["fmi3"], file_of(one), out / one)

    return made_once(tmp_path_factory, "given", make_all)


def test_the_fmu_keeps_the_lines_of_the_catalogue(host: Host, built: Path) -> None:
    """CSG-17-100 at T1, T2, rated and repeated peak torque, both signs; exact outside the corners, also with
    tuned parameters."""
    instance = host(COMPLIANCE, "fmi3", built / "catalogue").start()

    def lines(T: float, K1: float = 1e4, K2: float = 1.4e4, K3: float = 1.6e4) -> float:
        return min(T, 3.9) / K1 + max(min(T, 12.0) - 3.9, 0.0) / K2 + max(T - 12.0, 0.0) / K3

    for T, within in ((2.0, SAME), (3.9, STATED), (8.0, SAME), (12.0, STATED), (31.0, SAME), (70.0, SAME)):
        for sign in (1.0, -1.0):
            found = instance.at({"tau": sign * T})
            assert found["phi_rel"] == pytest.approx(sign * lines(T), rel=within)
    assert instance.at({"tau": 1.0})["K_WTS"] == pytest.approx(1e4, rel=SAME)
    assert instance.at({"tau": 50.0})["K_WTS"] == pytest.approx(1.6e4, rel=SAME)
    instance.set_values({"K3": 2e4})
    assert instance.at({"tau": 70.0})["phi_rel"] == pytest.approx(lines(70.0, K3=2e4), rel=SAME)


@pytest.mark.parametrize("one", LAWS)
@pytest.mark.parametrize("name", NAMES)
def test_native_code_gives_the_numbers_of_the_package(host: Host, built: Path, one: str, name: str) -> None:
    instance, values = host(name, "fmi3", built / one), file_of(one).values
    for tuned in ({}, TUNED[one]):
        instance.reset()
        instance.start(tuned)
        expected = law(name, replace_values(values, tuned)).after({"temperature": REFERENCE_TEMPERATURE})
        for inputs in random_inputs(name, 20, seed=3):
            assert instance.at(inputs) == close(expected(inputs))


@pytest.mark.parametrize("one", LAWS)
def test_the_python_flavour_has_the_same_variables_and_numbers(
    host: Host, fmu: Callable[..., Fmu], built: Path, one: str
) -> None:
    python = fmu(SPRING, folder=built / one / "python").start()
    native = host(SPRING, "fmi3", built / one).start()
    assert python.variables.keys() == native.variables.keys() - {"time"}
    for inputs in random_inputs(SPRING, 5, seed=9):
        assert python.at(inputs) == close(native.at(inputs))


@pytest.mark.parametrize("one", LAWS)
def test_derivatives_are_the_slopes_of_the_outputs(host: Host, built: Path, one: str) -> None:
    """Derivatives agree with differences of the outputs, on the lines and inside a corner (at the wind-up of
    T1)."""
    values = file_of(one).values
    for phi in (1e-4, 3.92e-4, 6e-4, 2e-3):
        state = CASES[SPRING].numbers.state | {"phi1": 0.0, "phi2": phi}
        instance, expected = host(SPRING, "fmi3", built / one).start(state), law(SPRING, values)
        names = {n: v.valueReference for n, v in instance.variables.items()}
        outputs = ("tau", "K_WTS", "K_TS", "tau1")
        column = instance.fmu.getDirectionalDerivative([names[n] for n in outputs], [names["phi2"]], [1.0], 4)
        h = 1e-9
        low, high = (expected({**state, "phi2": phi + d * h}) for d in (-1.0, 1.0))
        for output, found in zip(outputs, column, strict=True):
            rough = 1e-6 * abs(expected(state)[output]) / h
            assert found == pytest.approx(
                (high[output] - low[output]) / (2.0 * h), rel=1e-5, abs=1e-3 * rough
            )


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"T2": 3.0}, "T2 = 3 N.m is outside (3.9, inf): it must exceed T1"),
        ({"corner": 0.6}, "corner = 0.6 is outside [0, "),
        ({"K2": -1.0}, "K2 = -1 N.m/rad is outside (0, 1e+12]"),
    ],
)
def test_lines_that_cannot_be_are_refused(
    host: Host, fmu: Callable[..., Fmu], built: Path, values: dict[str, Any], message: str
) -> None:
    native = host(SPRING, "fmi3", built / "catalogue")
    python = fmu(SPRING, folder=built / "catalogue" / "python")
    for instance in (native, python):
        assert message in instance.refused(instance.start, values)


def table_of(points: int) -> ParameterFile:
    """Stiffening table with other numbers and the same number of points."""
    torque = tuple(40.0 * (i + 1) / points for i in range(points))
    angle = tuple(T / (6e3 + 100.0 * T) for T in torque)
    file = file_of("table")
    return file.with_values({"table.torque": torque, "table.angle": angle}, "user", "test")


@pytest.mark.parametrize("points", [2, 37, MAX_TABLE_POINTS])
@pytest.mark.parametrize("name", NAMES)
def test_another_table_needs_no_compiler(
    host: Host, built: Path, tmp_path: Path, enter: Enter, name: str, points: int
) -> None:
    """An FMU takes a table of any number of points without a compiler; it has the numbers of the package, the
    largest stiffness included."""

    enter(missing_package("ziglang"))
    file = table_of(points)
    with here_alone("3"):
        build_fmus([name], ["fmi3"], file, tmp_path)
    instance, expected = host(name, "fmi3", tmp_path).start(), law(name, file.values).after()
    for inputs in random_inputs(name, 10, seed=11):
        # a place within a short segment has the round-off of the whole wind-up
        assert instance.at(inputs) == close(expected(inputs), max(SAME, 1e-14 * points))


def test_beyond_the_table_the_last_line_goes_on_with_one_warning(host: Host, built: Path) -> None:
    instance = host(COMPLIANCE, "fmi3", built / "catalogue").start()
    far = instance.at({"tau": 500.0})
    assert far["K_WTS"] == pytest.approx(1.6e4, rel=SAME)
    assert far["phi_rel"] == pytest.approx(3.9e-4 + 8.1 / 1.4e4 + 488.0 / 1.6e4, rel=SAME)
    assert len(instance.warnings) == 1


# Two drives with names of their own in one process and in one system


TORQUE = 4.0
AGREE = 1e-9
"""Tolerance of FMU against package, as in tests/support/natives.py."""


def stiffened(factor: float) -> ParameterFile:
    """Parameter file of a drive whose steel is `factor` times as stiff, with a start load."""
    file = load_default("harmonic_drive")
    stiffer = {"K_FTS0": factor * file.values_by_name["K_FTS0"]}
    return replace(file.with_values(stiffer, "user", "test"), inputs={"tau": TORQUE})


FILES = {"ShoulderDrive": stiffened(1.0), "ElbowDrive": stiffened(1.5)}


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with FLAVOUR/ShoulderDrive.fmu and FLAVOUR/ElbowDrive.fmu."""

    def make(out: Path) -> None:
        for alias, file in FILES.items():
            build_fmus(["HarmonicDriveCompliance"], list(FLAVOUR_BUILDERS), file, out, fmu_alias=alias)

    return made_once(tmp_path_factory, "named drives", make)


@pytest.fixture(scope="module")
def expected() -> dict[str, float]:
    """Wind-up [rad] of each drive by the package."""
    return {n: law("HarmonicDriveCompliance", f.values)({"tau": TORQUE})["phi_rel"] for n, f in FILES.items()}


@pytest.mark.slow
@pytest.mark.parametrize("flavour", FLAVOUR_BUILDERS)
def test_everything_has_the_name(drives: Path, flavour: str) -> None:
    tokens = set()
    for alias in FILES:
        path = drives / flavour / f"{alias}.fmu"
        description = read_model_description(str(path))
        tokens.add(description.guid)
        assert description.modelName == alias
        assert {i.modelIdentifier for i in (description.coSimulation, description.modelExchange) if i} == {
            alias
        }
        assert validate_fmu(str(path)) == []
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            binaries = [n for n in names if n.startswith("binaries/")]
            assert binaries
            assert {Path(n).stem for n in binaries if Path(n).suffix} <= {alias, f"lib{alias}"}
            if flavour == "python":
                continue
            assert {Path(n).stem for n in binaries} == {alias}
            for n in binaries:
                assert b"HarmonicDriveCompliance" not in archive.read(n)
            assert f"<h1>{alias}</h1>" in archive.read("documentation/index.html").decode()
            assert f'.name = "{alias}"' in archive.read("sources/data.c").decode()
    assert len(tokens) == len(FILES)


@pytest.fixture
def both(drives: Path, request: pytest.FixtureRequest) -> Iterator[dict[str, Fmu]]:
    """Instances of both drives in one flavour, in one process."""
    made = {alias: Fmu(drives / request.param / f"{alias}.fmu") for alias in FILES}
    yield made
    for one in made.values():
        one.free_instance()


@pytest.mark.slow
@pytest.mark.parametrize("both", ["fmi2", "fmi3"], indirect=True)
def test_fmpy_holds_both_in_one_process(both: dict[str, Fmu], expected: dict[str, float]) -> None:
    for instance in both.values():
        instance.start()
    for alias in FILES:
        assert both[alias].get("phi_rel")["phi_rel"] == pytest.approx(expected[alias], rel=AGREE)
        wrong = both[alias].refused(both[alias].at, {"tau": float("nan")})
        assert wrong.startswith("tau = nan")


ECOS = """
import json, sys
from ecospy import EcosSimulation
path, out, *wanted = sys.argv[1:]
with EcosSimulation(ssp_path=path, step_size=0.1) as simulation:
    assert simulation.init()
    simulation.step(3)
    json.dump({name: simulation.get_real(name) for name in wanted}, open(out, "w"))
    simulation.terminate()
"""
SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" name="arm" version="1.0">
  <ssd:System name="arm"><ssd:Elements>{components}</ssd:Elements></ssd:System>
</ssd:SystemStructureDescription>
"""
COMPONENT = """<ssd:Component name="{0}" source="resources/{0}.fmu" type="application/x-fmu-sharedlibrary">
<ssd:Connectors><ssd:Connector name="phi_rel" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
</ssd:Component>"""


@pytest.fixture
def arm(drives: Path, tmp_path: Path) -> Path:
    """System archive (SSP) with both drives."""
    members = {f"resources/{a}.fmu": (drives / "fmi2" / f"{a}.fmu").read_bytes() for a in FILES}
    components = "".join(map(COMPONENT.format, FILES))
    write_archive(
        members | {"SystemStructure.ssd": SSD.format(components=components).encode()}, tmp_path / "arm.ssp"
    )
    return tmp_path / "arm.ssp"


@pytest.mark.slow
def test_fmpy_runs_a_system_of_both(arm: Path, expected: dict[str, float]) -> None:
    result = simulate_ssp(str(arm), stop_time=0.3, step_size=0.1)
    for alias, value in expected.items():
        assert result[f"{alias}.phi_rel"][-1] == pytest.approx(value, rel=AGREE)


@pytest.mark.slow
@needs("ecos")
def test_ecos_runs_a_system_of_both(arm: Path, tmp_path: Path, expected: dict[str, float]) -> None:
    out = tmp_path / "found.json"
    done = run_host(ECOS, arm, out, *(f"{alias}::phi_rel" for alias in FILES))
    assert done.returncode == 0, done.stderr
    found = json.loads(out.read_text())
    assert found == {f"{a}::phi_rel": pytest.approx(value, rel=AGREE) for a, value in expected.items()}
