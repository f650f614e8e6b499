"""Tables of curves: their stated errors, and each format read by another program."""

import json
import re
from contextlib import chdir

import numpy as np
import pytest
from jointfmu_tools import cli
from jointfmu_tools.exchange.export import keywords, tables, writing
from jointfmu_tools.exchange.export.target_model import SI_UNIT_SET, UNIT_SETS
from jointfmu_tools.joints.bolted_joint.export import (
    MAX_TABULATED_OVER_TIGHTENING_FORCE,
    TightenedState,
    tabulate_normal_force,
)
from scipy.interpolate import PchipInterpolator

import jointfmu
from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default, load_parameter_file

MM = UNIT_SETS["mm-N-MPa-t"]
STATE = TightenedState(9e3, 0.0)


@pytest.fixture(scope="module")
def bolted():
    return BoltedJointSpring.from_interface_nodes(load_default("bolted_joint").values)


@pytest.fixture(scope="module")
def gear():
    return GearContactSpring.tabulate(load_default("gear_contact").values)


@pytest.fixture(scope="module")
def drive():
    return HarmonicDriveSpring.tabulate(load_default("harmonic_drive").values)


# ---- errors ----


@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("joint", ["bolted", "gear"])
def test_law_table_keeps_to_the_law(joint, error, request):
    spring = request.getfixturevalue(joint)
    law, curve = spring.joint, spring.curve
    table = tables.tabulate_law(curve, error)
    x, p, k = table.table_rows.T
    assert np.all(np.diff(x) > 0.0)
    assert np.all(np.diff(p) > 0.0)
    assert table.table_rows[0].tolist() == [0.0, 0.0, 0.0]
    assert p[1] == pytest.approx(curve.closing_end_pressure, rel=1e-9)
    assert p[-1] == pytest.approx(law.hardness, rel=1e-9)
    state = evaluate_at_pressure(law, p[1:])
    np.testing.assert_allclose(k[1:], state["K_N"] / law.A_0, rtol=1e-7)  # the curve is within 1e-8
    some = np.geomspace(curve.closing_end_pressure, 0.999 * curve.end_point[1], 20001)
    at = curve.inverse(some) - curve.displacement[0]
    straight = np.max(np.abs(np.interp(at, x, p) / some - 1.0))
    # between the points at which the table was measured the error hardly grows
    assert straight <= 1.01 * table.linear_interpolation_errors[0] <= 1.01 * error
    slopes = (np.diff(p) / np.diff(x))[np.searchsorted(x, at, side="right") - 1]
    exact = curve.derivatives(at + curve.displacement[0], 1)[1]
    assert np.max(np.abs(slopes / exact - 1.0)) <= 1.02 * table.linear_interpolation_errors[1]
    cubic = PchipInterpolator(x, p)
    above = at > x[2]  # the first segment belongs to the closing
    assert np.max(np.abs(cubic(at) / some - 1.0)[above]) <= 1.05 * table.monotone_cubic_errors[0]


def test_error_falls_with_the_square_of_the_rows(bolted):
    rows = [len(tables.tabulate_law(bolted.curve, error).table_rows) for error in (4e-3, 1e-3, 2.5e-4)]
    # straight lines: second order; a whole number of rows
    assert rows[1] / rows[0] == pytest.approx(2.0, rel=0.06)
    assert rows[2] / rows[1] == pytest.approx(2.0, rel=0.06)


def test_pull_table_is_the_joints_force(bolted):
    table = tabulate_normal_force(bolted, 9e3, 500.0, 1e-3)
    s, force, k = table.table_rows.T
    assert np.all(np.diff(s) > 0.0)
    assert np.all(np.diff(force) >= 0.0)
    zero = int(np.flatnonzero(s == 0.0)[0])
    assert abs(force[zero]) < 1e-6  # N, of 72 kN: round-off of the sum
    for i in (0, 5, zero - 1, zero, zero + 1, len(s) - 3):
        state = bolted.evaluate(9e3, 500.0, (0.0, 0.0, s[i]), (0.0, 0.0, 0.0))
        assert -force[i] == pytest.approx(state["f_z"], rel=1e-9, abs=1e-6)
        assert k[i] == pytest.approx(state["K_zz"], rel=1e-9, abs=1.0)
    assert force[-1] == force[-2] == pytest.approx(72e3, rel=1e-12)
    assert force[0] == pytest.approx(
        -(MAX_TABULATED_OVER_TIGHTENING_FORCE - 1.0) * 72e3, rel=1e-3
    )  # its end is interpolated
    for x in np.linspace(s[0], s[-2], 101):
        exact = -bolted.evaluate(9e3, 500.0, (0.0, 0.0, x), (0.0, 0.0, 0.0))["f_z"]
        assert abs(np.interp(x, s, force) - exact) <= 1.01e-3 * max(abs(exact), 72e3)


