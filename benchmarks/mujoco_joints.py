"""Joints in MuJoCo: the plugin over the FMU called from Python, and elastic arms over the rigid arm.

    python benchmarks/mujoco_joints.py --run plugin|throughput|robot [--quick] [--hysteresis ARCMIN]

plugin     : a row of links on locked motors, each driven by a sine; the steps run in C (`mj_step` with
             `nstep`). MuJoCo's Euler scheme evaluates each joint twice a step: for the torque, and to accept
             the history at the end. The time of the same model without drives is subtracted. The obvious way
             is a Python callback that sets the inputs of each FMU by fmpy and reads its torques.
throughput : 4096 environments of a six-axis arm that fall from random poses, in MuJoCo's own rollout on two
             cores: the rigid arm; the rigid arm with the friction of the motors, each a constraint; elastic
             joints in plain MJCF, with and without this friction; elastic joints by the plugin, with
             friction. Damping is explicit (`eulerdamp` is off) except where stated. The models are timed in
             turn for several rounds; the shortest processor time counts.
robot      : the equations of a six-axis arm as one FMU, all effects of its drives on, motors driven by sines;
             time of its initialization and of its steps, compared with MuJoCo's steps of the plain elastic
             model
"""

import sys
import tempfile
from copy import copy
from pathlib import Path
from time import perf_counter, process_time

import fmpy
import mujoco
import numpy as np
from harness import ROOT, judge_target, read_options, require_machine, time_fastest_call
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools.api import drive
from jointfmu_tools.exchange.mujoco import plugin
from jointfmu_tools.exchange.robots import elastic, plugin_robot, robot_system
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from jointfmu_tools.run.host import FmuInstance
from jointfmu_tools.systems.fit.compiled_system import CompiledSystem
from mujoco import rollout

# plugin

PLUGIN = "HarmonicDriveSpring"
JOINTS, STEPS, REPEATS, PYTHON_STEPS = 6, 2000, 21, 200
QUICK = 2, 2
"""Values of REPEATS and PYTHON_STEPS with --quick."""
CASES = {
    "elastic": {},
    "hysteresis": {"hysteresis_loss": 3e-4},
    "hysteresis and friction": {
        "hysteresis_loss": 3e-4,
        "friction_coulomb": 0.01,
        "friction_stribeck": 0.005,
    },
}
"""{losses of the drive: its parameters}."""
TARGET = 2e-6
"""Target time per joint and step [s]."""


def make_link_row_model(parameters: dict[str, float] | None) -> mujoco.MjModel:
    """MuJoCo model of a row of links on locked motors, with drives between them if `parameters` is given."""
    bodies = "".join(
        f'<body><joint name="motor{i}" type="hinge" armature="1e-4"/><inertial pos="0 0 0" mass="1" '
        f'diaginertia="1e-4 1e-4 1e-4"/></body><body><joint name="link{i}" type="hinge"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.05 0.05 0.05"/></body>'
        for i in range(JOINTS)
    )
    instances = "".join(
        f'<instance name="drive{i}"><config key="phi1" value="motor{i}"/><config key="phi2" value="link{i}"/>'
        + "".join(f'<config key="{k}" value="{v}"/>' for k, v in (parameters or {}).items())
        + "</instance>"
        for i in range(JOINTS)
    )
    drives = f'<extension><plugin plugin="jointfmu.{PLUGIN}">{instances}</plugin></extension>'
    return mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.0005" gravity="0 0 0"/>'
        f"{drives if parameters is not None else ''}<worldbody>{bodies}</worldbody></mujoco>"
    )


def start_motion(made: mujoco.MjModel) -> mujoco.MjData:
    """MuJoCo data with all links in motion."""
    data = mujoco.MjData(made)
    data.qvel[1::2] = np.linspace(0.1, 0.2, JOINTS)
    return data


