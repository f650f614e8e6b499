"""Studies of an FMU or a joint in a folder: they can be killed at any time and resumed."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
import zipfile
from contextlib import contextmanager, suppress
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

import dying_run
import numpy as np
import pytest
from clients import needs
from conftest import refused_line, run_host
from jointfmu_tools import cli
from jointfmu_tools.run.ramps import ramp
from jointfmu_tools.studies.uncertainty import journal
from jointfmu_tools.studies.uncertainty.problem import define_joint_study
from jointfmu_tools.studies.uncertainty.runs import StudyExecution, evaluate_runs
from jointfmu_tools.studies.uncertainty.study import draw_unit_cube_points
from jointfmu_tools.studies.uncertainty.sweep import define_fmu_study
from jointfmu_tools.studies.uncertainty.worker import LoadRamp

from jointfmu.parameters import format_parameter_file, load_default

pytestmark = pytest.mark.slow

RAMP = ("--input", "tau", "--to", "5", "--step", "1")
DRIVE = LoadRamp("tau", 5.0, 1.0)
GIVEN = {"surface.D": "2.45..2.6", "eccentricity": "normal(5e-6, 5e-6)"}
SETTINGS = ("--set", *(f"{name}={text}" for name, text in GIVEN.items()))


@pytest.fixture(scope="module")
def fmu(native):
    return native / "fmi3" / "HarmonicDriveCompliance.fmu"


@contextmanager
def local_cluster(worker_count, settings=()):
    """Context with the address of a dask scheduler; workers are forked from a process with all imports done.

    settings : settings of dask
    """
    import dask
    from distributed import LocalCluster

    multiprocessing.set_forkserver_preload(
        ["distributed", "fmpy", "jointfmu_tools.studies.uncertainty.worker", "dying_run"]
    )
    how = "spawn" if sys.platform == "win32" else "forkserver"
    with (
        dask.config.set({"distributed.worker.multiprocessing-method": how, **dict(settings)}),
        LocalCluster(n_workers=worker_count, threads_per_worker=1, dashboard_address=":0") as one,
    ):
        yield one.scheduler_address


@pytest.fixture(scope="module")
def cluster():
    """Address of a dask scheduler with two workers."""
    with local_cluster(2) as address:
        yield address


DEPRECATED = (
    "jointfmu sweep: deprecated, and removed in the next major version; use jointfmu uncertainty FMU\n"
)


def do_runs(task, runs, out, **execution):
    """Runs of an FMU that are stored in a folder."""
    return evaluate_runs(
        task.run_evaluator, runs, task.output_units, task.loads.size, StudyExecution(out, **execution)
    )


def runs_of(task, count, seed=0):
    return task.list_run_settings(draw_unit_cube_points(count, len(task.uncertain_parameters), seed))


def indices(out):
    return [entry["run"] for entry in journal.read_journal_entries(out)]


def processes_of(group):
    """Living processes of a process group: {pid: fields of its status}."""
    found = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            fields = path.read_text().rpartition(")")[2].split()
            if int(fields[2]) == group and fields[0] != "Z":
                found[int(path.parent.name)] = fields
    return found


def wait_for(condition, process=None):
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline
        assert process is None or process.poll() is None
        time.sleep(0.005)


def start_sweep(arguments, own):
    """Start the command in a session of its own, with its temporary files in a folder."""
    return subprocess.Popen(
        [sys.executable, "-m", "jointfmu", *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=os.environ | {"TMPDIR": str(own)},
    )


@needs("Linux")
def test_a_local_sweep_opens_no_socket_and_ends_with_its_processes_when_killed(fmu, tmp_path):
    out, own = tmp_path / "out", tmp_path / "own"
    own.mkdir()
    arguments = ["sweep", str(fmu), *SETTINGS, *RAMP, "--samples", "512", "--workers", "2", "--out", str(out)]
    process = start_sweep(arguments, own)
    runs = out / journal.RUNS_FILE
    wait_for(lambda: runs.exists() and runs.read_bytes().count(b"\n") >= 5, process)
    pids = processes_of(process.pid)
    assert len(pids) >= 3
    opened = []
    for pid in pids:
        for handle in Path(f"/proc/{pid}/fd").iterdir():
            with suppress(OSError):  # closed by now
                opened.append(os.readlink(handle))
    assert len(opened) > 3 * len(pids)
    assert [one for one in opened if one.startswith("socket:")] == []
    os.kill(process.pid, signal.SIGKILL)
    assert process.communicate(timeout=10.0) == ("", "")
    wait_for(lambda: not processes_of(process.pid))


def test_killed_and_resumed(fmu, tmp_path, capsys):
    """kill -9 in the middle: no run is lost or repeated, and the unfinished last line is removed."""
    out = tmp_path / "out"
    arguments = ["sweep", str(fmu), *SETTINGS, *RAMP, "--samples", "64", "--workers", "1", "--out", str(out)]
    process = subprocess.Popen([sys.executable, "-m", "jointfmu", *arguments], stderr=subprocess.DEVNULL)
    runs = out / journal.RUNS_FILE
    wait_for(lambda: runs.exists() and runs.read_bytes().count(b"\n") >= 10, process)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    before = indices(out)
    assert 10 <= len(before) < 64
    kept = runs.read_bytes()
    kept = kept[: kept.rindex(b"\n") + 1]
    runs.write_bytes(kept + b'{"run": 63, "parameters": {"surf')
    assert indices(out) == before
    assert cli.main([*arguments, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["runs"], found["now"]) == (64, 64 - len(before))
    assert runs.read_bytes().startswith(kept)
    assert sorted(indices(out)) == list(range(64))
    # a normal distribution of mean and deviation 5e-6 has 15.87 % below zero, which the FMU refuses
    assert found["failed"] == pytest.approx(0.158655 * 64, abs=1.5)
    assert found["first_failure"]["parameters"]["eccentricity"] < 0.0
    assert "is outside [0, 0.001)" in found["first_failure"]["error"]
    assert cli.main([*arguments, "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert (again["now"], again["failed"]) == (0, found["failed"])
    assert "holds another study (samples = 64, now 512)" in refused_line(
        capsys, *arguments[:-1], out, "--samples", "512"
    )


@needs("Linux")
@pytest.mark.parametrize("moment", ["workers start", "runs"])
def test_ctrl_c_ends_it_at_once_and_it_resumes(moment, fmu, tmp_path, capsys):
    """The signal goes to all processes, as from a terminal: status 130, one line, no worker remains."""
    out, own = tmp_path / "out", tmp_path / "own"
    own.mkdir()
    arguments = ["sweep", str(fmu), *SETTINGS, *RAMP, "--samples", "32", "--workers", "2", "--out", str(out)]
    process = start_sweep(arguments, own)
    runs = out / journal.RUNS_FILE

    def reached():
        if moment == "runs":
            return runs.exists() and runs.read_bytes().count(b"\n") >= 5
        return len(processes_of(process.pid)) > 2  # beside this one and multiprocessing's own helper

    wait_for(reached, process)
    os.killpg(process.pid, signal.SIGINT)
    printed = process.communicate(timeout=30.0)
    assert process.returncode == 130
    assert printed == (
        "",
        f"jointfmu sweep: interrupted; finished runs are kept in {out}, the same command resumes\n",
    )
    assert list(own.iterdir()) == []
    wait_for(lambda: not processes_of(process.pid))
    before = indices(out)
    assert cli.main([*arguments, "--workers", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["now"] == 32 - len(before)
    assert sorted(indices(out)) == list(range(32))


@needs("Linux or macOS")
def test_a_process_that_dies_as_it_starts_prints_nothing():
    code = (
        "import subprocess, sys\n"
        "from jointfmu.progress import _quiet_start_context\n"
        "child = [sys.executable, '-c', '1/0']\n"
        "with _quiet_start_context():\n"
        "    subprocess.run(child)\n"
        "print('after', file=sys.stderr)\n"
        "subprocess.run([*child[:2], 'import sys; sys.stderr.write(str(1))'])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == "after\n1"


def test_runs_are_the_ramp_of_the_fmu(fmu, cluster, tmp_path):
    """Runs on the workers of a scheduler, given by its address only, give the same numbers as `jointfmu
    ramp`."""
    given = {"surface.D": "2.45..2.6", "eccentricity": 5e-6}
    task = define_fmu_study(fmu, DRIVE, given)
    runs = runs_of(task, 8)
    done = do_runs(task, runs, tmp_path, scheduler_address=cluster)
    assert (done.accepted_mask.size, done.new_run_count, done.error_messages) == (8, 8, {})
    found = {entry["run"]: entry for entry in journal.read_journal_entries(tmp_path)}
    for i, settings in enumerate(runs):
        assert (
            found[i]["parameters"] == settings == {"eccentricity": 5e-6, "surface.D": settings["surface.D"]}
        )
        alone = ramp.run_ramp(fmu, "tau", 5.0, 1.0, settings)
        assert found[i]["columns"] == {
            name: column.tolist() for name, column in alone.variable_columns.items()
        }


@pytest.mark.parametrize(
    ("flavour", "name", "load", "to", "given"),
    [
        ("fmi2", "BoltedJoint", "preload", 30e3, {"surface.D": "1.38..1.46", "H": "+-5%"}),
        ("fmi3", "GearContact", "f", 3e3, {"surface1.D": "1.4..1.5", "A_0": "+-5%"}),
        ("fmi2", "HarmonicDriveCompliance", "tau", 5.0, {"surface.D": "2.45..2.6", "K_FTS0": "+-5%"}),
    ],
)
def test_an_fmu_and_its_joint_have_the_same_numbers(flavour, name, load, to, given, native, tmp_path):
    """An FMU and its joint give the same numbers for the same samples, through the importer and through the
    library alone."""
    path, drive = native / flavour / f"{name}.fmu", LoadRamp(load, to, to / 6.0)
    task = define_fmu_study(path, drive, given)
    runs = runs_of(task, 4, 3)
    assert do_runs(task, runs, tmp_path, process_count=1).error_messages == {}
    joint = {"preload": "bolted_joint", "f": "gear_contact", "tau": "harmonic_drive"}[load]
    alone = define_joint_study(load_default(joint), given, to, 7)
    for entry in journal.read_journal_entries(tmp_path):
        found = alone.run_evaluator.evaluate_sample(entry["parameters"])
        for output in set(found) & set(entry["columns"]):
            assert found[output][1:] == pytest.approx(entry["columns"][output][1:], rel=1e-9), output


def test_bands_of_an_fmu(fmu, tmp_path, capsys):
    """The bands are those of the deprecated command for the same samples; without a folder nothing
    is stored."""
    arguments = [str(fmu), *SETTINGS, *RAMP, "--samples", "16", "--workers", "1", "--json"]
    assert cli.main(["uncertainty", *arguments, "--csv", str(tmp_path / "bands.csv")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["fmu"] == "HarmonicDriveCompliance.fmu"
    assert found["load"]["values"] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert found["indices"] is None
    assert cli.main(["sweep", *arguments, "--out", str(tmp_path / "old")]) == 0
    assert capsys.readouterr().err == DEPRECATED
    assert cli.main(["uncertainty", *arguments, "--out", str(tmp_path / "old")]) == 0
    again = json.loads(capsys.readouterr().out)
    assert (again["now"], again["runs"], again["failed"]) == (0, 16, found["refused"]["count"])
    assert again["outputs"] == found["outputs"]
    text = (tmp_path / "old" / journal.BANDS_FILE).read_text()
    assert text.startswith("tau [N.m],phi_rel 1 % [rad]")
    assert (tmp_path / "bands.csv").read_text().startswith("tau [N.m],phi_rel nominal [rad]")


SAMPLED = ("A_0=+-5%", "surface1.D=normal(1.95, 0.05)")
JOINT = ("uncertainty", "gear_contact", "--set", *SAMPLED, "--points", "30")


def test_a_study_of_a_joint_is_killed_and_resumed(tmp_path, capsys):
    """kill -9 in the middle: the numbers are equal to the bit to the numbers of a study without a folder."""
    arguments = [*JOINT, "--samples", "128", "--json"]
    assert cli.main(arguments) == 0
    expected = json.loads(capsys.readouterr().out)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "jointfmu", *arguments, "--out", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    runs = out / journal.RUNS_FILE
    wait_for(lambda: runs.exists() and runs.read_bytes().count(b"\n") >= 12, process)
    process.kill()
    process.wait()
    before = len(indices(out))
    assert 12 <= before < 128
    assert cli.main([*arguments, "--out", str(out)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found.pop("out"), found.pop("runs"), found.pop("now")) == (str(out), 128, 128 - before)
    assert found.pop("failed") == expected["refused"]["count"] == pytest.approx(0.158655 * 128, abs=2)
    assert "surface1.D = " in expected["refused"]["reason"]
    assert found == expected
    assert sorted(indices(out)) == list(range(128))
    assert (out / journal.SOBOL_RUNS_FILE).exists()
    assert (out / journal.BANDS_FILE).read_text().startswith("f [N],K_N nominal [N/m]")
    assert "holds another study (points = 30, now 31)" in refused_line(
        capsys, *arguments[:-3], "--points", "31", "--samples", "128", "--out", out
    )


def test_a_joint_on_a_cluster(cluster, capsys):
    arguments = [*JOINT, "--samples", "64", "--json"]
    assert cli.main(arguments) == 0
    alone = json.loads(capsys.readouterr().out)
    assert cli.main([*arguments, "--scheduler", cluster]) == 0
    assert json.loads(capsys.readouterr().out) == alone


def test_every_run_fails(fmu, cluster, tmp_path, capsys):
    arguments = ["--set", "eccentricity=0.9e-3..0.99e-3", "--samples", "4", "--scheduler", cluster]
    assert cli.main(["sweep", str(fmu), *RAMP, *arguments, "--out", str(tmp_path / "out")]) == 1
    text = capsys.readouterr().out
    assert "4 runs in" in text
    assert "4 failed" in text
    assert "the first failed, run " in text
    assert not (tmp_path / "out" / journal.BANDS_FILE).exists()


LOCAL = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[3])
import dying_run
from jointfmu import progress
if __name__ == "__main__":
    progress.MAX_JOB_ATTEMPTS = 2
    print(*dying_run.run_until_five_dies(*map(Path, sys.argv[1:3]), process_count=2))
"""
DIED = {5: "the process of the run died"}


