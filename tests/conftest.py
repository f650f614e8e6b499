"""Fixtures of all tests. Random cases are the same in every run; FMUs are built once."""

import gc
import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache, partial, wraps
from hashlib import sha256
from pathlib import Path
from typing import Any

import clients
import pytest
from filelock import FileLock
from fmpy import platform_tuple
from hypothesis import settings
from jointfmu_fmu_src.native.compiled.cache import (
    COMPILER_CACHE_ENVIRONMENT_VARIABLE,
    compiled_model_folder,
    compiler_cache_folder,
)
from jointfmu_fmu_src.native.compiled.compiler import ZIG_TARGETS, compile_libraries
from jointfmu_tools.run.host import FmuInstance
from surroundings import Enter

from jointfmu.progress import STATUS_DELAY_ENVIRONMENT_VARIABLE

settings.register_profile("jointfmu", deadline=None, max_examples=60, derandomize=True)
settings.load_profile("jointfmu")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell's background job ignores it, and so would the commands that tests interrupt.
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Asserts are rewritten once, not by every process in every run, and commands start as they do for users.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of the processes of xdist, which share the cores
os.environ.setdefault(STATUS_DELAY_ENVIRONMENT_VARIABLE, "inf")  # standard error is compared
# tests without kept parts compile with a warm cache
os.environ.setdefault(COMPILER_CACHE_ENVIRONMENT_VARIABLE, str(compiler_cache_folder()))

HERE = Path(__file__).parent
RELEASED = ("-target", ZIG_TARGETS[platform_tuple], "-O2", "-s")
"""Options of zig with which FMUs are linked in tests. With others, zig first compiles its C runtime: 4 to 20
s."""
SLOW_FIXTURES = frozenset({"fmus", "native", "system_files", "elastic_joint", "tutorial", "site"})
"""Fixtures that build FMUs or run commands; fixtures such as `fmu` and `host` depend on them."""
LONGEST_FILES = frozenset(
    {
        "test_native_c.py",
        "test_native_values.py",
        "test_fmu_build.py",
        "test_elastic_sides.py",
        "test_systems.py",
    }
)
"""Test files that take about a minute; they start first, so that no process runs one alone at the end."""


RUN = "JOINTFMU_TEST_RUN"
"""Environment variable with the folder that the processes of one run of pytest share."""


def pytest_configure(config: pytest.Config) -> None:
    """Make the folder in which all processes of this run store the results of the client probes."""
    if RUN not in os.environ:
        os.environ[RUN] = tempfile.mkdtemp(prefix="jointfmu-tests-")
        config.add_cleanup(lambda: shutil.rmtree(os.environ.pop(RUN)))
    clients.share_results(Path(os.environ[RUN]))


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test whose clients are missing, before its fixtures are made."""
    clients.skip_without(*(name for mark in item.iter_markers("needs") for name in mark.args))


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Exclude the modules and tests that exist now from garbage collection, to save time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Iterator[None]:
    """Let every second process collect the files in reverse order.

    In a new clone, the processes then rewrite the asserts of different files, and read the rewritten files of
    the others.
    """
    report: Any = yield
    if isinstance(collector, pytest.Directory) and os.environ.get("PYTEST_XDIST_WORKER", "0")[-1] in "13579":
        report.result.reverse()
    return report


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark tests as slow that use a slow fixture. Other slow tests have the mark in their file.

    Files with slow tests run first, the longest of them at the start. Short tests then keep all processes
    busy until the end.
    """
    for item in items:
        if not SLOW_FIXTURES.isdisjoint(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.slow)
        for mark in item.iter_markers("needs"):
            clients.count_tests(mark.args)
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: (item.path not in slow, item.path.name not in LONGEST_FILES, item.path))


def warnings_but_shape(printed: dict[str, Any]) -> dict[str, Any]:
    """JSON of `jointfmu new` without the warning that Ra alone does not give the height distribution."""
    others = [line for line in printed["warnings"] if "alone does not state the height" not in line]
    return printed | {"warnings": others}


