"""Robot as one FMU: equations in C, energy, frequencies, ringing and steps; against MuJoCo with springs."""

from dataclasses import replace

import fmpy
import mujoco
import numpy as np
import pytest
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.validation import validate_fmu
from jointfmu_tools.exchange.robots import elastic, robot_system
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from jointfmu_tools.systems.fmu.build import build_system_fmus, make_c_sources
from robots import ROBOT, add_rotors

from jointfmu.parameters import load_parameter_file

pytestmark = pytest.mark.slow  # builds FMUs

NAMES = [f"joint{i}" for i in range(1, 7)]
STIFFNESS = np.array([27e3, 50e3, 20e3, 10e3, 8e3, 4e3])
"""Of the drives [N.m/rad]."""
RATIOS = np.array([-100.0, 120.0, -100.0, 80.0, -50.0, 50.0])
PAYLOAD = 3.0
"""At the origin of the flange [kg]."""
POSE = {"joint2": "0.7", "joint3": "0.8", "joint5": "0.5"}


def drive_file(folder, k):
    """Drive without losses whose stiffness is constant."""
    text = (ROBOT.parents[1] / "harmonic_drive/cd_14_100_table.toml").read_text()
    text = text[: text.index("[table]")].replace("d = { value = 0.5", "d = { value = 0.0")
    text = text.replace("ratio = { value = 100.0", f"ratio = {{ value = {RATIOS[k]}")
    entry = '{} = {{ value = [{}, {}], unit = "{}", kind = "estimate", source = "test" }}\n'
    text += "[table]\n" + entry.format("torque", 0.01 * STIFFNESS[k], 0.1 * STIFFNESS[k], "N.m")
    text += entry.format("angle", 0.01, 0.1, "rad")
    (folder / f"drive{k}.toml").write_text(text)
    return load_parameter_file(folder / f"drive{k}.toml", "harmonic_drive")


def make_arm(folder, driven, has_motor_angles=False):
    """Arm whose joints with the given indices have drives, and the axes of these joints."""
    spec = elastic.read_robot(ROBOT)
    files = {NAMES[k]: drive_file(folder, k) for k in driven}
    axes = elastic.make_axes(spec, {name: make_transmission(file) for name, file in files.items()})
    model = spec.compile()
    pose, tip = elastic.make_robot_pose(model, POSE), model.body("flange").id
    return robot_system.read_arm(model, axes, files, pose, PAYLOAD, tip, has_motor_angles), axes


def build(arm, folder):
    system = robot_system.make_robot_system(arm, "robot", "robot of a test", PAYLOAD)
    (file,) = build_system_fmus(replace(system, stop_time=0.02), folder, "3", (fmpy.platform_tuple,))
    assert validate_fmu(str(file)) == []
    return fmpy.extract(str(file), str(folder / "unzipped"))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    """Arm with drives in all joints and torques as inputs: FMU, arm, MuJoCo's model and its dofs."""
    folder = tmp_path_factory.mktemp("robot")
    arm, axes = make_arm(folder, range(6))
    spec = mujoco.MjSpec.from_file(str(ROBOT))
    flange = spec.body("flange")
    flange.mass, flange.inertia, flange.explicitinertial = PAYLOAD, [1e-12] * 3, True
    flange.ipos, flange.iquat = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
    inertias = [axis.rotor_inertia / axis.drive.ratio**2 for axis in axes]
    model, dofs = add_rotors(spec, inertias, RATIOS, STIFFNESS)
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, 1e-4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return build(arm, folder), arm, model, dofs


class Robot:
    """Instance of an unzipped FMU, with variables by name."""

    def __init__(self, folder, parameters=(), is_exchange=False, tolerance=None):
        description = fmpy.read_model_description(folder)
        self.refs = {v.name: v.valueReference for v in description.modelVariables}
        self.instance = (FMU3Model if is_exchange else FMU3Slave)(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="robot",
        )
        self.instance.instantiate()
        self.write(dict(parameters))
        self.instance.enterInitializationMode(tolerance=tolerance)
        self.instance.exitInitializationMode()
        self.time = 0.0

    def write(self, values):
        self.instance.setFloat64([self.refs[name] for name in values], list(map(float, values.values())))

    def read(self, names):
        return np.array(self.instance.getFloat64([self.refs[name] for name in names]))

    def step(self, size):
        self.instance.doStep(self.time, size)
        self.time += size


