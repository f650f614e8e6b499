"""Binaries of native FMUs for five platforms: exports, dependencies, reproducibility, error messages.

macOS binaries cannot run here; their load commands and signatures are checked instead.
"""

import re
import struct
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

import fmpy
import pytest
from conftest import run_host
from jointfmu_fmu_src.building import build_fmus
from jointfmu_fmu_src.native.compiled import compiler
from surroundings import Enter, environment, missing_package

from jointfmu.joints import MODELS

pytestmark = pytest.mark.slow

VERSIONS = ("fmi2", "fmi3")
BINARIES = {
    "fmi2": {
        "win64": "dll",
        "linux64": "so",
        "aarch64-linux": "so",
        "darwin64": "dylib",
    },
    "fmi3": {
        "x86_64-windows": "dll",
        "x86_64-linux": "so",
        "aarch64-linux": "so",
        "x86_64-darwin": "dylib",
        "aarch64-darwin": "dylib",
    },
}
LARGEST_FMU = 620_000
"""Size limit of an FMU [bytes]; the experiments inside are less than a tenth of it."""
SYSTEM_DLL = re.compile(r"api-ms-win-crt-[a-z]+-l1-1-0\.dll|kernel32\.dll", re.IGNORECASE)
LINKER_MADE = {"__mh_dylib_header", "___dso_handle"}
"""Symbols that zig's linker adds to every macOS library."""


