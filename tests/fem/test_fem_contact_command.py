"""`jointfmu footprint compute`: printed results, written files, refusals."""

import io
import json
import math
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.cli import main
from jointfmu_tools.fem.convergence import (
    RESULT_UNITS,
    MeshResult,
    observed_orders,
    refinement_series,
    relative_changes,
)

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import load_default, load_parameter_file

pytestmark = pytest.mark.slow

PLATES = """
schema = 1
assembly = "bolted"
name = "two plates"
[side1]
body = "plate"
{plate}
[side2]
body = "plate"
{plate}
[bolts]
layout = "grid"
{bolts}
inside = {{ value = false, kind = "user", source = "test" }}
"""
PLATE = {"length": 0.1, "width": 0.06, "thickness": 0.012, "E": 2.1e11, "nu": 0.3, "density": 7850.0}
BOLTS = {
    "rows": 2.0,
    "columns": 2.0,
    "row_spacing": 0.03,
    "column_spacing": 0.05,
    "hole_diameter": 0.009,
    "head_diameter": 0.014,
}
COARSE = ["footprint", "compute", "--preload", "5e3", "--refinement", "0.5"]
UNITS = {"E": "Pa", "nu": "1", "density": "kg/m3", "rows": "1", "columns": "1"}


def entries(values: dict[str, float]) -> str:
    line = '{} = {{ value = {!r}, unit = "{}", kind = "user", source = "test" }}'
    return "\n".join(line.format(name, value, UNITS.get(name, "m")) for name, value in values.items())


