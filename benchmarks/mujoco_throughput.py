"""Environments of a six-axis arm with elastic joints in MuJoCo's own rollout, over those of the rigid arm.

    python benchmarks/mujoco_throughput.py [--hysteresis ARCMIN]

4096 environments that fall from random poses, on two cores, the same step and options for all: the rigid
arm; it with the friction of the drives' motors, each a constraint; joints elastic by plain MJCF, with and
without that friction; by the plugin, which has it. Damping is explicit (`eulerdamp` is off) but where it is
said: the rigid arm has none. Least processor times of rounds taken in turn; targets beside.
"""

import argparse
import sys
import tempfile
from copy import copy
from pathlib import Path
from time import process_time

import mujoco
import numpy as np
from jointfmu_tools.api import drive
from jointfmu_tools.exchange.robots import elastic, plugged
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from mujoco import rollout

ROBOT = Path(__file__).parents[1] / "models/robots/six_axis.xml"
SIZES = ("CSG-32-100", "CSG-40-100", "CSG-25-100", "CSG-20-100", "CSG-17-100", "CSG-14-100")
ENVIRONMENTS, THREADS, STEPS, ROUNDS = 4096, 2, 10, 5
STEP = 5e-4
"""[s]: a fifth of the period of the stiffest axis, 409 Hz, at least."""
TARGETS = {"plain": 1.5, "plain, no friction": 1.5, "plugin": 2.5}


def models(folder: Path, hysteresis: float | None) -> dict[str, mujoco.MjModel]:
    """The arm in all three forms."""
    spec = elastic.read_robot(ROBOT)
    spec.option.timestep = STEP
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    for actuator in [*spec.actuators]:
        spec.delete(actuator)
    stated = {} if hysteresis is None else {"hysteresis": hysteresis}
    files = {f"joint{i}": drive(size, **stated).file for i, size in enumerate(SIZES, 1)}
    axes = elastic.make_axes(spec, {joint: make_transmission(file) for joint, file in files.items()})
    for library in plugged.compile_plugins(files, folder).values():
        mujoco.mj_loadPluginLibrary(str(library))
    rough, smooth = spec.copy(), elastic.add_drives(spec, axes)
    for axis in axes:
        rough.joint(axis.joint).frictionloss = axis.drive.dry_friction * abs(axis.drive.ratio)
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
        "plugin": mujoco.MjModel.from_xml_string(plugged.format_plugin_robot(spec, axes, files)),
    }


def states(model: mujoco.MjModel) -> np.ndarray:
    """Initial states (ENVIRONMENTS, n): random poses, motors along with their links, at rest."""
    data, kind = mujoco.MjData(model), mujoco.mjtState.mjSTATE_FULLPHYSICS
    poses = np.random.default_rng(1).uniform(-1.0, 1.0, (ENVIRONMENTS, len(SIZES)))
    found = np.empty((ENVIRONMENTS, mujoco.mj_stateSize(model, kind)))
    motors = model.njnt > len(SIZES)
    for row, pose in zip(found, poses, strict=True):
        mujoco.mj_resetData(model, data)
        for i, angle in enumerate(pose, 1):
            data.joint(f"joint{i}").qpos[0] = angle
            if motors:
                data.joint(f"joint{i}_motor").qpos[0] = -100.0 * angle
        mujoco.mj_getState(model, data, row, kind)
    return found


def main() -> None:
    """Measure, print."""
    if sys.platform == "win32":
        raise SystemExit("this is Windows, expected Linux or macOS")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hysteresis", type=float, metavar="ARCMIN", help="of each drive (none)")
    with tempfile.TemporaryDirectory() as folder:
        made = models(Path(folder), parser.parse_args().hysteresis)
    begin = {name: states(model) for name, model in made.items()}
    pool = {name: [mujoco.MjData(model) for _ in range(THREADS)] for name, model in made.items()}
    room = {name: np.zeros((ENVIRONMENTS, STEPS, own.shape[1])) for name, own in begin.items()}
    times = {name: [] for name in made}
    with rollout.Rollout(nthread=THREADS) as run:
        for _ in range(ROUNDS):
            for name, model in made.items():
                before = process_time()
                run.rollout(model, pool[name], begin[name], nstep=STEPS, state=room[name])
                times[name].append(process_time() - before)
                assert not any(data.warning.number.any() for data in pool[name])
    least = {name: min(own) for name, own in times.items()}
    for name, own in least.items():
        ratios = own / least["rigid"], own / least["rigid, friction"]
        most = TARGETS.get(name)
        said = f", of {most:g} {'met' if ratios[0] <= most else 'MISSED'}" if most else ""
        print(
            f"{name:18} {1e6 * own / ENVIRONMENTS / STEPS:6.2f} us per environment and step, "
            f"{ratios[0]:5.2f} x rigid, {ratios[1]:5.2f} x rigid with friction{said}"
        )


if __name__ == "__main__":
    main()
