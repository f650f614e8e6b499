"""FMU of a whole system: motion against model exchange, derivatives, states, refusals."""

import re
import zipfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from jointfmu_fmu_src.proof.series import TimeSeries
from jointfmu_fmu_src.proof.standard import REFERENCE_FILE_FOLDER
from jointfmu_tools.run.host import open_instance, unpack_fmu
from jointfmu_tools.run.proof.manifest import RelatedFileReader
from jointfmu_tools.run.proof.run import prove
from jointfmu_tools.systems.fmu import proof
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import build_system_fmus
from jointfmu_tools.systems.fmu.code import generate_sources
from jointfmu_tools.systems.system import load_system, load_systems, read_system
from proofs import ECOS, LIBCOSIM, copy, replaced
from scipy.interpolate import CubicSpline

import jointfmu

pytestmark = pytest.mark.slow  # builds FMUs

LAST = {"robot_joint": "link.phi", "bolted_column": "column.s", "six_axis_robot": "hand_drive.phi_rel"}
DRIVE = ("link.phi", "link.w", "drive.tau", "drive.E_loss")


TURNED = 0.029
"""Time [s] after which the bolted column reversed within the last step."""


STOP = {"six_axis_robot": 0.6}
"""Stop time [s] in the middle of the motion: all axes slip and move fast."""


VERSIONS = {"six_axis_robot": "3"}
"""FMI versions that are compiled of a large system; of others, both."""


def made(name, out):
    shipped = load_system(name)
    ends = replace(shipped, stop_time=STOP.get(name, max(shipped.stop_time, TURNED)))
    versions = VERSIONS.get(name, "23")
    paths = build_system_fmus(assemble_system(ends), out, versions, (fmpy.platform_tuple,))
    return dict(zip(versions, paths, strict=True))


@pytest.fixture(scope="module")
def files_of(tmp_path_factory):
    """Function: name of a shipped system -> {FMI version: path}; each system is built once."""
    return cache(lambda name: made(name, tmp_path_factory.mktemp(name)))


@pytest.fixture(scope="module")
def joint(files_of):
    return files_of("robot_joint")


def run(file, outputs, step, stop, **more):
    return fmpy.simulate_fmu(
        file, stop_time=stop, output=outputs, step_size=step, output_interval=step, **more
    )


def exchange(file, outputs, stop, tolerance, interval):
    return run(
        file, outputs, interval, stop, fmi_type="ModelExchange", solver="CVode", relative_tolerance=tolerance
    )


def test_components_that_differ_in_data_share_their_code():
    """Six drives of the catalogue share one C; the C of bolted joints reads the data of one joint."""
    files = generate_sources(assemble_system(load_system("six_axis_robot")))
    drives = "HarmonicDriveSpring_"
    assert [name for name in files if name.endswith("harmonic_drive.c")] == [f"{drives}harmonic_drive.c"]
    assert len([name for name in files if re.fullmatch(rf"{drives}data\d*\.c", name)]) == 6
    column = assemble_system(load_system("bolted_column"))
    (joint,) = (c for c in column.components if c.fmu_model.name == "BoltedJoint")
    wider = joint.parameter_file.with_values({"pattern.hole_diameter": 0.02}, "user", "test")
    for parameters, count in ((joint.parameter_file, 1), (wider, 2)):
        other = replace(joint, name="other", parameter_file=parameters)
        files = generate_sources(replace(column, components=[other, *column.components]))
        assert len([name for name in files if name.endswith("_bolted_joint.c")]) == count


@pytest.mark.parametrize("version", ["2", "3"])
def test_description_is_valid(joint, version):
    assert validate_fmu(str(joint[version])) == []


@pytest.mark.parametrize(
    ("importer", "version"),
    [
        ("fmpy", "3"),
        pytest.param(*ECOS.values, "2", marks=ECOS.marks),
        pytest.param(*LIBCOSIM.values, "2", marks=LIBCOSIM.marks),
    ],
)
@pytest.mark.parametrize("name", ["robot_joint", "bolted_column"])
def test_any_step_passes_the_proof_in_each_importer(files_of, name, importer, version):
    """All outputs at 1 and 10 ms steps, within the 0.5 % that docs/systems_explanation.md states."""
    found = prove(files_of(name)[version], importer)
    assert found.failure_messages == []
    assert found.executed_experiment_count == (3 if importer == "fmpy" else 2)


