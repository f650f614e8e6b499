"""C sources of all native FMUs: warnings of two compilers, sanitizers, order of calls, fuzzing.

The programs in tests/native/hosts drive both FMI versions of a joint. Joints of their own there test the
runtime alone: `dummy` has everything a joint without memory can have, `passthrough` the least, `slider` a
memory.
"""

import math
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from functools import cache
from graphlib import TopologicalSorter
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import fmpy
import pytest
from clients import needs
from conftest import RELEASED
from filelock import FileLock
from joint_cases import JOINTS
from jointfmu_fmu_src.native.code.generate import (
    RUNTIME_FOLDER,
    generate_sources,
    list_runtime_files,
    read_instantiation_token,
)
from jointfmu_fmu_src.native.compiled.compiler import ZIG_TARGETS
from jointfmu_fmu_src.native.compiled.compiler import _write_source_folder as source_folder
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import make_c_sources
from jointfmu_tools.systems.system import load_system
from natives import SAID

from jointfmu.joints import MODELS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file

pytestmark = pytest.mark.slow

HOSTS = Path(__file__).parent / "hosts"
FMI_HEADERS = Path(fmpy.__file__).parent / "c-code"
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion")
COMPILERS = {"gcc": ("gcc",), "clang": ("clang",), "zig": (sys.executable, "-m", "ziglang", "cc")}
"""{name: command} of compilers. The last one is zig's clang, which builds the FMUs."""
SANITIZERS = {
    "clang": "address,undefined,float-cast-overflow",
    "gcc": "address,undefined,float-cast-overflow",
    "zig": "undefined,float-cast-overflow",
}
"""Compilers with sanitizers, the first installed one is used. Zig has no runtime of the address sanitizer."""
PLAIN = {
    "gcc": ("-O2", "-fPIC"),  # which finds some faults only where it optimizes
    "zig": ("-O0", "-fPIC", "-fno-sanitize=all", "-target", ZIG_TARGETS[fmpy.platform_tuple]),
}
VERSIONS = ("2", "3")
OWN = {
    version: (place, fmpy.sharedLibraryExtension)
    for version, place in zip(VERSIONS, (fmpy.platform, fmpy.platform_tuple), strict=True)
}
"""{version: folder and suffix of the libraries for this machine}."""
FUZZ_CALLS = 100_000 // (len(MODELS) * len(VERSIONS))

SYSTEM = "robot_joint"
MUTATIONS = dict.fromkeys([*MODELS, SYSTEM], 2_000) | {
    name: 5_000 for name in MODELS if name.startswith("HarmonicDrive")
}
"""Number of changed serialized states of each version, the same in every run."""
ELASTIC = "BoltedJoint with elastic sides"
"""Name of the FMU of the fixture `elastic_joint`."""
CATALOGUE_DRIVE = "HarmonicDriveSpring of law catalogue"
"""Name of a drive as systems have it: with the law `catalogue`."""
ELASTIC_MUTATIONS = 300
"""Number of changed states of ELASTIC; one costs ten times as much as for BoltedJoint."""

FEW_PARTNERS = ("RotationalInertia", "TorqueProfile")
"""One partner FMU with states and one with time; the C of the others differs in the equations only."""
ALONE = {"dummy": (2, 3, 4), "passthrough": (2, 2, 1), "slider": (2, 3, 2)}
"""{joint of tests/native/hosts: numbers of inputs, outputs, parameters}."""
C_LIBRARY = {
    "calloc", "free", "memcpy", "memmove", "memset", "memcmp", "strlen", "strcmp", "strchr", "snprintf",
    "sqrt", "fabs", "fmin", "fmax", "floor", "ceil", "copysign",
    "pow",  # of zeros and infinities
    "bcmp", "memchr",  # clang's for comparisons with memcmp and strchr
}  # fmt: skip
"""Functions of the C library that an FMU may use: none for files, environment, locale, time or exit; of the
mathematical functions only exact ones, so that all machines give the same bits."""


def linking(compiler: str) -> tuple[str, ...]:
    """Options of a compiler for a program with its sanitizers."""
    return RELEASED if compiler == "zig" else sanitized(compiler)


def sanitized(compiler: str) -> tuple[str, ...]:
    """Options of a compiler for its sanitizers, which are inserted before optimization."""
    found = ("-O1", f"-fsanitize={SANITIZERS[compiler]}", "-fno-sanitize-recover=all")
    # Zig would compile its runtime first, 30 s: without one, the program ends by a signal, which says less.
    alone = (f"-fsanitize-trap={SANITIZERS[compiler]}", "-target", ZIG_TARGETS[fmpy.platform_tuple])
    return (*found, *alone) if compiler == "zig" else (*found, "-g1")


UNDEFINED = 0
"""Section number of an undefined symbol in ELF."""


