"""Build of FMUs: its files, its error messages, and that a failed build leaves nothing behind."""

import csv
import io
import json
import os
import re
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from contextlib import redirect_stdout, suppress
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from shutil import copy, copytree, ignore_patterns
from subprocess import PIPE
from typing import Any, NamedTuple

import pytest
import pythonfmu
from browser import browser
from clients import needs
from conftest import here_alone, refused_line, run_host
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from jointfmu_fmu_src.building import FLAVOUR_BUILDERS, build_fmus
from jointfmu_fmu_src.native.code import generate
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_tools import cli
from jointfmu_tools.cli import pipeline
from jointfmu_tools.pages.report.page import write_report
from jointfmu_tools.run.ramps import ramp
from jointfmu_tools.studies import checks
from jointfmu_tools.studies.published import validation
from jointfmu_tools.systems import system as systems
from natives import VERSIONS
from proofs import BOTH, MEASURED
from proofs import copy as changed_copy
from pythonfmu import FmuBuilder
from surroundings import Enter, environment, missing_package

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import format_parameter_file, load_default

pytestmark = pytest.mark.slow

Capture = pytest.CaptureFixture[str]
NAMES = list(MODELS)


def everything(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*"))


@pytest.fixture
def gear_file(tmp_path: Path) -> Path:
    path = tmp_path / "my gear.toml"
    path.write_text(
        format_parameter_file(load_default("gear_contact").with_values({"e": 0.3}, "user", "test"))
    )
    return path


# What comes out


def test_fixed_parameters_run_as_tunable_ones(tmp_path: Path, native: Path, fmus: Path) -> None:
    found = {}
    asked = ["--flavour", *FLAVOUR_BUILDERS, "--parameters", "fixed", "--out", str(tmp_path)]
    with here_alone():
        assert cli.main(["build", "GearContact", *asked]) == 0
    folders = dict.fromkeys(VERSIONS, native) | {"python": fmus.parent}
    for said in ("fixed", "tunable"):
        for version in FLAVOUR_BUILDERS:
            path = (tmp_path if said == "fixed" else folders[version]) / version / "GearContact.fmu"
            assert validate_fmu(str(path)) == []
            variables = read_model_description(str(path)).modelVariables
            assert {v.variability for v in variables if v.causality == "parameter"} == {said}
            found[said, version] = ramp.run_ramp(path, "f", 1e3, 250.0, {"e": 0.3}).format_time_series_csv()
    assert len({found[said, "fmi2"] for said in ("fixed", "tunable")}) == 1
    for version in FLAVOUR_BUILDERS:
        assert found["fixed", version] == found["tunable", version]


def test_the_command_builds_what_it_is_asked_for(tmp_path: Path, gear_file: Path, capsys: Capture) -> None:
    out = tmp_path / "out with spaces äö"
    arguments = ["build", "GearContact", "--flavour", "python", "--params", str(gear_file), "--out", str(out)]
    assert cli.main(arguments) == 0
    built = out / "python" / "GearContact.fmu"
    assert capsys.readouterr().out == f"built {built}\n"
    assert [p for p in everything(out) if p.is_file()] == [built]
    start = {v.name: v.start for v in read_model_description(str(built)).modelVariables}
    assert float(start["e"]) == 0.3
    assert ramp.run_ramp(built, "f", 100.0, 100.0).variable_columns["K_N"][-1] > 0.0


def test_a_second_build_says_what_it_replaces(tmp_path: Path, capsys: Capture) -> None:
    other = tmp_path / "other.toml"
    other.write_text(
        format_parameter_file(load_default("gear_contact").with_values({"e": 0.3}, "user", "test"))
    )
    build = ["build", "GearContact", "--flavour", "python", "--out", str(tmp_path)]
    fmu = tmp_path / "python" / "GearContact.fmu"
    (tmp_path / "python").mkdir()
    (tmp_path / "python" / "mine.fmu").write_text("no FMU")
    assert cli.main(build) == 0
    assert "replaced" not in capsys.readouterr().err
    assert cli.main([*build, "--params", str(other)]) == 0
    was = load_default("gear_contact").values_by_name["e"]
    assert f"replaced {fmu}: e was {was}, is 0.3\n" in capsys.readouterr().err
    assert cli.main([*build, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["replaced"] == {str(fmu): {"e": ["0.3", str(was)]}}


def test_json_lists_what_was_built(tmp_path: Path, capsys: Capture) -> None:
    status = cli.main(["build", "GearContact", "--flavour", "python", "--out", str(tmp_path), "--json"])
    assert status == 0
    found = json.loads(capsys.readouterr().out)
    assert found["built"] == [str(tmp_path / "python" / "GearContact.fmu")]
    assert found.keys() == {"built", "replaced", "joints"}
    assert found["joints"]["gear_contact"].keys() == {"level", "warnings"}


def test_a_parameter_file_without_names_builds_the_fmus_of_its_joint(tmp_path: Path) -> None:
    built = build_fmus([], ["python"], load_default("harmonic_drive"), tmp_path)
    assert {p.stem for p in built} == {"HarmonicDriveSpring", "HarmonicDriveCompliance"}


def test_a_second_build_replaces_the_first(tmp_path: Path) -> None:
    (first,) = build_fmus(["GearContact"], ["python"], None, tmp_path)
    before = read_model_description(str(first)).guid
    changed = load_default("gear_contact").with_values({"e": 0.25}, "user", "test")
    (second,) = build_fmus(["GearContact"], ["python"], changed, tmp_path)
    assert second == first
    assert read_model_description(str(second)).guid != before
    assert [p.name for p in (tmp_path / "python").iterdir()] == ["GearContact.fmu"]


def test_an_fmu_starts_with_the_inputs_of_its_parameter_file(tmp_path: Path) -> None:
    """All flavours list the start values, start with them, and state them on the page."""
    file = replace(load_default("bolted_joint"), inputs={"preload": 9e3})
    model = MODELS["BoltedJoint"]
    loaded = model.evaluate(
        model.tabulate(file.values), {v.name: file.start_value(v.name) for v in model.inputs}
    )
    for path in build_fmus([model.name], ["fmi3", "python"], file, tmp_path):
        variables = read_model_description(str(path)).modelVariables
        start = {v.name: float(v.start) for v in variables if v.causality == "input"}
        assert start == {v.name: file.start_value(v.name) for v in model.inputs}
        assert start["preload"] == 9e3
        for settings, expected in (({}, float(loaded["K_zz"])), ({"preload": 0.0}, 0.0)):
            found = ramp.run_ramp(path, "s_rel_z", 1e-9, 1e-9, settings).variable_columns["K_zz"][0]
            assert found == pytest.approx(expected, rel=1e-10)  # as C and Python agree elsewhere
    with zipfile.ZipFile(tmp_path / "python" / f"{model.name}.fmu") as archive:
        for owner, file in (("jointfmu", "license"), ("NTNU", "pythonfmu")):
            assert owner in archive.read(f"documentation/licenses/{file}.txt").decode()
    with zipfile.ZipFile(tmp_path / "fmi3" / f"{model.name}.fmu") as archive:
        page = archive.read("documentation/index.html").decode()
    assert "preload of each bolt (bolt force at tightening); at least 0; starts at 9000<" in page
    assert "all other inputs at their start values." in page


def test_a_build_leaves_the_process_as_it_was(tmp_path: Path) -> None:
    build_fmus(["GearContact"], ["python"], None, tmp_path)  # what building itself imports is there now
    before = (
        list(sys.path),
        set(sys.modules),
        dict(os.environ),
        Path.cwd(),
    )
    changed = load_default("gear_contact").with_values({"e": 0.25}, "user", "test")
    build_fmus(["GearContact"], ["python"], changed, tmp_path)
    after = (
        list(sys.path),
        set(sys.modules),
        dict(os.environ),
        Path.cwd(),
    )
    assert after == before


BESIDE_AN_INSTANCE = """
import sys
from pathlib import Path
from conftest import Fmu
instance = Fmu(Path(sys.argv[1])).start()
import pythonfmu
assert not list(Path(pythonfmu.__file__).parent.rglob("binaries")), "the FMU has brought no copy"
from jointfmu_fmu_src.building import build_fmus
path, own = list(sys.path), pythonfmu.__file__
build_fmus(["GearContact"], ["python"], None, Path(sys.argv[2]))
assert (sys.path, sys.modules["pythonfmu"].__file__) == (path, own)
instance.at({"f": 1.0})
instance.free_instance()
"""


def test_a_process_in_which_a_python_fmu_runs_builds_the_same(fmus: Path, tmp_path: Path) -> None:
    """The built files are equal, although the process has imported an FMU's copy of pythonfmu."""
    done = run_host(BESIDE_AN_INSTANCE, fmus / "GearContact.fmu", tmp_path)
    assert done.returncode == 0, done.stderr
    built = tmp_path / "python" / "GearContact.fmu"
    contents = []
    for path in (built, fmus / "GearContact.fmu"):
        with zipfile.ZipFile(path) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
        del files["modelDescription.xml"]  # pythonfmu puts the date into it
        contents.append(files)
    assert contents[0] == contents[1]
    assert any(name.startswith("binaries/") for name in contents[0])


# Refusals


@pytest.mark.parametrize(
    ("names", "flavours", "joint", "parts"),
    [
        (["Gearbox"], ["python"], None, ["'Gearbox'", *NAMES]),
        (["GearContact", "Gearbox"], ["python"], None, ["'Gearbox'"]),
        (["GearContact"], ["fmi7"], None, ["'fmi7'", *FLAVOUR_BUILDERS]),
        (["GearContact"], ["python", "fmi7"], None, ["'fmi7'"]),
        (["GearContact"], ["python"], "bolted_joint", ["GearContact", "'bolted_joint'", "'gear_contact'"]),
        (["BoltedJoint", "GearContact"], ["python"], "bolted_joint", ["GearContact", "'bolted_joint'"]),
    ],
)
def test_bad_choices_are_refused_before_anything_is_built(
    tmp_path: Path,
    capsys: Capture,
    names: list[str],
    flavours: list[str],
    joint: str | None,
    parts: list[str],
) -> None:
    parameters = load_default(joint) if joint else None
    with pytest.raises(ValueError, match=re.escape(parts[0])):
        build_fmus(names, flavours, parameters, tmp_path / "out")
    arguments = ["build", *names, "--flavour", *flavours, "--out", tmp_path / "out"]
    if parameters:
        (tmp_path / "file.toml").write_text(format_parameter_file(parameters))
        arguments += ["--params", tmp_path / "file.toml"]
    line = refused_line(capsys, *arguments)
    assert [p for p in parts if p not in line] == []
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (None, "No such file"),
        ("", "schema"),
        ("schema = 1\njoint = [", "TOML"),
        ('schema = 1\njoint = "gearbox"\n', "'gearbox'"),
        ("{good}\nextra = 1\n", "extra"),
        ("{bad}", "e = 1.3 is outside [0, 1)"),
    ],
)
def test_bad_parameter_files_are_refused(
    tmp_path: Path, capsys: Capture, gear_file: Path, text: str | None, part: str
) -> None:
    path, good = tmp_path / "file.toml", gear_file.read_text()
    bad = good.replace("value = 0.3,", "value = 1.3,")
    if text is not None:
        path.write_text(text.replace("{good}", good).replace("{bad}", bad))
    line = refused_line(capsys, "build", "--params", path, "--out", tmp_path / "out")
    assert str(path) in line
    assert part in line
    assert not (tmp_path / "out").exists()


def test_an_unwritable_place_is_refused(tmp_path: Path, capsys: Capture) -> None:
    file = tmp_path / "file"
    file.write_text("mine")
    out = file / "below"
    with pytest.raises(ValueError, match="cannot be written") as raised:
        build_fmus(["GearContact"], ["python"], None, out)
    assert str(out) in str(raised.value)
    assert "\n" not in str(raised.value)
    line = refused_line(capsys, "build", "GearContact", "--flavour", "python", "--out", out)
    assert str(out) in line
    assert everything(tmp_path) == [file]
    assert file.read_text() == "mine"


def test_a_python_fmu_without_its_libraries_is_refused(
    tmp_path: Path,
) -> None:
    copy = tmp_path / "broken"
    installed = Path(pythonfmu.__file__).parent
    copytree(installed, copy / "pythonfmu", ignore=ignore_patterns("binaries"))
    (metadata,) = installed.parent.glob("pythonfmu-*.dist-info")
    copytree(metadata, copy / metadata.name)
    words = ["build", "GearContact", "--flavour", "python", "--out", str(tmp_path / "out")]
    with environment(PYTHONPATH=str(copy)):
        command = [sys.executable, "-m", "jointfmu", *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=100)
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert f"pythonfmu in {copy} has no libraries" in line
    assert not (tmp_path / "out").exists()


def test_ctrl_c_ends_a_build_after_code_that_swallows_it(
    tmp_path: Path, enter: Enter, monkeypatch: pytest.MonkeyPatch
) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))

    def swallowing(*_: object) -> dict[str, str]:
        with suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        return {}

    monkeypatch.setattr(generate, "generate_sources_without_data", swallowing)
    with pytest.raises(KeyboardInterrupt):
        build_fmus(["GearContact"], ["fmi3"], None, tmp_path / "new")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert everything(tmp_path) == []


