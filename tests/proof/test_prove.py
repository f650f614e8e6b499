"""`jointfmu prove`: FMUs pass their own proof in three importers; a changed FMU fails, and the fault is
named."""

import json
import os
import re
import signal
import subprocess
import sys
import time
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clients import needs
from conftest import here_alone, refused_line
from fmpy.cross_check import validate_result
from fmpy.util import read_csv, read_ref_opt_file
from jointfmu_fmu_src.building import build_fmus
from jointfmu_fmu_src.native.build import build_native_fmu as native_build
from jointfmu_fmu_src.proof.files import REFERENCE_TOLERANCE
from jointfmu_fmu_src.proof.members import make_proof_files
from jointfmu_fmu_src.proof.series import parse_time_series_csv
from jointfmu_fmu_src.proof.standard import REFERENCE_FILE_FOLDER
from jointfmu_tools import cli
from jointfmu_tools.run.proof.importers import SUPPORTED_FMI_VERSIONS as KNOWN
from jointfmu_tools.run.proof.report import MAX_PRINTED_FAILURES
from natives import VERSIONS
from proofs import BOTH, ECOS, MEASURED, copy, other_manifest, proved, replaced
from surroundings import Enter, environment, missing_package

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import load_default, load_parameter_file

pytestmark = pytest.mark.slow

RUNS = [
    pytest.param(name, importer, version, marks=[] if importer == "fmpy" else needs(importer))
    for name in ("GearContact", "BoltedJoint")
    for importer, known in KNOWN.items()
    for version in VERSIONS
    if version.removeprefix("fmi") in known and (name, importer) != ("BoltedJoint", "fmpy")
]
"""FMUs that are proved in each importer: one without history and, except in fmpy, one with history. For fmpy
the main job proves all FMUs; tests/native/test_native_clients.py compares the other importers with the
package."""


def assert_all_pass(found: dict) -> None:
    assert (found["passed"], found["misses"], found["start_values"]["differing"]) == (True, [], [])
    assert {one["verdict"] for one in found["experiments"]} == {"passed"}
    for one in found["experiments"]:
        for point in one["outputs"]:
            assert point["error"] <= MEASURED * point["allowed"], (one["name"], point)


@pytest.mark.parametrize(("name", "importer", "version"), RUNS)
def test_an_fmu_proves_itself(
    native: Path, capsys: pytest.CaptureFixture[str], name: str, importer: str, version: str
) -> None:
    found = proved(capsys, native / version / f"{name}.fmu", "--in", importer)
    assert_all_pass(found)
    assert {one["purpose"] for one in found["experiments"]} == {
        "smoke-test",
        "validation",
        "uncertainty-analysis",
    }
    assert found["start_values"]["compared"] > 0
    assert found["importer"] == importer
    interfaces = BOTH if importer == "fmpy" else BOTH[:1]
    assert found["interfaces"] == interfaces
    names = list(dict.fromkeys(one["name"] for one in found["experiments"]))
    runs = [(one["name"], one["interface"]) for one in found["experiments"]]
    assert runs == [(experiment, interface) for experiment in names for interface in interfaces]


@pytest.mark.parametrize(
    ("joint", "law"), [(name, law) for name, kind in KINDS.items() for law in list(kind.laws)[1:]]
)
def test_fmus_of_other_laws_prove_themselves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], joint: str, law: str
) -> None:
    """FMUs of other laws pass their own proof, also under a name that the user chose."""
    name = KINDS[joint].models[-1].name
    with here_alone("3"):
        fmu = native_build(name, load_default(joint, law), tmp_path, "3", fmu_alias="own_joint")
    assert fmu.name == "own_joint.fmu"
    assert_all_pass(proved(capsys, fmu))


# Tampered FMUs

NAME, OTHER = "GearContact", "GearMesh"
LIBRARY = f"binaries/linux64/{NAME}.so"


@pytest.fixture
def fmu(native: Path) -> Path:
    return native / "fmi2" / f"{NAME}.fmu"