def test_a_tolerance_that_is_too_loose_is_tightened(tmp_path):
    """The local errors of a step add up, to more in one system than in another: the FMU meets its references
    at long steps too, by a tolerance that the build finds."""
    system = replace(assemble_system(load_system("robot_joint")), step_tolerance=3e-3)
    (path,) = build_system_fmus(system, tmp_path, "3", (fmpy.platform_tuple,))
    assert prove(path).failure_messages == []


@pytest.mark.parametrize("name", ["robot_joint", "bolted_column", "six_axis_robot"])
def test_references_of_the_proof_are_those_of_model_exchange(files_of, name):
    """The references of the FMU are those of model exchange in fmpy; for FMI 2.0, those of fmpy's own master
    agree."""
    files, output = files_of(name), LAST[name]
    if name == "six_axis_robot":  # fmpy's master has nothing in it that the robot's one joint has not
        found = prove(files["3"])
        assert (found.failure_messages, found.executed_experiment_count) == ([], 3)
        return
    stop = max(load_systems()[name].stop_time, TURNED)
    references = RelatedFileReader(files["2"]).read_experiments()[0].reference_results
    expected = exchange(files["2"], [output], stop, 1e-9, stop / 20_000)
    due = np.interp(references.time, expected["time"], expected[output])
    assert np.abs(references.columns[output] - due).max() < 2e-4 * np.abs(due).max()  # of the memory's steps
    if name == "bolted_column":  # the spring is as stiff as at rest where its motion has turned
        found = run(files["2"], ["column.v", "joint.K_xx"], 1e-3, TURNED, fmi_type="CoSimulation")
        assert found["column.v"][-1] < 0.0 < found["column.v"][-2]
        assert found["joint.K_xx"][-2] < 0.98 * found["joint.K_xx"][0]
        assert found["joint.K_xx"][-1] == pytest.approx(found["joint.K_xx"][0], rel=1e-3)


@pytest.mark.parametrize(
    ("scale", "refused"),
    [
        (b"1e-12", ""),
        (b"none", "has scale of link.phi = 'none', expected a number"),
        (b"0", "= 0.0, expected a"),
    ],
)
def test_scales_decide_what_counts(joint, tmp_path, scale, refused):
    old = re.search(
        rb'name="link.phi" value="([^"]*)"',
        zipfile.ZipFile(joint["2"]).read(f"{REFERENCE_FILE_FOLDER}/co-simulation.exp"),
    )
    change = replaced("co-simulation.exp", old[0], old[0].replace(old[1], scale))
    path = copy(Path(joint["2"]), tmp_path / "other.fmu", change)
    if refused:
        with pytest.raises(ValueError, match=re.escape(refused)):
            prove(path)
    else:
        assert [text for text in prove(path).failure_messages if "link.phi" in text]


@pytest.mark.parametrize(("sensitive", "end"), [(3.0, 2.0), (0.505, 0.5), (0.5, 0.49)])
def test_the_proof_ends_before_the_motion_is_too_sensitive(monkeypatch, sensitive, end):
    """The proof ends where a tool's tolerance gives other results than the tolerance of the references."""
    model = assemble_system(load_system("robot_joint")).make_fmu_model()

    def exchanged(model, fmu, times, tolerance):
        columns = {v.name: times + 1.0 for v in model.outputs}
        if tolerance > proof.REFERENCE_SOLVER_TOLERANCE:
            columns["link.phi"] = np.where(times < sensitive - 1e-9, times + 1.0, 0.0)
        return TimeSeries(times, columns)

    monkeypatch.setattr(proof, "_simulate_outputs", exchanged)
    members = proof.make_proof_files(model, 2.0, 5e-4, Path())
    (text,) = (content.decode() for path, content in members.items() if path.endswith("model-exchange.exp"))
    assert f'stopTime="{end:g}"' in text
    assert f"They end at {end:g} s of 2 s" in members["documentation/fmi-ls-ref.txt"].decode()


