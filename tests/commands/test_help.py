"""Help of every command: an example that works, and the list of settings."""

import argparse
import json
import shlex
import shutil
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path

import coarse
import numpy as np
import pytest
from conftest import here_alone
from jointfmu_fmu_src.native.build import build_native_fmu as native_build
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from jointfmu_tools import cli
from jointfmu_tools.cli.examples import EXAMPLES
from jointfmu_tools.cli.parser import build_parser
from surroundings import Enter, environment
from test_readme import commands

from jointfmu.contact.laws import LAWS
from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

ROOT = Path(__file__).resolve().parents[2]


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for sub in action.choices.values():
                yield sub
                yield from parsers(sub)


def example(parser: argparse.ArgumentParser) -> str:
    """Last line of a help text without the name of the program: the example."""
    head, _, line = parser.format_help().rpartition(":\n  jointfmu ")
    assert head, f"{parser.prog} has no example"
    return line.strip()


HELPS = {sub.prog: example(sub) for sub in parsers(build_parser())}
NEED = (
    "build",
    "report",
    "modelica",
    "prove",
    "ramp",
    "ring",
    "system",
    "sweep",
    "footprint",
    "modes",
    "fit system",
)
"""Commands with examples that take long: the examples build or run FMUs, or solve finite elements."""
ON_PAGES = [{*shlex.split(line, comments=True)[1:]} for line in commands]
"""Words of the commands that test_readme.py executes."""


def test_no_example_is_of_a_command_that_is_gone() -> None:
    assert {f"jointfmu {name}" for name in EXAMPLES} <= set(HELPS)


@pytest.mark.parametrize("prog", HELPS)
def test_an_example_is_of_its_command(prog: str) -> None:
    words = shlex.split(HELPS[prog])
    assert f"jointfmu {' '.join(words)}".startswith(prog)
    build_parser().parse_args(words)


