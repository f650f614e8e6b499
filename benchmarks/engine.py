"""Times to evaluate a joint at many points: by the library of its FMU, and by the Python law.

    python benchmarks/engine.py [--library-alone]

The joint is the plate of the README. The path of POINTS points is followed in one process, also with the FMU
step by step in fmpy; the shortest of ROUNDS times counts. Each command is a process of its own, from start to
end; one run before it compiles what is missing, and writes points and patches of the contact to the cache.
`new` computes points and patches in every run. The table has elapsed times [s], and processor times [s] in
brackets.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
from jointfmu_tools.run.engine import JointEngine, PythonJoint, open_joint
from jointfmu_tools.run.ramps.ramp import run_path

import jointfmu

PLATE = ("--plate", "200x100", "--bolts", "4xM12", "--at", "160x60", "--grip", "40", "--material", "steel")
POINTS, ROUNDS = 200, 3
MAX_SHEAR_MOTION = 6e-6
"""Largest displacement along x [m]: the interface slips."""
FITTED_PARAMETERS = {"mu": 0.2, "h": 1.2e-6}
"""Parameters of the loops that are fitted: {name: value [SI]}."""
TARGETS = {"follow": 0.1, "plot": 2.0, "report": 3.0, "new": 6.0}
"""Target times [s] on two idle cores."""
PYTHON_LAW = "from jointfmu_tools.run import engine; engine.CompiledJoint = engine.PythonJoint; "
PLOT = "import sys, jointfmu; jointfmu.load(sys.argv[1]).plot().savefig(sys.argv[2])"
COMMAND = "from jointfmu_tools.cli import main; main()"
NEW_COMMAND = (
    f"from jointfmu.files import results; import jointfmu_tools; results.set_result_store(None); {COMMAND}"
)
"""Command `jointfmu new` for a contact whose points and patches are not in the cache."""

Seconds = tuple[float, float]
"""Elapsed time and processor time [s]."""


def measure_seconds(action: Callable[[], object]) -> Seconds:
    """Time that an action takes, including the processes for which it waits."""
    clock, before = perf_counter(), os.times()
    action()
    return perf_counter() - clock, sum(os.times()[:4]) - sum(before[:4])


def shortest_seconds(action: Callable[[], object]) -> Seconds:
    """Shortest time of an action that runs ROUNDS times."""
    return min(measure_seconds(action) for _ in range(ROUNDS))


def run_python_code(code: str, *arguments: object) -> None:
    """Run Python code in a process of its own, with Python's own cache of compiled modules."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], check=True, capture_output=True, env=environment
    )


def shear_cycles() -> np.ndarray:
    """Displacement (POINTS) [m]: first loading, then whole cycles."""
    return MAX_SHEAR_MOTION * np.sin(np.linspace(0.0, 4.5 * np.pi, POINTS))


def write_loops(joint: jointfmu.Joint, path: Path) -> None:
    """Write loops of force over displacement as a file of measurements."""
    columns = joint.with_values(FITTED_PARAMETERS).follow(s_rel_x=shear_cycles())
    table = np.column_stack([columns["s_rel_x"], -columns["f_x"]])
    np.savetxt(path, table, delimiter=",", header="displacement [m],force [N]", comments="", fmt="%.17g")


def compare_paths(file: Path, folder: Path) -> dict[str, Seconds]:
    """Times of the path: the library, the FMU in fmpy, the Python law."""
    joint = jointfmu.load(file)
    model = joint.model()
    fmu = joint.build(folder, "fmi3")[0]
    preload = joint.file.start_value("preload")

    def follow(engine: JointEngine) -> Callable[[], object]:
        return lambda: engine.evaluate_path({"s_rel_x": shear_cycles()})

    return {
        "library": shortest_seconds(follow(open_joint(model, joint.file))),
        "FMU in fmpy": shortest_seconds(
            lambda: run_path(fmu, "s_rel_x", shear_cycles(), {"preload": preload})
        ),
        "Python law": measure_seconds(follow(PythonJoint(model, joint.file))),
    }


def format_seconds(seconds: Seconds | None) -> str:
    """Format the elapsed time [s] and, in brackets, the processor time [s]."""
    return "" if seconds is None else f"{seconds[0]:8.2f} ({seconds[1]:.2f})"


def main() -> None:
    """Measure and print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument(
        "--library-alone",
        action="store_true",
        help="measure the FMU's library only, not the commands that use the Python law",
    )
    law_is_measured = not parser.parse_args().library_alone
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plate, loops, out = folder / "plate.toml", folder / "loops.csv", folder / "out"
        make = ("new", "bolted-joint", *PLATE, "--Ra", "0.8", "--out", plate, "--force")
        run_python_code(NEW_COMMAND, *make)
        new = measure_seconds(lambda: run_python_code(NEW_COMMAND, *make))
        write_loops(jointfmu.load(plate), loops)
        print(f"path of {POINTS} points [s]")
        for label, seconds in compare_paths(plate, folder).items():
            print(f"{label:12} {format_seconds((round(seconds[0], 4), seconds[1]))}")
        fit = ("fit", "loop", loops, "--params", plate, "--out", f"{out}.toml", "--force")
        commands: dict[str, tuple[object, ...]] = {
            "plot": (PLOT, plate, f"{out}.png"),
            "report": (COMMAND, "report", plate, "--out", f"{out}.html", "--force"),
            "fit loop": (COMMAND, *fit),
        }
        print(f"\n{'command [s]':12} {'library':>16} {'Python law':>16} {'ratio':>7} {'target':>7}")
        print(f"{'new':12} {format_seconds(new):>16} {'':16} {'':7} {TARGETS['new']:7.1f}")
        for label, (code, *arguments) in commands.items():
            run_python_code(str(code), *arguments)
            library = measure_seconds(lambda c=code, a=arguments: run_python_code(c, *a))
            law = (
                measure_seconds(lambda c=code, a=arguments: run_python_code(PYTHON_LAW + c, *a))
                if law_is_measured
                else None
            )
            ratio = f"{law[1] / library[1]:.1f}" if law else ""
            target = f"{TARGETS[label]:.1f}" if label in TARGETS else ""
            row = f"{format_seconds(library):>16} {format_seconds(law):>16}"
            print(f"{label:12} {row} {ratio:>7} {target:>7}")


if __name__ == "__main__":
    main()
