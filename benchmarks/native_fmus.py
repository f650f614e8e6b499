"""Times of the FMUs' calls in a host written in C, beside the python flavour in a Python host.

For Linux on x86_64. The libraries are built as for users, the host (native_fmus.c) by the same compiler.
One cycle sets all inputs, does one step and reads all outputs, with other inputs each time: along a
smooth trajectory with preload and moment at rest, along one on which the first other input alone moves,
along one on which the preload moves too, and at random over the table. A joint with memory remembers the
way: the bolted joint has six degrees of freedom on the smooth trajectory, and one without tilt on the second.
 "x PassThrough" is the smooth cycle over that of an FMU that passes two inputs on to two
outputs with the same runtime. "step" is doStep with changed inputs, "no change" with the inputs of the
step before. "derivative" is one directional derivative of all outputs along all inputs, "start" goes from
instantiation to the end of initialization. Medians. What is promised stands below with its target. With
`--worst` a million random steps of each are timed one by one instead.
"""

import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import NamedTuple

import fmpy
import numpy as np
from jointfmu_fmu_src.building import FLAVOURS, build
from jointfmu_fmu_src.native import data
from jointfmu_fmu_src.native.code import generate
from jointfmu_fmu_src.native.compiled import compiler
from jointfmu_fmu_src.native.compiled.binary import fill_library
from jointfmu_fmu_src.native.compiled.compiled_models import get_compiled_model
from jointfmu_tools.run.host import Instance

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default

HERE = Path(__file__).resolve().parent
TESTS = HERE.parent / "tests"
HOSTS = TESTS / "native" / "hosts"
sys.path.append(str(TESTS / "support"))
from joint_cases import CASES  # noqa: E402

ROUNDS, REPEATS, PYTHON_CYCLES = 5, 101, 100
ROWS = 4093  # as in native_fmus.c
NATIVE, PLATFORM = ("fmi2", "fmi3"), "x86_64-linux"
WIDE = "PassThrough4x9"
"""As many inputs and outputs as the harmonic drive has."""
PASS_THROUGH = {"PassThrough": (2, 2), WIDE: (4, 9)}
"""{FMU that passes its inputs on: (inputs, outputs)}."""
LOOP = {"hysteresis_loss": 3e-4}
FRICTION = LOOP | {
    "lost_motion": 1e-4,
    "error_2": 1e-4,
    "friction_coulomb": 0.03,
    "friction_stribeck": 0.02,
    "friction_viscous": 2e-4,
    "load_loss": 0.1,
}
"""All that is off by default."""
LOOPS = {f"{name}+loop": (name, LOOP) for name in ("HarmonicDriveSpring", "HarmonicDriveCompliance")}
OTHERS = LOOPS | {"HarmonicDriveSpring+all": ("HarmonicDriveSpring", FRICTION)}
"""The drive with hysteresis, with all: {in the table: (FMU, parameters)}."""
RANGES = {name: dict(case.numbers.span) for name, case in CASES.items()} | {
    name: {f"u{i}": (-1, 1) for i in range(n)} for name, (n, _) in PASS_THROUGH.items()
}
RANGES |= {label: RANGES[name] for label, (name, _) in OTHERS.items()}
"""Inputs over the range of the tables."""
HELD = ("preload", "moment")
"""Inputs that stay as they are along the trajectory: a joint is tightened once."""

NS, US, KB = (1e9, "ns"), (1e6, "us"), (1e-3, "kB")
COLUMNS = {
    "cycle_smooth": ("cycle smooth", *NS),
    "ratio": ("x PassThrough", 1.0, ""),
    "cycle_straight": ("one direction", *NS),
    "cycle_tightening": ("cycle preload", *NS),
    "cycle_bent": ("with moment", *NS),
    "cycle_random": ("cycle random", *NS),
    "step_smooth": ("step smooth", *NS),
    "step_random": ("step random", *NS),
    "unchanged": ("no change", *NS),
    "derivative": ("derivative", *NS),
    "start": ("start", *US),
    "memory": ("memory", *KB),
}
"""{what is measured: (heading, units per SI unit, unit)}."""

