"""Times of calls of native FMUs in a C host, compared with an FMU that passes its inputs on and with fmpy.

    python benchmarks/native_fmus.py [--quick] [--worst | --elastic-sides]

For Linux on x86_64. The libraries are built as for users, and the host (native_fmus.c) by the same compiler.
A cycle sets all inputs, does one step and reads all outputs. The inputs change in each cycle, on one of four
trajectories: smooth with constant preload and moment; smooth with one moving input; smooth with a moving
preload; at random over the range of the tables. The bolted joint moves in six degrees of freedom on the first
trajectory, and does not tilt on the second.

"x PassThrough" : time of a smooth cycle over the time of a cycle of an FMU with the same runtime that passes
                  two inputs on to two outputs
"step"          : doStep with changed inputs; "no change": with the inputs of the step before
"derivative"    : one directional derivative of all outputs along all inputs
"start"         : from instantiation to the end of initialization
"memory"        : memory of an instance

The times are medians; the targets stand below the table. `--worst` times a million random steps of each FMU
one by one. `--elastic-sides` times the bolted joint with elastic and with rigid sides.
"""

import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import NamedTuple

import fmpy
import numpy as np
from harness import ROOT, judge_target, read_options, require_machine
from joint_cases import CASES
from jointfmu_fmu_src.building import FLAVOUR_BUILDERS, build_fmus
from jointfmu_fmu_src.native import data
from jointfmu_fmu_src.native.code import generate
from jointfmu_fmu_src.native.compiled import compiler
from jointfmu_fmu_src.native.compiled.binary import fill_library_placeholders
from jointfmu_fmu_src.native.compiled.compiled_models import get_compiled_model
from jointfmu_tools.run.host import FmuInstance

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default

HOSTS = ROOT / "tests" / "native" / "hosts"
ROUNDS, REPEATS, PYTHON_CYCLES = 5, 101, 100
QUICK = 1, 1, 2
"""Values of ROUNDS, REPEATS and PYTHON_CYCLES with --quick."""
ROWS = 4093  # as in native_fmus.c
NATIVE, PLATFORM = ("fmi2", "fmi3"), "x86_64-linux"
WIDE = "PassThrough4x9"
"""Pass-through FMU with as many inputs and outputs as the harmonic drive."""
PASS_THROUGH = {"PassThrough": (2, 2), WIDE: (4, 9)}
"""Pass-through FMUs, whose outputs are their inputs: {name: (inputs, outputs)}."""
LOOP = {"hysteresis_loss": 3e-4}
FRICTION = LOOP | {
    "lost_motion": 1e-4,
    "error_2": 1e-4,
    "friction_coulomb": 0.03,
    "friction_stribeck": 0.02,
    "friction_viscous": 2e-4,
    "load_loss": 0.1,
}
"""Losses of the drive that are off by default."""
LOOPS = {f"{name}+loop": (name, LOOP) for name in ("HarmonicDriveSpring", "HarmonicDriveCompliance")}
DRIVES_WITH_LOSSES = LOOPS | {"HarmonicDriveSpring+all": ("HarmonicDriveSpring", FRICTION)}
"""Drives with hysteresis, and with all losses: {name in the table: (FMU, parameters)}."""
RANGES = {name: dict(case.numbers.span) for name, case in CASES.items()} | {
    name: {f"u{i}": (-1, 1) for i in range(n)} for name, (n, _) in PASS_THROUGH.items()
}
RANGES |= {label: RANGES[name] for label, (name, _) in DRIVES_WITH_LOSSES.items()}
"""Ranges {name in the table: {input: (lowest, highest)}}: for joints, the ranges of their tables."""
CONSTANT = ("preload", "moment")
"""Inputs that are constant along the input path: a joint is tightened once."""

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
"""Columns of the table: {measured quantity: (heading, printed units per SI unit, unit)}."""

Times = dict[str, float]
Ranges = Mapping[str, tuple[float, float]]