def members(fmu: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def binaries(native: Path, version: str) -> Iterator[tuple[str, bytes]]:
    """(path, content) of every binary of all FMUs of a version."""
    for name in MODELS:
        for path, content in members(native / version / f"{name}.fmu").items():
            if path.startswith("binaries/"):
                yield f"{name}: {path}", content


def images(content: bytes) -> Iterator[Any]:
    """Libraries in a file (several in a universal file). lief, which frees them with the iterator, is
    imported here because its import takes half a second."""
    import lief

    lief.logging.disable()
    if lief.is_macho(list(content)):
        file = lief.MachO.parse(list(content))
        yield from file
    else:
        yield lief.parse(list(content))


def exported(image: Any) -> set[str]:
    import lief

    if isinstance(image, lief.PE.Binary):
        return {entry.name for entry in image.get_export().entries}
    if isinstance(image, lief.MachO.Binary):
        return {e.symbol.name for e in image.dyld_info.exports} - LINKER_MADE
    return {s.name for s in image.exported_symbols}


OWN_FUNCTIONS: dict[str, set[str]] = {"fmi2": set(), "fmi3": {"jointfmu_follow_path"}}
"""{version: functions exported in addition to the standard}."""


def declared(version: str) -> set[str]:
    """Names of all functions of fmi2Functions.h or fmi3Functions.h."""
    header = Path(fmpy.__file__).parent / "c-code" / f"{version}Functions.h"
    return set(re.findall(rf"^\s*FMI\d_Export\s+\w+\s+({version}\w+);", header.read_text(), re.MULTILINE))


@pytest.mark.parametrize("version", VERSIONS)
def test_every_platform_is_there(native: Path, version: str) -> None:
    for name in MODELS:
        found = {path for path in members(native / version / f"{name}.fmu") if path.startswith("binaries/")}
        assert found == {f"binaries/{folder}/{name}.{end}" for folder, end in BINARIES[version].items()}


@pytest.mark.parametrize("version", VERSIONS)
def test_each_exports_every_function_of_the_standard_and_nothing_else(native: Path, version: str) -> None:
    import lief

    functions = declared(version)
    assert len(functions) == {"fmi2": 44, "fmi3": 75}[version]
    for path, content in binaries(native, version):
        for image in images(content):
            prefix = "_" if isinstance(image, lief.MachO.Binary) else ""
            assert exported(image) == {prefix + f for f in functions | OWN_FUNCTIONS[version]}, path


@pytest.mark.parametrize("platform", compiler.ZIG_TARGETS)
def test_no_static_library_of_the_compiler_is_linked_in(platform: str, tmp_path: Path) -> None:
    """Only the FMU's own objects and stubs of the system are linked, so the list of licences is complete."""
    source = "#include <math.h>\nint run(double x);\nint run(double x) { return sin(x) > 0.5; }\n"
    (tmp_path / "run.c").write_text(source)
    own = Path(compiler.__file__).with_name("windows.c")
    (tmp_path / own.name).write_bytes(own.read_bytes())
    options = [option for option in compiler._make_compiler_options(platform, "run") if option != "-s"]
    command = [sys.executable, "-m", "ziglang", "cc", *options, "run.c", "-v", "-o", "run.bin"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=300)
    linked = [x for x in done.stderr.splitlines() if re.match(r"(zig ld|ld\.lld|lld-link) ", x)]
    (line,) = [
        x for x in linked if "run.bin" in x
    ]  # with an empty cache, zig also links stubs of the C library
    inputs = {re.split(r"[/\\]", word)[-1] for word in line.split() if re.search(r"^[^-].*\.(a|lib)$", word)}
    stubs = {f"api-ms-win-crt-{part}-l1-1-0.lib" for part in compiler._UCRT_LIBRARIES}
    assert inputs <= stubs | {"libc_nonshared.a"}
    if platform.endswith("-linux"):  # the one archive with code, of which nothing is taken
        import lief

        image = lief.parse((tmp_path / "run.bin").as_posix())
        ours = {s.name for s in image.symbols if s.value and s.type == lief.ELF.Symbol.TYPE.FUNC}
        assert ours <= {"run"}


@pytest.mark.parametrize("version", VERSIONS)
def test_linux_needs_the_c_runtime_of_glibc_2_17_alone(native: Path, version: str) -> None:
    import lief

    seen = set()
    for path, content in binaries(native, version):
        if not path.endswith(".so"):
            continue
        image = lief.parse(list(content))
        seen.add(image.header.machine_type)
        assert set(image.libraries) <= {"libc.so.6", "libm.so.6"}, path
        needed = [v.name for r in image.symbols_version_requirement for v in r.get_auxiliary_symbols()]
        versions = [tuple(map(int, v.removeprefix("GLIBC_").split("."))) for v in needed]
        assert versions, path
        assert max(versions) <= (2, 17), path
        assert not [s.name for s in image.symtab_symbols], f"{path} is not stripped"
    assert seen == {lief.ELF.ARCH.X86_64, lief.ELF.ARCH.AARCH64}


@pytest.mark.parametrize("version", VERSIONS)
def test_windows_needs_the_c_runtime_of_the_system_alone(native: Path, version: str) -> None:
    import lief

    for path, content in binaries(native, version):
        if not path.endswith(".dll"):
            continue
        image = lief.parse(list(content))
        assert image.header.machine == lief.PE.Header.MACHINE_TYPES.AMD64
        assert [i.name for i in image.imports if not SYSTEM_DLL.fullmatch(i.name)] == [], path
        assert image.get_export().name == Path(path).name
        assert not image.has_tls
        assert not [s for s in image.sections if s.name.startswith(".debug")]
        assert b".pdb" not in content


@pytest.mark.parametrize("version", VERSIONS)
def test_macos_11_and_newer_can_load_it(native: Path, version: str) -> None:
    import lief

    cpu, seen = lief.MachO.Header.CPU_TYPE, []
    for path, content in binaries(native, version):
        if not path.endswith(".dylib"):
            continue
        for image in images(content):
            seen.append(image.header.cpu_type)
            assert image.header.file_type == lief.MachO.Header.FILE_TYPE.DYLIB, path
            assert tuple(image.build_version.minos) == (11, 0, 0), path
            found = {(c.command, c.name) for c in image.libraries}
            kinds = lief.MachO.LoadCommand.TYPE
            assert found == {
                (kinds.ID_DYLIB, f"@rpath/{Path(path).name}"),
                (kinds.LOAD_DYLIB, "/usr/lib/libSystem.B.dylib"),
            }, path
            if image.header.cpu_type == cpu.ARM64:
                signed = bytes(content[image.fat_offset :])
                check_signature(signed, image.code_signature.data_offset)
    assert sorted(map(str, seen)) == sorted(map(str, [cpu.X86_64, cpu.ARM64] * len(MODELS)))


def check_signature(library: bytes, at: int) -> None:
    """Assert the ad-hoc signature that arm64 requires: a digest of every page before it."""
    _, _, blobs = struct.unpack_from(">III", library, at)
    offsets = dict(struct.unpack_from(">II", library, at + 12 + 8 * i) for i in range(blobs))
    start = at + offsets[0]
    magic, _, _, flags, digests = struct.unpack_from(">IIIII", library, start)
    pages, limit, size, kind, _, page = struct.unpack_from(">IIBBBB", library, start + 28)
    assert (magic, flags & 2, size, kind, limit) == (0xFADE0C02, 2, 32, 2, at)
    for i in range(pages):
        content = library[i << page : min((i + 1) << page, limit)]
        digest = start + digests + 32 * i
        assert library[digest : digest + 32] == sha256(content).digest()


def test_a_universal_file_holds_the_libraries_unchanged(native: Path) -> None:
    for name in MODELS:
        content = members(native / "fmi2" / f"{name}.fmu")[f"binaries/darwin64/{name}.dylib"]
        magic, count = struct.unpack_from(">II", content)
        assert (magic, count) == (0xCAFEBABE, 2)
        for i, kind in enumerate((0x01000007, 0x0100000C)):
            cpu, _, offset, size, align = struct.unpack_from(">IIIII", content, 8 + 20 * i)
            assert cpu == kind
            assert offset % (1 << align) == 0
            assert offset + size <= len(content)
            assert content[offset : offset + 8] == struct.pack("<II", 0xFEEDFACF, kind)


def test_no_fmu_is_large(native: Path) -> None:
    sizes = {f"{v}/{n}": (native / v / f"{n}.fmu").stat().st_size for v in VERSIONS for n in MODELS}
    assert {name: size for name, size in sizes.items() if size > LARGEST_FMU} == {}


def test_another_process_with_a_cold_cache_builds_the_same_bytes(
    native: Path, tmp_path: Path, enter: Enter
) -> None:
    """One FMU of FMI 3.0, which contains the whole runtime except one file; equality of the sources of all
    FMUs is tested in test_native_description.py."""
    name, version = "GearContact", "fmi3"
    enter(environment(ZIG_GLOBAL_CACHE_DIR=str(tmp_path / "cold cache")))
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    enter(environment(PYTHONHASHSEED="7"))
    script = "import sys; from jointfmu_tools import cli; sys.exit(cli.main(sys.argv[1:]))"
    done = run_host(script, "build", name, "--flavour", version, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    first, again = (folder / version / f"{name}.fmu" for folder in (native, tmp_path / "out"))
    one, two = members(first), members(again)
    assert [member for member in one | two if one.get(member) != two.get(member)] == []
    assert first.read_bytes() == again.read_bytes()


@pytest.mark.parametrize("version", VERSIONS)
def test_no_path_of_this_machine_is_inside(native: Path, version: str) -> None:
    here = (Path.home(), Path(compiler.__file__).parent, Path(fmpy.__file__).parent, "/.cache/")
    for path, content in binaries(native, version):
        assert [p for p in here if str(p).encode() in content] == [], path


# What fails

WITHOUT_PACKAGE = """
import sys
from jointfmu_tools import cli

sys.modules[sys.argv[1]] = None
sys.exit(cli.main(["build", "GearContact", "--flavour", "fmi2", "--out", sys.argv[2]]))
"""

SOURCES = {"good.c": "int good(void);\nint good(void) { return 1; }\n"}


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("int f(void) { return x; }\n", "bad.c:1:22: error: use of undeclared identifier 'x'"),
        ('#include "missing.h"\n', "bad.c:1:10: fatal error: 'missing.h' file not found"),
        ('#include "fmi2Functions.h"\nvoid g(void);\nvoid f(void) { g(); }\n', "undefined symbol: g"),
    ],
)
def test_what_does_not_compile_is_named_in_one_line(text: str, part: str) -> None:
    text = text.replace("void f(", '__attribute__((visibility("default"))) void f(')
    with pytest.raises(RuntimeError, match=r"^Bad for [a-z0-9_-]+: [^\n]*$") as raised:
        compiler.compile_libraries("Bad", SOURCES | {"bad.c": text}, ["good.c", "bad.c"])
    assert part in str(raised.value)


