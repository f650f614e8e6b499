"""Environments of a six-axis arm with elastic joints in MuJoCo's own rollout, over those of the rigid arm.

    python benchmarks/mujoco_throughput.py [--hysteresis ARCMIN]

4096 environments that fall from random poses, on two cores, the same step for all: rigid; joints elastic by plain
MJCF; by the plugin. Least times of rounds taken in turn; targets beside.
"""

import argparse
import sys
import tempfile
from pathlib import Path
from time import perf_counter

import mujoco
import numpy as np
from jointfmu_tools.interface import drive
from jointfmu_tools.robots import elastic, plugged
from jointfmu_tools.robots.transmission import transmission
from mujoco import rollout

ROBOT = Path(__file__).parents[1] / "models/robots/six_axis.xml"
SIZES = ("CSG-32-100", "CSG-40-100", "CSG-25-100", "CSG-20-100", "CSG-17-100", "CSG-14-100")
ENVIRONMENTS, THREADS, STEPS, ROUNDS = 4096, 2, 20, 7
STEP = 5e-4
"""[s]: a fifth of the period of the stiffest axis, 409 Hz, at least."""
TARGETS = {"rigid": 1.0, "plain": 1.5, "plugin": 2.5}


def models(folder: Path, hysteresis: float | None) -> dict[str, mujoco.MjModel]:
    """The arm in all three forms."""
    spec = elastic.read(ROBOT)
    for actuator in [*spec.actuators]:
        spec.delete(actuator)
    stated = {} if hysteresis is None else {"hysteresis": hysteresis}
    files = {f"joint{i}": drive(size, **stated).file for i, size in enumerate(SIZES, 1)}
    axes = elastic.axes(spec, {joint: transmission(file) for joint, file in files.items()})
    for library in plugged.plugins(files, folder).values():
        mujoco.mj_loadPluginLibrary(str(library))
    made = {
        "rigid": spec.compile(),
        "plain": elastic.with_drives(spec, axes).compile(),
        "plugin": mujoco.MjModel.from_xml_string(plugged.text(spec, axes, files)),
    }
    for model in made.values():
        model.opt.timestep = STEP
    return made


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
    times = {name: [] for name in made}
    with rollout.Rollout(nthread=THREADS) as run:
        for _ in range(ROUNDS):
            for name, model in made.items():
                before = perf_counter()
                found, _ = run.rollout(model, pool[name], begin[name], nstep=STEPS)
                times[name].append(perf_counter() - before)
                assert not any(data.warning.number.any() for data in pool[name])
    rigid = min(times["rigid"])
    for name, own in times.items():
        ratio, rate = min(own) / rigid, ENVIRONMENTS * STEPS / min(own)
        verdict = "met" if ratio <= TARGETS[name] else "MISSED"
        print(
            f"{name:7} {1e6 / rate:7.2f} us per environment and step, {rate:9.3g} steps/s, "
            f"{ratio:5.2f} x rigid, of {TARGETS[name]:g} {verdict}"
        )


if __name__ == "__main__":
    main()
