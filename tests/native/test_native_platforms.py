"""Binaries for Windows (in Wine) and Linux aarch64 (in QEMU) against Linux on x86_64.

The hosts in tests/native/hosts are built for each platform by the same compiler as the FMUs. macOS is not
run. Without a C library of aarch64, no binary can be loaded. Then programs without that library are run: the
FMU's own sources, a host, and the few C library functions that a run calls (bare.c), linked together.
"""

import os
import struct
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import fmpy
import numpy as np
import pytest
import ziglang
from clients import SYSROOT, needs, prepare_wine, qemu, unusable
from fmpy import read_model_description
from jointfmu_fmu_src.native.compiled.compiler import _COMMON_ZIG_OPTIONS, ZIG_TARGETS
from natives import SAID

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model

pytestmark = [pytest.mark.slow, needs("Linux on x86_64")]

POINTS = 60
HOSTS = Path(__file__).parent / "hosts"
VERSIONS = ("fmi2", "fmi3")

BARE = (
    "-target", "aarch64-linux-musl", *_COMMON_ZIG_OPTIONS, "-w", "-DLINKED", "-nostdlib", "-static",
    "-fno-builtin-fprintf",
    *(
        f"-isystem{Path(ziglang.__file__).parent / 'lib' / 'libc' / 'include' / headers}"
        for headers in ("aarch64-linux-musl", "generic-musl")
    ),
)  # fmt: skip
"""Compiler options for FMU sources without a C library, which zig would compile first."""

WINDOWS = (
    str(HOSTS / "windows.c"), "-nostdlib", "-Wl,--entry=mainCRTStartup", "-D_UCRT", "-isystem",
    str(Path(ziglang.__file__).parent / "lib" / "libc" / "include" / "any-windows-any"), "-lkernel32",
    *(
        f"-lapi-ms-win-crt-{part}-l1-1-0"
        for part in ("convert", "heap", "math", "private", "runtime", "stdio", "string", "utility")
    ),
)  # fmt: skip
"""Linker options with the system's runtime only; the runtime of mingw takes zig a minute to compile."""


class Machine(NamedTuple):
    """Commands that build and run a host on a machine: `prefix` gives the words before the program's name."""

    target: str
    options: tuple[str, ...]
    folders: dict[str, str]
    end: str
    prefix: Callable[[], tuple[str, ...]] = tuple


HERE = Machine(
    ZIG_TARGETS["x86_64-linux"],
    ("-ldl", "-lpthread"),
    {"fmi2": "linux64", "fmi3": "x86_64-linux"},
    "so",
)
OTHERS = {
    "windows": Machine(
        ZIG_TARGETS["x86_64-windows"],
        WINDOWS,
        {"fmi2": "win64", "fmi3": "x86_64-windows"},
        "dll",
        lambda: ("wine",),
    ),
    "aarch64": Machine(
        ZIG_TARGETS["aarch64-linux"],
        ("-ldl", "-lpthread"),
        {"fmi2": "aarch64-linux", "fmi3": "aarch64-linux"},
        "so",
        lambda: (qemu(), "-L", str(SYSROOT)),
    ),
}
Run = Callable[..., str]

every_machine = pytest.mark.parametrize(
    "machine",
    [
        pytest.param("windows", marks=needs("Wine")),
        pytest.param("aarch64", marks=needs("QEMU", "C library of aarch64")),
    ],
)


@pytest.fixture(scope="module")
def wine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Environment variables of a Windows in a folder of its own, which runs until the end of the tests."""
    setting = prepare_wine(tmp_path_factory.mktemp("wine"))

    def call(*command: str) -> None:
        subprocess.run(
            command, env=os.environ | setting, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    if not unusable("Wine"):
        call("wineserver", "-p")
        call("wine", "wineboot", "--init")
    yield setting
    if not unusable("Wine"):
        call("wineserver", "-k")


@pytest.fixture(scope="module")
def run(native: Path, tmp_path_factory: pytest.TempPathFactory, wine: dict[str, str]) -> Run:
    """Function that runs a host with an FMU's library on a machine, and returns its output."""
    work = tmp_path_factory.mktemp("hosts")

    @cache
    def host(program: str, machine: str) -> Path:
        m = OTHERS.get(machine, HERE)
        file = work / f"{program}-{machine}.exe"
        include = Path(fmpy.__file__).parent / "c-code"
        compile_ = [sys.executable, "-m", "ziglang", "cc", "-target", m.target, "-std=gnu11", "-O2", "-s"]
        sources = [str(HOSTS / f"{program}.c"), "-I", str(include)]
        done = subprocess.run(
            [*compile_, *sources, *m.options, "-o", str(file)], capture_output=True, text=True, cwd=work
        )
        assert done.returncode == 0, done.stderr
        return file

    @cache
    def library(name: str, version: str, machine: str) -> Path:
        m = OTHERS.get(machine, HERE)
        folder = work / f"{name}-{version}-{machine}"
        with zipfile.ZipFile(native / version / f"{name}.fmu") as fmu:
            return Path(fmu.extract(f"binaries/{m.folders[version]}/{name}.{m.end}", folder))

    def go(program: str, machine: str, name: str, version: str, *arguments: object, points: str = "") -> str:
        m = OTHERS.get(machine, HERE)
        file = library(name, version, machine)
        description = read_model_description(str(native / version / f"{name}.fmu"))
        token = description.guid if version == "fmi2" else description.instantiationToken
        command = [*m.prefix(), host(program, machine), file, version[-1], token, *map(str, arguments)]
        for _ in range(3):  # a host says why it fails; Wine that does not come up says nothing
            done = subprocess.run(
                command,
                input=points,
                capture_output=True,
                text=True,
                timeout=300,
                cwd=file.parent,
                env=os.environ | wine,
            )
            if done.returncode == 0 or done.stdout or done.stderr or machine != "windows":
                break
        assert done.returncode == 0, done.stderr[-2000:]
        return done.stdout

    return go


