"""`jointfmu prove` with an FMU and manifests of others: a neuron model in C with events of each kind."""

import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from clients import needs
from conftest import RELEASED, refused_line
from jointfmu_fmu_src.proof.standard import (
    CO_SIMULATION,
    MANIFEST_PATH,
    MODEL_EXCHANGE,
    REFERENCE_FILE_FOLDER,
)
from numpy.typing import NDArray
from proofs import BOTH, ECOS, LIBCOSIM, copy, other_manifest, proved, replaced

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
SOURCE = HERE / "foreign"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"


@pytest.fixture(scope="module")
def neuron(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """FMU of another author, compiled for this machine, with both interfaces."""
    folder = tmp_path_factory.mktemp("neuron")
    library = folder / f"Neuron{fmpy.sharedLibraryExtension}"
    headers = Path(fmpy.__file__).parent / "c-code"
    command = [sys.executable, "-m", "ziglang", "cc", *RELEASED, "-shared", "-fPIC", f"-I{headers}"]
    subprocess.run([*command, *SOURCE.glob("*.c"), "-lm", "-o", library], check=True)
    with zipfile.ZipFile(folder / "Neuron.fmu", "w") as archive:
        archive.write(SOURCE / "modelDescription.xml", "modelDescription.xml")
        archive.write(library, f"binaries/{fmpy.platform}/{library.name}")
    return folder / "Neuron.fmu"


Columns = dict[str, NDArray[np.float64]]


def exact(time: NDArray[np.float64], u: float = 2.0, gain: float = 1.0, period: float = 0.25) -> Columns:
    """Exact solution x(time) from rest with resets at the limit 1, sampled once per period."""
    rest = gain * u
    cycle = -np.log(1.0 - 1.0 / rest)

    def x(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return -rest * np.expm1(-np.mod(t, cycle))

    return {
        "x": x(time),
        "sampled": x(period * np.floor(time / period + 1e-9)),
        "fired": np.floor(time / cycle),
    }


def csv(time: NDArray[np.float64], columns: Columns) -> bytes:
    rows = zip(time, *columns.values(), strict=True)
    return "\n".join(
        [",".join(["time", *columns]), *(",".join(map(repr, map(float, r))) for r in rows), ""]
    ).encode()


def ssv(*parameters: str) -> bytes:
    body = "".join(f"<v:Parameter {text}</v:Parameter>" for text in parameters)
    return f'<v:ParameterSet xmlns:v="{SSV}"><v:Parameters>{body}</v:Parameters></v:ParameterSet>'.encode()


TIME = np.linspace(0.0, 3.0, 61)  # no result at an instant at which it fires
STATED = '<TransientSimulation stopTime="3" stepSize="0.05"/>'


def experiment(name: str, inside: str) -> str:
    return f'<Experiment name="{name}" tolerance="1e-5">{STATED}{inside}</Experiment>'


FILES = '<Stimuli source="u.csv"/><References source="y.csv"/>'
INPUT = csv(np.array([0.0, 3.0]), {"u": np.array([2.0, 2.0])})


@pytest.mark.parametrize("importer", ["fmpy", ECOS, LIBCOSIM])
def test_events_of_all_kinds_are_met(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], importer: str
) -> None:
    """Four events occur; an integer output is compared; an enumeration is set by the name of its item."""
    files = {"u.csv": INPUT, "y.csv": csv(TIME, exact(TIME)), "double.csv": csv(TIME, exact(TIME, gain=2.0)),
             "double.ssv": ssv('name="gain"><v:Enumeration value="double"/>')}  # fmt: skip
    double = '<Parameters source="double.ssv"/><Stimuli source="u.csv"/><References source="double.csv"/>'
    experiments = experiment("single", FILES) + experiment("double", double)
    path, own = other_manifest(neuron, tmp_path / "n.fmu", experiments, **files), importer == "fmpy"
    found = proved(capsys, path, "--in", importer, status=int(not own))
    runs = [(one["name"], one["interface"], one["verdict"]) for one in found["experiments"]]
    last = "passed" if own else "missed"
    assert runs == [(name, way, verdict) for name, verdict in (("single", "passed"), ("double", last))
                    for way in (BOTH if own else BOTH[:1])]  # fmt: skip
    kind = "double, co-simulation: gain is of type Enumeration, which this importer does not take; use fmpy"
    assert found["misses"] == ([] if own else [kind])
    outputs = [point["output"] for point in found["experiments"][0]["outputs"]]
    assert outputs == ["x", "sampled", "fired"]
    assert exact(TIME)["fired"][-1] == 4


def test_an_event_that_nearly_meets_a_communication_point_is_met(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Events are met whose times differ by round-off from communication points.

    The FMU adds 0.1 s for each sample; the communication points are multiples of 0.05 s.
    """
    events = np.cumsum(np.full(30, 0.1))
    apart = np.abs(events - 0.05 * np.round(events / 0.05))
    assert np.any((apart > 0.0) & (apart < 1e-14))
    files = {"u.csv": INPUT, "y.csv": csv(TIME, exact(TIME, period=0.1))}
    files |= {"often.ssv": ssv('name="period"><v:Real value="0.1"/>')}
    path = other_manifest(
        neuron, tmp_path / "n.fmu", experiment("often", f'<Parameters source="often.ssv"/>{FILES}'), **files
    )
    assert {one["verdict"] for one in proved(capsys, path)["experiments"]} == {"passed"}


def test_inputs_jump_and_are_switched_off(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """u jumps from 0.8 to 0.5 at 1 s, a Boolean switches it off at 2 s; results at these times may be of
    either side."""
    begin = -0.8 * np.expm1(-1.0)
    middle = 0.5 + (begin - 0.5) * np.exp(-1.0)
    x = np.where(TIME < 1.0, -0.8 * np.expm1(-TIME), 0.5 + (begin - 0.5) * np.exp(1.0 - TIME))
    x = np.where(TIME > 2.0, middle * np.exp(2.0 - TIME), x)
    jump = int(np.flatnonzero(np.isclose(TIME, 1.0))[0])
    time = np.insert(TIME, jump, TIME[jump])
    y = {"x": np.insert(x, jump, x[jump])}
    stimuli = b"time,u,on\n0,0.8,1\n1,0.8,1\n1,0.5,1\n2,0.5,0\n3,0.5,0\n"
    files = {"u.csv": stimuli, "y.csv": csv(time, y)}
    found = proved(capsys, other_manifest(neuron, tmp_path / "n.fmu", experiment("jump", FILES), **files))
    assert [(one["verdict"], one["points"]) for one in found["experiments"]] == 2 * [("passed", 60)]


def test_an_input_that_rises_is_straight_in_model_exchange(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Model exchange interpolates an input linearly: x' = t/5 - x is met at a tolerance that co-simulation
    with inputs held for 50 ms misses."""
    x = (TIME - 1.0 + np.exp(-TIME)) / 5.0
    files = {"u.csv": b"Time,u\n0,0\n3,0.6\n", "y.csv": csv(TIME, {"x": x})}
    path = other_manifest(neuron, tmp_path / "n.fmu", experiment("rise", FILES), **files)
    found = proved(capsys, path, status=1)
    assert {one["interface"]: one["verdict"] for one in found["experiments"]} == {
        CO_SIMULATION: "missed",
        MODEL_EXCHANGE: "passed",
    }


@pytest.mark.parametrize(("label", "runs"), [(CO_SIMULATION, BOTH[:1]), (MODEL_EXCHANGE, BOTH[1:])])
def test_a_label_says_for_which_interface_an_experiment_is(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], label: str, runs: list[str]
) -> None:
    files = {"u.csv": INPUT, "y.csv": csv(TIME, exact(TIME))}
    path = other_manifest(neuron, tmp_path / "all.fmu", experiment("one", FILES), **files)
    name = f'<Label name="interface:{label.replace(" ", "-")}"/></Related>'.encode()
    change = replaced(Path(MANIFEST_PATH).name, b'role="experiment"/>', b'role="experiment">' + name)
    found = proved(capsys, copy(path, tmp_path / "one.fmu", change))
    assert [one["interface"] for one in found["experiments"]] == runs


def exchange_only(neuron: Path, tmp_path: Path) -> Path:
    """FMU with one experiment, for model exchange only."""
    files = {"u.csv": INPUT, "y.csv": csv(TIME, exact(TIME))}
    path = other_manifest(neuron, tmp_path / "all.fmu", experiment("one", FILES), **files)
    line = b'<CoSimulation modelIdentifier="Neuron" canHandleVariableCommunicationStepSize="true"/>'
    return copy(path, tmp_path / "me.fmu", replaced("modelDescription.xml", line, b""))


def test_an_fmu_for_model_exchange_only_is_proved(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = proved(capsys, exchange_only(neuron, tmp_path))
    assert found["interfaces"] == BOTH[1:]
    assert [one["verdict"] for one in found["experiments"]] == ["passed"]


@needs("ecos")
def test_an_fmu_for_model_exchange_only_is_refused_for_ecos(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = refused_line(capsys, "prove", exchange_only(neuron, tmp_path), "--in", "ecos")
    assert refused.endswith(
        "has only model exchange, but ecos runs only co-simulation; choose another importer\n"
    )


def test_a_missed_event_misses_by_name(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without its event indicator the event does not occur in model exchange."""
    files = {"u.csv": INPUT, "y.csv": csv(TIME, {"fired": exact(TIME)["fired"]})}
    path = other_manifest(neuron, tmp_path / "all.fmu", experiment("one", FILES), **files)
    change = replaced("modelDescription.xml", b'numberOfEventIndicators="1"', b'numberOfEventIndicators="0"')
    found = proved(capsys, copy(path, tmp_path / "none.fmu", change), status=1)
    (line,) = found["misses"]
    assert line.startswith("one, model exchange: fired = ")


def test_times_that_are_not_stated_are_those_of_the_results(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without stated times, tolerance and inputs, an experiment has the times of its results, at rest."""
    files = {"y.csv": b"time,x,fired\n0,0,0\n0.5,0,0\n"}
    one = '<Experiment name="rest"><TransientSimulation/><References source="y.csv"/></Experiment>'
    found = proved(capsys, other_manifest(neuron, tmp_path / "n.fmu", one, **files))
    assert [(one["verdict"], one["points"]) for one in found["experiments"]] == 2 * [("passed", 2)]


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"u.csv": b"time,on\n0,0.5\n3,1\n"}, "on = 0.5 is not of type Boolean"),
        (
            {"p.ssv": ssv('name="gain"><v:Enumeration value="treble"/>')},
            "gain = 'treble' is not of type Enumeration",
        ),
        ({"p.ssv": ssv('name="gain"><v:Real value="1.5"/>')}, "gain = 1.5 is not of type Enumeration"),
        ({"p.ssv": ssv('name="loss"><v:Real value="1.5"/>')}, "the FMU has no variable 'loss'"),
    ],
)
def test_values_that_do_not_fit_are_named(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], files: dict[str, bytes], said: str
) -> None:
    inside = '<Parameters source="p.ssv"/>' if "p.ssv" in files else '<Stimuli source="u.csv"/>'
    path = other_manifest(neuron, tmp_path / "n.fmu", experiment("own", inside), **files)
    assert proved(capsys, path, status=1)["misses"] == [f"own, {way}: {said}" for way in BOTH]