def test_a_refused_build_leaves_no_folder(tmp_path: Path, capsys: Capture, enter: Enter) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    enter(missing_package("ziglang"))
    line = refused_line(capsys, "build", "GearContact", "--out", tmp_path / "new" / "dist")
    assert "the package ziglang is missing" in line
    assert everything(tmp_path) == []


def test_a_folder_in_the_place_of_the_fmu_is_refused(tmp_path: Path) -> None:
    place = tmp_path / "python" / "GearContact.fmu"
    place.mkdir(parents=True)
    with pytest.raises(ValueError, match="is a folder; expected a file to write"):
        build_fmus(["GearContact"], ["python"], None, tmp_path)
    assert everything(tmp_path) == [tmp_path / "python", place]


@pytest.mark.parametrize(
    "failure", [OSError(28, "No space left on device"), KeyboardInterrupt(), RuntimeError("x")]
)
def test_an_existing_fmu_survives_a_failed_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException
) -> None:
    (built,) = build_fmus(["GearContact"], ["python"], None, tmp_path)
    before, path, modules = built.read_bytes(), list(sys.path), set(sys.modules)
    genuine: Callable[..., Path] = FmuBuilder.build_FMU

    def fail_at_the_end(*arguments: object, **options: object) -> Path:
        genuine(*arguments, **options)
        raise failure

    monkeypatch.setattr(FmuBuilder, "build_FMU", fail_at_the_end)
    expected = ValueError if isinstance(failure, OSError) else type(failure)
    changed = load_default("gear_contact").with_values({"e": 0.25}, "user", "test")
    with pytest.raises(expected) as raised:
        build_fmus(["GearContact"], ["python"], changed, tmp_path)
    if isinstance(failure, OSError):
        assert "No space left on device" in str(raised.value)
    assert everything(tmp_path) == [tmp_path / "python", built]
    assert built.read_bytes() == before
    assert sys.path == path
    assert set(sys.modules) == modules