@pytest.fixture(scope="module")
def run_sources(native: Path, tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Function that runs host and FMU sources as one program for aarch64, and returns its output."""
    work = tmp_path_factory.mktemp("linked")

    @cache
    def build(name: str) -> Path:
        folder = work / name
        for version in VERSIONS:  # which have all files but one in common
            with zipfile.ZipFile(native / version / f"{name}.fmu") as fmu:
                fmu.extractall(folder, [entry for entry in fmu.namelist() if entry.startswith("sources/")])
        hosts = [str(HOSTS / f"{unit}.c") for unit in ("run", "bare")]
        units = [str(file) for file in (folder / "sources").glob("*.c")]
        headers = ["-I", str(folder / "sources"), "-I", str(Path(fmpy.__file__).parent / "c-code")]
        out = folder / "program"
        command = [sys.executable, "-m", "ziglang", "cc", *BARE, *headers, *hosts, *units, "-o", str(out)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
        assert done.returncode == 0, done.stderr
        return out

    def go(name: str, version: str, *arguments: object, points: str) -> str:
        description = read_model_description(str(native / version / f"{name}.fmu"))
        token = description.guid if version == "fmi2" else description.instantiationToken
        done = subprocess.run(
            [qemu(), build(name), "-", version[-1], token, *map(str, arguments)],
            input=points,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        return done.stdout

    return go


def counts(model: Model) -> tuple[int, int, int]:
    return len(model.inputs), len(model.outputs), len(model.parameter_fields())


def points(model: Model, write: Callable[[float], str] = repr) -> str:
    """Lines of inputs: the ramped one along its ramp, the others with any sign and many magnitudes.

    write : text of a number
    """
    rng = np.random.default_rng(3)
    columns = [
        rng.uniform(0.0, model.ramp.end_value, POINTS)
        if v.name == model.ramp.input_name
        else v.nominal * 10.0 ** rng.uniform(-4.0, 0.0, POINTS) * rng.choice([-1.0, 1.0], POINTS)
        if not v.start
        else v.start * rng.uniform(0.9, 1.2, POINTS)
        for v in model.inputs
    ]
    return "\n".join(" ".join(map(write, map(float, line))) for line in zip(*columns, strict=True)) + "\n"


def bits(number: float) -> str:
    """The 64 bits of a number, in the format of the host."""
    return struct.pack(">d", number).hex()


def table(text: str) -> np.ndarray:
    """Numbers in the output of the host."""
    rows = [bytes.fromhex(line) for line in text.splitlines()]
    return np.array([np.frombuffer(row, ">f8") for row in rows])


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
@every_machine
def test_it_gives_the_numbers_of_linux(run: Run, machine: str, name: str, version: str) -> None:
    model = MODELS[name]
    inputs, outputs, _ = counts(model)
    found, expected = (
        table(run("run", m, name, version, inputs, outputs, points=points(model, bits)))
        for m in (machine, "here")
    )
    assert expected.shape == (POINTS, outputs)
    assert len(np.unique(expected, axis=0)) > POINTS / 2
    np.testing.assert_array_equal(found, expected)  # bit for bit


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("program", ["lifecycle", "modes", "refusals"])
@every_machine
def test_it_behaves_as_on_linux(run: Run, machine: str, program: str, version: str) -> None:
    """The runtime behaves alike; it is tested with the joint that starts fastest."""
    name = "HarmonicDriveCompliance"
    assert run(program, machine, name, version, *counts(MODELS[name])) == SAID[program]


@pytest.mark.parametrize("version", VERSIONS)
@every_machine
def test_instances_in_threads_do_not_see_each_other(run: Run, machine: str, version: str) -> None:
    model = MODELS["GearContact"]
    inputs, outputs, _ = counts(model)
    numbers = inputs, outputs, 1 + inputs + outputs  # the last: a parameter
    told = run("threads", machine, model.name, version, *numbers, points=points(model))
    assert told == f"8 threads, {POINTS * outputs} numbers each\n"


@needs("QEMU")
@pytest.mark.parametrize("name", MODELS)
def test_the_sources_give_the_numbers_of_linux(run: Run, run_sources: Run, name: str) -> None:
    model = MODELS[name]
    inputs, outputs, _ = counts(model)
    given = points(model, bits)
    for version in VERSIONS:
        found = table(run_sources(name, version, inputs, outputs, points=given))
        expected = table(run("run", "here", name, version, inputs, outputs, points=given))
        assert expected.shape == (POINTS, outputs)
        assert len(np.unique(expected, axis=0)) > POINTS / 2
        np.testing.assert_array_equal(found, expected)  # bit for bit
