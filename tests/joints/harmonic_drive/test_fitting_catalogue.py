"""A catalogue row to the law of its lines, and to the smooth law of the contact pair, down to the FMU."""

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from conftest import here_alone, refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.harmonic_drive.fit import catalogue, lines
from jointfmu_tools.joints.harmonic_drive.fit.drive import windup
from jointfmu_tools.ramps import ramp

from jointfmu.joints.harmonic_drive.spring import torque_curve
from jointfmu.parameters import load

pytestmark = pytest.mark.slow

SIZE_14 = {"K1": 4700.0, "K2": 6100.0, "K3": 7100.0, "T1": 2.0, "T2": 6.9}
SHIPPED = Path(str(files("jointfmu_models") / "catalogue" / "size_14_ratio_80.toml"))


def row(K1, K2, K3, T1, T2, rated=None):
    return catalogue.Row(K1=K1, K2=K2, K3=K3, T1=T1, T2=T2, rated=rated or T2)


def options(**values):
    return [text for name, value in values.items() for text in (f"--{name}", str(value))]


def test_angle_of_the_polygon():
    one = row(**SIZE_14)
    expected = [0.0, 1 / 4700, 2 / 4700, 2 / 4700 + 4.9 / 6100, 2 / 4700 + 4.9 / 6100 + 3.1 / 7100]
    np.testing.assert_allclose(one.angle([0.0, 1.0, 2.0, 6.9, 10.0]), expected, rtol=1e-15)


@pytest.mark.parametrize(
    "one",
    [
        row(**SIZE_14),
        row(**SIZE_14, rated=4.0),
        row(**SIZE_14, rated=9.5),
        row(24000, 30000, 49000, 29, 108),  # the steepest last rise of the catalogue
        row(67000, 110000, 120000, 29, 108),  # the steepest first
        row(440, 670, 840, 0.29, 0.75),
    ],
    ids=str,
)
def test_angles_are_kept(one):
    found = catalogue.fit(one)
    kept = np.array([one.T1, one.T2, one.rated])
    np.testing.assert_allclose(windup(found.parameters.values, kept), one.angle(kept), rtol=0.01)
    assert found.parameters.values.max_torque == catalogue.MAX_OVER_RATED * one.rated


