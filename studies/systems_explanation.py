"""Figures of docs/systems_explanation.md: energy, stability and proof of one FMU for a system.

    python studies/systems_explanation.py [SECTION ...]

proof  : the bolted column over more periods: time of its build, rows that its proof compares
energy : drift of the energy of an arm with six drives and fixed motors that oscillates for two seconds
         without losses, at several tolerances of the importing tool
coupling : the six-axis arm, each axis alone and all coupled: frequencies at the end of its motion, errors of
         the tip, oscillation after the motion
random : the robot joint from 10 000 random states under random torques, three steps of 10 ms each: all values
         are finite, and energy less work falls in every step (without hysteresis, whose sliders store energy
         too)
"""

import shutil
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import fmpy
import mujoco
import numpy as np
from common import ROOT, run_study
from jointfmu_tools.api import drive, load
from jointfmu_tools.exchange.robots import elastic, poses, robot_system
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from jointfmu_tools.pages.report.systems import wind_up_and_tip_error
from jointfmu_tools.run.proof.manifest import RelatedFileReader
from jointfmu_tools.run.proof.run import prove
from jointfmu_tools.systems.cosimulation import simulate_arm
from jointfmu_tools.systems.fit.compiled_system import CompiledSystem
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import build_system_fmus
from jointfmu_tools.systems.system import load_system
from scipy.interpolate import CubicSpline

ROBOT = ROOT / "models/robots/six_axis.xml"
SIZES = ("CSG-32-100", "CSG-40-100", "CSG-25-100", "CSG-20-100", "CSG-17-100", "CSG-14-100")
LOSSES = ("d", "friction_coulomb", "friction_stribeck", "friction_viscous", "hysteresis_loss", "load_loss")
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8)
PAYLOAD, SWING = 3.0, 2.0
DRAWS, STEP, STEPS = 10_000, 1e-2, 3
LONG_DURATIONS = (0.03, 1.0, 40.0)


def potential(joint, widest: float):
    """Function: elastic energy [J] of a joint over the wind-up [rad] up to `widest`, without losses."""
    given = {name: 0.0 for name in LOSSES if name in joint.values}
    turns = np.linspace(-widest, widest, 4001)
    torque = joint.with_values(given).evaluate("HarmonicDriveSpring", phi2=turns)["tau"]
    energy = CubicSpline(turns, np.asarray(torque)).antiderivative()
    return lambda x: energy(x) - energy(0.0)


def print_energy_drift() -> None:
    """Print the drift of the arm's energy for each solver tolerance of the importing tool."""
    with tempfile.TemporaryDirectory() as name:
        drift_in(Path(name))


def drift_in(folder: Path) -> None:
    """Build the arm with fixed motors in a folder, and print the drift of its energy without losses."""
    model, axes, files = read_axes()
    joints = {f"joint{i}": drive(size) for i, size in enumerate(SIZES, 1)}
    pose = elastic.make_robot_pose(model, {"joint2": "0.7", "joint3": "0.8"})
    tip = model.body("flange").id
    arm = robot_system.read_arm(model, axes, files, pose, PAYLOAD, tip, has_prescribed_motor_motion=True)
    system = robot_system.make_robot_system(arm, "swing", "arm that swings", PAYLOAD)
    (file,) = build_system_fmus(system, folder, ("2",), (fmpy.platform_tuple,))
    unzipped = fmpy.extract(str(file))
    described = fmpy.read_model_description(unzipped)
    names = {v.name for v in described.modelVariables}
    given = {f"{n}.drive.{loss}": 0.0 for n in joints for loss in LOSSES if f"{n}.drive.{loss}" in names}
    for tolerance in TOLERANCES:
        found = fmpy.simulate_fmu(
            unzipped,
            model_description=described,
            stop_time=SWING,
            step_size=1e-3,
            output_interval=1e-3,
            relative_tolerance=tolerance,
            start_values=given,
            output=[f"{n}.{x}" for n in joints for x in ("phi", "w", "drive.phi_rel")],
        )
        angles, speeds = (np.column_stack([found[f"{n}.{x}"] for n in joints]) for x in ("phi", "w"))
        kinetic, total = rigid_energies(angles, speeds)
        for n, joint in joints.items():
            wind_up = found[f"{n}.drive.phi_rel"]
            total += potential(joint, max(1.1 * np.abs(wind_up).max(), 1e-6))(wind_up)
        drift = np.ptp(total) / kinetic.max() / SWING
        print(f"tolerance {tolerance:.0e}: energy within {drift:.1e} of {kinetic.max():.2g} J per second")
    shutil.rmtree(unzipped)