def measure_step_times(parameters: dict[str, float], repeats: int) -> tuple[float, float]:
    """Times [s] of a step without drives, and of the drives alone; medians of alternating runs."""
    made = make_link_row_model(None), make_link_row_model(parameters)
    data = [start_motion(each) for each in made]
    times = np.empty((repeats, 2))
    for row in times:
        for i in range(2):
            begin = perf_counter()
            mujoco.mj_step(made[i], data[i], STEPS)
            row[i] = (perf_counter() - begin) / STEPS
    assert np.isfinite(data[1].qpos).all()
    return float(np.median(times[:, 0])), float(np.median(times[:, 1] - times[:, 0]))


def measure_python_time(fmu: Path, parameters: dict[str, float], folder: Path, steps: int) -> float:
    """Time [s] per joint and step with the FMU called from a Python callback."""
    description = fmpy.read_model_description(str(fmu))
    refs = {v.name: v.valueReference for v in description.modelVariables}
    inputs, torques = [refs[n] for n in ("phi1", "w1", "phi2", "w2")], [refs["tau1"], refs["tau2"]]
    unpacked = fmpy.extract(str(fmu), str(folder))
    slaves = []
    for i in range(JOINTS):
        instance = FmuInstance(unpacked, description, f"drive{i}", uses_model_exchange=True)
        instance.instantiate()
        instance.set_values(parameters)
        instance.enter_initialization()
        slave = instance.fmu
        slave.exitInitializationMode()
        slave.enterContinuousTimeMode()
        slaves.append(slave)

    def set_inputs(data: mujoco.MjData) -> None:
        moves = np.stack([data.qpos.reshape(-1, 2), data.qvel.reshape(-1, 2)], axis=2).reshape(-1, 4)
        for slave, row in zip(slaves, moves.tolist(), strict=True):
            slave.setFloat64(inputs, row)

    def passive(made: mujoco.MjModel, data: mujoco.MjData) -> None:
        set_inputs(data)
        data.qfrc_passive[:] += [tau for slave in slaves for tau in slave.getFloat64(torques)]

    made = make_link_row_model(None)
    data = start_motion(made)
    mujoco.set_mjcb_passive(passive)
    try:
        begin = perf_counter()
        for _ in range(steps):
            mujoco.mj_step(made, data)
            set_inputs(data)
            for slave in slaves:
                slave.completedIntegratorStep()
        return (perf_counter() - begin) / steps / JOINTS
    finally:
        mujoco.set_mjcb_passive(None)
        for slave in slaves:
            slave.terminate()
            slave.freeInstance()


def print_plugin(quick: bool) -> None:
    """Print the time of the plugin per joint and step, and of the FMU called from Python."""
    repeats, python_steps = QUICK if quick else (REPEATS, PYTHON_STEPS)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        build_fmus([PLUGIN], ["fmi3"], None, folder)
        fmu = folder / "fmi3" / f"{PLUGIN}.fmu"
        mujoco.mj_loadPluginLibrary(str(plugin(fmu, folder)))
        print(f"{'per joint and step':26} {'plugin':>10} {'Python':>10}")
        for label, parameters in CASES.items():
            bare, added = measure_step_times(parameters, repeats)
            taken = added / JOINTS
            other = measure_python_time(fmu, parameters, folder / label, python_steps)
            times = f"{taken * 1e6:7.3f} us {other * 1e6:7.1f} us"
            print(f"{label:26} {times}  of {TARGET * 1e6:g} us {judge_target(taken, TARGET)}")
        print(f"MuJoCo's own step of {2 * JOINTS} joints: {bare * 1e6:.2f} us")


# throughput

ROBOT = ROOT / "models/robots/six_axis.xml"
SIZES = ("CSG-32-100", "CSG-40-100", "CSG-25-100", "CSG-20-100", "CSG-17-100", "CSG-14-100")
ENVIRONMENTS, THREADS, ROLLOUT_STEPS, ROUNDS = 4096, 2, 10, 5
QUICK_ENVIRONMENTS = 16
STEP = 5e-4
"""Time step [s]: at most a fifth of the period of the stiffest axis, 409 Hz."""
TARGETS = {"plain": 1.5, "plain, no friction": 1.5, "plugin": 2.5}