@pytest.fixture(scope="module")
def plates(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("assembly") / "plates.toml"
    path.write_text(PLATES.format(plate=entries(PLATE), bolts=entries(BOLTS)))
    return path


@pytest.fixture(scope="module")
def computed(plates) -> tuple[dict, Path]:
    """Output and folder of one run of the command that writes all files."""
    folder = plates.parent / "out"
    names = {"--out": "joint.toml", "--field": "field.csv", "--plot": "field.png"}
    given = [part for option, name in names.items() for part in (option, str(folder / name))]
    with redirect_stdout(io.StringIO()) as out:
        assert main([*COARSE, str(plates), "--refinement", "0.3", *given, "--json"]) == 0
    return json.loads(out.getvalue()), folder


@needs("gmsh")
def test_what_is_computed(computed):
    found, _ = computed
    assert found["force"] == pytest.approx(20e3, rel=1e-9)  # four bolts
    area = 0.1 * 0.06 - math.pi * 0.009**2
    assert found["area"] == pytest.approx(area, rel=1e-9)
    assert found["p_max"] > found["p_mean"] == pytest.approx(20e3 / found["area"])
    assert len(found["between"]) == 4
    assert found["warnings"] == []
    assert [found[name] for name in ("K_N", "K_rx", "K_ry")] == [
        found["meshes"][-1][name] for name in ("K_N", "K_rx", "K_ry")
    ]


@needs("gmsh")
def test_the_field_as_csv(computed):
    found, folder = computed
    table = np.genfromtxt(folder / "field.csv", delimiter=",", skip_header=1)
    head = (folder / "field.csv").read_text().splitlines()[0]
    assert head == "x [m],y [m],area [m2],pressure [Pa]"
    assert table[:, 2] @ table[:, 3] == pytest.approx(20e3, rel=1e-9)
    assert table[:, 2].sum() == found["area"]


@needs("gmsh")
def test_the_picture(computed):
    assert (computed[1] / "field.png").read_bytes().startswith(b"\x89PNG")


@needs("gmsh")
def test_the_joint_has_the_field(computed):
    found, folder = computed
    joint = load_parameter_file(folder / "joint.toml", "bolted_joint").values
    assert (joint.n_bolts, joint.row_bolts, joint.row_distance) == (4.0, 2.0, 0.03)
    assert (joint.side1.E, joint.side1.nu) == (2.1e11, 0.3)
    state = BoltedJointSpring.from_interface_nodes(joint).evaluate(5e3, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    for name, sum_ in (("K_zz", "K_N"), ("K_rx", "K_rx"), ("K_ry", "K_ry")):
        assert state[name] == pytest.approx(found[sum_], rel=1e-6), name  # what the reduction keeps


@needs("gmsh")
def test_vtu_for_paraview(plates, tmp_path):
    import meshio

    path = tmp_path / "field.vtu"
    assert main([*COARSE, str(plates), "--refinement", "1", "--field", str(path)]) == 0
    mesh = meshio.read(path)
    a, b, c, d = (mesh.points[mesh.cells_dict["quad"][:, k], :2] for k in range(4))
    area = 0.5 * np.abs((c - a)[:, 0] * (d - b)[:, 1] - (c - a)[:, 1] * (d - b)[:, 0])
    mean = mesh.point_data["pressure"][mesh.cells_dict["quad"]].mean(axis=1)
    assert area.sum() == pytest.approx(0.1 * 0.06 - math.pi * 0.009**2, rel=1e-9)
    assert area @ mean == pytest.approx(20e3, rel=5e-3)  # trapezoidal rule; 1e-2 is refused by an import


@needs("gmsh")
def test_a_pressure_beyond_the_hardness_is_said(plates, capsys):
    assert main([*COARSE, str(plates), "--preload", "1e9"]) == 0
    said = capsys.readouterr()
    lines = said.err.splitlines()
    assert all(line.startswith("warning: ") for line in lines)
    assert lines[0].startswith("warning: preload = 1e+09 N is above ")
    assert "warning: a pressure of " in said.err
    hardness = load_default("bolted_joint").values.hardness
    assert f"above the hardness of the softer body, {hardness:.4g} Pa" in said.err


@needs("gmsh")
def test_refinement_prints_changes(plates, capsys):
    assert main([*COARSE, str(plates), "--refine", "2", "--moment", "100"]) == 0
    out = capsys.readouterr().out
    assert "change to   0.50" in out
    assert "moment 100 N.m" in out


REFUSED = [
    (["--preload", "0"], "preload = 0 N is outside (0, inf)"),
    (["--preload", "5e3", "--moment", "1e6"], "moment = 1e+06 N.m is outside (-300, 300)"),
    (["--refinement", "0.1"], "--refinement = 0.1 is outside [0.3, 4]"),
    (["--refine", "0"], "--refine = 0 is outside [1, 5]"),
    (["--field", "field.dat"], "suffix '.dat' is not of a pressure field, allowed are .csv, .vtu"),
    (["--plot", "field.gif"], "suffix '.gif' is not that of a picture"),
    (["--out", "."], "is a folder"),
    (["--params", "nowhere.toml"], "nowhere.toml: cannot be read"),
]


@pytest.mark.parametrize(("given", "text"), REFUSED)
def test_refused(plates, capsys, given, text):
    assert main([*COARSE, str(plates), *given]) == 2
    error = capsys.readouterr().err
    assert text in error
    assert error.count("\n") == 1


def test_observed_orders():
    """Values like 1 + h^2 have the order two; values that do not converge have none."""
    rows = [
        MeshResult(refinement, 1, 1, dict.fromkeys(RESULT_UNITS, 1.0 + 1e-4 / refinement**2))
        for refinement in refinement_series(3)
    ]
    assert observed_orders(rows)["peak"] == pytest.approx(
        2.0, abs=1e-3
    )  # changes are relative to 1 + 1e-4 h^2
    assert [round(r.refinement, 3) for r in rows] == [0.707, 1.0, 1.414]
    worse = [*rows[:2], replace(rows[2], result_values=dict.fromkeys(RESULT_UNITS, 2.0))]
    assert math.isnan(observed_orders(worse)["peak"])
    assert relative_changes(rows)[0]["K_N"] < 0.0