class Sources(NamedTuple):
    """C sources of one joint, and the numbers that a host needs."""

    files: Mapping[str, str]
    inputs: int
    outputs: int
    parameters: int

    @property
    def arguments(self) -> tuple[str, ...]:
        """Token and layout on the command line of a host."""
        return (
            read_instantiation_token(dict(self.files)),
            str(self.inputs),
            str(self.outputs),
            str(self.parameters),
        )


ELASTIC_FILES: list[ParameterFile] = []
"""Parameter file of ELASTIC, filled by the first test that makes it."""


@cache
def c_of(name: str) -> Sources:
    """Sources of an FMU, or of the joint in a folder of tests/native/hosts."""
    if name in (ELASTIC, CATALOGUE_DRIVE):
        file = ELASTIC_FILES[0] if name == ELASTIC else load_default("harmonic_drive", "catalogue")
        model = MODELS[name.split()[0]].with_parameters(file.joint, file.values)
        files = generate_sources(model.name, file)
        return Sources(files, len(model.inputs), len(model.outputs), len(model.parameter_fields()))
    if model := (MODELS | PARTNERS).get(name):
        files = generate_sources(
            name, partner_parameters(name) if name in PARTNERS else load_default(model.joint)
        )
        return Sources(files, len(model.inputs), len(model.outputs), len(model.parameter_fields()))
    if name == SYSTEM:
        parts = assemble_system(load_system(name))
        counts = (
            len(parts.inputs),
            len(parts.outputs),
            sum(len(p.exposed_parameters) for p in parts.components),
        )
        return Sources(make_c_sources(parts)[0], *counts)
    files = {p.name: p.read_text() for p in [*list_runtime_files(), *(HOSTS / name).iterdir()]}
    return Sources(files, *ALONE[name])


def shipped(native: Path, name: str, version: str, out: Path, platform: str, suffix: str) -> Path:
    """Unpacked library of an FMU for a platform."""
    with zipfile.ZipFile(native / f"fmi{version}" / f"{name}.fmu") as fmu:
        return Path(fmu.extract(f"binaries/{platform}/{name}{suffix}", out))


def digest(value: object) -> str:
    """Digest of the `repr` of a value, the same in every process."""
    return sha256(repr(value).encode()).hexdigest()[:16]


class Builder:
    """Compiler of sources and hosts, each of them once.

    work : folder of hosts and programs
    kept : folder that stores the object files of joints, for later runs with equal sources
    """

    def __init__(self, work: Path, kept: Path) -> None:
        self.work, self.kept = work, kept
        self.objects, self.host, self.program = map(cache, (self._objects, self._host, self._program))

    def _objects(self, compiler: str, name: str, *options: str) -> list[Path]:
        """Object files of a joint; a warning is an error.

        Zig caches its own object files, if equal sources have equal paths.
        """
        files = c_of(name).files
        units = [file for file in files if file.endswith(".c")]
        command = (*COMPILERS[compiler], *STRICT, *options, "-isystem", str(FMI_HEADERS))
        if compiler == "zig":  # which compiles several files at a time into one only
            merged = self.work / f"{name}-{digest(options)}.o"
            self.call(source_folder(files), *command, "-r", *units, "-o", str(merged))
            return [merged]
        version = self.call(self.work, *COMPILERS[compiler], "--version")
        kind = f"{compiler}-{name}-{digest(options)}"
        folder = self.kept / f"{kind}-{digest((version, command, sorted(files.items())))}"
        with FileLock(self.kept / f"{kind}.lock"):
            if not folder.exists():
                for old in self.kept.glob(f"{kind}-*"):
                    shutil.rmtree(old)
                unfinished = folder.with_suffix(".part")
                unfinished.mkdir()
                for file, text in files.items():
                    (unfinished / file).write_text(text)
                self.call(unfinished, *command, "-c", *units)
                unfinished.rename(folder)
        return [folder / f"{Path(unit).stem}.o" for unit in units]

    def _host(self, compiler: str, program: str) -> Path:
        """Object file of a host that includes the FMU, with sanitizers."""
        out = self.work / f"{compiler}-{program}.o"
        source = str(HOSTS / f"{program}.c")
        options = (*STRICT, *sanitized(compiler), "-D_GNU_SOURCE", "-DLINKED", "-isystem", str(FMI_HEADERS))
        self.call(self.work, *COMPILERS[compiler], *options, "-c", source, "-o", str(out))
        return out

    def _program(self, compiler: str, program: str, name: str) -> Path:
        """Program of a host and a joint, with sanitizers."""
        objects = [self.host(compiler, program), *self.objects(compiler, name, *sanitized(compiler))]
        out = self.work / f"{compiler}-{program}-{name}"
        libraries = ("-lm", "-lpthread", "-o", str(out))
        self.call(self.work, *COMPILERS[compiler], *linking(compiler), *map(str, objects), *libraries)
        return out

    @staticmethod
    def call(folder: Path, *command: str) -> str:
        """Run a program and return its output; fails if a sanitizer reports a fault."""
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
        return done.stdout


