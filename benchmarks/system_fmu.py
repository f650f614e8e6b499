"""One FMU of a whole system beside the archive of separate FMUs, both in fmpy, in one run.

    python benchmarks/system_fmu.py

For each shipped system: the largest difference of an output from model exchange (CVode, tight), over its
largest value, at communication steps of 1 ms and 10 ms; and the time of a run of the archive at the system's
interval over that of the FMU at 1 ms. Both include loading; the archive's includes unpacking.
"""

import platform
import shutil
import tempfile
import time
from pathlib import Path

import fmpy
import numpy as np
from fmpy.ssp.simulation import simulate_ssp
from jointfmu_fmu_src.system.fmu import build_system
from jointfmu_tools.systems import ssp
from jointfmu_tools.systems.assembly import assembly
from jointfmu_tools.systems.system import system

WATCHED = {
    "robot_joint": ("link.phi", "link.w", "drive.tau", "drive.E_loss"),
    "bolted_column": ("column.s", "column.v", "joint.f_x", "joint.E_loss"),
    "six_axis_robot": ("shoulder_link.w", "elbow_drive.tau", "hand_drive.phi_rel"),
}
EXCHANGE = {"robot_joint": (1e-9, 1e-3), "bolted_column": (1e-8, 1e-5), "six_axis_robot": (1e-9, 1e-3)}
"""Relative tolerance, and interval of the result [s]: CVode takes at most 500 steps in one."""
STEPS = (1e-3, 1e-2)
REPEATS = 3


def fastest(call):
    """Result and least time [s] of some runs."""
    times = []
    for _ in range(REPEATS):
        before = time.perf_counter()
        found = call()
        times.append(time.perf_counter() - before)
    return found, min(times)


def main() -> None:
    """Print the table."""
    here = (
        f"{'aarch64' if platform.machine() in ('arm64', 'aarch64') else 'x86_64'}-{platform.system().lower()}"
    )
    print("system           output          at 1 ms   at 10 ms |  FMU 1 ms   10 ms   archive  ratio")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        for name, outputs in WATCHED.items():
            one = system(name)
            file = build_system(assembly(one), out / "whole", ("2",), (here,))[0]
            ssp.build_systems(out, [one])
            unzipped = fmpy.extract(str(file))
            tolerance, interval = EXCHANGE[name]
            common = {"filename": unzipped, "stop_time": one.stop_time, "output": outputs}
            expected = fmpy.simulate_fmu(
                **common,
                fmi_type="ModelExchange",
                solver="CVode",
                relative_tolerance=tolerance,
                output_interval=interval,
            )
            misses, times = [], []
            for step in STEPS:
                found, taken = fastest(
                    lambda common=common, step=step: fmpy.simulate_fmu(
                        **common, fmi_type="CoSimulation", step_size=step, output_interval=step
                    )
                )
                times.append(taken)
                misses.append(
                    {
                        o: np.abs(found[o] - np.interp(found["time"], expected["time"], expected[o])).max()
                        / np.abs(expected[o]).max()
                        for o in outputs
                    }
                )
            archive = str(out / "ssp" / f"{name}.ssp")
            before = time.perf_counter()
            simulate_ssp(archive, stop_time=one.stop_time, step_size=one.interval)
            apart = time.perf_counter() - before
            shutil.rmtree(unzipped)
            for k, o in enumerate(outputs):
                line = f"{name if not k else '':16} {o:20} {misses[0][o]:.1e}   {misses[1][o]:.1e} |"
                if not k:
                    line += f" {times[0]:7.3f} s {times[1]:6.3f} s {apart:7.2f} s {apart / times[0]:6.1f}"
                print(line)


if __name__ == "__main__":
    main()