def test_a_local_run_that_kills_its_process(fmu, tmp_path):
    """The run is recorded with its parameters. The study runs in a process of its own, so that no test worker
    can die."""
    done = run_host(LOCAL, fmu, tmp_path, Path(dying_run.__file__).parent)
    assert done.stdout == f"24 24 {DIED}\n", done.stderr
    assert sorted(indices(tmp_path)) == list(range(24))


HALF = """
import sys, time
from pathlib import Path
sys.path.insert(0, sys.argv[2])
import dying_run
from jointfmu import progress
if __name__ == "__main__":
    progress.MAX_JOB_ATTEMPTS = 1
    print(*(result for _, result in progress.run_jobs(dying_run.send_half_of_result, [Path("no folder")], 1)))
    try:
        with progress.worker_processes(1) as pool:
            pool.submit(dying_run.send_half_of_result, Path(sys.argv[1]))
            while not list(Path(sys.argv[1]).iterdir()):
                time.sleep(0.01)
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        print("interrupted")
"""


@needs("Linux or macOS")
def test_a_process_that_dies_in_the_middle_of_its_result(tmp_path):
    """Of itself, or killed on Ctrl-C: its pool does not wait for the rest."""
    done = run_host(HALF, tmp_path, Path(dying_run.__file__).parent)
    assert done.stdout == "None\ninterrupted\n", done.stderr