def test_a_bad_source_date_is_refused_by_name(tmp_path: Path, enter: Enter, capsys: Capture) -> None:
    enter(environment(SOURCE_DATE_EPOCH="yesterday"))
    line = refused_line(capsys, "build", "GearContact", "--flavour", "python", "--out", tmp_path)
    assert "SOURCE_DATE_EPOCH" in line
    assert [p for p in everything(tmp_path) if p.is_file()] == []


# The main job


class Links(HTMLParser):
    """Parser that collects the addresses that a page would load, and the tags of the page."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        loading = {"src", "srcset", "data", "poster"} | (
            {"href"} if tag in ("link", "use", "image") else set()
        )
        self.loaded += [v or "" for k, v in attrs if k.removeprefix("xlink:") in loading]


class Job(NamedTuple):
    """Run of the main job: its folder, its printed lines, its result."""

    folder: Path
    said: str
    outcome: pipeline.PipelineResult


PROVED_DRIVES = ("base_drive", "hand_drive")
"""Of the robot's six drives, which have the same code: the largest and the smallest."""


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory, fmus: Path, native: Path, system_files: Path) -> Job:
    """Run of the main job that all these tests examine; it gets copies of the FMUs and systems of the
    fixtures."""
    folder = tmp_path_factory.mktemp("job")

    def copied(sources: Iterable[Path], out: Path) -> list[Path]:
        files = [(path, out / path.parent.name / path.name) for path in sources]
        new = [(path, target) for path, target in files if not target.exists()]
        for path, target in new:
            target.parent.mkdir(parents=True, exist_ok=True)
            copy(path, target)
        return [target for _, target in new]

    def built(
        names: Sequence[str], flavours: Sequence[str], file: object, out: Path, process_pool: Executor
    ) -> Any:
        assert (names, flavours, file) == ([], [*FLAVOUR_BUILDERS], None)
        folders = {"python": fmus} | {version: native / version for version in VERSIONS}
        return copied((folders[f] / f"{name}.fmu" for f in flavours for name in NAMES), out)

    def built_systems(out: Path, build_joints: bool, process_pool: Executor) -> list[Path]:
        assert not build_joints
        made = [path for suffix in ("fmu", "ssp") for path in copied(system_files.glob(f"*/*.{suffix}"), out)]
        return [path for path in made if "_drive" not in path.stem or path.stem.endswith(PROVED_DRIVES)]

    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as out:
        patch.setattr(pipeline, "build_fmus", built)
        patch.setattr(pipeline, "build_system_archives", built_systems)
        outcome = pipeline.run_pipeline(folder)
        assert pipeline.print_summary(outcome, folder) == 0, out.getvalue()
    return Job(folder, out.getvalue(), outcome)


