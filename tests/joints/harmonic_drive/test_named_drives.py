"""Two drives with names of their own in one process and in one system."""

import json
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import Fmu, importable, made_once, run_host
from fmpy import read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu
from joint_cases import law
from jointfmu_fmu_src.archive import pack
from jointfmu_fmu_src.building import FLAVOURS, build

from jointfmu.parameters import ParameterFile, default

pytestmark = pytest.mark.slow

TORQUE = 4.0
SAME = 1e-9
"""As in tests/support/natives.py: two mathematical libraries and orders of summation."""


def file_of(factor: float) -> ParameterFile:
    """A drive whose steel is so many times as stiff, loaded from the start."""
    file = default("harmonic_drive")
    stiffer = {"K_FTS0": factor * file.flat["K_FTS0"]}
    return replace(file.with_values(stiffer, "user", "test"), inputs={"tau": TORQUE})


FILES = {"ShoulderDrive": file_of(1.0), "ElbowDrive": file_of(1.5)}


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with FLAVOUR/ShoulderDrive.fmu and FLAVOUR/ElbowDrive.fmu."""

    def make(out: Path) -> None:
        for alias, file in FILES.items():
            build(["HarmonicDriveCompliance"], list(FLAVOURS), file, out, alias=alias)

    return made_once(tmp_path_factory, "named drives", make)


@pytest.fixture(scope="module")
def expected() -> dict[str, float]:
    """Wind-up [rad] of each by the package."""
    return {n: law("HarmonicDriveCompliance", f.values)({"tau": TORQUE})["phi_rel"] for n, f in FILES.items()}


@pytest.mark.parametrize("flavour", FLAVOURS)
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
    """An instance of each, of one flavour, in one process."""
    made = {alias: Fmu(drives / request.param / f"{alias}.fmu") for alias in FILES}
    yield made
    for one in made.values():
        one.free()


@pytest.mark.parametrize("both", ["fmi2", "fmi3"], indirect=True)
def test_fmpy_holds_both_in_one_process(both: dict[str, Fmu], expected: dict[str, float]) -> None:
    for instance in both.values():
        instance.start()
    for alias in FILES:
        assert both[alias].get("phi_rel")["phi_rel"] == pytest.approx(expected[alias], rel=SAME)
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
    """An SSP of both."""
    members = {f"resources/{a}.fmu": (drives / "fmi2" / f"{a}.fmu").read_bytes() for a in FILES}
    components = "".join(map(COMPONENT.format, FILES))
    pack(members | {"SystemStructure.ssd": SSD.format(components=components).encode()}, tmp_path / "arm.ssp")
    return tmp_path / "arm.ssp"


def test_fmpy_runs_a_system_of_both(arm: Path, expected: dict[str, float]) -> None:
    result = simulate_ssp(str(arm), stop_time=0.3, step_size=0.1)
    for alias, value in expected.items():
        assert result[f"{alias}.phi_rel"][-1] == pytest.approx(value, rel=SAME)


def test_ecos_runs_a_system_of_both(arm: Path, tmp_path: Path, expected: dict[str, float]) -> None:
    if not importable("ecospy"):
        pytest.skip("needs ecospy (in the extra 'test' on Linux x86_64) and Debian's libtbb12")
    out = tmp_path / "found.json"
    done = run_host(ECOS, arm, out, *(f"{alias}::phi_rel" for alias in FILES))
    assert done.returncode == 0, done.stderr
    found = json.loads(out.read_text())
    assert found == {f"{a}::phi_rel": pytest.approx(value, rel=SAME) for a, value in expected.items()}