def test_variables_are_those_of_the_components(joint):
    variables = {v.name: v for v in fmpy.read_model_description(str(joint["3"])).modelVariables}
    inputs = [name for name, v in variables.items() if v.causality == "input"]
    assert inputs == ["load.tau_in", "drive.temperature", "link.tau_a"]
    assert variables["drive.ratio"].causality == "parameter"
    assert variables["link.J"].start == "0.05"
    assert not [name for name in variables if "lag" in name]
    assert variables["link.w"].derivative is variables["link.phi"]
    assert variables["link.a"].derivative is variables["link.w"]


class Opened:
    """Instance of the system FMU in a mode after initialization."""

    def __init__(self, file, exchange=False):
        self.messages = []
        self._unpacked = unpack_fmu(Path(file))
        folder, description = self._unpacked.__enter__()
        self._opened = open_instance(
            folder, description, "system", self.messages, uses_model_exchange=exchange
        )
        self.host = self._opened.__enter__()

    def __enter__(self):
        self.host.enter_initialization()
        return self

    def __exit__(self, *error):
        self._opened.__exit__(None, None, None)
        self._unpacked.__exit__(None, None, None)


def test_derivatives_are_exact(joint):
    """Derivatives agree with central differences; 1e-6 is the square root of their round-off."""
    with Opened(joint["2"]) as one:
        fmu, known = one.host.fmu, one.host.variables
        names = ["motor.phi", "link.phi", "motor.w", "link.w", "load.tau_in", "link.tau_a"]
        one.host.set_values({"motor.phi": 0.03, "link.phi": 0.02, "motor.w": 1.0, "link.w": 0.2})
        for name in names:
            start = one.host.get_value(name)
            slope = fmu.getDirectionalDerivative(
                [known["motor.a"].valueReference, known["link.a"].valueReference],
                [known[name].valueReference],
                [1.0],
            )
            h = 1e-7
            ends = []
            for place in (start + h, start - h):
                one.host.set_values({name: place})
                ends.append(np.array([one.host.get_value("motor.a"), one.host.get_value("link.a")]))
            one.host.set_values({name: start})
            differences = (ends[0] - ends[1]) / (2.0 * h)
            assert slope == pytest.approx(differences, rel=1e-5, abs=1e-3)
            assert np.any(differences != 0.0) or name == "motor.w"


def test_a_saved_state_goes_on_alike(joint):
    """A run from a saved state, also from its bytes, is equal to the last bit, with slipping friction."""
    with Opened(joint["2"]) as one:
        fmu, host = one.host.fmu, one.host
        fmu.exitInitializationMode()
        for k in range(1010):
            host.do_step(k * 1e-3, 1e-3)
        state = fmu.getFMUstate()
        content = fmu.serializeFMUstate(state)

        def onward():
            for k in range(1010, 1030):
                host.do_step(k * 1e-3, 1e-3)
            return [host.get_value(name) for name in DRIVE]

        first = onward()
        fmu.setFMUstate(state)
        assert onward() == first
        fmu.setFMUstate(fmu.deSerializeFMUstate(content))
        assert onward() == first