def test_the_main_job_builds_checks_and_reports(job: Job) -> None:
    folder, out, _ = job
    assert f"built: {3 * len(NAMES)} FMUs" in out
    assert "missed: 0" in out
    proved = re.search(r"proved in fmpy: (\d+) FMUs by (\d+) runs", out)
    assert proved is not None
    assert int(proved[1]) > 3 * len(NAMES)  # those of systems, too
    assert int(proved[2]) > 15 * 5 * len(NAMES)  # of two flavours in both interfaces, of one in one
    for flavour in ("fmi2", "fmi3", "python"):
        own = [f"six_axis_robot_{drive}" for drive in systems.load_system("six_axis_robot").joints]
        partners = [] if flavour == "python" else [*PARTNERS, *own]
        assert {p.stem for p in (folder / flavour).iterdir()} == {*NAMES, *partners}
    archives = {f"{name}{suffix}" for name in systems.list_system_names() for suffix in ("", "_in_turn")}
    for ssp in ("ssp", "ssp2"):
        assert {p.stem for p in (folder / ssp).iterdir()} == archives
    report = folder / "report"
    assert {p.name for p in report.iterdir()} == {
        "index.html",
        "laboratory.html",
        *(f"{n}.csv" for n in NAMES),
    }
    for name in NAMES:
        with (report / f"{name}.csv").open(newline="") as file:
            header, *rows = csv.reader(file)
        model = MODELS[name]
        assert header[0].split(" [")[0] == model.ramp.input_name
        assert [h.split(" [")[0] for h in header[1:]] == [v.name for v in model.outputs]
        assert len(rows) == round(model.ramp.end_value / model.ramp.value_step) + 1
        assert float(rows[-1][0]) == pytest.approx(model.ramp.end_value, rel=1e-12)
    page = (report / "index.html").read_text(encoding="utf-8")
    links = Links()
    links.feed(page)
    assert "svg" in links.tags
    assert not re.findall(r"(?:src|href)\s*=\s*[\"']?(?:https?:)?//", page)
    assert not re.findall(r"@import|url\(\s*[\"']?(?:https?:)?//", page)
    assert [x for x in links.loaded if not x.startswith(("#", "data:"))] == []
    assert [name for name in NAMES if name not in page] == []
    # the command, the job and the page count alike
    counted = validation.format_validation_summary(validation.validate_published_numbers())
    assert f"; {counted}; " in out
    assert f"<p>{counted}.</p>" in page


