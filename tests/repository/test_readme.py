"""Code in the README and in the pages that continue it runs; figures are those of the product."""

import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

import coarse
import pytest
from clients import needs
from conftest import here_alone
from jointfmu_fmu_src.native.build import build_native_fmu as native_build
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from jointfmu_tools import cli
from jointfmu_tools.inputs.fields import nodal_result
from jointfmu_tools.inputs.fields.nodal_result import ContactPressureField
from jointfmu_tools.studies.published import validation
from oracles import system_records
from surroundings import environment

from jointfmu.files.outputs import write_parameter_text
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import load_default

ROOT = Path(__file__).resolve().parents[2]
ASSEMBLY = "models/assemblies/box_specimen.toml"
README, COMMANDS, FMUS, PYTHON, VALIDITY = (
    (ROOT / name).read_text(encoding="utf-8")
    for name in ("README.md", "docs/commands.md", "docs/fmus.md", "docs/python.md", "docs/validity.md")
)


def blocks(language, text=README):
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def test_the_readme_is_short():
    assert len(re.findall(r"\S*\w\S*", README)) <= 700


@pytest.mark.slow
@needs("git and a checkout", "gmsh")
def test_every_block_of_the_readme_runs_top_to_bottom(tmp_path, few_points, enter):
    """The blocks run in a clone; `.ci/run` runs the installation and the complete build in an environment of
    its own."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    variables = os.environ | {"URL": str(ROOT), "PATH": path}
    found = re.findall(r"```(sh|python)\n(.*?)```", README, flags=re.DOTALL)
    assert [language for language, _ in found] == ["sh", "sh", "python", "sh"]
    (_, clone), (_, install), *first = found
    installs = re.findall(r"^pip .*\n", README, flags=re.MULTILINE)
    assert install in installs
    for line in installs:
        assert line in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    with_nothing = clone.replace("-m venv", "-m venv --without-pip")  # which `.ci/run` puts in and uses
    subprocess.run(["bash", "-ec", with_nothing], cwd=tmp_path, env=variables, check=True, timeout=100)
    work = tmp_path / "joints"
    assert (work / ".venv" / "bin" / "python").exists()
    enter(chdir(work))
    enter(environment(MPLBACKEND="agg"))
    with here_alone():
        for language, block in first:
            if language == "python":
                exec(compile(block, "README", "exec"), {})
                continue
            for line in block.splitlines():
                program, *words = shlex.split(line)
                if program == "pip":
                    continue
                assert (program, cli.main(words)) == ("jointfmu", 0), line
    for made in ("drive.png", "loops.png", "plate.html", "dist/fmi2/HarmonicDriveSpring.fmu"):
        assert (work / made).is_file(), made


@pytest.fixture(scope="module")
def folder(tmp_path_factory, native):
    place = tmp_path_factory.mktemp("readme")
    shutil.copytree(native, place / "dist", ignore=shutil.ignore_patterns(".*"))
    inertia = partner_parameters("RotationalInertia")
    with here_alone():
        native_build("RotationalInertia", inertia, place / "dist" / "fmi2", "2")
    specimen = (ROOT / "models/bolted_joint/box_specimen.toml").read_text()
    write_parameter_text(place / "my_joint.toml", specimen)  # as a command that the page does not show
    (place / "models/assemblies").mkdir(parents=True)
    (place / ASSEMBLY).write_text((ROOT / ASSEMBLY).read_text())
    joint = load_default("bolted_joint").values
    with coarse.contact_cells(3):  # few nodes are read as many are
        shape, mean = joint.pattern.pressure_distribution(), 9e3 * joint.n_bolts / joint.A_0
    field = ContactPressureField(
        joint.A_0 * shape.area_share, shape.position, mean * shape.preload_pressure_ratio
    )
    (place / "my_field.csv").write_text(nodal_result.format_field_csv(field))
    (place / "models/robots").mkdir()
    shutil.copy(ROOT / "models/robots/six_axis.xml", place / "models/robots")
    speeds = (s * w for s in (-1.0, 1.0) for w in (0.1, 0.5, 1.0, 2.0))
    rows = "".join(f"{w},{math.copysign(0.5, w) + 0.3 * w}\n" for w in speeds)
    (place / "robot.csv").write_text(f"dq [rad/s],i [A]\n{rows}")
    spring, still = BoltedJointSpring.from_joint(joint), (0.0, 0.0, 0.0)
    rows = "".join(f"{F},{spring.evaluate(F, 0.0, still, still)['K_zz']}\n" for F in (3e3, 9e3, 15e3))
    (place / "stiffness.csv").write_text(f"preload [N],stiffness [N/m]\n{rows}")
    words = ["ramp", str(place / "dist/fmi3/HarmonicDriveSpring.fmu"), "--input", "phi2", "--loop", "1e-3"]
    assert cli.main([*words, "--csv", str(place / "loop.csv")]) == 0
    system_records.make_chirp_record(place, 1)
    return place


@needs("gmsh")
def test_python_blocks_run(folder, few_points, enter):
    enter(chdir(folder))
    names = {}
    for page in (FMUS, PYTHON):
        (block,) = blocks("python", page)
        with here_alone():
            exec(compile(block, "docs", "exec"), names)
    # the ramp of the first block ends at 5 N m, the second evaluates 1000 pressures
    assert names["result"]["K_WTS"][-1] > names["result"]["K_WTS"][0] > 1e3
    assert names["state"]["K_N"].shape == (1000,)


commands = [
    line
    for page in (FMUS, COMMANDS)
    for block in blocks("sh", page)
    for line in block.splitlines()
    if line.startswith("jointfmu ")
]


ELSEWHERE = ("jointfmu build --systems ", "jointfmu system six_axis_robot ", "jointfmu report ")
"""Commands that other tests run: tests/systems/test_systems.py, examples/robot.py, or the README itself
above."""
MESHED = ("jointfmu footprint compute ", "jointfmu modes ", "jointfmu new bolted-joint ")
"""Commands that mesh bodies with gmsh."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    [
        pytest.param(line, marks=needs("gmsh") if line.startswith(MESHED) else ())
        for line in commands
        if not line.startswith(ELSEWHERE)
    ],
)
def test_commands_run(line, folder, tmp_path, enter, capsys):
    enter(chdir(folder))
    if line.startswith("jointfmu cache"):  # a cache of years takes long to count
        enter(environment(JOINTFMU_CACHE=str(tmp_path)))
    with here_alone():
        assert cli.main(shlex.split(line, comments=True)[1:]) == 0
    assert capsys.readouterr().out