def make_arm_models(folder: Path, hysteresis: float | None) -> dict[str, mujoco.MjModel]:
    """Make MuJoCo models of a robot arm: rigid, with elastic drives in plain MJCF, and with the plugin."""
    spec = elastic.read_robot(ROBOT)
    spec.option.timestep = STEP
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    for actuator in [*spec.actuators]:
        spec.delete(actuator)
    stated = {} if hysteresis is None else {"hysteresis": hysteresis}
    files = {f"joint{i}": drive(size, **stated).file for i, size in enumerate(SIZES, 1)}
    axes = elastic.make_axes(spec, {joint: make_transmission(file) for joint, file in files.items()})
    for library in plugin_robot.compile_plugins(files, folder).values():
        mujoco.mj_loadPluginLibrary(str(library))
    rough, smooth = spec.copy(), elastic.add_drives(spec, axes)
    for axis in axes:
        rough.joint(axis.joint_name).frictionloss = axis.drive.dry_friction * abs(axis.drive.ratio)
    for actuator in [*smooth.actuators]:
        smooth.delete(actuator)
    plain = elastic.add_drives(spec, axes).compile()
    implicit = copy(plain)
    implicit.opt.disableflags = 0
    return {
        "rigid": spec.compile(),
        "rigid, friction": rough.compile(),
        "plain": plain,
        "plain, implicit": implicit,
        "plain, no friction": smooth.compile(),
        "plugin": mujoco.MjModel.from_xml_string(plugin_robot.format_robot_with_plugins(spec, axes, files)),
    }


def make_initial_states(model: mujoco.MjModel, count: int) -> np.ndarray:
    """Initial states (count, n): random poses at rest, the motors at the angles of their links."""
    data, kind = mujoco.MjData(model), mujoco.mjtState.mjSTATE_FULLPHYSICS
    poses = np.random.default_rng(1).uniform(-1.0, 1.0, (count, len(SIZES)))
    found = np.empty((count, mujoco.mj_stateSize(model, kind)))
    motors = model.njnt > len(SIZES)
    for row, pose in zip(found, poses, strict=True):
        mujoco.mj_resetData(model, data)
        for i, angle in enumerate(pose, 1):
            data.joint(f"joint{i}").qpos[0] = angle
            if motors:
                data.joint(f"joint{i}_motor").qpos[0] = -100.0 * angle
        mujoco.mj_getState(model, data, row, kind)
    return found


def print_throughput(hysteresis: float | None, quick: bool) -> None:
    """Print the processor time per environment and step, over the time of the rigid arm."""
    count, rounds = (QUICK_ENVIRONMENTS, 1) if quick else (ENVIRONMENTS, ROUNDS)
    with tempfile.TemporaryDirectory() as folder:
        made = make_arm_models(Path(folder), hysteresis)
    starts = {name: make_initial_states(model, count) for name, model in made.items()}
    pool = {name: [mujoco.MjData(model) for _ in range(THREADS)] for name, model in made.items()}
    room = {name: np.zeros((count, ROLLOUT_STEPS, own.shape[1])) for name, own in starts.items()}
    times = {name: [] for name in made}
    with rollout.Rollout(nthread=THREADS) as run:
        for _ in range(rounds):
            for name, model in made.items():
                before = process_time()
                run.rollout(model, pool[name], starts[name], nstep=ROLLOUT_STEPS, state=room[name])
                times[name].append(process_time() - before)
                assert not any(data.warning.number.any() for data in pool[name])
    least = {name: min(own) for name, own in times.items()}
    for name, own in least.items():
        ratios = own / least["rigid"], own / least["rigid, friction"]
        most = TARGETS.get(name)
        target = f", of {most:g} {judge_target(ratios[0], most)}" if most else ""
        print(
            f"{name:18} {1e6 * own / count / ROLLOUT_STEPS:6.2f} us per environment and step, "
            f"{ratios[0]:5.2f} x rigid, {ratios[1]:5.2f} x rigid with friction{target}"
        )


# robot

