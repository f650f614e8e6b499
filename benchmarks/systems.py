"""One FMU of a system compared with the archive of separate FMUs, both in fmpy: deviation and time.

    python benchmarks/systems.py [--quick] [--worst]

The first table has the largest deviation of an output from model exchange (CVode, tight tolerance), over the
largest value of the output: for the FMU at communication steps of 1 ms and 10 ms, and for the archive at the
interval of the system. The second table has run times: of the FMU, of the archive at this interval, and of
the archive at the longest step that keeps its outputs within 0.5 % too (the interval, halved until they are).
All times include loading, and for the archive unpacking.

With `--worst`: processor times of a million communication steps under random loads on the bodies; every
thousand steps start again from rest.
"""

import tempfile
import time
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv
from harness import read_options, time_fastest_call
from jointfmu_tools.run.host import unpack_fmu
from jointfmu_tools.systems import ssp
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import build_system_fmus
from jointfmu_tools.systems.system import load_system

OUTPUTS = {
    "robot_joint": ("link.phi", "link.w", "drive.tau2", "drive.E_loss"),
    "bolted_column": ("column.s", "column.v", "joint.f_x", "joint.E_loss"),
    "six_axis_robot": ("shoulder_link.w", "elbow_drive.tau2", "hand_link.phi"),
}
REFERENCE_RUN = {"robot_joint": (1e-9, 1e-4), "bolted_column": (1e-8, 1e-6), "six_axis_robot": (1e-9, 1e-4)}
"""{system: (relative tolerance, output interval [s])} of model exchange. fmpy reports completed steps once in
an interval, and the friction takes reversals from them."""
STEPS = (1e-3, 1e-2)
LOADS = {
    "robot_joint": (1e-3, {"load.tau_in": 0.05, "link.tau_a": 5.0}),
    "bolted_column": (5e-5, {"load.f_in": 5e3}),
    "six_axis_robot": (
        1e-3,
        {f"{axis}_load.tau_in": 20.0 for axis in ("base", "shoulder", "elbow", "forearm")},
    ),
}
"""{system: (step [s], {input: largest random load [N.m, N]})}: the column's period is 0.5 ms."""
RANDOM_STEPS, STEPS_FROM_REST = 1_000_000, 1000
"""Number of steps of `--worst`, and number of steps between two resets."""
TOLERANCE = 5e-3
MAX_HALVINGS = 6


def largest_output_deviations(found, expected, outputs, late=0.0):
    """Largest deviation of each output over its largest value; `late` [s]: delay of the rows."""
    return {
        o: np.abs(found[o] - np.interp(found["time"] + late, expected["time"], expected[o])).max()
        / np.abs(expected[o]).max()
        for o in outputs
    }


def run_archive(path, name, one, step, expected, outputs):
    """Deviations of the outputs that the archive has, and time [s]."""
    parameters = read_ssv(str(path), f"parameters/{name}.ssv")
    before = time.perf_counter()
    found = simulate_ssp(str(path), stop_time=one.stop_time, step_size=step, parameter_set=parameters)
    taken = time.perf_counter() - before
    return largest_output_deviations(
        found, expected, [o for o in outputs if o in found.dtype.names], step
    ), taken


def build_fmu(name: str, out: Path) -> Path:
    """Build one FMU of a system; the axes of an arm are not coupled, as in its archive."""
    system = replace(load_system(name), arm=None)
    return build_system_fmus(assemble_system(system), out / "whole", ("2",), (fmpy.platform_tuple,))[0]


def print_longest_steps(out: Path, count: int) -> None:
    """Print median and longest time of random steps [us]."""
    print("system             median  1 in 1e4   longest  refused")
    for name, (step, loads) in LOADS.items():
        with unpack_fmu(build_fmu(name, out)) as (folder, described):
            refs = {v.name: v.valueReference for v in described.modelVariables}
            wanted = [refs[o] for o in loads]
            fmu = fmpy.instantiate_fmu(folder, described, "CoSimulation", logger=lambda *_: None)
            draw = np.random.default_rng(1).uniform(-1.0, 1.0, (count, len(loads))) * [*loads.values()]
            taken, refused = np.empty(count), 0
            for k, row in enumerate(draw.tolist()):
                if k % STEPS_FROM_REST == 0:
                    fmu.reset()
                    fmu.setupExperiment(startTime=0.0)
                    fmu.enterInitializationMode()
                    fmu.exitInitializationMode()
                fmu.setReal(wanted, row)
                before = time.thread_time()
                try:
                    fmu.doStep(k % STEPS_FROM_REST * step, step)
                except fmpy.fmi1.FMICallException:
                    refused += 1
                taken[k] = time.thread_time() - before
            fmu.terminate()
            fmu.freeInstance()
        found = 1e6 * np.quantile(taken, [0.5, 1.0 - 1e-4, 1.0])
        print(f"{name:16} {found[0]:8.1f} {found[1]:9.1f} {found[2]:9.1f} {refused:8}")


def main() -> None:
    """Print the tables of times."""
    options = read_options(__doc__, worst={"action": "store_true", "help": "time a million random steps"})
    if options.worst:
        with tempfile.TemporaryDirectory() as folder:
            print_longest_steps(Path(folder), 2000 if options.quick else RANDOM_STEPS)
        return
    systems = dict([*OUTPUTS.items()][: 1 if options.quick else None])
    times = []
    print("system           output                1 ms     10 ms   archive at its interval")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        for name, outputs in systems.items():
            one = load_system(name)
            ssp.build_system_archives(out, [one])
            tolerance, interval = REFERENCE_RUN[name]
            with unpack_fmu(build_fmu(name, out)) as (unzipped, _):
                common = {"filename": unzipped, "stop_time": one.stop_time, "output": outputs}
                expected = fmpy.simulate_fmu(
                    **common,
                    fmi_type="ModelExchange",
                    solver="CVode",
                    relative_tolerance=tolerance,
                    output_interval=interval,
                )
                runs = [
                    time_fastest_call(
                        lambda common=common, step=step: fmpy.simulate_fmu(
                            **common, fmi_type="CoSimulation", step_size=step, output_interval=step
                        ),
                        1 if options.quick else 3,
                    )
                    for step in STEPS
                ]
            found = [largest_output_deviations(result, expected, outputs) for result, _ in runs]
            archive, step = out / "ssp" / f"{name}.ssp", one.output_interval
            far, taken = own = run_archive(archive, name, one, step, expected, outputs)
            for _ in range(MAX_HALVINGS):
                if max(far.values()) < TOLERANCE:
                    break
                step /= 2.0
                far, taken = run_archive(archive, name, one, step, expected, outputs)
            for k, o in enumerate(outputs):
                apart = f"{own[0][o]:9.1e}" if o in own[0] else ""
                print(f"{name if not k else '':16} {o:18} {found[0][o]:9.1e} {found[1][o]:9.1e} {apart}")
            times.append(
                (name, [t for _, t in runs], one.output_interval, own[1], step, taken, max(far.values()))
            )
    print(
        "\nsystem             1 ms    10 ms |  archive: step   time   ratios |    step   time   ratios   miss"
    )
    for name, (fine, long), interval, own, step, taken, far in times:
        print(
            f"{name:16} {fine:6.3f} s {long:6.3f} s"
            f" | {interval:7.1e} s {own:6.2f} s {own / fine:5.1f} {own / long:5.1f}"
            f" | {step:7.1e} s {taken:6.2f} s {taken / fine:5.1f} {taken / long:5.1f} {far:.1e}"
        )


if __name__ == "__main__":
    main()
