"""Wrong or unusual inputs give one line with advice, in Python and on the command line."""

from contextlib import chdir
from dataclasses import dataclass

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools.api.law import law as make_law
from jointfmu_tools.run.ramps.loops import MAX_AMPLITUDE_OVER_NOMINAL, _check_amplitudes

import jointfmu
from jointfmu.contact.laws import LAWS
from jointfmu.contact.laws.roughness import RoughnessLaw
from jointfmu.parameters import format_parameter_file, load_default
from jointfmu.quantity import flatten_parameters


@pytest.fixture
def drive_file(tmp_path):
    path = tmp_path / "drive.toml"
    path.write_text(format_parameter_file(load_default("harmonic_drive", "catalogue")), encoding="utf-8")
    return path


def test_a_midline_beyond_its_end_warns_as_the_fmu_does():
    drive = jointfmu.load("HarmonicDriveSpring")
    end = float(drive.wind_up(30.0))
    with pytest.warns(UserWarning, match=r"torque = 1e\+09 N\.m is outside .*: outside the tabulated law"):
        far = drive.wind_up(1e9)
    with pytest.warns(UserWarning, match=r"wind-up = 1 rad is outside .* rad: outside the tabulated law"):
        torque = drive.torque([0.0, -1.0])
    assert far > end  # the last tangent continues
    assert torque[0] == 0.0 > torque[1]
    np.testing.assert_allclose(drive.torque([end, -end]), [30.0, -30.0])  # a warning would be an error


def test_no_pressure_gives_empty_columns():
    frame = make_law("roughness", Ra1=1e-6, Ra2=1e-6).at_pressure([])
    assert frame["K_N"].shape == (0,)
    assert str(frame).startswith("0 points")


def test_a_law_that_no_joint_has_is_evaluated(monkeypatch):
    """The steps are those of docs/architecture.md: a class, and a line in LAWS."""

    @dataclass(frozen=True, kw_only=True)
    class NewLaw(RoughnessLaw):
        pass

    monkeypatch.setitem(LAWS, "new2026", NewLaw)
    values = flatten_parameters(make_law("roughness").parameters)
    K = make_law("new2026", **values).at_pressure(1e6)["K_N"]
    assert np.all(make_law("roughness").at_pressure(1e6)["K_N"] == K)
    with pytest.raises(ValueError, match="missing"):
        make_law("new2026")


def test_a_parameter_file_in_place_of_another_subject(drive_file, capsys):
    line = refused_line(capsys, "uncertainty", drive_file, "--params", drive_file)
    assert "stated twice; leave out --params" in line
    for command in (("modes",), ("footprint", "compute")):
        line = refused_line(capsys, *command, drive_file, "--preload", "9e3")
        assert "is the parameter file of a harmonic_drive, not an assembly" in line


def test_a_wrong_stiffness_is_looked_for_where_corners_overlap(drive_file, capsys):
    drive_file.write_text(drive_file.read_text(encoding="utf-8").replace("value = 4700.0", "value = 67.0"))
    assert "check the value and the unit of K1" in refused_line(capsys, "report", drive_file)


def test_a_built_fmu_is_no_parameter_file(capsys, tmp_path):
    path = tmp_path / "BoltedJoint.fmu"
    path.write_bytes(b"PK\x03\x04\xff\xfe")
    line = refused_line(capsys, "report", path)
    assert "is a built FMU; expected the parameter file" in line
    assert "BoltedJoint," in line  # the name, which is accepted


def test_a_similar_command_is_suggested(capsys):
    with pytest.raises(SystemExit):
        jointfmu_main("bild")
    assert capsys.readouterr().err.rstrip().endswith("did you mean build?")


def jointfmu_main(*words):
    from jointfmu_tools.cli import main

    return main([*words])


class Description:
    """Description of an FMU with one input."""

    class Input:
        """Displacement input."""

        name, unit, nominal = "s_rel_x", "m", "1e-6"

    modelVariables = (Input,)


def test_a_loop_of_a_metre_is_asked_about():
    _check_amplitudes(Description, "s_rel_x", [1e-6, MAX_AMPLITUDE_OVER_NOMINAL * 1e-6])
    with pytest.raises(ValueError, match=r"loop = 1 m of s_rel_x is outside \(0, 0.01\] m: values are in SI"):
        _check_amplitudes(Description, "s_rel_x", [1e-6, 1.0])


def test_a_deleted_folder_is_said(tmp_path, enter, capsys):
    folder = tmp_path / "gone"
    folder.mkdir()
    enter(chdir(folder))
    folder.rmdir()
    assert jointfmu_main("report", str(tmp_path / "drive.toml")) == 2
    assert (
        capsys.readouterr().err == "jointfmu report: the current folder was deleted; change to another one\n"
    )