DURATION, COMMUNICATION_STEP, PAYLOAD = 2.0, 1e-3, 3.0
"""Simulated time [s], communication step of the FMU [s], mass at the tip [kg]."""
ROBOT_EFFECTS = {"hysteresis_loss": 2.9e-4, "lost_motion": 2.9e-4, "friction_stribeck": 0.01, "error_2": 1e-4}
"""Parameters of all drives that the catalogue does not have; it has friction and load loss."""
MIN_REAL_TIME_RATIO, MAX_START_TIME = 20.0, 5e-3
"""Targets: simulated time over processor time, and time to initialize [s]."""


def print_robot(quick: bool) -> None:
    """Print the processor time of the equations of a robot's FMU, over the time of the plain MuJoCo model."""
    spec = elastic.read_robot(ROBOT)
    spec.option.timestep = STEP
    files = {f"joint{i}": drive(size).file for i, size in enumerate(SIZES, 1)}
    axes = elastic.make_axes(spec, {joint: make_transmission(file) for joint, file in files.items()})
    rigid, plain = spec.compile(), elastic.add_drives(spec, axes).compile()
    pose, tip = elastic.make_robot_pose(rigid, {"joint2": "0.7", "joint3": "0.8"}), rigid.body("flange").id
    arm = robot_system.read_arm(rigid, axes, files, pose, PAYLOAD, tip)
    model = robot_system.make_robot_system(arm, "robot", "robot", PAYLOAD)
    system = CompiledSystem(model)
    time = COMMUNICATION_STEP * np.arange(round(DURATION / COMMUNICATION_STEP) + 1)
    torques = {
        f"{joint.joint_name}.tau_motor": joint.motor_load
        + 0.3 * axis.drive.rated_torque / axis.drive.ratio * np.sin(2.0 * np.pi * time)
        for joint, axis in zip(arm.joints, axes, strict=True)
    }
    values = {f"{axis.joint_name}.drive.{key}": x for axis in axes for key, x in ROBOT_EFFECTS.items()}
    outputs, repeats = ["tip.x", "tip.y", "tip.z"], 1 if quick else 10
    data = mujoco.MjData(plain)

    def run(points: int) -> np.ndarray:
        inputs = {name: torque[:points] for name, torque in torques.items()}
        return system.simulate(values, time[:points], inputs, outputs, model.step_tolerance)

    def run_mujoco() -> None:
        mujoco.mj_resetData(plain, data)
        mujoco.mj_step(plain, data, round(DURATION / STEP))

    _, start = time_fastest_call(lambda: run(1), repeats, process_time)
    _, taken = time_fastest_call(lambda: run(time.size), repeats, process_time)
    _, other = time_fastest_call(run_mujoco, repeats, process_time)
    ratio = DURATION / taken
    print(
        f"robot, start: {1e3 * start:.2f} ms, of {1e3 * MAX_START_TIME:g} "
        f"{judge_target(start, MAX_START_TIME)}"
    )
    print(
        f"robot, communication step {1e3 * COMMUNICATION_STEP:g} ms: {ratio:.1f} x real time, "
        f"of {MIN_REAL_TIME_RATIO:g} {judge_target(-ratio, -MIN_REAL_TIME_RATIO)}"
    )
    print(f"plain MuJoCo model, step {1e3 * STEP:g} ms: {DURATION / other:.1f} x real time")


def main() -> None:
    """Run one of the benchmarks: MuJoCo accepts only one plugin of a name in a process."""
    options = read_options(
        __doc__,
        hysteresis={
            "type": float,
            "metavar": "ARCMIN",
            "help": "throughput: hysteresis of each drive [arcmin] (default: none)",
        },
        run={"choices": ("plugin", "throughput", "robot"), "required": True, "help": "benchmark to run"},
    )
    require_machine(sys.platform != "win32", "Linux or macOS")
    if options.run == "plugin":
        print_plugin(options.quick)
    elif options.run == "robot":
        print_robot(options.quick)
    else:
        print_throughput(options.hysteresis, options.quick)


if __name__ == "__main__":
    main()