Times = dict[str, float]


def trajectories(name: str) -> dict[str, np.ndarray]:
    """Inputs (ROWS, n): along a smooth trajectory, with one of them moving alone, with the preload moving as
    well, the same under a moment that stays, and at random. An oscillation takes some 64 steps."""
    low, high = np.array(list(RANGES[name].values()), dtype=float).T
    phase = 2.0 * np.pi / 64.0 * np.arange(ROWS)[:, None]
    moving = np.sin(phase * (1.0 + 0.1 * np.arange(low.size)))
    bent, resting = (np.where([v in held for v in RANGES[name]], 0.5, moving) for held in (HELD[1:], HELD))
    smooth, loaded = (0.5 * (low + high) + 0.5 * (high - low) * waves for waves in (resting, bent))
    tightening = np.where([v in HELD[1:] for v in RANGES[name]], 0.0, loaded)
    first = next(v for v in RANGES[name] if v not in HELD)
    straight = np.where([v == first for v in RANGES[name]], smooth, 0.5 * (low + high))
    scattered = np.random.default_rng(1).uniform(low, high, (ROWS, low.size))
    return {
        "smooth": smooth,
        "straight": straight,
        "tightening": tightening,
        "bent": loaded,
        "random": scattered,
    }


def pass_through(name: str) -> dict[str, str]:
    """C sources of an FMU that passes its inputs on."""
    inputs, outputs = PASS_THROUGH[name]
    paths = [
        p
        for p in generate.list_runtime_files()
        if p.parent.name != "fmi" or p.stem in (*NATIVE, "fmi_common")
    ]
    files = {p.name: p.read_text(encoding="utf-8") for p in paths}
    rows = [
        "time",
        *(f"u{i}" for i in range(inputs)),
        *(f"y{i}" for i in range(outputs)),
    ]
    any_number = '"1", "", "(-inf, inf)"'
    texts = [f'{{"{v}", {any_number}, -INFINITY, INFINITY, 1, 1, 0, 0}}' for v in (*rows, "gain")]
    own = data.make_data_block(name, f"{{{name}}}", [*(0.0 for _ in rows), 1.0])
    return files | {
        "joint.c": (HOSTS / "passthrough" / "joint.c").read_text(encoding="utf-8"),
        "data.h": own.make_header(),
        "data.c": own.make_source(),
        "model.h": f"enum {{ N_INPUTS = {inputs}, N_OUTPUTS = {outputs}, N_PARAMETERS = 1 }};\n",
        "variables.c": '#include "variables.h"\n\n#include <math.h>\n\n'
        f"const Variable variables[N_VALUES] = {{{', '.join(texts)}}};\n"
        "const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS] = {{1}};\n",
    }


class Linked(NamedTuple):
    """Libraries of an FMU by flavour, and its token."""

    libraries: dict[str, bytes]
    token: str


def as_built(name: str) -> Linked:
    """Of an FMU with its default parameters, or of one of OTHERS."""
    own, changes = OTHERS.get(name, (name, {}))
    file = load_default(MODELS[own].joint).with_values(changes, "user", "benchmark")
    model = MODELS[own].with_parameters(file.joint, file.values)
    given = data.split_parameters(model, file)
    part, before = get_compiled_model(model, file, given), data.make_placeholder(model, given)
    after = data.make_fmu_data(model, file, given, part.sources)
    made = {f: fill_library(part.libraries[f[-1]][PLATFORM], before, after, own) for f in NATIVE}
    return Linked(made, after.token)


def as_compiled(name: str) -> Linked:
    """Of an FMU that passes its inputs on."""
    files = pass_through(name)
    units = {flavour: compiler.select_units(list(files), flavour[-1]) for flavour in NATIVE}
    made = {f: compiler.compile_libraries(name, files, u, [PLATFORM])[PLATFORM] for f, u in units.items()}
    return Linked(made, generate.read_token(files))


