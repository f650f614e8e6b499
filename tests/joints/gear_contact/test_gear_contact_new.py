"""Tooth contacts from a drawing: Hertz's patch, hollow and flat flanks, refusals."""

import json
import math

import pytest
from conftest import refused_line
from jointfmu_tools import cli

from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.parameters import load

DRAWING = ["--width", "20", "--load", "2000", "--material", "hardened steel", "--Ra", "0.4"]


def made(capsys, *words, path=None):
    out = ["--out", str(path)] if path else []
    assert cli.main(["new", "gear-contact", *words, *out, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(
    ("radii", "curvature"),
    [
        (["12", "30"], 1 / 0.012 + 1 / 0.03),
        (["12", "-30"], 1 / 0.012 - 1 / 0.03),
        (["12", "flat"], 1 / 0.012),
    ],
)
def test_the_patch_is_hertz(capsys, radii, curvature):
    found = made(capsys, *DRAWING, "--radii", *radii)
    E = 0.5 * 206e9 / (1.0 - 0.09)
    b = math.sqrt(4.0 * 2000.0 / (math.pi * 0.02 * E * curvature))
    facts = {name: fact["value"] for name, fact in found["facts"].items()}
    assert facts["half_width"] == pytest.approx(b)
    assert facts["p_hertz"] == pytest.approx(math.sqrt(2000.0 * E * curvature / (math.pi * 0.02)))
    assert found["parameters"]["A_0"] == pytest.approx(2.0 * b * 0.02)


def test_the_file_has_the_stiffness_it_shows(capsys, tmp_path):
    path = tmp_path / "flanks.toml"
    found = made(capsys, *DRAWING, "--radii", "12", "30", path=path)
    file = load(path)
    assert (file.law, file.start("f")) == ("roughness", 2000.0)
    state = GearContactSpring.of(file.values).approach(2000.0)
    assert found["facts"]["K_N"]["value"] == pytest.approx(float(state["K_N"]))
    assert float(state["K_N"]) == pytest.approx(2000.0 / (0.45 * file.values.h), rel=0.1)


@pytest.mark.parametrize(
    ("radii", "text"),
    [
        (["12"], "--radii has 1 values, expected one of each flank"),
        (["-12", "30"], "--radii = -12 30: the flanks do not bulge towards each other"),
        (["flat", "flat"], "do not bulge towards each other"),
        (["0", "30"], "--radii = 0 mm is no radius"),
        (["a", "30"], "--radii = 'a' is no number"),
    ],
)
def test_what_does_not_fit_is_refused(capsys, radii, text):
    assert text in refused_line(capsys, "new", "gear-contact", *DRAWING, "--radii", *radii)