def shear() -> str:
    """Rows of a friction loop: both branches are parabolas that double the first loading (Masing)."""
    u = np.cos(np.linspace(0.0, 3.0 * np.pi, 120))
    way = np.where(np.arange(120) // 40 % 2, u + 1.0, u - 1.0)
    force = np.copysign(0.9, -way) + 2.0 * (0.5 * way - np.copysign(0.1 * (0.5 * way) ** 2, way))
    return "".join(f"{2.0 * a:.8g},{5e3 * b:.8g}\n" for a, b in zip(u, force, strict=True))


@pytest.fixture(scope="module")
def read(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Input files of the examples: parameters, a scan, loops, a log, stiffness over preload."""
    place = tmp_path_factory.mktemp("read")
    curve = HarmonicDriveSpring.tabulate(load_default("harmonic_drive").values).curve
    torque = 15.0 * np.sin(np.linspace(0.0, 2.5 * np.pi, 200))
    angle = np.sign(torque) * np.interp(np.abs(torque), curve.load, curve.displacement)
    rows = "".join(f"{a:.8g},{b:.8g}\n" for a, b in zip(torque, angle, strict=True))
    (place / "loop.csv").write_text(f"torque [N.m],angle [rad]\n{rows}")
    (place / "stiffness.csv").write_text(
        "preload [N],stiffness [N/m]\n3000,4e9\n9000,9e9\n15000,1.3e10\n20000,1.6e10\n30000,2.2e10\n"
    )
    shutil.copy(ROOT / "models/bolted_joint/box_specimen.toml", place / "my_joint.toml")
    speeds = "".join(f"{s * w},{s * (0.5 + 0.3 * w)}\n" for s in (-1.0, 1.0) for w in (0.1, 0.5, 1.0, 2.0))
    (place / "robot.csv").write_text("dq [rad/s],i [A]\n" + speeds)
    shutil.copy(ROOT / "models/robots/six_axis.xml", place / "my_robot.xml")
    (place / "shear.csv").write_text("displacement [um],force [N]\n" + shear())
    assert cli.main([*shlex.split(EXAMPLES["surface synthesize"])[:-1], str(place / "scan.csv")]) == 0
    return place


@pytest.fixture
def folder(read: Path, tmp_path: Path) -> Path:
    """Folder with the input files of the examples."""
    return shutil.copytree(read, tmp_path, dirs_exist_ok=True)


@pytest.mark.parametrize(
    "line",
    sorted({line for line in HELPS.values() if not line.startswith((*NEED, "new bolted-joint"))}),
    ids=lambda line: line[:24],
)
def test_an_example_runs(line: str, folder: Path, enter: Enter, capsys: pytest.CaptureFixture[str]) -> None:
    """All examples except the plate, which tests/drawing/test_new.py runs."""
    enter(chdir(folder))
    enter(environment(JOINTFMU_CACHE=str(folder / "parts")))  # a user's may be large
    enter(coarse.poses())
    assert cli.main(shlex.split(line)) == 0
    assert capsys.readouterr().out


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory, native: Path) -> Path:
    """FMUs and files for the examples that need them."""
    place = tmp_path_factory.mktemp("help")
    shutil.copytree(native, place / "dist", ignore=shutil.ignore_patterns(".*"))
    inertia = partner_parameters("RotationalInertia")
    with here_alone():
        native_build("RotationalInertia", inertia, place / "dist" / "fmi2", "2")
    (place / "models").symlink_to(ROOT / "models")
    shutil.copy(ROOT / "models/bolted_joint/box_specimen.toml", place / "my_joint.toml")
    return place


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    sorted(
        {
            line
            for line in HELPS.values()
            if line.startswith(NEED) and not any(words.issuperset(shlex.split(line)) for words in ON_PAGES)
        }
    ),
    ids=lambda line: line[:24],
)
def test_an_example_with_fmus_runs(
    line: str, built: Path, enter: Enter, capsys: pytest.CaptureFixture[str]
) -> None:
    if line.startswith("footprint import"):
        computed = shlex.split(EXAMPLES["footprint compute"])
        enter(chdir(built))
        assert cli.main([*computed, "--field", "my_field.csv"]) == 0
    enter(chdir(built))
    with here_alone():
        assert cli.main(shlex.split(line)) == 0
    assert capsys.readouterr().out


# What can be set


def listed(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, dict]:
    assert cli.main(["parameters", *words, "--json"]) == 0
    return {row["name"]: row for row in json.loads(capsys.readouterr().out)["parameters"]}


@pytest.mark.parametrize("name", MODELS)
def test_an_fmu_lists_its_parameters(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    for law in KINDS[MODELS[name].joint].laws:
        file = load_default(MODELS[name].joint, law)
        fields = MODELS[name].with_parameters(file.joint, file.values).parameter_fields()
        rows = listed(capsys, name, "--law", law)
        assert set(rows) == {n for n in fields if n in file.values_by_name}
        for stated, row in rows.items():
            meta = fields[stated].metadata
            assert (row["meaning"], row["default"]) == (meta["doc"], file.values_by_name[stated])
            assert row["unit"] == meta.get("unit")


@pytest.mark.parametrize("law", LAWS)
def test_a_law_lists_what_set_takes(law: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`--set` accepts every default in the form of the list. Points of a table can be set in files only."""
    for name, row in listed(capsys, law).items():
        if isinstance(row["default"], list):
            continue
        value = 1e-6 if row["default"] is None else row["default"]
        setting = f"{name}={str(value).lower() if isinstance(value, bool) else value}"
        assert cli.main(["law", law, "--pressure", "1e6", "--set", setting]) == 0
        capsys.readouterr()


def test_a_joint_lists_what_its_file_has(capsys: pytest.CaptureFixture[str]) -> None:
    rows = listed(capsys, "bolted_joint", "--params", str(ROOT / "models/bolted_joint/box_specimen.toml"))
    assert rows["row_bolts"]["whole"]
    assert rows["spot_stiffness"]["allowed"] == ["hertz", "family"]
    assert (rows["side1.nu"]["low"], rows["side1.nu"]["high"], rows["A_0"]["high"]) == (-1.0, 0.5, None)


def test_the_list_as_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["parameters", "HarmonicDriveSpring"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    assert head.split() == ["name", "default", "unit", "allowed", "meaning"]
    (damping,) = [line.split(maxsplit=5) for line in lines if line.startswith("d ")]
    assert damping == ["d", "0.5", "N.m.s/rad", "[0,", "inf)", "viscous damping at the output"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["hu2023", "--law", "roughness"], "--law has no effect for the law hu2023"),
        (
            ["gear_contact", "--law", "hu2023"],
            "law = 'hu2023' is not a law of a gear_contact, allowed are yu2022",
        ),
        (["hu2023", "--params", "absent.toml"], "absent.toml"),
    ],
)
def test_what_cannot_be_listed_is_refused(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["parameters", *words]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert said in err


def test_build_names_the_fmus() -> None:
    (build,) = [sub for sub in parsers(build_parser()) if sub.prog == "jointfmu build"]
    for name in MODELS:
        assert name in build.format_help()