def libraries(folder: Path) -> Iterator[tuple[str, str, Path, str, int]]:
    """Name, flavour, library, token and number of outputs of every native FMU and pass-through."""
    for name in (*MODELS, *OTHERS, *PASS_THROUGH):
        model = MODELS.get(OTHERS.get(name, (name, {}))[0])
        outputs = len(model.outputs) if model else PASS_THROUGH[name][1]
        linked = as_built(name) if model else as_compiled(name)
        for flavour, library in linked.libraries.items():
            file = folder / flavour / f"{name}.so"
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(library)
            yield name, flavour, file, linked.token, outputs


def build_host(folder: Path) -> Path:
    """Compile native_fmus.c."""
    file = folder / "host"
    include = Path(fmpy.__file__).parent / "c-code"
    target = ("-target", compiler.TARGETS[PLATFORM], "-s")  # for which zig has compiled its runtime
    options = ("-std=gnu11", "-O2", *target, f"-I{HOSTS}", f"-I{include}", "-ldl", "-o", str(file))
    subprocess.run(
        [sys.executable, "-m", "ziglang", "cc", str(HERE / "native_fmus.c"), *options], check=True, cwd=folder
    )
    return file


def native_times(
    host: Path, name: str, flavour: str, library: Path, token: str, outputs: int, repeats: int = REPEATS
) -> Times:
    """What the host in C measures."""
    inputs = b"".join(rows.tobytes() for rows in trajectories(name).values())
    counts = (str(len(RANGES[name])), str(outputs), str(repeats))
    done = subprocess.run(
        [host, library, flavour[-1], token, *counts], input=inputs, capture_output=True, check=True
    )
    return {key: float(value) for key, value in map(str.split, done.stdout.decode().splitlines())}