def test_every_kind_of_command_is_shown():
    assert {line.split()[1] for line in commands} == {
        "new",
        "catalogue",
        "law",
        "parameters",
        "report",
        "build",
        "cache",
        "ramp",
        "prove",
        "validate",
        "surface",
        "fit",
        "uncertainty",
        "modelica",
        "export",
        "footprint",
        "modes",
        "ring",
        "robot",
        "system",
    }


@pytest.fixture(scope="module")
def rows():
    return validation.validate_published_numbers()


def predicted(count):
    """Number of predictions in words."""
    return {0: "none is a prediction", 1: "1 is a prediction"}.get(count, f"{count} are predictions")


def test_counts_are_those_of_the_comparison(rows):
    found = validation.count_points(rows)
    n, won = found.roles, sum(found.nearer.values())
    for said in (
        f"{found.numbers} numbers are compared, {found.printed} printed in the papers and "
        f"{found.derived} computed from printed ones, and {n['claim']} claims",
        f"{n['calibration']} were used to calibrate, {n['circular']} are met by construction, "
        f"{n['constant']} are constants, {n['self-check']} self-checks "
        f"and {n['contradiction']} a contradiction",
        f"{n['interpolation']} lie between calibrated points",
        f"nearer to the published number than the trivial guess in {won} of these {n['interpolation']} cases",
        f"{predicted(n['prediction'])}.",
    ):
        assert said in VALIDITY, said


def test_errors_are_those_of_the_comparison(rows):
    between = [row for row in rows if row.published_point.role == "interpolation"]
    worst = {
        unit: max(
            abs(row.error) for row in between if (row.published_point.unit == "%") == (unit == "points")
        )
        for unit in ("share", "points")
    }
    said = re.search(
        r"published K_TS within ([\d.]+) %, and the published change .*? within ([\d.]+) percentage points",
        VALIDITY,
    )
    assert said is not None
    assert float(said[1]) == round(100.0 * worst["share"], 1)  # to the printed digit
    assert float(said[2]) == round(worst["points"], 1)


def test_the_start_says_how_far_it_holds(rows):
    """The limits of validity are stated in five lines of the README, and before the first picture of the
    guide."""
    start = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    trust = README.partition("## How far to trust it")[2].partition("\n## ")[0]
    assert trust.count("\n- ") == 5
    assert "](docs/validity.md)" in trust
    here = start.partition("![")[0].partition("\n**How far it holds.**\n")[2]
    found = validation.count_points(rows)
    share = predicted(found.roles["prediction"])
    said = f"Of the {found.numbers} numbers compared with the papers {share}: "
    assert said in here
    assert f"of the {found.numbers} numbers compared {predicted(found.roles['prediction'])}." in trust
    assert re.search(r"\| \[Validity\]\(validity\.md\)", start.partition("## Where to go")[2])


def test_picture_and_links_exist():
    links = re.findall(r"\]\((?!https?:)([^)#]+)\)", README)
    assert links
    for link in links:
        assert (ROOT / link).exists(), link