def test_drive_table_is_odd_and_keeps_to_the_curve(drive):
    table = tables.tabulate_odd_curve(drive.curve, 1e-3)
    np.testing.assert_array_equal(table.table_rows[:, :2], -table.table_rows[::-1, :2])
    np.testing.assert_array_equal(table.table_rows[:, 2], table.table_rows[::-1, 2])
    tau = np.geomspace(1e-3, 30.0, 5001)
    phi = drive.evaluate_torque(tau)["phi_rel"]
    assert np.max(np.abs(np.interp(phi, *table.table_rows[:, :2].T) / tau - 1.0)) <= 1.01e-3


@pytest.mark.parametrize("error", [0.0, -1e-3, 0.5, np.nan, 1e-9])
def test_errors_that_no_table_has_are_refused(bolted, error):
    with pytest.raises(ValueError, match="error = "):
        tables.tabulate_law(bolted.curve, error)


def test_state_outside_the_law_is_refused(bolted):
    with pytest.raises(ValueError, match="preload = -5 N per bolt"):
        tabulate_normal_force(bolted, -5.0, 0.0, 1e-3)


# ---- formats ----


def test_contact_text(bolted):
    table = tables.tabulate_law(bolted.curve, 1e-3)
    text = keywords.format_contact(table, MM, ["about"], keywords.MAX_CALCULIX_TABLE_ROWS)
    cards = [line for line in text.splitlines() if line.startswith("*") and not line.startswith("**")]
    assert cards == [
        "*SURFACE INTERACTION, NAME=JOINT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
    ]
    rows = np.loadtxt(text.splitlines(), delimiter=",", comments="*")
    np.testing.assert_allclose(rows[:-1, 0], table.table_rows[:, 1] / 1e6, rtol=1e-10)  # eleven digits
    np.testing.assert_allclose(rows[:-1, 1], table.table_rows[:, 0] * 1e3, rtol=1e-10)
    # the last row continues the tangent by a metre, 1000 mm
    assert rows[-1, 1] - rows[-2, 1] == pytest.approx(1e3)
    assert (rows[-1, 0] - rows[-2, 0]) / 1e3 == pytest.approx(table.table_rows[-1, 2] / 1e9, rel=1e-9)
    assert max(len(cell) for line in text.splitlines()[-9:] for cell in line.split(", ")) <= 20  # ccx: f20.0


def test_calculix_refuses_more_rows_than_it_holds():
    file = load_default("bolted_joint")
    rows = writing.export_contact("abaqus", file, SI_UNIT_SET, 1e-4).printed_quantities["rows"]
    assert rows > 200
    with pytest.raises(ValueError, match=f"has {rows + 1} rows, CalculiX holds 200; state a larger error"):
        writing.export_contact("calculix", file, SI_UNIT_SET, 1e-4)


@pytest.mark.parametrize("finish", ["ground", "milled", "turned", "lapped"])
def test_calculix_gets_the_smallest_error_that_fits(finish, tmp_path, capsys, enter):
    """The command chooses the smallest error whose table has at most 200 rows, CalculiX's limit.

    The contact of an ordinary steel joint needs more rows at the default error.
    """
    enter(chdir(tmp_path))
    new = "new bolted-joint --plate 80x40 --bolts 2xM10 --at 40x0 --grip 10 15 --hole 11 --sides rigid"
    assert cli.main([*new.split(), "--material", "steel", "--finish", finish, "--out", "c.toml"]) == 0
    file = load_parameter_file("c.toml")
    needed = writing.export_contact("abaqus", file, SI_UNIT_SET, 1e-3).printed_quantities["rows"] + 1
    assert needed > 200
    capsys.readouterr()
    assert (
        cli.main(
            ["export", "calculix", "contact", "--params", "c.toml", "--units", "mm-N-MPa-t", "--out", "c.inp"]
        )
        == 0
    )
    said = capsys.readouterr().err
    found = re.search(r"error = (\S+): smallest error whose table fits the 200 rows of calc.*", said)
    assert f"(0.001 needs {needed} rows)" in found[0]
    error = float(found[1])
    rows = len(np.loadtxt("c.inp", delimiter=",", comments="*"))
    curve = BoltedJointSpring.from_interface_nodes(file.values).curve
    assert rows == len(tables.tabulate_law(curve, error).table_rows) + 1 <= 200
    smaller = error - 10.0 ** np.floor(np.log10(error * 1.0001) - 1.0)
    assert len(tables.tabulate_law(curve, smaller).table_rows) + 1 > 200