def python_times(fmu: Path, unpacked: Path) -> Times:
    """The same of the python flavour, in fmpy; all inputs and all outputs take one call each."""
    description = fmpy.read_model_description(str(fmu))
    slave = Instance(fmpy.extract(str(fmu), str(unpacked)), description, "benchmark", model_exchange=False)
    refs = {
        kind: [v.valueReference for v in description.modelVariables if v.causality == kind]
        for kind in ("input", "output")
    }
    begin = perf_counter()
    slave.instantiate()
    slave.enter_initialization()
    slave.fmu.exitInitializationMode()
    times = {"start": perf_counter() - begin}
    calls = slave.fmu
    now = 0.0
    for column, rows in trajectories(fmu.stem).items():
        each = []
        for row in rows[:: ROWS // PYTHON_CYCLES][:PYTHON_CYCLES]:
            start = perf_counter()
            calls.setReal(refs["input"], row)
            changed = perf_counter()
            calls.doStep(currentCommunicationPoint=now, communicationStepSize=1.0)
            stepped = perf_counter()
            calls.getReal(refs["output"])
            read = perf_counter()
            calls.doStep(currentCommunicationPoint=now + 1.0, communicationStepSize=1.0)
            each.append((read - start, stepped - changed, perf_counter() - read))
            now += 2.0
        cycle, step, unchanged = map(median, zip(*each, strict=True))
        times |= {f"cycle_{column}": cycle, f"step_{column}": step, "unchanged": unchanged}
    calls.terminate()
    calls.freeInstance()
    return times


def measure(folder: Path) -> dict[tuple[str, str], Times]:
    """{(name, flavour): times} of the FMUs in folder/FLAVOUR/NAME.fmu; rounds over all of them."""
    host = build_host(folder)
    native = [*libraries(folder)]
    rounds: dict[tuple[str, str], list[Times]] = {(name, flavour): [] for name, flavour, *_ in native}
    for _ in range(ROUNDS):
        for name, flavour, *rest in native:
            rounds[name, flavour].append(native_times(host, name, flavour, *rest))
    times = {key: {k: median(t[k] for t in found) for k in found[0]} for key, found in rounds.items()}
    for name in MODELS:
        fmu = folder / "python" / f"{name}.fmu"
        times[name, "python"] = python_times(fmu, folder / "python" / name)
    for (_, flavour), found in times.items():
        base = times["PassThrough", "fmi3" if flavour == "fmi3" else "fmi2"]
        found["ratio"] = found["cycle_smooth"] / base["cycle_smooth"]
    return times


def worst(folder: Path) -> None:
    """Print the longest of a million random steps of each FMU beside the median."""
    host = build_host(folder)
    print(f"{'random steps [us]':28} {'median':>9} {'1 in 1e4':>9} {'longest':>9}")
    for name, flavour, *rest in libraries(folder):
        if flavour == NATIVE[-1] and name not in PASS_THROUGH:
            found = native_times(host, name, flavour, *rest, repeats=0)
            times = [found[key] * 1e6 for key in ("median", "rare", "longest")]
            print(f"{name:28}" + "".join(f" {time:9.2f}" for time in times))


def report(times: dict[tuple[str, str], Times]) -> None:
    """Print the table."""
    print(f"{'FMU':28} {'flavour':7}" + "".join(f" {heading:>13}" for heading, *_ in COLUMNS.values()))
    print(" " * 36 + "".join(f" {unit:>13}" for *_, unit in COLUMNS.values()))
    for name in (*MODELS, *OTHERS, *PASS_THROUGH):
        for flavour in FLAVOURS:
            if found := times.get((name, flavour)):
                print(f"{name:28} {flavour:7}" + "".join(f" {cell(found, key):>13}" for key in COLUMNS))
    print()
    for flavour in NATIVE:
        for name, key, most in targets(times, flavour):
            value = times[name, flavour][key]
            verdict = "met" if value <= most else "MISSED"
            heading = COLUMNS[key][0]
            print(
                f"{name:28} {flavour:7} {heading:>13} {value * 1e6:9.3f} us of {most * 1e6:7.3f} us {verdict}"
            )


def targets(times: dict[tuple[str, str], Times], flavour: str) -> list[tuple[str, str, float]]:
    """FMU, what is measured, and the most it may take [s]."""
    drive = 1.5 * times[WIDE, flavour]["cycle_smooth"] + 30e-9
    # 1.2 of what it was, over the plain drive, before temperature and two shares of the load
    everything = 1.2 * 3.09 * times["HarmonicDriveSpring", flavour]["cycle_smooth"]
    return [
        ("BoltedJoint", "cycle_smooth", 6e-6),
        ("BoltedJoint", "cycle_straight", 2e-6),
        ("BoltedJoint", "cycle_tightening", 15e-6),
        ("GearContact", "cycle_smooth", 150e-9),
        ("HarmonicDriveSpring", "cycle_smooth", drive),
        *((name, "cycle_smooth", 300e-9) for name in LOOPS),
        ("HarmonicDriveSpring+all", "cycle_smooth", everything),
        *((name, "start", 1.5e-3) for name in MODELS),
    ]


def cell(found: Times, key: str) -> str:
    """A number in the column's unit; a dash if it was not measured."""
    if key not in found:
        return "-"
    number = found[key] * COLUMNS[key][1]
    return f"{number:.1f}" if number < 1000.0 else f"{number:,.0f}"


def main() -> None:
    """Build, measure, print."""
    if (sys.platform, platform.machine()) != ("linux", "x86_64"):
        raise SystemExit(f"this is {sys.platform} on {platform.machine()}, expected linux on x86_64")
    with tempfile.TemporaryDirectory() as folder:
        if "--worst" in sys.argv[1:]:
            worst(Path(folder))
            return
        build([], ["python"], None, Path(folder))
        report(measure(Path(folder)))


if __name__ == "__main__":
    main()