def test_a_run_that_kills_its_process_of_a_cluster(fmu, tmp_path):
    """The run is recorded with its parameters; jobs that only waited on the same worker are repeated.

    With these settings dask blames every job of a worker that dies, on its first death.
    """
    with local_cluster(1, {"distributed.scheduler.allowed-failures": 0}) as address:
        assert dying_run.run_until_five_dies(fmu, tmp_path, scheduler_address=address) == (24, 24, DIED)
    assert sorted(indices(tmp_path)) == list(range(24))


def test_bands_of_the_runs(fmu, cluster, tmp_path):
    arguments = ["--samples", "32", "--scheduler", cluster, "--out", str(tmp_path)]
    assert cli.main(["sweep", str(fmu), *SETTINGS, *RAMP, *arguments]) == 0
    head, *rows = (tmp_path / journal.BANDS_FILE).read_text().splitlines()
    column = head.split(",").index("K_WTS 50 % [N.m/rad]")
    good = [
        entry["columns"]["K_WTS"] for entry in journal.read_journal_entries(tmp_path) if "columns" in entry
    ]
    median = [float(row.split(",")[column]) for row in rows]
    assert median == pytest.approx(np.median(good, axis=0), rel=1e-15)
    assert [float(row.split(",")[0]) for row in rows] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


