# %% [markdown]
"""
# A joint controller for an elastic arm

A joint controller tuned on the rigid arm, on constant springs and on the FMU; each then runs on the FMU.
The build of the FMU takes a few minutes. Needs the extra `mujoco`.
"""

# %%
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import fmpy
import matplotlib.pyplot as plt
import mujoco
import numpy as np
from fmpy.fmi3 import FMU3Slave
from scipy.linalg import expm

import jointfmu

DRIVES = {"joint2": "CSG-40-100", "joint3": "CSG-25-100"}  # the other joints are rigid
START, TRAVEL = {"joint2": 0.7, "joint3": 0.8}, 0.15  # rad; all joints move by the same travel
STEP, MOVE, STOP = 1e-3, 0.3, 0.8  # s: period of the controller, time of the motion, end
DAMPING, PAYLOAD = 0.7, 3.0  # 1, kg
MAX_RINGING = 1e-4  # m, of the tip in the last 0.2 s
MAX_DEVIATION = 0.05  # rad, of an angle from its target: beyond it the controller is unstable
ROBOT, FMU = str(files("jointfmu_models") / "robots/six_axis.xml"), Path("robot/fmi3/six_axis.fmu")

if not FMU.exists():
    words = ["--drive", *(f"{j}={d}" for j, d in DRIVES.items()), "--payload", str(PAYLOAD), "--fmu"]
    words += ["--pose", *(f"{j}={q}" for j, q in START.items()), "--out", "robot"]
    subprocess.run([sys.executable, "-m", "jointfmu", "robot", ROBOT, *words], check=True)

# The arm at its start pose: mass matrix [kg.m2] of links and payload, Jacobian of the tip, rotors, stiffness
spec = mujoco.MjSpec.from_file(ROBOT)
tip = spec.body("flange")
tip.mass, tip.inertia, tip.explicitinertial = PAYLOAD, [1e-9] * 3, True
tip.ipos, tip.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
data = mujoco.MjData(model := spec.compile())
names = [model.joint(k).name for k in range(model.njnt)]
n, driven = len(names), np.array([name in DRIVES for name in names])
data.qpos[:] = [START.get(name, 0.0) for name in names]
mujoco.mj_forward(model, data)
mass, jacobian = np.zeros((n, n)), np.zeros((3, n))
mujoco.mj_fullM(model, data, mass)
mujoco.mj_jacBody(model, data, jacobian, None, model.body("flange").id)
rotors, inertia = model.dof_armature, mass.diagonal()  # inertia of link and rotor
drives = {name: jointfmu.drive(size).values for name, size in DRIVES.items()}
rigid = {"K3": 0.0, "d": 0.0, "ratio": 1.0}
K, d, ratio = np.transpose([[drives.get(name, rigid)[key] for key in rigid] for name in names])
load = data.qfrc_bias / ratio  # motor torques that hold the weight at the start


def target(time):
    """Angle from the start [rad] and speed [rad/s] of all joints: a quintic from rest to rest."""
    x = min(max(time / MOVE, 0.0), 1.0)
    return TRAVEL * x**3 * (10 - 15 * x + 6 * x * x), TRAVEL * 30 * x * x * (1 - x) ** 2 / MOVE


def torque(bandwidth, time, q, motor_speed):
    """Torque at the joints [N.m]: angle of the link, speed of the motor; the same bandwidth [Hz] for all."""
    w, (angle, speed) = 2.0 * np.pi * bandwidth, target(time)
    return inertia * (w**2 * (angle - q) + 2.0 * DAMPING * w * (speed - motor_speed))