def test_error_that_no_table_has():
    table = tables.LoadTable(np.zeros((300, 3)), (0.0, 0.0), (0.0, 0.0))
    with pytest.raises(
        ValueError, match=r"the law needs more than 200 rows for a table with an error of 0\.5"
    ):
        tables.tabulate_within_row_limit(lambda error: table, 1e-3, 200)


@pytest.mark.parametrize(
    ("joint", "state", "heads"),
    [
        ("harmonic_drive", None, "phi_rel [rad],tau [N.m],K_WTS [N.m/rad]"),
        ("gear_contact", None, "s_rel [m],f [N],K_N [N/m]"),
        ("bolted_joint", STATE, "s_rel_z [m],pull [N],K_zz [N/m]"),
    ],
)
def test_csv_is_read_by_numpy(joint, state, heads):
    written = writing.export_curve("csv", load_default(joint), state, SI_UNIT_SET, 1e-3)
    lines = [line for line in written.file_text.splitlines() if not line.startswith("#")]
    assert lines[0] == heads
    rows = np.loadtxt(lines[1:], delimiter=",")
    assert rows.shape == (written.printed_quantities["rows"], 3)
    slope = np.gradient(rows[:, 1], rows[:, 0])[2:-2]
    inside = rows[2:-2, 2] > 0.1 * rows[:, 2].max()
    assert np.max(np.abs(slope / rows[2:-2, 2] - 1.0)[inside]) < 0.01  # central differences of the load


def test_units_of_a_curve():
    metres = writing.export_curve("csv", load_default("gear_contact"), None, SI_UNIT_SET, 1e-2).file_text
    millimetres = writing.export_curve("csv", load_default("gear_contact"), None, MM, 1e-2).file_text
    one, other = (
        np.loadtxt(t.splitlines(), delimiter=",", comments=["#", "s"]) for t in (metres, millimetres)
    )
    np.testing.assert_allclose(other, one * [1e3, 1.0, 1e-3], rtol=1e-10)
    assert "s_rel [mm],f [N],K_N [N/mm]" in millimetres


def test_drive_has_no_contact_table():
    with pytest.raises(ValueError, match="export its curve"):
        writing.export_contact("csv", load_default("harmonic_drive"), SI_UNIT_SET, 1e-3)


# ---- Modelica: the text, and a CombiTable1D of its rows run by rumoca ----

MODEL = """
type Smoothness = enumeration(LinearSegments, ContinuousDerivative);
type Extrapolation = enumeration(HoldLastPoint, LastTwoPoints);
class ExternalCombiTable1D
  extends ExternalObject;
  function constructor
    input String tableName;
    input String fileName;
    input Real table[:, :];
    input Integer columns[:];
    input Smoothness smoothness;
    input Extrapolation extrapolation;
    output ExternalCombiTable1D object;
    external "C" object = ModelicaStandardTables_CombiTable1D_init2(fileName, tableName, table,
      size(table, 1), size(table, 2), columns, size(columns, 1), smoothness, extrapolation, true);
  end constructor;
  function destructor
    input ExternalCombiTable1D object;
    external "C" ModelicaStandardTables_CombiTable1D_close(object);
  end destructor;
end ExternalCombiTable1D;
function value
  input ExternalCombiTable1D object;
  input Integer column;
  input Real u;
  output Real y;
  external "C" y = ModelicaStandardTables_CombiTable1D_getValue(object, column, u);
end value;
model Top
  parameter Real rows[ROWS, 3] = MATRIX;
  parameter ExternalCombiTable1D object = ExternalCombiTable1D("NoName", "NoName", rows, {2, 3},
    Smoothness.LinearSegments, Extrapolation.LastTwoPoints);
  Real x;
  Real load;
  Real stiffness;
equation
  x = SPAN*(2*time - 1);
  load = value(object, 1, x);
  stiffness = value(object, 2, x);
end Top;
"""


def modelica_table(text):
    """Name and rows of a table of the text format: "#1", comments, `double name(rows, columns)`, numbers."""
    lines = text.splitlines()
    assert lines[0] == "#1"
    body = [line for line in lines if not line.startswith("#")]
    name, rows, count = re.fullmatch(r"double (\w+)\((\d+),(\d+)\)", body[0]).groups()
    values = np.loadtxt(body[1:])
    assert values.shape == (int(rows), int(count))
    return name, values