def refused_line(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """Function that runs `jointfmu` and returns the one line of its refusal: exit status 2, nothing on
    standard output."""
    from jointfmu_tools import cli

    try:
        status = cli.main([str(a) for a in arguments])
    except SystemExit as leave:
        status = int(str(leave.code))
    out, err = capsys.readouterr()
    assert (status, out) == (2, "")
    assert err.endswith("\n")
    assert err.count("\n") == 1, err
    return err


class Fmu(FmuInstance):
    """Instance of an FMU file with a clock, and access to its messages."""

    def __init__(self, path: Path, name: str = "test", exchange: bool = False, logging: bool = True) -> None:
        super().__init__(*unpack(path, path.stat().st_mtime_ns), name, exchange)
        self.outputs = [v.name for v in self.description.modelVariables if v.causality == "output"]
        self.time = 0.0
        native = self.description.modelExchange is not None
        self.error_statuses = (2, 3) if native else (3, 4)  # pythonfmu turns every exception into fatal
        two = self.version == 2
        self.read = self.fmu.getReal if two else self.fmu.getFloat64
        self.write = self.fmu.setReal if two else self.fmu.setFloat64
        self.instantiate(logging)

    def get(self, *names: str) -> dict[str, float]:
        """Outputs (default: all), inputs or parameters, all in one call."""
        names = names or tuple(self.outputs)
        return dict(zip(names, self.read([self.variables[n].valueReference for n in names]), strict=True))

    def enter_initialization(self, start: float = 0.0, stop: float | None = None) -> None:
        """Enter initialization mode."""
        super().enter_initialization(start, stop)
        self.time = start

    def start(self, values: Mapping[str, Any] | None = None) -> "Fmu":
        """Set start values in initialization mode, then leave this mode."""
        self.enter_initialization()
        self.set_values(values or {})
        self.fmu.exitInitializationMode()
        return self

    def step(self, size: float = 1.0) -> None:
        """Do one step."""
        self.do_step(self.time, size)
        self.time += size

    def at(self, values: Mapping[str, float]) -> dict[str, float]:
        """All outputs at the given inputs, without a step."""
        self.set_values(values)
        return self.get()

    def reset(self) -> None:
        """Reset to the state after instantiation."""
        self.fmu.reset()

    def refused(self, call: Callable[..., Any], *args: Any) -> str:
        """Execute a call that the FMU must refuse, and return the one error that it logs."""
        from fmpy.fmi1 import FMICallException

        seen = len(self.messages)
        with pytest.raises(FMICallException) as raised:
            call(*args)
        assert raised.value.status in self.error_statuses
        errors = [m for m in self.messages[seen:] if m.fmi_status in (2, 3)]
        assert len(errors) == 1, self.messages[seen:]
        assert errors[0].message_category == "logStatusError"
        assert "\n" not in errors[0].message_text
        return errors[0].message_text

    @property
    def warnings(self) -> list[str]:
        """Texts of all warnings so far."""
        return [m.message_text for m in self.messages if m.fmi_status == 1]


@cache
def unpack(path: Path, stamp: int) -> tuple[str, Any]:
    """Folder and model description of an unpacked FMU file; `stamp` distinguishes a rebuilt file from the old
    one."""
    from fmpy import extract, read_model_description

    folder = path.parent / f".{path.stem}-{stamp}-{os.getpid()}"  # no process unpacks over another's library
    return str(extract(str(path), str(folder))), read_model_description(str(path))


def run_host(script: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run a script in a process of its own, so that a crash does not end the tests. The script can import
    this file."""
    return subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (HERE, HERE / "support")))},
        capture_output=True,
        text=True,
        timeout=100,
    )


def run_client(script: str, tmp_path: Path, path: Path | str, **case: Any) -> Any:
    """Run the script of a client in a process of its own. The script reads a case from a file and writes its
    result.

    Standard output carries no result, because some clients print to it.
    """
    file = tmp_path / "case.json"
    file.write_text(json.dumps(case))
    done = run_host(script, file, path)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(file.read_text())


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Folder that `make` fills once for all test processes."""
    parallel = "PYTEST_XDIST_WORKER" in os.environ
    folder = (factory.getbasetemp().parent if parallel else factory.getbasetemp()) / name
    with FileLock(folder.with_suffix(".lock")):
        if not folder.exists():
            unfinished = folder.with_suffix(".part")
            shutil.rmtree(unfinished, ignore_errors=True)  # of an attempt that failed
            make(unfinished)
            unfinished.rename(folder)
    return folder


@contextmanager
def here_alone(versions: str = "23") -> Iterator[None]:
    """Build FMUs for this machine only; the fixture `native` has all platforms.

    Models that are compiled for all platforms are read from the cache. Models that are compiled here, for one
    platform, have a cache folder of their own. Commands build in this process, because worker processes
    would build for all platforms.

    versions : versions of FMI that are compiled
    """
    from jointfmu_fmu_src.native.compiled import compiled_models
    from jointfmu_tools.systems.fmu import build as system

    from jointfmu import progress

    places, read = compiled_models._list_candidate_cache_paths, compiled_models.unpack_compiled_model

    def places_here(name: str) -> tuple[Path, ...]:
        *others, last = places(name)
        return (
            *others,
            last,
            compiled_model_folder() / f"here{versions}" / last.relative_to(compiled_model_folder()),
        )

    def libraries_here(*files: Any, **options: Any) -> dict[str, bytes]:
        return compile_libraries(*files[:3], [platform_tuple], **options)

    def read_here(content: bytes) -> compiled_models.CompiledModel:
        part = read(content)
        return compiled_models.CompiledModel(
            part.source_texts,
            {
                v: {platform_tuple: built[platform_tuple]}
                for v, built in part.libraries_by_fmi_version.items()
            },
        )

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled_models, "FMI_VERSIONS", (*versions,))
        patch.setattr(compiled_models, "_list_candidate_cache_paths", places_here)
        patch.setattr(compiled_models, "unpack_compiled_model", read_here)
        patch.setattr(compiled_models, "compile_libraries", libraries_here)
        patch.setattr(system, "compile_libraries", libraries_here)
        patch.setattr(progress._WorkerPool, "map", staticmethod(map))
        yield


@pytest.fixture
def enter() -> Iterator[Enter]:
    """Function that enters a context for the rest of the test: `chdir`, and those of
    `tests/support/surroundings.py`."""
    with ExitStack() as stack:
        yield stack.enter_context


REFINEMENT = {"bodies": 0.5}
"""Refinement of the elements of plates in tests, for `jointfmu new`."""


@contextmanager
def refined_bodies() -> Iterator[None]:
    """Use the element sizes of the product instead of coarse ones, for tests of exact numbers."""
    REFINEMENT["bodies"], before = 1.0, REFINEMENT["bodies"]
    yield
    REFINEMENT["bodies"] = before


@pytest.fixture
def fine_elements(enter: Enter) -> None:
    """Elements of `refined_bodies`."""
    enter(refined_bodies())


@pytest.fixture
def few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Use few points for ramp and loops of an FMU's page, because a page of elastic plates takes 20 s."""
    from jointfmu_tools.pages.report import load_history
    from jointfmu_tools.run.ramps.loops import CyclicInputPath

    monkeypatch.setattr(load_history, "_RAMP_POINT_COUNT", 11)
    monkeypatch.setattr(load_history, "_LOAD_CYCLE", CyclicInputPath(points_per_cycle=8))


@pytest.fixture(scope="session", autouse=True)
def solved_once(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Share computed results between all test processes: bodies of equal plates (with doubled element size,
    unless `fine_elements`), patches of equal contacts, experiments of equal FMUs."""
    from jointfmu_fmu_src.proof import members
    from jointfmu_tools.inputs.fields import joint_parameters
    from jointfmu_tools.joints.bolted_joint.new import plate_finite_elements

    from jointfmu.joints.bolted_joint import joint
    from jointfmu.joints.model import Model
    from jointfmu.parameters import ParameterFile, format_parameter_file

    def once(what: str, real: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(real)
        def found(*asked: Any) -> Any:
            if sys.modules.get("gmsh", sys) is None:  # a test hides it
                return real(*asked)
            name = f"{what}-{sha256(pickle.dumps((asked, REFINEMENT))).hexdigest()[:16]}"
            folder = made_once(
                tmp_path_factory,
                name,
                lambda out: (out.mkdir(), (out / "found").write_bytes(pickle.dumps(real(*asked)))),
            )
            return pickle.loads((folder / "found").read_bytes())

        return found

    solve = plate_finite_elements.compute_joint
    solve_once = once("whole", solve)

    def whole(*asked: Any) -> Any:
        try:
            from jointfmu_tools.fem.whole_joint import JointFiniteElements
        except ImportError:  # a test hides a package
            return solve(*asked)
        own = not isinstance(vars(JointFiniteElements)["from_assembly"], classmethod)
        if own:  # a test has elements of its own
            return solve(*asked)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(
                JointFiniteElements,
                "from_assembly",
                partial(JointFiniteElements.from_assembly, refinement=REFINEMENT["bodies"]),
            )
            return solve_once(*asked)

    def experiments_of(model: Model, parameters: ParameterFile) -> Any:
        text = f"{model.name}\n{format_parameter_file(parameters)}"  # what the product keeps them by

        def make(out: Path) -> None:
            out.mkdir()
            (out / "found").write_bytes(pickle.dumps(tuple(compute_reference_experiments(model, parameters))))

        name = f"experiments-{sha256(text.encode()).hexdigest()[:16]}"
        return pickle.loads((made_once(tmp_path_factory, name, make) / "found").read_bytes())

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plate_finite_elements, "compute_joint", whole)
        for module in (joint, joint_parameters):
            patch.setattr(module, "reduce_patches", once("patches", module.reduce_patches))
        compute_reference_experiments = members.compute_reference_experiments
        patch.setattr(members, "compute_reference_experiments", experiments_of)
        yield


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with all FMUs of the default parameters."""
    from jointfmu_fmu_src.building import build_fmus

    return made_once(tmp_path_factory, "fmus", lambda out: build_fmus([], ["python"], None, out)) / "python"


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with fmi2/NAME.fmu and fmi3/NAME.fmu of the default parameters."""
    from jointfmu_fmu_src.building import build_fmus

    return made_once(tmp_path_factory, "native", lambda out: build_fmus([], ["fmi2", "fmi3"], None, out))


@pytest.fixture(scope="session")
def system_files(tmp_path_factory: pytest.TempPathFactory, native: Path) -> Path:
    """Folder with the files that `jointfmu build --systems` writes, and the drive with torque as input.

    FMUs that `native` does not have are for this machine alone.
    """
    from jointfmu_fmu_src.building import build_fmus
    from jointfmu_tools import cli

    def make(out: Path) -> None:
        with here_alone():
            build_fmus(["HarmonicDriveCompliance"], ["fmi2"], None, out)
            assert cli.main(["build", "--systems", "--out", str(out)]) == 0

    return made_once(tmp_path_factory, "systems", make)


@pytest.fixture(scope="session")
def elastic_joint(tmp_path_factory: pytest.TempPathFactory, solved_once: None) -> Path:
    """Folder with joint.toml (plate with four bolts and elastic sides) and its FMUs, in subfolders as in
    `native`.

    The FMUs are for this machine alone. Finite elements compute the sides: mark the test with needs("gmsh").
    """
    from jointfmu_fmu_src.building import build_fmus
    from jointfmu_tools import cli

    from jointfmu.parameters import load_parameter_file

    words = ["--plate", "80x80", "--bolts", "4xM8", "--at", "50x50", "--grip", "20"]
    words += ["--material", "steel", "--Ra", "0.8", "--embedding", "0", "--preload", "15000"]

    def make(out: Path) -> None:
        out.mkdir()
        file = out / "joint.toml"
        assert cli.main(["new", "bolted-joint", *words, "--out", str(file), "--json"]) == 0
        with here_alone():
            build_fmus(["BoltedJoint"], ["fmi2", "fmi3"], load_parameter_file(file), out)

    return made_once(tmp_path_factory, "elastic-joint", make)


@pytest.fixture
def fmu(fmus: Path) -> Iterator[Callable[..., Fmu]]:
    """Function that makes instances by name, by default of `fmus`; they are freed after the test."""
    made: list[Fmu] = []
    path = list(sys.path)

    def instance(name: str, folder: Path | None = None, instance_name: str = "test") -> Fmu:
        made.append(Fmu((folder or fmus) / f"{name}.fmu", instance_name))
        return made[-1]

    yield instance
    for one in made:
        one.free_instance()
    sys.path[:] = path  # pythonfmu puts the resources of every instance in front


@pytest.fixture
def fixed(tmp_path: Path, fmu: Callable[..., Fmu]) -> Callable[..., Fmu]:
    """Function as `fmu`, for FMUs with fixed instead of tunable parameters."""
    from jointfmu_fmu_src.building import build_fmus

    def instance(name: str) -> Fmu:
        path = tmp_path / "python" / f"{name}.fmu"
        if not path.exists():
            build_fmus([name], ["python"], None, tmp_path, "fixed")
        return fmu(name, folder=path.parent)

    return instance


@pytest.fixture(params=["fmi2", "fmi3"])
def version(request: pytest.FixtureRequest) -> str:
    """FMI version of each native flavour."""
    return str(request.param)


@pytest.fixture(params=[False, True], ids=["co-simulation", "model exchange"])
def exchange(request: pytest.FixtureRequest) -> bool:
    """Whether the interface is model exchange; both are tested."""
    return bool(request.param)


@pytest.fixture
def host(native: Path) -> Iterator[Callable[..., Fmu]]:
    """Function that makes instances of native FMUs by name, by default of `native`; they are freed after the
    test."""
    made: list[Fmu] = []

    def instance(name: str, version: str = "fmi3", folder: Path = native, **options: Any) -> Fmu:
        made.append(Fmu(folder / version / f"{name}.fmu", **options))
        return made[-1]

    yield instance
    for one in made:
        one.free_instance()
