"""Gear meshes from a drawing: geometry against printed numbers, patches, every refusal."""

import json
import math

import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.gear_mesh.new.wheels import Wheels

from jointfmu.parameters import default, load

DRAWING = ["--module", "4", "--teeth", "29", "45", "--width", "10", "--torque", "150"]
FACES = ["--material", "hardened steel", "--Ra", "0.4"]


def made(capsys, *words, path=None):
    out = ["--out", str(path)] if path else []
    assert cli.main(["new", "gear-mesh", *words, *out, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def wheels(helix=0.0, width=0.01):
    return Wheels(4e-3, (29.0, 45.0), width, math.radians(20.0), math.radians(helix))


def test_the_pair_of_the_shipped_file_comes_out(capsys, tmp_path):
    """models/gear_mesh/beveloid_pair.toml: r_b and contact ratio by hand, c' = 14 N/(mm um)."""
    path = tmp_path / "mesh.toml"
    made(capsys, *DRAWING, *FACES, path=path)
    found, shipped = load(path).values, default("gear_mesh").values
    assert (found.r_b1, found.r_b2) == pytest.approx((shipped.r_b1, shipped.r_b2), rel=1e-6)
    assert found.contact_ratio == pytest.approx(shipped.contact_ratio, abs=2e-3)
    assert found.K_tooth == pytest.approx(shipped.K_tooth, rel=0.03)
    assert found.d == pytest.approx(shipped.d, rel=0.1)
    assert found.teeth1 == shipped.teeth1


def test_the_patch_is_hertz(capsys):
    """R = 1/(1/R1 + 1/R2) with R_i = r_i sin(alpha); b = sqrt(4 F R/(pi L E*)), p = 2 F/(pi b L)."""
    found = made(capsys, *DRAWING, *FACES)
    R1, R2 = (0.5 * 4e-3 * z * math.sin(math.radians(20.0)) for z in (29, 45))
    F = 150.0 / (0.5 * 4e-3 * 29 * math.cos(math.radians(20.0)))
    E = 0.5 * 206e9 / (1.0 - 0.09)
    b = math.sqrt(4.0 * F / (math.pi * 0.01 * E * (1.0 / R1 + 1.0 / R2)))
    facts = {name: fact["value"] for name, fact in found["facts"].items()}
    assert facts["load"] == pytest.approx(F)
    assert facts["p_hertz"] == pytest.approx(2.0 * F / (math.pi * b * 0.01))
    assert found["parameters"]["A_0"] == pytest.approx(2.0 * b * 0.01)
    # bending and roughness in series, for the mean number of pairs
    h, pairs = found["parameters"]["h"], facts["contact_ratio"]
    rough = F / pairs / (0.45 * h)
    expected = pairs / (1.0 / rough + 1.0 / found["parameters"]["K_tooth"])
    assert facts["K"] == pytest.approx(expected, rel=0.02)  # few spots make the interface a little stiffer


def test_a_helix_adds_overlap_and_softens_the_tooth():
    spur, helical = wheels(), wheels(20.0)
    overlap = 0.01 * math.sin(math.radians(20.0)) / (math.pi * 4e-3)
    assert helical.contact_ratio - overlap < spur.contact_ratio
    assert math.tan(helical.transverse_angle) == pytest.approx(
        math.tan(math.radians(20)) / math.cos(math.radians(20))
    )
    assert helical.tooth_stiffness((206e9, 206e9)) < 1.1 * spur.tooth_stiffness((206e9, 206e9))
    # half of steel's modulus on both sides: half the stiffness
    assert spur.tooth_stiffness((103e9, 103e9)) == pytest.approx(0.5 * spur.tooth_stiffness((206e9, 206e9)))


def test_options(capsys):
    base = made(capsys, *DRAWING, *FACES)["parameters"]
    assert base["backlash"] == pytest.approx(2 / 3 * (0.06 + 0.0005 * 148 + 0.12) * 1e-3)  # ISO/TR 10064-2
    changed = made(capsys, *DRAWING, *FACES, "--backlash", "80")["parameters"]
    assert changed["backlash"] == pytest.approx(80e-6)
    steep = made(capsys, *DRAWING, *FACES, "--pressure-angle", "25")["parameters"]
    assert steep["r_b1"] == pytest.approx(0.058 * math.cos(math.radians(25)))
    helical = made(capsys, *DRAWING, *FACES, "--helix-angle", "15")["parameters"]
    assert helical["contact_ratio"] > base["contact_ratio"]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--teeth", "29"], "--teeth has 1 values, expected one of each wheel"),
        (["--teeth", "29", "45.5"], "--teeth = 29 45.5: expected whole numbers"),
        (["--module", "0"], "--module = '0' is outside (0, inf)"),
        (["--pressure-angle", "50"], "--pressure-angle = 50 deg is outside (0, 45)"),
        (["--helix-angle", "-5"], "--helix-angle = -5 deg is outside [0, 60)"),
        (["--width", "200", "--helix-angle", "40"], "contact_ratio"),
        (["--torque", "nan"], "--torque = 'nan' is no number"),
    ],
)
def test_what_does_not_fit_is_refused(capsys, words, text):
    assert text in refused_line(capsys, "new", "gear-mesh", *DRAWING, *FACES, *words)


def test_a_pressure_beyond_the_hardness_is_warned_of(capsys):
    (line,) = made(capsys, *DRAWING, *FACES, "--material", "steel", "--torque", "1000")["warnings"]
    assert "above the hardness" in line