STATES = [f"{name}.rotation" for name in NAMES] + [f"{name}.motor.phi" for name in NAMES]
SPEEDS = [f"{name}.w" for name in NAMES] + [f"{name}.motor.w" for name in NAMES]
RATES = [f"{name}.a" for name in NAMES] + [f"{name}.motor.a" for name in NAMES]


def place(model, dofs, arm, travel, speeds):
    data = mujoco.MjData(model)
    data.qpos[dofs] = travel
    data.qpos[dofs[:6]] += [joint.start_position for joint in arm.joints]
    data.qpos[dofs[6:]] += RATIOS * [joint.start_position for joint in arm.joints]  # unwound there
    data.qvel[dofs] = speeds
    return data


def test_accelerations_and_tip_are_mujocos(robot):
    """At random states, with the torques of the springs."""
    file, arm, model, dofs = robot
    m, rng = Robot(file, is_exchange=True), np.random.default_rng(4)
    for _ in range(20):
        x, v = (
            np.concatenate([s, RATIOS * (s + t)])
            for s, t in (rng.normal(0.0, [[1.0], [1e-3]], (2, 6)) for _ in "xv")
        )
        tau = rng.normal(0.0, 1.0, 6)
        m.write(dict(zip([*STATES, *SPEEDS], [*x, *v], strict=True)))
        m.write({f"{name}.tau_motor": t for name, t in zip(NAMES, tau, strict=True)})
        data = place(model, dofs, arm, x, v)
        data.qfrc_applied[dofs[6:]] = tau
        mujoco.mj_forward(model, data)
        assert m.read(RATES) == pytest.approx(data.qacc[dofs], rel=1e-6, abs=1e-6 * np.abs(data.qacc).max())
        assert m.read(["tip.x", "tip.y", "tip.z"]) == pytest.approx(data.body("flange").xpos, abs=1e-12)
        assert m.read([f"{name}.phi" for name in NAMES]) == pytest.approx(data.qpos[dofs[:6]])


def test_frequencies_over_ten_poses_are_mujocos(robot):
    """Frequencies by the exact derivatives agree within 0.5 % with MuJoCo, by differences."""
    file, arm, model, dofs = robot
    rng = np.random.default_rng(6)
    for k in range(10):
        pose = rng.uniform(-1.5, 1.5, 6)
        m = Robot(
            file,
            {f"{name}.phi_start": q for name, q in zip(NAMES, pose, strict=True)},
            is_exchange=True,
        )
        found = np.empty((12, 12))
        for j, state in enumerate(STATES):
            found[:, j] = m.instance.getDirectionalDerivative(
                [m.refs[n] for n in RATES], [m.refs[state]], [1.0]
            )
        m.instance.freeInstance()
        tau, expected = [joint.motor_load for joint in arm.joints], np.empty((12, 12))
        for j in range(12):
            sides = []
            for step in (1e-5, -1e-5):
                data = mujoco.MjData(model)
                data.qpos[dofs] = [*pose, *(RATIOS * pose)]
                data.qpos[dofs[j]] += step
                data.qfrc_applied[dofs[6:]] = tau
                mujoco.mj_forward(model, data)
                sides.append(data.qacc[dofs].copy())
            expected[:, j] = (sides[0] - sides[1]) / 2e-5
        frequencies = [np.sort(np.linalg.eigvals(-a).real)[6:] for a in (found, expected)]
        assert np.sqrt(frequencies[0]) == pytest.approx(np.sqrt(frequencies[1]), rel=1e-4), k
        assert np.sqrt(frequencies[0])[0] > 2.0 * np.pi * 10.0


def energy(model, dofs, arm, travel, speeds):
    data = place(model, dofs, arm, travel, speeds)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    mujoco.mj_forward(model, data)
    return data.energy.copy()


