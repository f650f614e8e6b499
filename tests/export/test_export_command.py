"""Command `jointfmu export`: written files, messages, refusals."""

import json
import re
import subprocess
import sys
from contextlib import chdir

import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.exchange.export.exports import CONTENTS_BY_FORMAT

from jointfmu import __version__
from jointfmu.parameters import format_parameter_file, load_default

MARKS = {
    "ansys": "!",
    "calculix": "**",
    "abaqus": "**",
    "nastran": "$",
    "aster": "#",
    "modelica": "#",
    "csv": "#",
}


@pytest.fixture(autouse=True)
def folder(tmp_path, enter):
    enter(chdir(tmp_path))
    return tmp_path


def run(capsys, *arguments):
    assert cli.main(["export", *map(str, arguments)]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return out


@pytest.mark.parametrize(
    ("form", "what"), [(form, what) for form, kinds in CONTENTS_BY_FORMAT.items() for what in kinds]
)
def test_every_file_says_what_it_is(form, what, folder, capsys):
    options = [] if what == "contact" else ["--preload", "9e3"]
    said = json.loads(run(capsys, form, what, *options, "--out", "sub/joint.txt", "--json"))
    assert {k: said[k] for k in ("written", "format", "what", "units")} == {
        "written": "sub/joint.txt",
        "format": form,
        "what": what,
        "units": "m-N-Pa-kg",
    }
    text = (folder / "sub/joint.txt").read_text()
    head = []
    for line in text.splitlines()[form == "modelica" :]:
        if not line.startswith(MARKS[form]):
            break
        head.append(line)
    comment = "\n".join(head)
    assert f"{MARKS[form]} written by jointfmu {__version__}" == head[0]
    assert "parameters: box specimen of Zhao 2018 (bolted_joint)" in comment
    assert "m-N-Pa-kg" in comment or what == "curve"
    assert ("preload 9000 N per bolt, moment 0 N.m" in comment) == (what != "contact")


def test_files_repeat(folder, capsys):
    for name in ("one.inp", "two.inp"):
        run(capsys, "abaqus", "springs", "--preload", 9e3, "--out", name)
    assert (folder / "one.inp").read_text() == (folder / "two.inp").read_text()


def test_says_what_it_wrote(capsys):
    out = run(capsys, "calculix", "springs", "--preload", 9e3, "--units", "mm-N-MPa-t", "--out", "s.inp")
    assert out.splitlines()[0] == "wrote s.inp: springs for calculix, mm-N-MPa-t"
    said = dict(line.split()[:2] for line in out.splitlines()[1:])
    joint = load_default("bolted_joint").values
    assert said["pairs"] == "1188"
    assert re.search(r"K_zz +\S+ N/m$", out, flags=re.MULTILINE)
    assert float(said["K_xx"]) / float(said["K_zz"]) == pytest.approx(0.445, abs=1e-3)
    assert joint.n_bolts == 8.0


def test_own_parameters_and_other_joints(capsys, folder):
    file = load_default("bolted_joint").with_values({"surface.D": 1.5}, "user", "test")
    (folder / "mine.toml").write_text(format_parameter_file(file))
    state = ("--preload", 9e3, "--json", "--out", "s.csv")
    mine = json.loads(run(capsys, "csv", "springs", "--params", "mine.toml", *state))
    plain = json.loads(run(capsys, "csv", "springs", *state))
    assert mine["K_zz"] > 1.1 * plain["K_zz"]
    drive = json.loads(
        run(capsys, "modelica", "curve", "--joint", "harmonic_drive", "--out", "t.txt", "--json")
    )
    assert drive["table"] == "torque"
    assert drive["error"] <= 1e-3
    run(capsys, "abaqus", "contact", "--joint", "gear_contact", "--out", "g.inp")


def test_springs_on_nodes(capsys, folder):
    run(
        capsys,
        "csv",
        "springs",
        "--preload",
        15e3,
        "--moment",
        4500,
        "--units",
        "mm-N-MPa-t",
        "--out",
        "own.csv",
    )
    said = run(
        capsys,
        *("ansys", "springs", "--nodes", "own.csv", "--first", 70001, "--first-set", 12),
        *("--out", "s.cdb", "--json"),
    )
    facts = json.loads(said)
    plain = json.loads(
        run(capsys, *("csv", "springs", "--preload", 15e3, "--moment", 4500, "--out", "x.csv", "--json"))
    )
    assert facts["K_zz"] == pytest.approx(plain["K_zz"], rel=1e-9)
    text = (folder / "s.cdb").read_text()
    assert "NBLOCK" not in text
    assert "ET,       12,  27" in text
    assert re.search(r"^EBLOCK,19,SOLID, +72376, +2376$", text, flags=re.MULTILINE)
    assert "pressures of own.csv" in text


E = [
    (("ansys", "contact"), "ansys contact cannot be written; ansys has springs"),
    (("modelica", "springs", "--preload", 9e3), "modelica springs cannot be written; modelica has curve"),
    (
        ("calculix", "springs"),
        "springs need --preload, the force of each bolt at tightening [N], or --nodes with a column pressure",
    ),
    (("calculix", "springs", "--preload", -1), "preload = -1 N per bolt with moment = 0 N.m is outside"),
    (("calculix", "springs", "--preload", "nan"), "preload = nan N per bolt"),
    (("calculix", "springs", "--moment", 5), "--moment needs --preload"),
    (("calculix", "springs", "--joint", "gear_contact"), "springs of a gear_contact cannot be written"),
    (("csv", "contact", "--joint", "harmonic_drive"), "the contact of a harmonic_drive cannot be exported"),
    (("csv", "contact", "--preload", 9e3), "--preload has no effect for the contact of a bolted_joint"),
    (("csv", "curve"), "the curve of a bolted_joint needs --preload"),
    (("csv", "curve", "--joint", "gear_contact", "--preload", 1), "--preload has no effect for the curve"),
    (("csv", "contact", "--nodes", "own.csv"), "--nodes has no effect for a contact; it is for springs"),
    (("csv", "contact", "--normal", "x"), "--normal has no effect for a contact"),
    (("csv", "springs", "--preload", 9e3, "--error", 0.1), "--error has no effect for springs"),
    (("csv", "contact", "--error", -1), "error = -1 is outside (0, 0.5)"),
    (("calculix", "contact", "--error", 1e-4), "holds 200; state a larger error (--error)"),
    (("abaqus", "springs", "--nodes", "own.csv"), "--nodes needs --first, a number above all elements"),
    (("ansys", "springs", "--nodes", "own.csv", "--first", 9), "--nodes needs --first-set, a number above"),
    (("calculix", "springs", "--preload", 9e3, "--first-set", 9), "--first-set has no effect for calculix"),
    (("ansys", "springs", "--preload", 9e3, "--first-set", -9), "--first-set = -9 is outside [1, 100000]"),
    (("ansys", "springs", "--nodes", "none.csv", "--first", 5, "--first-set", 5), "none.csv: cannot be read"),
    (("ansys", "springs", "--preload", 9e3, "--first", 0), "--first = 0 is outside [1, 10000000]"),
    (("csv", "springs", "--nodes", "own.csv", "--preload", 9e3), "own.csv states the pressures; leave out"),
    (
        ("modelica", "curve", "--preload", 9e3, "--units", "mm-N-MPa-t"),
        "a Modelica table is always in m-N-Pa-kg",
    ),
    (("radioss", "springs"), "argument FORMAT: invalid choice: 'radioss'"),
    (("csv", "springs", "--preload", 9e3, "--units", "inch"), "argument --units: invalid choice: 'inch'"),
    (("csv", "contact", "--params", "none.toml"), "none.toml: cannot be read"),
]


@pytest.mark.parametrize(("arguments", "said"), E, ids=[said for _, said in E])
def test_refusals_are_one_line_and_write_nothing(arguments, said, folder, capsys):
    (folder / "own.csv").write_text(
        "node_1 [1],node_2 [1],x [m],y [m],area [m2],pressure [Pa]\n"
        "1,4,0,0,0.01,1e6\n2,5,1,0,0.01,1e6\n3,6,0,1,0.0182,1e6\n"
    )
    assert said in refused_line(capsys, "export", *arguments, "--out", "joint.txt")
    assert [p.name for p in folder.iterdir()] == ["own.csv"]


def test_place_that_cannot_be_written(folder, capsys):
    assert "is a folder" in refused_line(capsys, "export", "csv", "contact", "--out", folder)
    assert "the following arguments are required: --out" in refused_line(capsys, "export", "csv", "contact")


def test_what_can_be_written_and_fitted_is_known_without_scipy():
    program = (
        "import sys\n"
        "from jointfmu_tools.cli.commands import export, fit\n"
        "from jointfmu_tools.cli.command import Parser\n"
        "words = Parser().add_subparsers()\n"
        "export.add_command(words), fit.add_command(words)\n"
        "print([name for name in ('scipy', 'matplotlib') if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