def test_a_free_swing_without_losses_keeps_its_energy(joint):
    """Motor and link move against each other; the tolerance of the host limits the steps. Allowed drift: 1e-6
    per second."""
    off = {f"load.{name}_height": 0.0 for name in ("ramp", "pulse")} | {"link.m": 0.0}
    off |= {"drive.d": 0.0, "drive.hysteresis_loss": 0.0, "link.phi": 1e-3}
    outputs = ("motor.w", "link.w", "drive.phi_rel", "drive.tau")
    drive = jointfmu.load("HarmonicDriveSpring").with_values({"d": 0.0})
    turns = np.linspace(-2e-3, 2e-3, 4001)
    torque = np.asarray(drive.evaluate("HarmonicDriveSpring", phi2=turns)["tau"])
    stored = CubicSpline(turns, torque).antiderivative()
    drifts = []
    for tolerance in (None, 1e-9):
        found = run(
            joint["2"],
            outputs,
            1e-3,
            1.0,
            fmi_type="CoSimulation",
            start_values=off,
            relative_tolerance=tolerance,
        )
        energy = 0.5 * 1e-5 * found["motor.w"] ** 2 + 0.5 * 0.05 * found["link.w"] ** 2
        energy += stored(found["drive.phi_rel"]) - stored(0.0)
        assert np.ptp(found["drive.phi_rel"]) > 1.9e-3
        drifts.append(np.abs(energy / energy[0] - 1.0).max())
    assert drifts[1] < drifts[0] < 1e-3
    assert drifts[1] < 1e-6


def test_a_torque_on_the_link_is_held_by_the_drive(joint):
    """At rest the drive carries the difference to the weight: 0.5 N.m at the link. The motor is held by its
    friction only, so the link moves to where its weight alone holds it."""
    with Opened(joint["3"]) as one:
        host = one.host
        host.set_values({"link.tau_a": 0.5, "drive.d": 20.0})
        host.fmu.exitInitializationMode()
        host.do_step(0.0, 0.05)
        accelerations = [host.get_value(f"{name}.a") for name in ("motor", "link")]
        carried = host.get_value("drive.tau1"), host.get_value("drive.tau2")
        weight = 1.0 * 9.80665 * 0.2 * np.sin(host.get_value("link.phi"))
        assert accelerations[0] * 1e-5 == pytest.approx(carried[0], abs=1e-12)
        assert accelerations[1] * 0.05 == pytest.approx(carried[1] + 0.5 - weight, abs=1e-12)
        assert host.get_value("link.phi") > 0.0


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("drive.ratio", 0.0, "drive: ratio = 0"),
        ("link.J", -1.0, "link.J = -1"),
        ("motor.J", 0.0, "motor.J = 0"),
    ],
)
def test_refused_parameters_are_named(joint, name, value, said):
    with Opened(joint["2"]) as one:
        one.host.set_values({name: value})
        with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
            one.host.fmu.exitInitializationMode()
        assert any(said in line for line in one.messages)


def test_a_refused_step_leaves_the_state(joint):
    """A torque at which nothing is finite; afterwards the instance continues."""
    with Opened(joint["2"]) as one:
        host = one.host
        host.fmu.exitInitializationMode()
        host.do_step(0.0, 1e-3)
        before = [host.get_value(name) for name in DRIVE]
        host.set_values({"link.tau_a": 1e300})
        with pytest.raises(Exception, match="fmi2DoStep"):
            host.do_step(1e-3, 1e-3)
        assert "the motion cannot be followed at 0.001 s" in one.messages[-1]
        assert " is not finite; expected" in one.messages[-1]
        host.set_values({"link.tau_a": 0.0})
        assert [host.get_value(name) for name in DRIVE] == before
        host.do_step(1e-3, 1e-3)


def text(connections, drive=""):
    wires = ", ".join(f'["{a}", "{b}"]' for a, b in connections)
    return f"""
schema = 1
connect = [{wires}]
[drive]
model = "HarmonicDriveSpring"
{drive}
[motor]
model = "RotationalInertia"
J = {{ value = 1.0e-5, unit = "kg.m2", kind = "user", source = "test" }}
[load]
model = "TorqueProfile"
[experiment]
stop_time = {{ value = 1.0, unit = "s", kind = "user", source = "test" }}
interval = {{ value = 1.0e-3, unit = "s", kind = "user", source = "test" }}
"""


def test_a_joint_between_grounds_is_refused(tmp_path):
    file = tmp_path / "held.toml"
    wires = [("drive.flange1", "ground"), ("drive.flange2", "ground"), ("load", "motor.flange_a")]
    file.write_text(text(wires))
    with pytest.raises(ValueError, match='drive: all its flanges are on "ground"; allowed is'):
        assemble_system(read_system(file))