@needs("Chromium")
def test_the_report_can_be_read_on_a_phone(job: Job) -> None:
    """The page has a tab per joint with line charts, no text below 11 px, nothing wider than the screen, and
    all checks."""
    with browser() as shown:
        shown.shape(390, 800, phone=True)
        shown.open(job.folder / "report" / "index.html")
        rows = 0
        for name in KINDS:
            shown.run(f"document.getElementById('tab-{name}').click()")
            panel = f"document.getElementById('of-{name}')"
            assert not shown.run(f"{panel}.hidden")
            assert shown.run("document.querySelectorAll('[role=tabpanel]:not([hidden])').length") == 1
            drawn = shown.run(
                f"[...{panel}.querySelectorAll('svg.plot')].map((s) => s.querySelector('path') !== null)"
            )
            assert drawn
            assert all(drawn)
            assert shown.run("document.documentElement.scrollWidth") <= 390
            sizes = f"[...{panel}.querySelectorAll('*')].map((e) => parseFloat(getComputedStyle(e).fontSize))"
            assert shown.run(f"Math.min(...{sizes})") >= 11.0
            rows += (
                shown.run(f"{panel}.querySelectorAll('[aria-label=\"Checks of the ramps\"] tr').length") - 1
            )
        assert f"; {rows} checks of the ramps" in job.said