def test_energy_of_a_free_swing_is_kept(robot):
    """Free motors, no losses: the energy is constant for one second, relative to the kinetic one."""
    file, arm, model, dofs = robot
    m = Robot(file, tolerance=1e-9)
    m.write({f"{name}.tau_motor": 0.0 for name in NAMES})
    energies = []
    for _ in range(1001):
        energies.append(energy(model, dofs, arm, m.read(STATES), m.read(SPEEDS)))
        m.step(1e-3)
    potential, kinetic = np.transpose(energies)
    assert kinetic.max() > 50.0
    assert np.abs(np.ptp(potential + kinetic)) < 1e-6 * kinetic.max()


def test_ringing_after_a_stop_is_mujocos(robot):
    """Motors speed up and brake by constant torques; then all joints ring. The limit is 5 %."""
    file, arm, model, dofs = robot
    m, data = Robot(file), place(model, dofs, arm, np.zeros(12), np.zeros(12))
    hold = np.array([joint.motor_load for joint in arm.joints])
    push = 0.3 * RATIOS * [joint.rotor_inertia for joint in arm.joints] * 30.0
    found, expected = [], []
    for k in range(300):
        tau = hold + push * (1.0 if k < 100 else -1.0 if k < 200 else 0.0)
        m.write({f"{name}.tau_motor": t for name, t in zip(NAMES, tau, strict=True)})
        m.step(1e-3)
        data.qfrc_applied[dofs[6:]] = tau
        mujoco.mj_step(model, data, 10)
        found.append(m.read([f"{name}.drive.phi_rel" for name in NAMES]))
        expected.append(data.qpos[dofs[:6]] - data.qpos[dofs[6:]] / RATIOS)
    found, expected = np.array(found)[200:], np.array(expected)[200:]
    assert (np.ptp(expected, axis=0) > 1e-5).all()
    assert (np.abs(found - expected).max(axis=0) < 0.02 * np.ptp(expected, axis=0)).all()


def test_the_communication_step_does_not_matter(robot):
    """With constant inputs, over 0.2 s."""
    file, *_ = robot
    ends = []
    for step in (1e-3, 5e-3, 2e-2):
        m = Robot(file, tolerance=1e-8)
        for _ in range(round(0.2 / step)):
            m.step(step)
        ends.append(m.read(STATES))
    scale = np.abs(ends[0]).max()
    for end in ends[1:]:
        assert np.abs(end - ends[0]).max() < 1e-5 * scale


def test_prescribed_motors_and_a_joint_without_a_drive(tmp_path):
    """The FMU's outputs are those of the equations in Python, whose dynamics MuJoCo confirms elsewhere."""
    arm, _ = make_arm(tmp_path, (1, 2), has_motor_angles=True)
    m, rng = Robot(build(arm, tmp_path), is_exchange=True), np.random.default_rng(8)
    component = arm.make_arm_component(PAYLOAD)
    states, inputs = component.fmu_model.outputs[:4], component.system_inputs
    assert [v.name for v in states] == ["joint2.rotation", "joint3.rotation", "joint2.w", "joint3.w"]
    for _ in range(5):
        values = {v.name: rng.normal(0.0, 1.0) for v in (*states, *inputs)}
        m.write(values)
        values |= {f"{name}.tau2": m.read([f"{name}.drive.tau2"])[0] for name in ("joint2", "joint3")}
        expected = arm.evaluate_outputs(component.parameter_file.values, values)
        outputs = [v.name for v in component.fmu_model.outputs]
        assert m.read(outputs) == pytest.approx([expected[name] for name in outputs], rel=1e-9, abs=1e-9)


def test_long_functions_keep_their_values_off_the_stack(tmp_path):
    """Else they need more than a page of it, which Windows refuses without a library of the compiler."""
    arm, _ = make_arm(tmp_path, (0,))
    files, _ = make_c_sources(robot_system.make_robot_system(arm, "robot", "robot of a test", PAYLOAD))
    (text,) = (
        text for name, text in files.items() if name.endswith(".c") and "void outputs_jacobian(" in text
    )
    functions = [part for part in text.split("\nvoid ") if part.startswith("outputs")]
    assert [part.partition("(")[0] for part in functions] == [
        "outputs",
        "outputs_jacobian",
        "outputs_jacobian_product",
    ]
    assert all("    const double" not in part and "w[0] = " in part for part in functions)
    assert text.count("w[") > 5000
