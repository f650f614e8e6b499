"""The README's code runs and its figures are those of the product."""

import re
import shlex
import shutil
from pathlib import Path

import pytest
from jointfmu_fmu_src.native.build import build as native_build
from jointfmu_fmu_src.partners import parameters as partner_parameters

from jointfmu import cli, validation
from jointfmu.fields import csvfile
from jointfmu.fields.contact import ContactField
from jointfmu.footprint import bolts
from jointfmu.parameters import default

ROOT = Path(__file__).resolve().parent.parent
ASSEMBLY = "models/assemblies/box_specimen.toml"
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, native):
    place = tmp_path_factory.mktemp("readme")
    shutil.copytree(native, place / "dist", ignore=shutil.ignore_patterns(".*"))
    native_build("RotationalInertia", partner_parameters("RotationalInertia"), place / "dist" / "fmi2", "2")
    (place / "my_joint.toml").write_text((ROOT / "models/bolted_joint/box_specimen.toml").read_text())
    (place / "models/assemblies").mkdir(parents=True)
    (place / ASSEMBLY).write_text((ROOT / ASSEMBLY).read_text())
    joint = default("bolted_joint").values
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bolts, "CELLS_ACROSS", 3)  # few nodes are read as many are
        shape, mean = joint.pattern.shape(), 9e3 * joint.n_bolts / joint.A_0
    field = ContactField(joint.A_0 * shape.share, shape.position, mean * shape.equal)
    (place / "my_field.csv").write_text(csvfile.text(field))
    return place


def test_python_blocks_run(folder, monkeypatch):
    monkeypatch.chdir(folder)
    assert len(blocks("python")) == 2
    names = {}
    for block in blocks("python"):
        exec(compile(block, "README.md", "exec"), names)
    # the ramp of the first block ends at 5 N m, the second evaluates 1000 pressures
    assert names["result"]["K_WTS"][-1] > names["result"]["K_WTS"][0] > 1e3
    assert names["state"]["K_N"].shape == (1000,)


commands = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("jointfmu ")]


@pytest.mark.slow
@pytest.mark.parametrize("line", commands)
def test_commands_run(line, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    assert cli.main(shlex.split(line, comments=True)[1:]) == 0
    assert capsys.readouterr().out


def test_every_kind_of_command_is_shown():
    assert {line.split()[1] for line in commands} == {
        "law",
        "build",
        "ramp",
        "validate",
        "surface",
        "fit",
        "uncertainty",
        "sweep",
        "modelica",
        "export",
        "footprint",
        "modes",
        "ring",
    }


def test_figures_are_those_of_the_comparison():
    rows = validation.validate()
    roles = [row.point.role for row in rows]
    said = re.search(r"(\d+) points are compared: (\d+) calibrate, (\d+) validate", README)
    assert said is not None
    assert tuple(map(int, said.groups())) == (
        len(rows),
        roles.count("calibration"),
        roles.count("validation"),
    )
    predicted = {row.point.id: abs(row.error) for row in rows if row.point.role == "validation"}
    stiffness = [e for name, e in predicted.items() if re.fullmatch(r"K_TS\.(max|min)\.\d", name)]
    changes = [e for name, e in predicted.items() if name.startswith("K_TS.eccentricity")]
    # printed: 2.5 %, 0.4 percentage points; rounded to the printed digit
    assert len(stiffness) == 3
    assert round(100 * max(stiffness), 1) == 2.5
    assert len(changes) == 2
    assert round(max(changes), 1) == 0.4


def test_picture_and_links_exist():
    links = re.findall(r"\]\((?!https?:)([^)#]+)\)", README)
    assert links
    for link in links:
        assert (ROOT / link).exists(), link