def make_input_paths(ranges: Ranges) -> dict[str, np.ndarray]:
    """Input paths {name: (ROWS, n)} within the ranges {input: (lowest, highest)}.

    smooth     : oscillations of about 64 steps; preload and moment are constant
    straight   : only the first input oscillates
    tightening : the preload oscillates too; the moment is zero
    bent       : preload and moment oscillate too
    random     : independent random values
    """
    low, high = np.array(list(ranges.values()), dtype=float).T
    phase = 2.0 * np.pi / 64.0 * np.arange(ROWS)[:, None]
    moving = np.sin(phase * (1.0 + 0.1 * np.arange(low.size)))
    bent, resting = (np.where([v in held for v in ranges], 0.5, moving) for held in (CONSTANT[1:], CONSTANT))
    smooth, loaded = (0.5 * (low + high) + 0.5 * (high - low) * waves for waves in (resting, bent))
    tightening = np.where([v in CONSTANT[1:] for v in ranges], 0.0, loaded)
    first = next(v for v in ranges if v not in CONSTANT)
    straight = np.where([v == first for v in ranges], smooth, 0.5 * (low + high))
    scattered = np.random.default_rng(1).uniform(low, high, (ROWS, low.size))
    return {
        "smooth": smooth,
        "straight": straight,
        "tightening": tightening,
        "bent": loaded,
        "random": scattered,
    }


def generate_pass_through_sources(name: str) -> dict[str, str]:
    """C sources of an FMU whose outputs are its inputs."""
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
    own = data.make_data_struct(name, f"{{{name}}}", [*(0.0 for _ in rows), 1.0])
    return files | {
        "joint.c": (HOSTS / "passthrough" / "joint.c").read_text(encoding="utf-8"),
        "data.h": own.make_c_header(),
        "data.c": own.make_c_source(),
        "model.h": f"enum {{ N_INPUTS = {inputs}, N_OUTPUTS = {outputs}, N_PARAMETERS = 1 }};\n",
        "variables.c": '#include "variables.h"\n\n#include <math.h>\n\n'
        f"const Variable variables[N_VALUES] = {{{', '.join(texts)}}};\n"
        "const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS] = {{1}};\n",
    }


class LibrariesByFlavour(NamedTuple):
    """Libraries of an FMU by flavour, and its instantiation token."""

    libraries: dict[str, bytes]
    token: str


def build_joint_libraries(name: str) -> LibrariesByFlavour:
    """Libraries of an FMU as users build it: default parameters, or an entry of DRIVES_WITH_LOSSES."""
    own, changes = DRIVES_WITH_LOSSES.get(name, (name, {}))
    file = load_default(MODELS[own].joint).with_values(changes, "user", "benchmark")
    model = MODELS[own].with_parameters(file.joint, file.values)
    given = data.split_parameters(model, file)
    part, before = get_compiled_model(model, file, given), data.make_placeholder_data_struct(model, given)
    after = data.make_fmu_data_struct(model, file, given, part.source_texts)
    made = {
        f: fill_library_placeholders(part.libraries_by_fmi_version[f[-1]][PLATFORM], before, after, own)
        for f in NATIVE
    }
    return LibrariesByFlavour(made, after.instantiation_token)


def build_pass_through_libraries(name: str) -> LibrariesByFlavour:
    """Libraries of an FMU of PASS_THROUGH."""
    files = generate_pass_through_sources(name)
    units = {flavour: compiler.select_source_files(list(files), flavour[-1]) for flavour in NATIVE}
    made = {f: compiler.compile_libraries(name, files, u, [PLATFORM])[PLATFORM] for f, u in units.items()}
    return LibrariesByFlavour(made, generate.read_instantiation_token(files))


def list_native_libraries(folder: Path) -> Iterator[tuple[str, str, Path, str, int]]:
    """Name, flavour, library, token and number of outputs of every native FMU and pass-through."""
    for name in (*MODELS, *DRIVES_WITH_LOSSES, *PASS_THROUGH):
        model = MODELS.get(DRIVES_WITH_LOSSES.get(name, (name, {}))[0])
        outputs = len(model.outputs) if model else PASS_THROUGH[name][1]
        linked = build_joint_libraries(name) if model else build_pass_through_libraries(name)
        for flavour, library in linked.libraries.items():
            file = folder / flavour / f"{name}.so"
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(library)
            yield name, flavour, file, linked.token, outputs


def build_host(folder: Path) -> Path:
    """Compile the host native_fmus.c."""
    file = folder / "host"
    include = Path(fmpy.__file__).parent / "c-code"
    target = ("-target", compiler.ZIG_TARGETS[PLATFORM], "-s")  # for which zig has compiled its runtime
    options = ("-std=gnu11", "-O2", *target, f"-I{HOSTS}", f"-I{include}", "-ldl", "-o", str(file))
    subprocess.run(
        [sys.executable, "-m", "ziglang", "cc", str(ROOT / "benchmarks" / "native_fmus.c"), *options],
        check=True,
        cwd=folder,
    )
    return file