def test_a_changed_start_value_fails_by_name(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("modelDescription.xml")
    match = re.search(rb'name="e".*?start="([^"]*)"', text, re.DOTALL)
    assert match is not None
    old, new = match[0], match[0].replace(match[1], b"0.21")
    path = copy(fmu, tmp_path / fmu.name, replaced("modelDescription.xml", old, new))
    found = proved(capsys, path, status=1)
    line = f"e starts at {float(match[1])!r}, modelDescription.xml says 0.21"
    assert (found["passed"], found["misses"]) == (False, [line])
    assert cli.main(["prove", str(path)]) == 1
    assert capsys.readouterr().out.endswith(f"missed: {line}\n44 passed, 0 missed, 1 start value differs\n")


def test_a_changed_parameter_of_the_python_flavour_fails_by_name(
    fmus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change = replaced("resources/parameters.toml", b"e = { value = 0.2,", b"e = { value = 0.3,")
    found = proved(capsys, copy(fmus / f"{NAME}.fmu", tmp_path / "changed.fmu", change), status=1)
    assert found["misses"][0] == "e starts at 0.3, modelDescription.xml says 0.2"
    assert any(line.startswith("load ramp, co-simulation: ") for line in found["misses"])


@needs("gmsh")
def test_an_elastic_joint_in_gross_slip_passes_its_proof(
    elastic_joint: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With a friction coefficient of 0.05, the loop slips so far that K_xx is round-off of its value at rest.

    C_loop, which contains the square root of K_xx, then differs from the package by more than 1e-5 of itself.
    """
    file = load_parameter_file(elastic_joint / "joint.toml")
    with here_alone("2"):
        build_fmus(["BoltedJoint"], ["fmi2"], replace(file, values=replace(file.values, mu=0.05)), tmp_path)
    (path,) = tmp_path.rglob("BoltedJoint.fmu")
    found = proved(capsys, path)
    assert not found["misses"]
    with zipfile.ZipFile(path) as archive:
        text = archive.read(f"{REFERENCE_FILE_FOLDER}/experiments/02_loop_ref.csv").decode()
    stiffness = parse_time_series_csv(text, "loop").columns["K_xx"]
    assert stiffness.min() < 1e-14 * stiffness.max()


def test_the_library_of_another_joint_fails_in_one_line(
    native: Path, fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with zipfile.ZipFile(native / "fmi2" / f"{OTHER}.fmu") as archive:
        library = archive.read(f"binaries/linux64/{OTHER}.so")
    path = copy(fmu, tmp_path / fmu.name, lambda name, data: library if name == LIBRARY else data)
    found = proved(capsys, path, status=1)
    (line,) = found["misses"]
    assert line.startswith("start: ")
    assert "the token is" in line
    assert line.endswith(f"that of {OTHER}")


@pytest.mark.parametrize("importer", ["fmpy", ECOS])
def test_a_library_that_computes_something_else_fails_by_name(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], importer: str
) -> None:
    """A library with another constant of the law (another pi) fails with the name of the output."""
    number = np.float64(np.pi).tobytes()

    def change(name: str, data: bytes) -> bytes:
        if name != LIBRARY:
            return data
        assert number in data
        return data.replace(number, np.float64(3.14).tobytes())

    found = proved(capsys, copy(fmu, tmp_path / fmu.name, change), "--in", importer, status=1)
    assert found["start_values"]["differing"] == []
    for interface in found["interfaces"]:
        begin = f"smoke test, {interface}: "
        assert any(line.startswith(begin) and ", reference " in line for line in found["misses"])
    verdicts = {one["verdict"] for one in found["experiments"] if one["name"] == "load ramp"}
    assert verdicts == {"missed"}


def test_a_library_that_crashes_fails_in_one_line(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A library that crashes (its code is overwritten with trap instructions) fails with one line."""

    def change(name: str, data: bytes) -> bytes:
        if name != LIBRARY:
            return data
        import lief

        image = lief.ELF.parse(list(data))  # must outlive its section
        text = image.get_section(".text")
        whole = bytearray(data)
        whole[text.offset : text.offset + text.size] = b"\xcc" * text.size
        return bytes(whole)

    found = proved(capsys, copy(fmu, tmp_path / fmu.name, change), status=1)
    (line,) = found["misses"]
    assert cli.main(["prove", str(tmp_path / fmu.name)]) == 1
    assert capsys.readouterr().out.splitlines()[-2:] == [
        f"missed: {line}",
        "the FMU does not start, nothing was executed",
    ]
    assert re.fullmatch(r"start: fmpy ended with status -\d+; the FMU's library may be broken", line)


def test_a_library_for_another_platform_is_named(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with zipfile.ZipFile(fmu) as archive:
        library = archive.read(f"binaries/win64/{NAME}.dll")
    path = copy(fmu, tmp_path / fmu.name, lambda name, data: library if name == LIBRARY else data)
    (line,) = proved(capsys, path, status=1)["misses"]
    assert line.startswith(f"start: the library in the FMU cannot be loaded (binaries/linux64/{NAME}.so")


def test_an_fmu_without_this_platform_is_refused(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = copy(fmu, tmp_path / fmu.name, lambda name, data: None if "linux" in name else data)
    line = refused_line(capsys, "prove", path)
    assert re.search(r"has no binary for linux64, only for .*win64", line)


def test_a_changed_reference_fails_by_name(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A reference that was changed by twice the tolerance, in the last row of one output, fails with the name
    of the output."""

    def change(name: str, data: bytes) -> bytes:
        if not name.endswith("load_ramp_ref.csv"):
            return data
        *rows, last = data.decode().splitlines()
        cells = last.split(",")
        cells[2] = repr(float(cells[2]) * (1.0 + 2.0 * REFERENCE_TOLERANCE))
        return "\n".join([*rows, ",".join(cells), ""]).encode()

    found = proved(capsys, copy(fmu, tmp_path / fmu.name, change), status=1)
    for line, interface in zip(found["misses"], BOTH, strict=True):
        text = rf"load ramp, {interface}: K_N = \S+ at 20 s, reference \S+, off by \S+, allowed \S+"
        assert re.fullmatch(text, line)
    assert {one["name"] for one in found["experiments"] if one["verdict"] == "missed"} == {"load ramp"}


@pytest.mark.parametrize("importer", ["fmpy", ECOS])
def test_a_refused_parameter_is_reported_in_the_words_of_the_fmu(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], importer: str
) -> None:
    change = replaced("e_0_999999.ssv", b'value="0.999999"', b'value="1.0"')
    found = proved(capsys, copy(fmu, tmp_path / fmu.name, change), "--in", importer, status=1)
    for line, interface in zip(found["misses"], found["interfaces"], strict=True):
        assert line.startswith(f"e = 0.999999, {interface}: ")
        assert "e = 1 is outside [0, 1)" in line


@pytest.mark.parametrize(
    ("part", "data", "said"),
    [
        ("fmi-ls-manifest.xml", None, "has no extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"),
        ("fmi-ls-manifest.xml", b"<fmi", "fmi-ls-manifest.xml is not valid XML"),
        (
            "fmi-ls-manifest.xml",
            b"<fmiReferences/>",
            "fmi-ls-name = None, expected 'org.fmi-standard.fmi-ls",
        ),
        (
            "validation.exp",
            None,
            "has no extra/org.fmi-standard.fmi-ls-ref/validation.exp, which its manifest",
        ),
        ("load_ramp_ref.csv", b"", "load_ramp_ref.csv: is empty; expected columns, 'time' first"),
        ("load_ramp_ref.csv", b"\xff", "is not a text; expected UTF-8"),
        ("e_0_999999.ssv", b"<a", "e_0_999999.ssv is not valid XML"),
    ],
)
def test_a_broken_proof_is_refused_in_one_line(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], part: str, data: bytes | None, said: str
) -> None:
    path = copy(fmu, tmp_path / fmu.name, lambda name, old: data if name.endswith(part) else old)
    assert said in refused_line(capsys, "prove", path)


def test_what_cannot_be_proved_is_refused_in_one_line(
    native: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], enter: Enter
) -> None:
    text = tmp_path / "text.fmu"
    text.write_text("no FMU")
    assert "absent.fmu: there is no such file; expected an FMU" in refused_line(
        capsys, "prove", tmp_path / "absent.fmu"
    )
    assert "is not an FMU" in refused_line(capsys, "prove", text)
    assert "invalid choice: 'simulink'" in refused_line(capsys, "prove", text, "--in", "simulink")
    enter(missing_package("ecospy"))
    line = refused_line(capsys, "prove", native / "fmi2" / f"{NAME}.fmu", "--in", "ecos")
    assert "the package ecospy is missing" in line
    enter(missing_package("libcosimpy"))  # its version of FMI is refused even if it is not installed
    line = refused_line(capsys, "prove", native / "fmi3" / f"{NAME}.fmu", "--in", "libcosim")
    assert "is of FMI 3.0, but libcosim takes only 2.0" in line


def test_an_importer_whose_library_does_not_load_is_refused(
    native: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], enter: Enter
) -> None:
    """An importer is refused if its library does not load, as on a machine without a library that
    it needs."""
    (tmp_path / "ecospy.py").write_text("raise OSError('libtbb.so.12: cannot open shared object file')\n")
    enter(environment(PYTHONPATH=str(tmp_path)))
    line = refused_line(capsys, "prove", native / "fmi2" / f"{NAME}.fmu", "--in", "ecos")
    assert line.endswith(
        "ecos cannot be loaded (OSError: libtbb.so.12: cannot open shared object file); "
        "on Debian, install libtbb12\n"
    )


@needs("libcosim")
def test_an_fmu_of_another_version_than_the_importer_takes_is_refused(
    native: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused_line(capsys, "prove", native / "fmi3" / f"{NAME}.fmu", "--in", "libcosim")
    assert "is of FMI 3.0, but libcosim takes only 2.0" in line


def resealed(source: Path, target: Path, parameter: str, value: float) -> Path:
    """Copy an FMU with another value of a parameter, and references that the package computes for it.
    Description, data and references agree, as if it were built so, without a compiler."""
    model = MODELS[source.stem]
    file = load_default(model.joint).with_values({parameter: value}, "user", "test")
    made = make_proof_files(model.with_parameters(file.joint, file.values), file)
    own = {
        path.removeprefix(f"{REFERENCE_FILE_FOLDER}/"): data
        for path, data in made.items()
        if path.startswith(REFERENCE_FILE_FOLDER)
    }
    old = rf'name="{re.escape(parameter)}".*?start="([^"]*)"'.encode()

    def change(name: str, data: bytes) -> bytes | None:
        if name != "modelDescription.xml":
            return None if name.startswith(REFERENCE_FILE_FOLDER) else data
        match = re.search(old, data, re.DOTALL)
        assert match is not None
        return data[: match.start(1)] + repr(value).encode() + data[match.end(1) :]

    return copy(source, target, change, **own)


def test_an_fmu_agrees_with_the_parameter_file_that_it_is_of(
    native: Path, fmus: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An FMU passes with its parameter file, from which the references are then computed."""
    own = KINDS[MODELS[NAME].joint].default_file()
    for path in (native / "fmi3" / f"{NAME}.fmu", fmus / f"{NAME}.fmu"):
        assert_all_pass(proved(capsys, path, "--against", str(own)))


def test_a_changed_parameter_is_seen_though_references_were_changed_along(
    fmus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A python FMU with another parameter in all its files passes its own proof; with the right file it
    misses."""
    text = b"e = { value = 0.2,", b"e = { value = 0.3,"
    path = resealed(fmus / f"{NAME}.fmu", tmp_path / f"{NAME}.fmu", "e", 0.3)
    path = copy(path, tmp_path / "changed.fmu", replaced("resources/parameters.toml", *text))
    assert_all_pass(proved(capsys, path))
    own = KINDS[MODELS[NAME].joint].default_file()
    found = proved(capsys, path, "--against", str(own), status=1)
    assert found["misses"][0] == f"e starts at 0.3, {own} says 0.2"
    assert any(line.startswith("load ramp, co-simulation: ") for line in found["misses"])
    assert cli.main(["prove", str(path), "--against", str(own)]) == 1
    printed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("missed: ")]
    assert len(found["misses"]) > len(printed) == MAX_PRINTED_FAILURES + 1
    assert printed[0] == f"missed: {found['misses'][0]}"


def test_an_fmu_is_not_compared_with_the_file_of_another_joint(
    fmu: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = KINDS[MODELS[OTHER].joint].default_file()
    line = refused_line(capsys, "prove", fmu, "--against", file)
    assert f"{NAME}.fmu: does not have the inputs and outputs of {OTHER}; expected an FMU of" in line
    line = refused_line(capsys, "prove", fmu, "--against", file, "--listing", "out")
    assert "leave out --against" in line


# Manifests that are not our own

STEP = (
    '<Experiment name="old" startTime="1.0" stopTime="3.0" stepSize="1.0">'
    '<Stimuli source="u%20in.csv"/><References source="y.csv"/></Experiment>'
)


def test_a_manifest_of_an_older_draft_is_read(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Manifests of older drafts are read: times as attributes, no tolerance, unquoted columns, an escaped
    address, a start time."""
    with zipfile.ZipFile(fmu) as archive:
        text, drive = (
            archive.read(f"{REFERENCE_FILE_FOLDER}/experiments/01_load_ramp_{x}.csv").decode()
            for x in ("ref", "in")
        )
    f = drive.split(",")[-1].strip()
    rows = [line.split(",") for line in text.splitlines()]
    third = rows[21][rows[0].index('"s_rel"')]
    files = {
        "u in.csv": f"time,f\n0,0\n1,{f}\n3,{f}\n".encode(),
        "y.csv": f"time,s_rel\n2,{third}\n".encode(),
    }
    found = proved(capsys, other_manifest(fmu, tmp_path / "old.fmu", STEP, **files))
    assert [one["interface"] for one in found["experiments"]] == BOTH
    for one in found["experiments"]:
        assert (one["purpose"], one["verdict"], one["points"]) == ("smoke-test", "passed", 1)
        (point,) = one["outputs"]
        assert (point["output"], point["time"]) == ("s_rel", 2.0)
        assert point["allowed"] == pytest.approx(1e-3 * point["reference"])


def test_memory_is_accepted_at_completed_steps(
    native: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An importer that omits completed steps misses the loop in model exchange, and only there."""
    name = next(model.name for model in MODELS.values() if model.load_cycle)
    with zipfile.ZipFile(native / "fmi3" / f"{name}.fmu") as archive:
        assert b'needsCompletedIntegratorStep="true"' in archive.read("modelDescription.xml")
    change = replaced("modelDescription.xml", b'needsCompletedIntegratorStep="true"', b"")
    path = copy(native / "fmi3" / f"{name}.fmu", tmp_path / f"{name}.fmu", change)
    found = proved(capsys, path, status=1)
    verdicts = {one["interface"]: one["verdict"] for one in found["experiments"] if one["name"] == "loop"}
    assert verdicts == dict(zip(BOTH, ("passed", "missed"), strict=True))


def test_what_is_not_executed_is_said(fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    experiments = (
        '<Experiment name="still"><SteadyState/></Experiment>'
        '<Experiment name="hdf"><TransientSimulation/>'
        '<References type="application/hdf5" source="y.hdf5"/></Experiment>'
        '<Experiment name="plain"><TransientSimulation stopTime="2" stepSize="1"/></Experiment>'
    )
    path = other_manifest(fmu, tmp_path / "own.fmu", experiments)
    verdicts = [one["verdict"] for one in proved(capsys, path)["experiments"]]
    kind = "not executed: has References of type application/hdf5; only text/csv is supported"
    assert verdicts == [
        "not executed: is a SteadyState; only TransientSimulation is supported",
        kind,
        *2 * ["runs, no reference"],
    ]
    assert cli.main(["prove", str(path)]) == 0
    assert "2 passed, 0 missed, 2 not executed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("experiment", "files", "said"),
    [
        ('<References source="y.csv"/>', {"y.csv": b"time,z\n1,0\n"}, "the FMU has no variable 'z'"),
        (
            '<Parameters source="p.ssv"/>',
            {"p.ssv": b"mm"},
            "of side1.E: unit 'MPa', expected 'Pa'",
        ),
    ],
)
def test_an_experiment_that_does_not_fit_the_fmu_fails_by_name(
    fmu: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    experiment: str,
    files: dict[str, bytes],
    said: str,
) -> None:
    space = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    if "p.ssv" in files:
        body = '<v:Parameter name="side1.E"><v:Real value="2e5" unit="MPa"/></v:Parameter>'
        whole = f'<v:ParameterSet xmlns:v="{space}"><v:Parameters>{body}</v:Parameters></v:ParameterSet>'
        files = {"p.ssv": whole.encode()}
    one = f'<Experiment name="own"><TransientSimulation stopTime="2"/>{experiment}</Experiment>'
    found = proved(capsys, other_manifest(fmu, tmp_path / "own.fmu", one, **files), status=1)
    for line, interface in zip(found["misses"], BOTH, strict=True):
        assert line.startswith(f"own, {interface}: ")
        assert said in line


SLAVE = '''
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real


class Counter(Fmi2Slave):
    """x grows by `rate` every second, `times` over."""

    def __init__(self, **options):
        super().__init__(**options)
        self.rate, self.times, self.on, self.x = 0.0, 2, True, 0.0
        fixed = dict(causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
        self.register_variable(Real("rate", causality=Fmi2Causality.input))
        self.register_variable(Integer("times", **fixed))
        self.register_variable(Boolean("on", **fixed))
        self.register_variable(Real("x", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        self.x += self.on * self.times * self.rate * step
        return True
'''


@pytest.fixture(scope="module")
def counter(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """FMU of another tool with states and integers.

    Built in a process of its own: an FMU of the python flavour that ran in this one has left a pythonfmu
    without libraries.
    """
    folder = tmp_path_factory.mktemp("counter")
    (folder / "counter.py").write_text(SLAVE)
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", "counter.py", "-d", str(folder)]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return next(folder.glob("*.fmu"))


def test_an_fmu_of_another_kind_is_proved_by_its_manifest(
    counter: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An FMU of another tool passes: x = 3 rate t for a parameter set with an integer, 0 if switched off."""
    space = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    values = {
        "three.ssv": '<v:Parameter name="times"><v:Integer value="3"/></v:Parameter>',
        "off.ssv": '<v:Parameter name="on"><v:Boolean value="false"/></v:Parameter>',
    }
    head, tail = f'<v:ParameterSet xmlns:v="{space}"><v:Parameters>', "</v:Parameters></v:ParameterSet>"
    files = {name: f"{head}{body}{tail}".encode() for name, body in values.items()}
    files |= {"u.csv": b"time,rate\n0,0.5\n2,0.5\n", "y.csv": b"time,x\n0,0\n1,1.5\n2,3\n"}
    files |= {"zero.csv": b"time,x\n0,0\n2,0\n"}
    experiments = "".join(
        f'<Experiment name="{name}" tolerance="1e-12"><TransientSimulation stepSize="0.25"/>'
        f'<Parameters source="{given}"/><Stimuli source="u.csv"/><References source="{result}"/></Experiment>'
        for name, given, result in (
            ("three", "three.ssv", "y.csv"),
            ("off", "off.ssv", "zero.csv"),
            ("wrong", "off.ssv", "y.csv"),
        )
    )
    found = proved(capsys, other_manifest(counter, tmp_path / "counter.fmu", experiments, **files), status=1)
    assert [one["verdict"] for one in found["experiments"]] == ["passed", "passed", "missed"]
    assert found["start_values"] == {"compared": 3, "differing": []}
    assert found["misses"] == [
        "wrong, co-simulation: x = 0 at 1 s, reference 1.5, off by 1.5, allowed 1.5e-12"
    ]


# Text, listing, Ctrl-C


def test_the_text_has_value_reference_and_tolerance(fmu: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["prove", str(fmu)]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    tables = [block.splitlines() for block in out.split("\n\n")]
    for head, *rows in tables[1:3]:
        assert re.split(r"  +", head)[-4:] == ["value", "reference", "off by", "allowed"]
        for row in rows:
            value, reference, error, allowed = map(float, re.split(r"  +", row)[-4:])
            assert abs(value - reference) <= allowed
            assert error <= allowed
    assert tables[3] == ["44 passed, 0 missed"]


@pytest.mark.parametrize("version", VERSIONS)
def test_the_listing_has_what_the_cross_check_asks_for(
    native: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], version: str
) -> None:
    """fmpy's readers read the files, and fmpy's simulation meets the references within the band of
    the rules."""
    import fmpy

    fmu = native / version / f"{NAME}.fmu"
    found = proved(capsys, fmu, "--listing", str(tmp_path / "out"))
    folders = {"fmi2": ["darwin64", "linux64", "win64"], "fmi3": [
        "aarch64-darwin", "aarch64-linux", "x86_64-darwin", "x86_64-linux", "x86_64-windows"
    ]}[version]  # fmt: skip
    above = [Path(folder).relative_to(tmp_path / "out").parts for folder in found["listing"]]
    assert [parts[:4] for parts in above] == [
        ("fmus", f"{version[-1]}.0", "cs", platform) for platform in folders
    ]
    for parts in above:
        folder = (tmp_path / "out").joinpath(*parts)
        assert parts[-1] == NAME
        assert sorted(path.name for path in folder.iterdir()) == [
            f"{NAME}.fmu", f"{NAME}_in.csv", f"{NAME}_ref.csv", f"{NAME}_ref.opt", "README.md",
        ]  # fmt: skip
        assert (folder / f"{NAME}.fmu").read_bytes() == fmu.read_bytes()
    names = [v.name for v in fmpy.read_model_description(str(fmu)).modelVariables]
    given, reference = (read_csv(folder / f"{NAME}_{kind}.csv") for kind in ("in", "ref"))
    options = read_ref_opt_file(folder / f"{NAME}_ref.opt")
    for series in (given, reference):
        assert series.dtype.names[0] == "time"
        assert set(series.dtype.names[1:]) <= set(names)
    start, stop = options["StartTime"], options["StopTime"]
    assert (reference["time"][0], reference["time"][-1]) == (start, stop)
    result = fmpy.simulate_fmu(
        str(fmu), start_time=start, stop_time=stop, output_interval=options["StepSize"], input=given,
        fmi_type="CoSimulation",
    )  # fmt: skip
    assert validate_result(result, reference, start, stop) is None
    assert (
        "Furthest" in (folder / "README.md").read_text() or "furthest" in (folder / "README.md").read_text()
    )


def test_no_listing_of_an_fmu_that_fails(
    fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = copy(fmu, tmp_path / fmu.name, replaced("smoke_test_ref.csv", b"4.0,", b"4.0,1"))
    assert cli.main(["prove", str(path), "--listing", str(tmp_path / "out")]) == 1
    assert "the listing is not written" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    place = path / "out"  # no folder: found before the experiments run
    assert f"{place}: cannot be written" in refused_line(capsys, "prove", path, "--listing", place)


def test_ctrl_c_ends_it_and_its_importer(fmu: Path, tmp_path: Path) -> None:
    """Ctrl-C during an experiment of a million steps ends the command and its importer."""
    one = '<Experiment name="long"><TransientSimulation stopTime="10" stepSize="2e-6"/></Experiment>'
    path = other_manifest(fmu, tmp_path / "long.fmu", one)
    command, own = [sys.executable, "-m", "jointfmu", "prove", str(path)], tmp_path / "own"
    own.mkdir()
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=os.environ | {"TMPDIR": str(own)},
    )
    while not list(own.rglob("modelDescription.xml")):  # the FMU is unpacked
        time.sleep(0.05)
        assert process.poll() is None
    time.sleep(1.5)
    assert process.poll() is None
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (130, "", "jointfmu prove: interrupted\n")
    with pytest.raises(ProcessLookupError):  # nobody of the group is left
        os.killpg(process.pid, 0)


def test_the_json_of_a_number_that_is_none_is_json(
    counter: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An output that is not finite misses; its JSON value is null."""
    files = {"u.csv": b"time,rate\n0,inf\n2,inf\n", "y.csv": b"time,x\n2,3\n"}
    one = (
        '<Experiment name="endless"><TransientSimulation stepSize="1"/>'
        '<Stimuli source="u.csv"/><References source="y.csv"/></Experiment>'
    )
    found = proved(capsys, other_manifest(counter, tmp_path / "c.fmu", one, **files), status=1)
    (point,) = found["experiments"][0]["outputs"]
    assert (point["value"], point["error"], point["passed"]) == (None, None, False)
    assert json.dumps(found)