def test_every_processor_of_its_kind_can_run_it() -> None:
    """The compiler may use AVX only in functions that `simd.h` selects when the FMU runs."""
    text = '#ifdef __AVX__\n#error "code needs AVX"\n#endif\n'
    platforms = [name for name in compiler.ZIG_TARGETS if name.startswith("x86_64")]
    made = compiler.compile_libraries("Avx", SOURCES | {"avx.c": text}, ["good.c", "avx.c"], platforms)
    assert made.keys() == set(platforms) == {"x86_64-linux", "x86_64-windows", "x86_64-darwin"}


@pytest.mark.parametrize("package", ["ziglang", "casadi"])
def test_a_missing_package_is_one_line_that_says_what_to_install(
    tmp_path: Path, package: str, enter: Enter
) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    done = run_host(WITHOUT_PACKAGE, package, tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert package in done.stderr
    assert "pip install 'jointfmu[build]'" in done.stderr
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == []


def test_an_fmu_survives_a_failed_build(tmp_path: Path, enter: Enter) -> None:
    (built,) = build_fmus(["GearContact"], ["fmi3"], None, tmp_path)
    before = built.read_bytes()

    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    enter(missing_package("ziglang"))
    with pytest.raises(ImportError, match="ziglang"):
        build_fmus(["GearContact"], ["fmi3"], None, tmp_path)
    assert sorted(tmp_path.rglob("*")) == [built.parent, built]
    assert built.read_bytes() == before


def test_an_unwritable_place_is_refused_before_anything_is_compiled(tmp_path: Path, enter: Enter) -> None:
    (tmp_path / "file").write_text("mine")
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    enter(missing_package("ziglang"))
    with pytest.raises(ValueError, match="cannot be written") as raised:
        build_fmus(["GearContact"], ["fmi2"], None, tmp_path / "file" / "below")
    assert "\n" not in str(raised.value)
    assert (tmp_path / "file").read_text() == "mine"


def test_an_unwritable_cache_is_refused_by_name(tmp_path: Path, enter: Enter) -> None:
    (tmp_path / "file").write_text("mine")
    enter(environment(ZIG_GLOBAL_CACHE_DIR=str(tmp_path / "file" / "below")))
    with pytest.raises(ValueError, match="ZIG_GLOBAL_CACHE_DIR to a writable folder") as raised:
        compiler.compile_libraries("Good", SOURCES, ["good.c"])
    assert str(tmp_path) in str(raised.value)
    assert "\n" not in str(raised.value)
