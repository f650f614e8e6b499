"""Time of the drive's plugin in MuJoCo per joint and step, and of the same torques through Python's ctypes.

A row of links on locked motors, each driven by a sine; the steps run in C (`mj_step` with `nstep`). A step
evaluates each joint twice with MuJoCo's Euler scheme: for the torque, and to accept the path at its end. What
the same model takes without drives is subtracted. Medians. The other way is a callback in Python that gives
each joint's inputs to the FMU by fmpy and reads its torques.
"""

import sys
import tempfile
from pathlib import Path
from time import perf_counter

import fmpy
import mujoco
import numpy as np
from jointfmu_fmu_src.building import build
from jointfmu_tools.exchange.mujoco import plugin
from jointfmu_tools.run.host import Instance

NAME = "HarmonicDriveSpring"
JOINTS, STEPS, REPEATS, PYTHON_STEPS = 6, 2000, 21, 200
CASES = {
    "elastic": {},
    "hysteresis": {"hysteresis_loss": 3e-4},
    "hysteresis and friction": {
        "hysteresis_loss": 3e-4,
        "friction_coulomb": 0.01,
        "friction_stribeck": 0.005,
    },
}
"""{what the drive has: its parameters}."""
MOST = 2e-6
"""What is promised for a joint and step [s]."""


def model(parameters: dict[str, float] | None) -> mujoco.MjModel:
    """Links and motors, with drives between them unless there are no parameters."""
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
    drives = f'<extension><plugin plugin="jointfmu.{NAME}">{instances}</plugin></extension>'
    return mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.0005" gravity="0 0 0"/>'
        f"{drives if parameters is not None else ''}<worldbody>{bodies}</worldbody></mujoco>"
    )


def start(made: mujoco.MjModel) -> mujoco.MjData:
    """All links in motion."""
    data = mujoco.MjData(made)
    data.qvel[1::2] = np.linspace(0.1, 0.2, JOINTS)
    return data


def step_times(parameters: dict[str, float]) -> tuple[float, float]:
    """Seconds of a step of the model without drives, and what the drives add; both measured in turn."""
    made = model(None), model(parameters)
    data = [start(one) for one in made]
    times = np.empty((REPEATS, 2))
    for row in times:
        for i in range(2):
            begin = perf_counter()
            mujoco.mj_step(made[i], data[i], STEPS)
            row[i] = (perf_counter() - begin) / STEPS
    assert np.isfinite(data[1].qpos).all()
    return float(np.median(times[:, 0])), float(np.median(times[:, 1] - times[:, 0]))


def python_time(fmu: Path, parameters: dict[str, float], folder: Path) -> float:
    """Seconds of a joint and step, the FMU being called from a callback in Python."""
    description = fmpy.read_model_description(str(fmu))
    refs = {v.name: v.valueReference for v in description.modelVariables}
    inputs, torques = [refs[n] for n in ("phi1", "w1", "phi2", "w2")], [refs["tau1"], refs["tau2"]]
    unpacked = fmpy.extract(str(fmu), str(folder))
    slaves = []
    for i in range(JOINTS):
        instance = Instance(unpacked, description, f"drive{i}", model_exchange=True)
        instance.instantiate()
        instance.set_values(parameters)
        instance.enter_initialization()
        slave = instance.fmu
        slave.exitInitializationMode()
        slave.enterContinuousTimeMode()
        slaves.append(slave)

    def give(data: mujoco.MjData) -> None:
        moves = np.stack([data.qpos.reshape(-1, 2), data.qvel.reshape(-1, 2)], axis=2).reshape(-1, 4)
        for slave, row in zip(slaves, moves.tolist(), strict=True):
            slave.setFloat64(inputs, row)

    def passive(made: mujoco.MjModel, data: mujoco.MjData) -> None:
        give(data)
        data.qfrc_passive[:] += [tau for slave in slaves for tau in slave.getFloat64(torques)]

    made = model(None)
    data = start(made)
    mujoco.set_mjcb_passive(passive)
    try:
        begin = perf_counter()
        for _ in range(PYTHON_STEPS):
            mujoco.mj_step(made, data)
            give(data)
            for slave in slaves:
                slave.completedIntegratorStep()
        return (perf_counter() - begin) / PYTHON_STEPS / JOINTS
    finally:
        mujoco.set_mjcb_passive(None)
        for slave in slaves:
            slave.terminate()
            slave.freeInstance()


def main() -> None:
    """Build, measure, print."""
    if sys.platform == "win32":
        raise SystemExit("this is Windows, expected Linux or macOS")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        build([NAME], ["fmi3"], None, folder)
        fmu = folder / "fmi3" / f"{NAME}.fmu"
        mujoco.mj_loadPluginLibrary(str(plugin(fmu, folder)))
        print(f"{'per joint and step':26} {'plugin':>10} {'Python':>10}")
        for label, parameters in CASES.items():
            bare, added = step_times(parameters)
            taken = added / JOINTS
            other = python_time(fmu, parameters, folder / label)
            verdict = "met" if taken <= MOST else "MISSED"
            print(f"{label:26} {taken * 1e6:7.3f} us {other * 1e6:7.1f} us  of {MOST * 1e6:g} us {verdict}")
        print(f"MuJoCo's own step of {2 * JOINTS} joints: {bare * 1e6:.2f} us")


if __name__ == "__main__":
    main()