def test_the_main_job_proves_every_fmu(job: Job) -> None:
    """The proof covers all flavours, partners and drives of systems, with all experiments in all
    interfaces."""
    proofs = {pipeline.report_name_of_fmu(proof.fmu_path): proof for proof in job.outcome.fmu_proofs}
    flavours = {f"{flavour}/{name}" for flavour in FLAVOUR_BUILDERS for name in NAMES}
    partners = {f"{version}/{name}" for version in VERSIONS for name in PARTNERS}
    assert flavours | partners < proofs.keys()
    for name, proof in proofs.items():
        assert (proof.importer_name, proof.failure_messages, proof.compared_start_value_count > 0) == (
            "fmpy",
            [],
            True,
        ), name
        assert [*proof.executed_interfaces] == (BOTH[:1] if name.startswith("python/") else BOTH), name
        runs = [
            (one.experiment.experiment_name, one.fmi_interface)
            for one in proof.experiment_outcomes
            if one.fmi_interface
        ]
        names = dict.fromkeys(one for one, _ in runs)
        assert runs == [(one, interface) for one in names for interface in proof.executed_interfaces], name
        assert proof.worst_point is not None
        assert proof.worst_point.error_over_tolerance <= MEASURED, name
        if name in flavours:
            purposes = {one.experiment.experiment_purpose for one in proof.experiment_outcomes}
            assert purposes == {"smoke-test", "validation", "uncertainty-analysis"}, name


