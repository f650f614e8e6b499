"""The whole joint that `new bolted-joint` prints: interface, members and bolts side by side."""

import json
import sys

import pytest
from conftest import refused_line
from jointfmu_tools import cli

M16 = ["--plate", "80x80", "--bolts", "M16", "--grip", "40", "--material", "steel", "--Ra", "0.8"]
LOAD = ["--preload", "60e3"]


def made(capsys, *words):
    assert cli.main(["new", "bolted-joint", *words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    return {name: fact["value"] for name, fact in found["facts"].items()}, found


@pytest.mark.slow
def test_a_bolt_loaded_at_its_heads_is_that_of_vdi_2230(capsys):
    """The cone of VDI 2230 is within 15 to 20 % of finite elements, which hold what lies under a head as one
    face; its opening load is the preload less embedding over 1 - Phi."""
    facts, _ = made(capsys, *M16, *LOAD, "--attached", "heads")
    left, members = 60e3 - facts["embedding"], facts["whole_K_zz"] - facts["bolt_stiffness"]
    assert members == pytest.approx(facts["member_stiffness"], rel=0.2)
    assert facts["whole_load_factor"] == pytest.approx(facts["load_factor"], rel=0.15)
    assert facts["opening_load"] == pytest.approx(left / (1.0 - facts["whole_load_factor"]))
    assert facts["interface_share"] < 0.05


@pytest.mark.slow
def test_the_load_at_the_faces_passes_the_bolts_by(capsys):
    """VDI's factor n: the nearer to the interface a load enters, the less of it the bolts take."""
    heads, _ = made(capsys, *M16, *LOAD, "--attached", "heads")
    faces, found = made(capsys, *M16, *LOAD)
    assert faces["whole_load_factor"] < 0.5 * heads["whole_load_factor"]
    assert heads["whole_K_zz"] < faces["whole_K_zz"] < faces["K_zz"]
    assert "between the outer faces; of its energy" in found["facts"]["whole_K_zz"]["text"]
    assert "the FMU is the whole" in found["facts"]["interface_share"]["text"]


@pytest.mark.slow
def test_four_bolts_share_a_load_evenly(capsys):
    words = ["--plate", "80x80", "--bolts", "4xM8", "--at", "40x40", "--grip", "20", *M16[6:]]
    facts, _ = made(capsys, *words, "--preload", "10e3")
    assert facts["whole_load_factor"] == pytest.approx(4.0 * facts["whole_bolt_share"], rel=1e-2)
    assert facts["whole_K_xx"] == pytest.approx(facts["whole_K_yy"], rel=0.02)  # gmsh's mesh is not symmetric


def test_without_finite_elements_it_is_said(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)
    facts, found = made(capsys, *M16, *LOAD)
    assert "whole_K_zz" not in facts
    (line,) = found["warnings"]
    assert line.startswith("members and bolts are not computed, the FMU is the interface alone: ")
    assert "pip install 'jointfmu[fem]'" in line


def test_heads_that_do_not_fit_are_said(capsys):
    _, found = made(capsys, *M16, *LOAD, "--bearing", "90")
    (line,) = found["warnings"]
    assert "head_diameter = 0.09 m reaches beyond the flange" in line


def test_an_unknown_attachment_is_refused(capsys):
    line = refused_line(capsys, "new", "bolted-joint", *M16, "--attached", "bolts")
    assert "--attached" in line
    assert "heads" in line