def test_one_sweep_per_folder(tmp_path):
    with journal.RunJournal(tmp_path, 8), pytest.raises(ValueError, match="another command is writing here"):
        journal.RunJournal(tmp_path, 8).__enter__()


def test_a_run_is_written_once(tmp_path):
    first, second = ({"run": 3, "parameters": {}, "error": text} for text in ("x", "y"))
    with journal.RunJournal(tmp_path, 8) as held:
        held.append_entries(first)
        held.append_entries(second)
    with journal.RunJournal(tmp_path, 8) as held:
        assert held.finished_runs == {3}
        assert held.first_failure == first


def test_an_interval_is_that_of_the_file_that_the_fmu_carries(fmu, tmp_path):
    known = replace(load_default("harmonic_drive"), ranges={"surface.D": (2.5, 2.55)})
    own = tmp_path / "own.fmu"
    with zipfile.ZipFile(fmu) as before, zipfile.ZipFile(own, "w") as after:
        for path in before.namelist():
            carried = fnmatch(path, "extra/*/parameters/*.toml") and not path.endswith("study.toml")
            after.writestr(path, format_parameter_file(known) if carried else before.read(path))
    task = define_fmu_study(own, DRIVE, {"surface.D": "interval"})
    assert task.make_study_record(4, 0)["parameters"] == {"surface.D": "2.5..2.55"}
    assert all(2.5 <= run["surface.D"] <= 2.55 for run in runs_of(task, 4))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--input", "tau", "--set", "mu=interval"], "mu = interval: the parameter file states no interval"),
        (["--input", "tau", "--set", "surface.X=1..2"], "unknown name 'surface.X', allowed are tau"),
        (["--input", "torque", "--set", "surface.D=2.4..2.6"], "unknown input 'torque', allowed are tau"),
        (["--input", "tau", "--set", "tau=1..2"], "tau is the input of the ramp"),
        (["--input", "tau", "--set", "surface.D=2.4"], "or a study file (--set)"),
        (["--input", "tau", "--set", "surface.D=2.6..2.4"], "low = 2.6 is not below high = 2.4"),
        (["--input", "tau", "--set", "surface.D=+-1%", "--workers", "0"], "workers = 0 is outside [1, inf)"),
    ],
)
def test_refused_arguments(arguments, words, fmu, tmp_path, capsys):
    line = refused_line(
        capsys, "sweep", fmu, *arguments, "--to", "5", "--step", "1", "--out", tmp_path / "out"
    )
    assert words in line
    assert not (tmp_path / "out").exists()


def test_refused_folders_and_schedulers(fmu, tmp_path, capsys):
    arguments = ["sweep", fmu, *SETTINGS, *RAMP, "--samples", "4", "--out"]
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("x")
    assert "contains other files than those of a study" in refused_line(capsys, *arguments, tmp_path / "full")
    line = refused_line(capsys, *arguments, tmp_path / "new" / "one", "--scheduler", "nowhere")
    assert "scheduler = nowhere: cannot be reached" in line
    assert not (tmp_path / "new").exists()
