"""Stiffness from the upper tail of the heights: closed forms, and what `surface` prints and writes."""

import json

import numpy as np
import pytest
from jointfmu_tools.cli import main
from jointfmu_tools.inputs.drawing.tables import find_table_row, read_material_or_finish_table
from jointfmu_tools.inputs.surfaces import bearing_curve, csvfile, form, solve, stiffness_table
from jointfmu_tools.inputs.surfaces.bearing_curve import BearingCurve, HeightSample
from jointfmu_tools.inputs.surfaces.heights import ArealMap
from oracles.machined_surfaces import gaussian, lognormal, plateau, sample_periodic

from jointfmu.parameters import load_parameter_file


def sample(heights):
    return HeightSample(heights, np.ones(heights.size))


def test_exponential_heights_have_their_decay_length_at_every_plane():
    z = np.random.default_rng(1).exponential(2e-6, 400_000)
    curve = BearingCurve.from_height_sample(sample(z))
    assert curve.mean_excess[curve.section_area_share > 1e-3] == pytest.approx(2e-6, rel=0.06)


def test_gaussian_heights_have_their_own_tail_and_persson_s_length_at_heavy_load():
    z = np.random.default_rng(2).normal(0.0, 1e-6, 400_000)
    curve = BearingCurve.from_height_sample(sample(z))
    assert curve.gaussian_tail_height == pytest.approx(1e-6, rel=0.02)
    heavy = curve.section_area_share > 0.2
    assert curve.decay_length[heavy] == pytest.approx(0.48e-6, rel=0.02)
    assert np.all(curve.decay_length <= curve.mean_excess)


def test_mean_excess_of_a_normal_distribution_by_integration():
    share = np.array([1e-3, 0.03, 0.38])
    z = np.linspace(-9.0, 9.0, 200_001)
    density = np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi)
    above = np.cumsum(density[::-1])[::-1] * (z[1] - z[0])
    excess = np.cumsum((above)[::-1])[::-1] * (z[1] - z[0]) / above
    expected = np.interp(-np.log(share), -np.log(above), excess)
    assert bearing_curve.gaussian_mean_excess(share) == pytest.approx(expected, rel=1e-3)


def test_modulus_and_slope_act_through_their_product_with_the_share():
    z = np.random.default_rng(3).normal(0.0, 1e-6, 50_000)
    one, steep = (
        BearingCurve.from_height_sample(sample(z)),
        BearingCurve.from_height_sample(HeightSample(z, np.full(z.size, 4.0))),
    )
    p = np.geomspace(0.003, 0.1, 5) * 1e11
    assert steep.normal_stiffness(2.0 * p, 1e11) == pytest.approx(
        2.0 * one.normal_stiffness(p, 1e11), rel=1e-9
    )
    assert one.normal_stiffness(2.0 * p, 2e11) == pytest.approx(2.0 * one.normal_stiffness(p, 1e11), rel=1e-9)


def test_skewed_heights_have_the_tail_of_lognormal_surfaces():
    for exponent in (-0.3, 0.3):
        z = np.sign(exponent) * np.exp(exponent * np.random.default_rng(4).normal(size=400_000))
        found = sample(z)
        tail = BearingCurve.from_height_sample(found).gaussian_tail_height / z.std()
        assert bearing_curve.lognormal_tail_over_rms_height(found.standardized_moment(3)) == pytest.approx(
            tail, rel=0.03
        )
    assert bearing_curve.lognormal_tail_over_rms_height(0.0) == 1.0


def test_gap_of_two_surfaces_has_the_sum_of_their_moments():
    first = sample_periodic(lognormal(1, 128, 0.6))
    gap = bearing_curve.add_independent_surfaces(first, first)
    assert gap.heights.std() == pytest.approx(np.sqrt(2.0), rel=0.02)
    assert gap.standardized_moment(3) == pytest.approx(first.standardized_moment(3) / np.sqrt(2.0), rel=0.05)
    assert gap.squared_slopes.mean() == pytest.approx(2.0 * first.squared_slopes.mean(), rel=0.03)


def test_sample_of_a_scan_has_its_height_and_its_slope_where_it_is_steep():
    n, d = 256, 1e-6
    z = 1e-6 * plateau(3, n, 0.55, 0.1)
    heights = ArealMap(z=z, dx=d, dy=d, scan_name="scan")
    scan = form.compute_scan_roughness(heights, heights, n * d)
    assert scan.height_sample.heights.std() == pytest.approx(scan.long_wave_rms_height, rel=0.02)
    assert np.sqrt(scan.height_sample.squared_slopes.mean()) == pytest.approx(scan.rms_slope, rel=1e-9)
    valley = scan.height_sample.heights < -1e-6
    assert (
        scan.height_sample.squared_slopes[valley].mean() > scan.height_sample.squared_slopes[~valley].mean()
    )


@pytest.fixture
def scan(tmp_path):
    def write(z, name="scan.csv"):
        path = tmp_path / name
        path.write_text(csvfile.format_scan_csv(ArealMap(z=0.5e-6 * z, dx=4e-6, dy=4e-6, scan_name=name)))
        return path

    return write