def measure_native_times(
    host: Path, ranges: Ranges, flavour: str, library: Path, token: str, outputs: int, repeats: int = REPEATS
) -> Times:
    """Times that the C host measures."""
    inputs = b"".join(rows.tobytes() for rows in make_input_paths(ranges).values())
    counts = (str(len(ranges)), str(outputs), str(repeats))
    done = subprocess.run(
        [host, library, flavour[-1], token, *counts], input=inputs, capture_output=True, check=True
    )
    return {key: float(value) for key, value in map(str.split, done.stdout.decode().splitlines())}


def measure_python_times(fmu: Path, unpacked: Path, cycles: int) -> Times:
    """Times of the python flavour in fmpy; one call sets all inputs, one call gets all outputs."""
    description = fmpy.read_model_description(str(fmu))
    slave = FmuInstance(
        fmpy.extract(str(fmu), str(unpacked)), description, "benchmark", uses_model_exchange=False
    )
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
    for column, rows in make_input_paths(RANGES[fmu.stem]).items():
        each = []
        for row in rows[:: ROWS // cycles][:cycles]:
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


def measure_all_times(folder: Path, quick: bool) -> dict[tuple[str, str], Times]:
    """Times {(name, flavour): times}, measured in rounds over all FMUs."""
    round_count, repeats, cycles = QUICK if quick else (ROUNDS, REPEATS, PYTHON_CYCLES)
    host = build_host(folder)
    native = [*list_native_libraries(folder)]
    rounds: dict[tuple[str, str], list[Times]] = {(name, flavour): [] for name, flavour, *_ in native}
    for _ in range(round_count):
        for name, flavour, *rest in native:
            rounds[name, flavour].append(
                measure_native_times(host, RANGES[name], flavour, *rest, repeats=repeats)
            )
    times = {key: {k: median(t[k] for t in found) for k in found[0]} for key, found in rounds.items()}
    for name in MODELS:
        fmu = folder / "python" / f"{name}.fmu"
        times[name, "python"] = measure_python_times(fmu, folder / "python" / name, cycles)
    for (_, flavour), found in times.items():
        base = times["PassThrough", "fmi3" if flavour == "fmi3" else "fmi2"]
        found["ratio"] = found["cycle_smooth"] / base["cycle_smooth"]
    return times


def print_longest_steps(folder: Path) -> None:
    """Print median and longest time of a million random steps of each FMU."""
    host = build_host(folder)
    print(f"{'random steps [us]':28} {'median':>9} {'1 in 1e4':>9} {'longest':>9}")
    for name, flavour, *rest in list_native_libraries(folder):
        if flavour == NATIVE[-1] and name not in PASS_THROUGH:
            found = measure_native_times(host, RANGES[name], flavour, *rest, repeats=0)
            times = [found[key] * 1e6 for key in ("median", "rare", "longest")]
            print(f"{name:28}" + "".join(f" {time:9.2f}" for time in times))


def print_times(times: dict[tuple[str, str], Times]) -> None:
    """Print the table of times and the targets."""
    print(f"{'FMU':28} {'flavour':7}" + "".join(f" {heading:>13}" for heading, *_ in COLUMNS.values()))
    print(" " * 36 + "".join(f" {unit:>13}" for *_, unit in COLUMNS.values()))
    for name in (*MODELS, *DRIVES_WITH_LOSSES, *PASS_THROUGH):
        for flavour in FLAVOUR_BUILDERS:
            if found := times.get((name, flavour)):
                print(
                    f"{name:28} {flavour:7}" + "".join(f" {format_cell(found, key):>13}" for key in COLUMNS)
                )
    print()
    for flavour in NATIVE:
        for name, key, most in list_targets(times, flavour):
            value = times[name, flavour][key]
            heading = COLUMNS[key][0]
            scale, unit = KB if key == "memory" else US
            target = f"of {most * scale:8.3f} {unit} {judge_target(value, most)}"
            print(f"{name:28} {flavour:7} {heading:>13} {value * scale:9.3f} {unit} {target}")


def list_targets(times: dict[tuple[str, str], Times], flavour: str) -> list[tuple[str, str, float]]:
    """Targets: FMU, measured quantity, largest allowed value [s, bytes]."""
    drive = 1.5 * times[WIDE, flavour]["cycle_smooth"] + 30e-9
    # 1.2 times its ratio to the plain drive before temperature and two load losses were added
    everything = 1.2 * 3.09 * times["HarmonicDriveSpring", flavour]["cycle_smooth"]
    return [
        ("BoltedJoint", "cycle_smooth", 12e-6),
        ("BoltedJoint", "cycle_straight", 4e-6),
        ("BoltedJoint", "cycle_tightening", 15e-6),
        ("GearContact", "cycle_smooth", 150e-9),
        ("HarmonicDriveSpring", "cycle_smooth", drive),
        *((name, "cycle_smooth", 300e-9) for name in LOOPS),
        ("HarmonicDriveSpring+all", "cycle_smooth", everything),
        *((name, "start", 2e-3) for name in MODELS),
        *((name, "memory", 300e3) for name in MODELS),
    ]


def format_cell(found: Times, key: str) -> str:
    """Table cell: number in the unit of the column; a dash if it was not measured."""
    if key not in found:
        return "-"
    number = found[key] * COLUMNS[key][1]
    return f"{number:.1f}" if number < 1000.0 else f"{number:,.0f}"


def print_elastic_sides(folder: Path, quick: bool) -> None:
    """Print times of the README's bolted joint with elastic sides over its times with rigid sides."""
    from oracles.joint_elements import PlateJoint, stiffnesses

    joint = PlateJoint.of("faces")
    motions = ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
    share = 0.5 * np.array([1.0, 0.3, 0.1, 0.1, 0.1, 0.3])
    amplitudes = dict(zip(motions, share * joint.load() / stiffnesses(joint)[0], strict=True))
    inputs = [variable.name for variable in MODELS["BoltedJoint"].inputs]
    ranges = {name: (-amplitudes.get(name, 0.0), amplitudes.get(name, 0.0)) for name in inputs}
    ranges["preload"] = (joint.preload, joint.preload)
    made = {}
    for name, file in {"elastic": joint.file, "rigid": joint.rigid}.items():
        files = generate.generate_sources("BoltedJoint", file)
        units = compiler.select_source_files(list(files), "3")
        library = folder / f"{name}.so"
        library.write_bytes(compiler.compile_libraries("BoltedJoint", files, units, [PLATFORM])[PLATFORM])
        model = MODELS["BoltedJoint"].with_parameters(file.joint, file.values)
        made[name] = library, generate.read_instantiation_token(files), len(model.outputs)
    host, (round_count, repeats, _) = build_host(folder), QUICK if quick else (ROUNDS, REPEATS, 0)
    rounds: dict[str, list[Times]] = {name: [] for name in made}
    for _ in range(round_count):
        for name, rest in made.items():
            rounds[name].append(measure_native_times(host, ranges, "fmi3", *rest, repeats=repeats))
    calls = ("step_smooth", "derivative", "start")
    times = {name: [median(t[call] for t in found) for call in calls] for name, found in rounds.items()}
    print(f"{'sides':10} {'step [us]':>10} {'derivative [us]':>16} {'start [us]':>11}")
    for name, row in times.items():
        print(f"{name:10} {row[0] * 1e6:10.1f} {row[1] * 1e6:16.1f} {row[2] * 1e6:11.0f}")
    ratios = [elastic / rigid for elastic, rigid in zip(times["elastic"], times["rigid"], strict=True)]
    print(f"{'ratio':10} {ratios[0]:10.1f} {ratios[1]:16.1f} {ratios[2]:11.1f}")


def main() -> None:
    """Build the FMUs, measure the times and print them."""
    flag = {"action": "store_true"}
    options = read_options(
        __doc__,
        worst=flag | {"help": "time a million random steps of each FMU, one by one"},
        elastic_sides=flag | {"help": "time the bolted joint with elastic and with rigid sides"},
    )
    require_machine((sys.platform, platform.machine()) == ("linux", "x86_64"), "Linux on x86_64")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if options.worst:
            print_longest_steps(folder)
        elif options.elastic_sides:
            print_elastic_sides(folder, options.quick)
        else:
            build_fmus([], ["python"], None, folder)
            print_times(measure_all_times(folder, options.quick))


if __name__ == "__main__":
    main()