@pytest.fixture(scope="module")
def builder(tmp_path_factory: pytest.TempPathFactory, pytestconfig: pytest.Config) -> Builder:
    work, cache = tmp_path_factory.mktemp("c"), getattr(pytestconfig, "cache", None)
    return Builder(work, cache.mkdir("objects") if cache else work)  # no cache with -p no:cacheprovider


@pytest.fixture(scope="module")
def sanitizing(builder: Builder) -> str:
    """Compiler that has its sanitizers."""
    probe = builder.work / "probe.c"
    probe.write_text("int main(void) { return 0; }\n")
    for compiler in SANITIZERS:
        command = [*COMPILERS[compiler], *linking(compiler), str(probe), "-o", str(probe.with_suffix(""))]
        if shutil.which(command[0]) and subprocess.run(command, capture_output=True).returncode == 0:
            return compiler
    pytest.fail("no compiler has its sanitizers")


def ramp_points(name: str, count: int) -> str:
    """Points along the joint's load ramp; other inputs are at their start value or near zero."""
    if name not in MODELS:
        return "\n".join(f"{0.1 * i} {0.2 * i}" for i in range(1, count))
    model = MODELS[name]
    rows = []
    for i in range(1, count):
        other = 1e-7 * math.sin(i)
        row = (
            model.ramp.end_value * i / count
            if v.name == model.ramp.input_name
            else v.start + (v.start == 0.0) * other
            for v in model.inputs
        )
        rows.append(" ".join(repr(x) for x in row))
    return "\n".join(rows)


every_joint = pytest.mark.parametrize("name", [*MODELS, *ALONE])
every_version = pytest.mark.parametrize("version", VERSIONS)


@pytest.mark.parametrize("name", [*MODELS, *FEW_PARTNERS, *ALONE, CATALOGUE_DRIVE, SYSTEM])
def test_no_warning(sanitizing: str, builder: Builder, name: str) -> None:
    """Warnings of clang, or of zig, which is clang; the objects are those of the tests below.

    The drive of the catalogue does not run there, and clang's warnings need no optimization.
    """
    compiled = ("zig", *PLAIN["zig"]) if name == CATALOGUE_DRIVE else (sanitizing, *sanitized(sanitizing))
    assert builder.objects(compiled[0], name, *compiled[1:])


@needs("gcc")
@pytest.mark.parametrize("name", ["BoltedJoint", "GearMesh", "HarmonicDriveSpring", CATALOGUE_DRIVE, SYSTEM])
def test_gcc_does_not_warn(builder: Builder, name: str) -> None:
    assert builder.objects("gcc", name, *PLAIN["gcc"])


def test_files_use_each_other_in_one_direction() -> None:
    """A .c file and its header count as one; joint_model.h only names the header of the joint."""
    uses: dict[str, set[str]] = {}
    for path in RUNTIME_FOLDER.rglob("*.[ch]"):
        found = set(re.findall(r'#include "(\w+)\.h"', path.read_text(encoding="utf-8")))
        uses.setdefault(path.stem, set()).update(found - {path.stem, "joint_model"})
    assert uses["fmi3"]
    tuple(TopologicalSorter(uses).static_order())  # raises CycleError


@pytest.mark.parametrize("name", MODELS)
def test_no_data_that_changes_and_little_of_the_c_library(native: Path, tmp_path: Path, name: str) -> None:
    import lief

    binary = lief.parse(str(shipped(native, name, "3", tmp_path, "x86_64-linux", ".so")))
    assert isinstance(binary, lief.ELF.Binary)
    sizes = {str(section.name): section.size for section in binary.sections}
    assert ".text" in sizes
    assert sizes.get(".data", 0) == sizes.get(".bss", 0) == 0
    outside = {str(symbol.name) for symbol in binary.symbols if symbol.name and symbol.shndx == UNDEFINED}
    assert "calloc" in outside
    assert outside <= C_LIBRARY
    files = c_of(name).files.items()
    assert {file for file, text in files if "calloc(" in text} == {"curve.c", "instance.c", "snapshot.c"}


@pytest.mark.parametrize("name", ["GearContact", "HarmonicDriveSpring", *ALONE])
@every_version
@pytest.mark.parametrize("program", ["lifecycle", "modes", "refusals"])
def test_in_order_and_out_of_order(
    sanitizing: str, builder: Builder, program: str, name: str, version: str
) -> None:
    """The runtime is tested with a joint without and a joint with history. All joints are fuzzed below, and
    simulated elsewhere without sanitizers."""
    run = builder.program(sanitizing, program, name)
    assert builder.call(builder.work, str(run), "", version, *c_of(name).arguments) == SAID[program]