@pytest.mark.parametrize(
    ("joint", "state"), [("harmonic_drive", None), ("gear_contact", None), ("bolted_joint", STATE)]
)
def test_modelica_text(joint, state):
    written = writing.export_curve("modelica", load_default(joint), state, SI_UNIT_SET, 1e-3)
    name, rows = modelica_table(written.file_text)
    assert name == written.printed_quantities["table"] == ("torque" if joint == "harmonic_drive" else "force")
    assert np.all(np.diff(rows[:, 0]) > 0.0)
    csv = writing.export_curve("csv", load_default(joint), state, SI_UNIT_SET, 1e-3).file_text
    same = np.loadtxt([line for line in csv.splitlines() if line[0] in "-0123456789"], delimiter=",")
    np.testing.assert_array_equal(rows, same)


def test_rumoca_runs_a_combi_table_of_the_rows(drive):
    import rumoca

    text = writing.export_curve("modelica", load_default("harmonic_drive"), None, SI_UNIT_SET, 1e-3).file_text
    rows = modelica_table(text)[1]
    matrix = "[" + "; ".join(", ".join(map(repr, row)) for row in rows.tolist()) + "]"
    span = 1.2 * float(rows[-1, 0])
    model = MODEL.replace("ROWS", str(len(rows))).replace("MATRIX", matrix)
    model = model.replace("SPAN", repr(span))
    session = rumoca.Session()
    found = session.loads(model, model="Top", filename="Top.mo").simulate(
        t=(0.0, 1.0), dt=1e-3, config=rumoca.SimConfig(rtol=1e-10, atol=1e-14)
    )
    frame = found.to_dataframe()
    x, load, stiffness = (np.array(frame[name]) for name in ("x", "load", "stiffness"))
    exact, slope = drive.curve.derivatives(np.abs(x), 1)
    inside = (np.abs(x) <= rows[-1, 0]) & (np.abs(x) > 1e-9)
    ratios = (load / np.copysign(np.maximum(exact, 1e-9), x))[inside], (stiffness / slope)[inside]
    errors = [np.max(np.abs(ratio - 1.0)) for ratio in ratios]
    assert errors[0] <= 1.01e-3
    assert errors[1] <= 5e-3  # the third column: straight lines through the stiffness itself
    beyond = x > rows[-1, 0]
    last = (rows[-1, 1] - rows[-2, 1]) / (rows[-1, 0] - rows[-2, 0])
    np.testing.assert_allclose(load[beyond], rows[-1, 1] + last * (x[beyond] - rows[-1, 0]), rtol=1e-9)


def test_header_is_plain_text():
    file = load_default("gear_contact")
    odd = type(file)(file.joint, "Zähne *STEP", file.values, file.origins, file.sources)
    text = writing.export_contact("abaqus", odd, SI_UNIT_SET, 1e-2).file_text
    assert "** parameters: Z?hne *STEP (gear_contact)" in text
    assert text.isascii()
    assert tables.format_modelica_table(np.eye(2), "t", ["a\nb"]).splitlines()[2] == "# a b"


def test_a_catalogue_drive_has_rows_for_a_per_cent_of_its_stiffness(tmp_path, capsys):
    """The limit of 1 % also holds at the corners of the stiffness, smooth or sharp."""
    for corner in (0.04, 0.0):
        file = jointfmu.drive("CSG-25-100", corner=corner).save(tmp_path / "drive.toml")
        out = tmp_path / "curve.txt"
        asked = ["export", "modelica", "curve", "--params", str(file), "--out", str(out), "--json"]
        assert cli.main(asked) == 0
        found = json.loads(capsys.readouterr().out)
        assert found["stiffness_error"] <= 0.01
        assert not [text for text in found["warnings"] if "differs from the stiffness" in text]
        lines = (line.split() for line in out.read_text().split("\n"))
        rows = np.array(
            [row for row in lines if len(row) == 3 and row[0].lstrip("-")[:1].isdigit()], dtype=float
        )
        assert len(rows) == found["rows"]
        x, y = rows[:, 0], rows[:, 1]
        there = jointfmu.load(file).stiffness(0.5 * (y[1:] + y[:-1]))
        np.testing.assert_allclose(np.diff(y) / np.diff(x), there, rtol=0.0101)


def test_a_slope_that_is_off_is_a_warning(tmp_path, capsys):
    out = tmp_path / "curve.csv"
    assert cli.main(["export", "csv", "curve", "--joint", "gear_contact", "--out", str(out)]) == 0
    assert "from the stiffness by up to 4.6 % with straight lines" in capsys.readouterr().err