def test_shipped_example_is_this_fit(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1767225600")
    out = tmp_path / "out.toml"
    source = "Harmonic Drive catalogue, CSG/HFUC series, size 14, ratio 80 and more"
    given = options(**SIZE_14, ratio=100, source=source, law="hu2023", out=out)
    assert cli.main(["fit", "catalogue", *given]) == 0
    assert "not determined" in capsys.readouterr().out  # three angles do not fix three parameters
    made, shipped = load(out), load(SHIPPED)
    assert (made.name, made.sources, made.origins) == (shipped.name, shipped.sources, shipped.origins)
    torque = np.linspace(0.1, 27.0, 50)
    # another platform's round-off may end the fit elsewhere along what is not determined
    np.testing.assert_allclose(windup(made.values, torque), windup(shipped.values, torque), rtol=1e-4)


def test_fmu_passes_through_the_catalogue(tmp_path):
    from jointfmu_fmu_src.building import build

    with here_alone():
        build(["HarmonicDriveCompliance"], ["fmi2"], load(SHIPPED), tmp_path)
    path = tmp_path / "fmi2" / "HarmonicDriveCompliance.fmu"
    columns = ramp.run(path, "tau", 6.9, 0.1, {}).columns
    for T in (2.0, 6.9):
        i = int(np.argmin(np.abs(columns["tau"] - T)))
        assert columns["phi_rel"][i] == pytest.approx(row(**SIZE_14).angle(T), rel=0.01)


def test_a_row_beyond_the_law_is_said(capsys):
    """K3 = 1.6 K2 with the rated torque far above T2: the law's stiffness does not rise that fast."""
    values = {"K1": 24000, "K2": 30000, "K3": 49000, "T1": 29, "T2": 108}
    given = options(**values, law="hu2023")
    assert cli.main(["fit", "catalogue", *given, "--rated-torque", "151.2"]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "keeps the angle of K1 = 24000" in err


def test_the_lines_stay_where_no_smooth_law_keeps_them():
    one = row(24000, 30000, 49000, 29, 108, rated=151.2)
    found = lines.fit(one)
    assert "keeps the angle of K1 = 24000" in found.notes[0]
    assert "pair_angle_error" not in found.facts
    assert windup(found.parameters.values, np.array(151.2)) == pytest.approx(one.angle(151.2), rel=1e-12)


def test_the_default_keeps_the_lines_and_tells_what_the_pair_makes_of_them(tmp_path, capsys):
    """CSG-17-100; the smooth law is 14 % below K1 without torque and some per cent above K3."""
    out, picture = tmp_path / "out.toml", tmp_path / "fit.svg"
    given = options(K1="1.0", K2="1.4", K3="1.6", T1="3.9Nm", T2=12, out=out, plot=picture)
    given += ["--stiffness-unit", "1e4 Nm/rad", "--rated-torque", "31", "--json"]
    assert cli.main(["fit", "catalogue", *given]) == 0
    document = json.loads(capsys.readouterr().out)
    file = load(out)
    assert file.law == "catalogue"
    assert {name: document["parameters"][name] for name in ("K1", "K2", "K3", "T1", "T2")} == {
        "K1": 1e4, "K2": 1.4e4, "K3": 1.6e4, "T1": 3.9, "T2": 12.0,
    }  # fmt: skip
    assert document["unknowns"] == []
    facts = {name: fact["value"] for name, fact in document["facts"].items()}
    assert all(abs(facts[f"angle_error_{name}"]) < 0.005 for name in ("T1", "T2", "rated", "max"))
    pair = catalogue.fit(row(1e4, 1.4e4, 1.6e4, 3.9, 12, rated=31.0)).parameters.values
    K = torque_curve(pair).stiffness[0]
    assert facts["pair_stiffness_zero"] == pytest.approx(K / 1e4 - 1.0, rel=1e-9)
    assert facts["pair_stiffness_zero"] < -0.1
    assert abs(facts["pair_angle_error"]) > 0.1
    assert picture.stat().st_size > 0


def test_nothing_is_free_in_the_law_of_the_lines(capsys):
    line = refused_line(capsys, "fit", "catalogue", *options(**SIZE_14, free="K1"))
    assert "--free is allowed with --law hu2023" in line


def test_json(capsys):
    assert cli.main(["fit", "catalogue", *options(**SIZE_14, law="hu2023"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert abs(document["facts"]["angle_error_T2"]["value"]) < 0.01
    assert {row["name"] for row in document["unknowns"]} == set(catalogue.FREE)


IN_1E4 = {"K1": 1.0, "K2": 1.4, "K3": 1.6, "T1": 3.9, "T2": 12, "rated-torque": 12}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"K2": 4000}, "K2 = 4000 N.m/rad is outside [4700, inf): the drive stiffens"),
        ({"T2": 1.5}, "T2 = 1.5 N.m is outside (2, inf)"),
        ({"K1": -1}, "K1 = -1 N.m/rad is outside (0, inf): stiffness below T1"),
        ({"rated-torque": "nan"}, "rated = nan N.m is outside (0, inf): rated torque"),
        ({"ratio": 0}, "ratio = 0 is outside (0, inf)"),
        (IN_1E4, "K1 = 1 N.m/rad winds up 9.69 rad at the rated torque 12 N.m, allowed are 1e-05 to 0.1 rad"),
        (IN_1E4, "likely they are in 1e4 N.m/rad: times 10000"),
        (IN_1E4 | {"K1": 2.9, "K2": 3.9, "K3": 4.4}, "likely they are in N.m/arcmin: times 3437.75"),
        (IN_1E4 | {"K1": 1e8, "K2": 1e8, "K3": 1e8}, "1.2e-07 rad at the rated torque"),
        ({"free": "K_FTS", "law": "hu2023"}, "'K_FTS' is no parameter to fit"),
        ({"K1": "4700N"}, "--K1 = '4700N': unit 'N.m/rad' does not measure what 'N' does"),
    ],
)
def test_bad_rows(change, message, capsys):
    assert message in refused_line(capsys, "fit", "catalogue", *options(**SIZE_14 | change))