@every_version
def test_behaviour(sanitizing: str, builder: Builder, version: str) -> None:
    run = builder.program(sanitizing, "behaviour", "dummy")
    found = builder.call(builder.work, str(run), "", version, c_of("dummy").arguments[0])
    assert found == "the dummy behaves\n"


@every_version
def test_memory(sanitizing: str, builder: Builder, version: str) -> None:
    run = builder.program(sanitizing, "memory", "slider")
    found = builder.call(builder.work, str(run), "", version, c_of("slider").arguments[0])
    assert found == "the slider remembers\n"


@every_version
@pytest.mark.parametrize("name", ["GearContact", "BoltedJoint", "passthrough"])
def test_threads(sanitizing: str, builder: Builder, name: str, version: str) -> None:
    """No joint has global data that change (test above); only the runtime could share data between
    threads."""
    c, reference = c_of(name), 1 + c_of(name).inputs + c_of(name).outputs
    if model := MODELS.get(name):
        reference += list(model.parameter_fields()).index(JOINTS[model.joint].scaled)
    command = [
        str(builder.program(sanitizing, "threads", name)),
        "",
        version,
        *c.arguments[:3],
        str(reference),
    ]
    count = 12 if name == "BoltedJoint" else 40  # whose step takes long
    done = subprocess.run(command, input=ramp_points(name, count), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"8 threads, {(count - 1) * c.outputs} numbers each\n"


@every_version
@pytest.mark.parametrize("name", [*MODELS, *FEW_PARTNERS])
def test_fuzz(sanitizing: str, builder: Builder, name: str, version: str) -> None:
    run = builder.program(sanitizing, "fuzz", name)
    counts = builder.call(builder.work, str(run), "", version, *c_of(name).arguments, "1", str(FUZZ_CALLS))
    ok, _, discarded, errors = (int(word) for word in counts.replace(",", "").split() if word.isdigit())
    assert min(ok, discarded + errors) > FUZZ_CALLS / 4  # neither all refused nor nothing


def check_mutations(builder: Builder, compiler: str, name: str, version: str, count: int) -> None:
    """Check that changed states of an FMU are refused, or used without a fault."""
    run = builder.program(compiler, "states", name)
    found = builder.call(builder.work, str(run), "", version, *c_of(name).arguments, "1", str(count))
    mutations, refused = (int(word) for word in found.replace(",", "").split() if word.isdigit())
    assert mutations == count
    assert mutations / 4 < refused < mutations  # neither all refused nor nothing


@every_version
@pytest.mark.parametrize("name", MUTATIONS)
def test_a_mutated_state_is_refused_or_used_without_harm(
    sanitizing: str, builder: Builder, name: str, version: str
) -> None:
    """A changed state with a correct checksum is refused, or used without a fault.

    The checksum protects against accidents only.
    """
    check_mutations(builder, sanitizing, name, version, MUTATIONS[name])


@needs("gmsh")
def test_a_mutated_state_of_elastic_sides_is_refused_or_used_without_harm(
    sanitizing: str, builder: Builder, elastic_joint: Path
) -> None:
    """A mutated state is refused or harmless in both FMI versions, whose states differ in their
    header only."""
    ELASTIC_FILES[:] = [load_parameter_file(elastic_joint / "joint.toml")]
    for version in VERSIONS:
        check_mutations(builder, sanitizing, ELASTIC, version, ELASTIC_MUTATIONS)


@every_joint
def test_a_library_exports_all_and_leaves_nothing_behind(
    builder: Builder, native: Path, tmp_path: Path, name: str
) -> None:
    """The library is loaded at run time as by hosts, without sanitizers, whose allocator would hide leaks."""
    zig, host, library = COMPILERS["zig"], builder.work / "lifecycle", tmp_path / f"{name}.so"
    if name not in MODELS:
        objects = map(str, builder.objects("zig", name, *PLAIN["zig"]))
        builder.call(builder.work, *zig, *RELEASED, "-shared", *objects, "-lm", "-o", str(library))
    if not host.exists():
        found = ("-D_GNU_SOURCE", "-isystem", str(FMI_HEADERS), "-ldl", "-lm")
        options = (*STRICT, *RELEASED, "-fno-sanitize=all", *found)
        builder.call(builder.work, *zig, str(HOSTS / "lifecycle.c"), *options, "-o", str(host))
    for version in VERSIONS:
        if name in MODELS:
            library = shipped(native, name, version, tmp_path, *OWN[version])
        found = builder.call(builder.work, str(host), str(library), version, *c_of(name).arguments)
        assert found == SAID["lifecycle"]