def surface(capsys, *arguments):
    assert main(["surface", *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_plateau_gets_the_law_table_and_gaussian_heights_the_law_roughness(capsys, scan, tmp_path):
    for z, law, skewness in (
        (plateau(5, 128, 0.55, 0.1), "table", -1.4),
        (gaussian(5, 128), "roughness", 0.0),
    ):
        out = tmp_path / f"{law}.toml"
        found = surface(capsys, scan(z), "--side", "1", "--joint", "bolted_joint", "--out", out)
        assert load_parameter_file(out).law == law == found["law"]
        assert found["roughness"]["scans"][0]["Ssk"] == pytest.approx(skewness, abs=0.2)
        assert found["roughness"]["gaussian"] == (law == "roughness")
    file = load_parameter_file(tmp_path / "table.toml")
    assert file.values.table.stiffness == pytest.approx(surface_points(capsys, scan, tmp_path), rel=1e-4)
    assert file.ranges["table.factor"] == bearing_curve.SURFACE_OVER_LAW_STIFFNESS_RANGE


def test_a_joint_that_is_not_the_users_is_named(capsys, scan, tmp_path):
    """With --joint, all but the surface is of the shipped joint; with --params, of the user's file."""
    out, z = tmp_path / "joint.toml", gaussian(5, 128)
    first = surface(capsys, scan(z), "--side", "both", "--joint", "bolted_joint", "--out", out)
    second = surface(capsys, scan(z), "--side", "both", "--params", out, "--out", tmp_path / "second.toml")
    named = [[text for text in one["warnings"] if "shipped joint" in text] for one in (first, second)]
    assert "box specimen of Zhao 2018" in named[0][0]
    assert named[1] == []


def surface_points(capsys, scan, tmp_path):
    """Stiffness in the file for `new --interface-table`."""
    table = tmp_path / "points.csv"
    surface(capsys, scan(plateau(5, 128, 0.55, 0.1)), "--side", "1", "--table", table)
    return np.loadtxt(table, delimiter=",", skiprows=2)[:, 1]


def test_new_takes_the_table_of_a_scan(capsys, scan, tmp_path):
    surface_points(capsys, scan, tmp_path)
    arguments = "new gear-contact --radii 20 30 --width 10 --load 500 --material steel --interface-table"
    out = tmp_path / "contact.toml"
    assert main([*arguments.split(), str(tmp_path / "points.csv"), "--out", str(out)]) == 0
    assert load_parameter_file(out).law == "table"


def test_a_profile_cannot_be_solved(capsys, tmp_path):
    path = tmp_path / "line.csv"
    x = np.arange(256) * 1e-6
    z = 1e-7 * np.sin(1e5 * x) + 1e-8 * np.random.default_rng(1).normal(size=x.size)
    path.write_text("# profile: x [m], z [m]\n" + "".join(f"{a},{b}\n" for a, b in zip(x, z, strict=True)))
    assert main(["surface", str(path), "--solve"]) == 2
    assert "is a profile; a boundary-element solution needs an areal map" in capsys.readouterr().err


def test_scans_of_different_spacing_are_no_pair():
    one = ArealMap(z=gaussian(1, 64), dx=1e-6, dy=1e-6, scan_name="one")
    other = ArealMap(z=gaussian(1, 64), dx=2e-6, dy=2e-6, scan_name="other")
    with pytest.raises(ValueError, match="other: spacing = 2e-06 x 2e-06 m, one has 1e-06"):
        solve.compute_gap_heights([one, other])


def test_drives_have_no_interface_table():
    assert stiffness_table.has_table_law("bolted_joint")
    assert not stiffness_table.has_table_law("harmonic_drive")


@pytest.mark.parametrize(("options", "is_known"), [("--finish ground", True), ("--Ra 0.8", False)])
def test_a_finish_gives_gamma_the_range_of_its_skewness(capsys, tmp_path, options, is_known):
    out = tmp_path / "contact.toml"
    words = f"new gear-contact --radii 20 30 --width 10 --load 500 --material steel {options}"
    assert main([*words.split(), "--out", str(out)]) == 0
    assert ("does not state the height distribution" in capsys.readouterr().err) != is_known
    file = load_parameter_file(out)
    assert file.values.gamma == 0.45
    if is_known:
        numbers = find_table_row("finishes", "ground").sourced_numbers
        expected = [
            0.45
            * bearing_curve.lognormal_tail_over_rms_height(numbers[f"skewness_{end}"].si_value / np.sqrt(2.0))
            for end in ("low", "high")
        ]
        assert file.ranges["gamma"] == pytest.approx(expected, rel=1e-6)
    else:  # who knows less has the wider range: that of every finish
        low, high = file.ranges["gamma"]
        for finish in read_material_or_finish_table("finishes"):
            stated = tmp_path / f"{finish}.toml"
            words = f"new gear-contact --radii 20 30 --width 10 --load 500 --material steel {options}"
            assert main([*words.split(), "--finish", finish, "--out", str(stated)]) == 0
            known = load_parameter_file(stated).ranges["gamma"]
            assert low <= known[0] < known[1] <= high, finish