def simulate_linear(bandwidth, has_springs):
    """Tip (times, 3) [m] from its start; with springs K3 or rigid joints. The weight is compensated."""
    elastic = np.flatnonzero(driven) if has_springs else np.array([], dtype=int)
    motors, rows = np.arange(n), np.arange(elastic.size)
    motors[elastic] = n + rows  # after the links, the rotors of the driven joints at the joint
    M = np.diag(np.concatenate([np.zeros(n), rotors[elastic]]))
    M[:n, :n] = mass
    M[elastic, elastic] -= rotors[elastic]
    B = np.zeros((elastic.size, len(M)))  # wind-up of the drives
    B[rows, elastic], B[rows, motors[elastic]] = 1.0, -1.0
    S, D = B.T @ np.diag(K[elastic]) @ B, B.T @ np.diag(d[elastic]) @ B
    m = len(M)
    A = np.zeros((2 * m + n, 2 * m + n))
    A[:m, m : 2 * m] = np.eye(m)
    A[m : 2 * m, :m], A[m : 2 * m, m : 2 * m] = -np.linalg.solve(M, S), -np.linalg.solve(M, D)
    A[m : 2 * m, 2 * m :] = np.linalg.solve(M, np.eye(m)[:, motors])
    step, x, rows = expm(A * STEP), np.zeros(2 * m + n), []
    for k in range(round(STOP / STEP)):
        x[2 * m :] = torque(bandwidth, k * STEP, x[:n], x[m : 2 * m][motors])
        x = step @ x
        rows.append(jacobian @ x[:n])
    return np.array(rows)


description = fmpy.read_model_description(FMU)
refs = {v.name: v.valueReference for v in description.modelVariables}
motors = [refs[f"{name}.motor.w" if name in DRIVES else f"{name}.w"] for name in names]
read = [refs[f"{name}.phi"] for name in names] + motors + [refs[f"tip.{x}"] for x in "xyz"]
keys = {"guid": description.guid, "modelIdentifier": description.coSimulation.modelIdentifier}
fmu = FMU3Slave(**keys, unzipDirectory=fmpy.extract(FMU), instanceName="arm")
fmu.instantiate(logMessage=lambda *_: None)


def simulate_fmu(bandwidth):
    """Tip (times, 3) [m] from its start, after a second at rest; infinite if the controller is unstable."""
    fmu.reset()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    start, rows = data.qpos, []
    for k in range(round((1.0 + STOP) / STEP)):
        time, (q, speed, place) = k * STEP - 1.0, np.split(np.array(fmu.getFloat64(read)), [n, 2 * n])
        rows.append(place)
        if np.abs(q - start - target(time)[0]).max() > MAX_DEVIATION:
            return np.full((1, 3), np.inf)
        tau = torque(bandwidth, time, q - start, speed / ratio)
        fmu.setFloat64([refs[f"{name}.tau_motor"] for name in names], (load + tau / ratio).tolist())
        fmu.doStep(k * STEP, STEP)
    return np.array(rows)[round(1.0 / STEP) :] - rows[0]


def ringing(tip):
    """Largest movement of the tip [m] in the last 0.2 s."""
    last = tip[-round(0.2 / STEP) :]
    return np.linalg.norm(np.ptp(last, axis=0)) if np.abs(last).max() < 1.0 else np.inf


models = {
    "rigid arm": lambda b: simulate_linear(b, has_springs=False),
    "constant springs": lambda b: simulate_linear(b, has_springs=True),
    "FMU": simulate_fmu,
}
bandwidths = 60.0 / 1.1 ** np.arange(22)  # Hz
ringings = {name: np.array([ringing(simulate(b)) for b in bandwidths]) for name, simulate in models.items()}
figure, axes = plt.subplots(layout="constrained")
print("tuned on          bandwidth [Hz]  ringing there [mm]  on the FMU [mm]")
for name, moved in ringings.items():
    tuned = np.argmax(moved < MAX_RINGING)  # the largest bandwidth at which the tip rests after the motion
    values = 1e3 * moved[tuned], 1e3 * ringings["FMU"][tuned]
    print(f"{name:17} {bandwidths[tuned]:14.1f}  {values[0]:18.3f}  {values[1]:15.3f}")
    axes.semilogy(bandwidths, 1e3 * np.where(np.isfinite(moved), moved, np.nan), ".-", label=name)
axes.axhline(1e3 * MAX_RINGING, color="0.5", linestyle="--", label="limit")
axes.set(xlabel="bandwidth of the controller [Hz]", ylabel="ringing of the tip [mm]", ylim=(1e-5, 1e2))
axes.legend(frameon=False)
figure.savefig("robot_controller.png")