def test_the_main_job_has_resonance_and_decay_of_the_working_point(job: Job) -> None:
    """Results are near the formulas; frequencies increase with the load, damping with the amplitude."""
    found = job.outcome.free_vibrations
    assert len(checks.check_free_vibrations(found)) == 3  # the column has no dashpot
    for name, most in (("robot_joint", 1.69), ("bolted_column", 2.79)):
        frequencies = [r.frequency for r in found[name]]
        assert frequencies == sorted(frequencies)
        assert frequencies[-1] / frequencies[0] == pytest.approx(most, abs=0.02)
    assert {*found} == {*job.outcome.free_decays}
    for (one,) in job.outcome.free_decays.values():
        assert one.amplitude[0] > 10.0 * one.amplitude[-1]
        assert one.frequency[0] < 0.95 * one.frequency[-1]
        assert one.damping[0] > 3.0 * one.damping[-1]


def test_the_main_job_fails_when_a_check_or_a_proof_misses(job: Job, tmp_path: Path, capsys: Capture) -> None:
    """The results of the main job are used, except for an FMU with a changed reference and deviations of the
    integrals. The exit status is then 1, and the report shows the failures."""
    name = NAMES[0]
    path = tmp_path / "fmi2" / f"{name}.fmu"
    path.parent.mkdir()

    def change(member: str, data: bytes) -> bytes:
        is_meant = member.endswith("load_ramp_ref.csv")
        return re.sub(rb"(?m)^1\.0,[^,]+", b"1.0,1e99", data) if is_meant else data

    changed_copy(job.folder / "fmi2" / f"{name}.fmu", path, change)
    problems, proof = pipeline._validate_and_prove(path)
    found = [
        replace(c, deviation=0.01) if c.tolerance == checks.INTEGRATION_TOLERANCE else c
        for c in job.outcome.numerical_checks
        if c.fmu_name in NAMES
    ]
    outcome = replace(job.outcome, fmu_problems=problems, fmu_proofs=[proof], numerical_checks=found)
    assert pipeline.print_summary(outcome, tmp_path) == 1
    # both interfaces of the FMU, and an integral of each ramp
    missed = capsys.readouterr().out.partition(f"missed: {2 + len(NAMES)}\n")[2].splitlines()
    assert [line.split(":")[0].strip() for line in missed] == [*2 * [f"fmi2/{name}"], *NAMES]
    assert [interface in line for interface, line in zip(BOTH, missed, strict=False)] == [True, True]
    write_report(tmp_path / "index.html", outcome)
    assert '<td class="miss">miss</td>' in (tmp_path / "index.html").read_text(encoding="utf-8")


@needs("Linux or macOS")
def test_the_main_job_ends_with_its_processes_on_ctrl_c(tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "build_fmus.py"
    command = [sys.executable, str(script), "--out", str(tmp_path / "dist")]
    process = subprocess.Popen(command, stdout=PIPE, stderr=PIPE, text=True, start_new_session=True)
    while not list(tmp_path.glob("dist/fmi2/*.fmu")):  # its processes are at work
        time.sleep(0.05)
        assert process.poll() is None
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60.0)
    assert (process.returncode, out, err) == (130, "", "build_fmus.py: interrupted\n")
    late = time.monotonic() + 30.0
    with suppress(ProcessLookupError):
        while time.monotonic() < late:
            os.killpg(process.pid, 0)
            time.sleep(0.05)
        pytest.fail("processes are left")


def test_the_main_job_refuses_an_unwritable_place_with_one_line(tmp_path: Path, capsys: Capture) -> None:
    (tmp_path / "file").write_text("")
    assert pipeline.main(tmp_path / "file" / "below") == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("build_fmus.py: ")
    assert "cannot be written" in err
    assert err.count("\n") == 1
    assert everything(tmp_path) == [tmp_path / "file"]