def test_what_lies_elsewhere_or_in_other_formats_is_left_out(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A web address, an experiment in another format and a second result file are left out."""
    files = {"y.csv": b"time,x\n0,0\n3,0\n"}
    two = '<References source="y.csv"/><References source="z.csv"/>'
    path = other_manifest(neuron, tmp_path / "n.fmu", experiment("two", two), **files)
    more = (
        b'<Related source="https://example.org/far.exp" type="application/x-ma-hs-experiments" '
        b'role="experiment"/>'
        b'<Related source="plan.txt" type="text/plain" role="experiment/validation"/></fmiReferences>'
    )
    path = copy(path, tmp_path / "m.fmu", replaced(Path(MANIFEST_PATH).name, b"</fmiReferences>", more))
    found = {one["name"]: one["verdict"] for one in proved(capsys, path, status=1)["experiments"]}
    assert found == {
        "two": "not executed: has 2 References; only one is supported",
        "https://example.org/far.exp": "not executed: its file is outside the FMU",
        "plan.txt": "not executed: its type is text/plain; only application/x-ma-hs-experiments is supported",
    }


def test_the_example_of_the_standard_is_read(
    neuron: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Original manifest with labels, annotations and missing files; experiments as in the example of the
    draft, one with results in HDF5."""
    manifest = (HERE / "standards" / "fmi_ls_ref_manifest_example.xml").read_bytes()
    smoke = b"""<?xml version="1.0" encoding="UTF-8"?>
<Experiments name="Smoke Tests" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xsi:noNamespaceSchemaLocation="../../schema/maHarmonizedSpecificationExperiments.xsd">
  <Experiment name="Test1" startTime="0.0" stopTime="3.0" stepSize="0.001" tolerance="0.004">
    <Stimuli source="test1-in.csv" /><References source="test1-ref.csv" />
  </Experiment>
  <Experiment name="Test2" startTime="0.0" stopTime="15.0" stepSize="0.010">
    <Parameters source="dynamic-params.ssv" /><Stimuli source="test1-in.csv" />
    <References source="test2-ref.hdf5" type="application/hdf5" />
  </Experiment>
</Experiments>
"""
    files = {"fmi-ls-manifest.xml": manifest, "smoke-tests.exp": smoke, "test1-in.csv": INPUT}
    files |= {"test1-ref.csv": csv(TIME, exact(TIME))}
    path = copy(neuron, tmp_path / "example.fmu", lambda name, data: data, **files)
    with zipfile.ZipFile(path) as archive:
        assert f"{REFERENCE_FILE_FOLDER}/baseline-params.ssv" not in archive.namelist()
    verdicts = [(one["name"], one["verdict"]) for one in proved(capsys, path)["experiments"]]
    kind = "not executed: has References of type application/hdf5; only text/csv is supported"
    assert verdicts == [("Test1", "passed"), ("Test1", "passed"), ("Test2", kind)]