def rigid_energies(angles, speeds):
    """Kinetic energy (n) [J] of the links and the payload, and kinetic plus potential energy, by MuJoCo."""
    loaded = elastic.read_robot(ROBOT)
    flange = loaded.body("flange")
    flange.mass, flange.inertia, flange.explicitinertial = PAYLOAD, [1e-12] * 3, True
    flange.ipos, flange.iquat = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
    for joint in loaded.joints:
        joint.armature = 0.0
    model = loaded.compile()
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data, rows = mujoco.MjData(model), []
    for data.qpos[:], data.qvel[:] in zip(angles, speeds, strict=True):
        mujoco.mj_forward(model, data)
        rows.append((data.energy[1], data.energy.sum()))
    return np.transpose(rows)


def print_coupling() -> None:
    """Print frequencies [Hz], tip errors and oscillation of the arm, coupled and with separate inertias."""
    model, axes, _ = read_axes()
    pose = np.array([link.travel for link in load_system("six_axis_robot").arm.links])
    tip = model.body("flange").id
    torques, _ = poses.compute_weight_torques(model, axes, pose, PAYLOAD, tip)
    inertias = np.diag(poses.compute_link_mass_matrix(model, axes, pose, PAYLOAD, tip))
    stiffness = np.array(
        [axis.stiffness_at_torque(t) for axis, t in zip(axes, torques.tolist(), strict=True)]
    )
    alone = np.sort(np.sqrt(stiffness / inertias)) / (2.0 * np.pi)
    coupled = poses.compute_frequencies(model, axes, pose, PAYLOAD, tip)
    for name, frequencies in (("each axis alone", alone), ("coupled", coupled)):
        print(f"{name}: {', '.join(f'{x:.3g}' for x in frequencies)} Hz")
    arm = load_system("six_axis_robot")
    results = simulate_arm(arm)
    separate = CompiledSystem(assemble_system(replace(arm, arm=None)))
    angles = [name for name in results if name.endswith(".phi")]
    rows = separate.simulate({}, results["time"], {}, angles)
    for name, found in (
        ("coupled", results),
        ("one inertia per axis", dict(zip(angles, rows.T, strict=True))),
    ):
        _, wind_up, error = wind_up_and_tip_error(arm, found)
        ringing = np.ptp(wind_up[results["time"] > arm.arm.motion_start + arm.arm.motion_duration], axis=0)
        print(f"{name}: error of the tip up to {1e3 * error.max():.3g} mm, at rest {1e3 * error[-1]:.3g} mm")
        print(
            f"  wind-up after the motion, peak to peak: {', '.join(f'{1e6 * x:.2g}' for x in ringing)} urad"
        )


def read_axes():
    """Read the six-axis arm: rigid MuJoCo model, driven axes, and parameter files of the drives."""
    spec = elastic.read_robot(ROBOT)
    files = {f"joint{i}": drive(size).file for i, size in enumerate(SIZES, 1)}
    axes = elastic.make_axes(spec, {name: make_transmission(file) for name, file in files.items()})
    return spec.compile(), axes, files


def print_random_states() -> None:
    """Print the largest increase of energy minus work, and whether all values are finite, without and with
    hysteresis."""
    with tempfile.TemporaryDirectory() as name:
        random_states_in(Path(name))


def random_states_in(folder: Path) -> None:
    """Build the robot joint in a folder, and step it from random states."""
    (file,) = build_system_fmus(
        assemble_system(load_system("robot_joint")), folder, ("2",), (fmpy.platform_tuple,)
    )
    unzipped = fmpy.extract(str(file))
    described = fmpy.read_model_description(unzipped)
    refs = {v.name: v.valueReference for v in described.modelVariables}
    stored = potential(load("HarmonicDriveSpring"), 0.5)
    draw = np.random.default_rng(1)
    states = draw.uniform(-1.0, 1.0, (DRAWS, 6)) * [10.0, 300.0, 0.1, 3.0, 0.1, 10.0]
    states[:, 2] += states[:, 0] / 100.0
    names = ["motor.phi", "motor.w", "link.phi", "link.w", "load.tau_in", "link.tau_a"]
    quiet = {"load.ramp_height": 0.0, "load.pulse_height": 0.0}
    for loss in (0.0, 2.9e-4):
        given = quiet | {"drive.hysteresis_loss": loss}
        fmu = fmpy.instantiate_fmu(unzipped, described, "CoSimulation", logger=lambda *_: None)
        rises, spans = [], []
        for row in states:
            fmu.reset()
            fmu.setupExperiment(startTime=0.0)
            fmu.enterInitializationMode()
            start = dict(zip(names, row.tolist(), strict=True)) | given
            fmu.setReal([refs[name] for name in start], list(start.values()))
            fmu.exitInitializationMode()
            seen = [fmu.getReal([refs[name] for name in names[:4]])]
            for k in range(STEPS):
                fmu.doStep(k * STEP, STEP)
                seen.append(fmu.getReal([refs[name] for name in names[:4]]))
            phi1, w1, phi2, w2 = np.array(seen).T
            spans.append(np.abs([w1 / 300.0, w2 / 3.0]).max())
            total = 0.5 * 1e-5 * w1**2 + 0.5 * 0.05 * w2**2 + 9.80665 * 0.2 * (1.0 - np.cos(phi2))
            total += stored(phi2 - phi1 / 100.0) - row[4] * phi1 - row[5] * phi2
            rises.append(np.diff(total).max() / (total.max() - total.min() + 1e-3))
        fmu.terminate()
        fmu.freeInstance()
        said = (
            ""
            if loss
            else f", energy less work falls in every step, by {-max(rises):.1e} of its span or more"
        )
        finite = np.isfinite(rises).all()
        print(
            f"hysteresis {loss:g} rad, {DRAWS} draws: {'all finite' if finite else 'NOT FINITE'}, "
            f"speeds within {max(spans):.2g} times their draw{said}"
        )
    shutil.rmtree(unzipped)


def prove_long_system() -> None:
    """Print build time, end of the proof, and failures, for several durations of the system."""
    with tempfile.TemporaryDirectory() as name:
        prove_long_system_in(Path(name))


def prove_long_system_in(folder: Path) -> None:
    """Build the bolted column in a folder, and print its proof."""
    for stop in LONG_DURATIONS:
        begin = time.perf_counter()
        column = replace(load_system("bolted_column"), stop_time=stop)
        (file,) = build_system_fmus(assemble_system(column), folder, ("2",), (fmpy.platform_tuple,))
        taken = time.perf_counter() - begin
        rows = [
            e.reference_results.time
            for e in RelatedFileReader(file).read_experiments()
            if e.reference_results
        ]
        found = prove(file)
        print(
            f"bolted_column over {stop:g} s: built in {taken:.0f} s, proved up to {rows[0][-1]:g} s, "
            f"{', '.join(str(row.size) for row in rows)} rows, misses: {found.failure_messages or 'none'}"
        )


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "proof": prove_long_system,
            "energy": print_energy_drift,
            "coupling": print_coupling,
            "random": print_random_states,
        },
    )
