"""Identification of synthesized surfaces: intervals, ranges, pairs and joints."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.inputs import fractal
from jointfmu_tools.inputs.surfaces import synthesis
from jointfmu_tools.inputs.surfaces.fit import fit_self_affine_law
from jointfmu_tools.inputs.surfaces.form import remove_form
from jointfmu_tools.inputs.surfaces.heights import ArealMap, Profile
from jointfmu_tools.inputs.surfaces.identify import identify_surface
from jointfmu_tools.inputs.surfaces.joint_parameters import fractal_parameters, set_surface_parameters
from jointfmu_tools.inputs.surfaces.results import FractalRoughnessEstimate
from jointfmu_tools.inputs.surfaces.spectrum import power_spectrum, structure_function
from scipy.integrate import quad

from jointfmu.joints import KINDS
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

pytestmark = pytest.mark.slow

SIZE, GAMMA = 1e-3, 1.5


def waves(points):
    return synthesis.FractalWaves(size=SIZE, points=points, gamma=GAMMA)


def gaussian_profile(points, H, G, seed, dx=1e-6):
    """Gaussian self-affine profile: a quarter of a periodic one."""
    n = 4 * points
    f = np.fft.rfftfreq(n, dx)
    f[0] = np.inf
    noise = np.fft.rfft(np.random.default_rng(seed).standard_normal(n))
    z = np.fft.irfft(noise * np.sqrt(0.5 * fractal.height_variance_density(f, H, G) / (f * n * dx) * n), n=n)
    return Profile(z=z[:points].copy(), dx=dx, scan_name="Gaussian")


@pytest.mark.parametrize("H", [0.2, 0.5, 0.8])
def test_structure_constant_is_the_integral_of_the_spectrum(H):
    f, whole = 1.0, 0.0
    for low, high in zip(np.arange(0, 400), np.arange(1, 401), strict=True):  # one period each
        whole += quad(lambda u: u ** (-1 - 2 * H) * (1 - np.cos(2 * np.pi * u)), low, high)[0]
    whole += 400.0 ** (-2 * H) / (2 * H)  # the cosine averages out beyond
    assert fractal.structure_function_constant(H) * f == pytest.approx(whole, rel=1e-5)


@pytest.mark.parametrize("H", [0.2, 0.5, 0.8])
def test_profile_share_is_the_mean_over_directions(H):
    mean = quad(lambda a: np.cos(a) ** (2 * H), 0.0, np.pi / 2)[0] / (np.pi / 2)
    assert fractal.profile_variance_ratio(H) == pytest.approx(mean, rel=1e-8)
    G = 1e-9
    profile = fractal.height_variance_density(1e5, H, G) * fractal.profile_variance_ratio(H)
    isotropic = fractal.areal_fractal_roughness(1.0, H) ** (2 * (1 - H))
    assert fractal.height_variance_density(1e5, H, G) == pytest.approx(profile * isotropic, rel=1e-12)


def test_zhao_equation_30():
    G, D, omega = 1.21e-8, 1.42, 1e5
    g = fractal.zhao_fractal_roughness(G, 2.0 - D, GAMMA)
    printed = g ** (2 * (D - 1)) / (2 * np.log(GAMMA)) * omega ** (2 * D - 5)
    assert fractal.height_variance_density(omega, 2.0 - D, G) / omega == pytest.approx(printed, rel=1e-12)


def test_isotropic_is_hu_equation_1():
    D, G, M, seed = 2.4, 1e-9, 7, 3
    made = synthesis.synthesize_isotropic(waves(64), D, G, M, seed)
    count = int(np.log(32.0) / np.log(GAMMA)) + 1
    phases = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, (M, count))
    x, y = np.meshgrid(np.arange(64) * SIZE / 64, np.arange(64) * SIZE / 64)
    z = np.zeros_like(x)
    for m in range(1, M + 1):
        for n in range(count):
            along = np.hypot(x, y) * np.cos(np.arctan2(y, x) - np.pi * m / M)
            p = phases[m - 1, n]
            z += GAMMA ** ((D - 3) * n) * (np.cos(p) - np.cos(2 * np.pi * GAMMA**n * along / SIZE + p))
    z *= SIZE * (G / SIZE) ** (D - 2) * np.sqrt(np.log(GAMMA) / M)
    np.testing.assert_allclose(made.z, z, atol=1e-12 * np.ptp(z))


def test_textured_is_the_sum_of_two_profiles():
    made = synthesis.synthesize_textured(waves(64), (1.3, 1.6), (1e-9, 1e-10), 5)
    np.testing.assert_allclose(made.z - made.z[:1], (made.z - made.z[:1])[:, :1] + 0 * made.z, atol=1e-18)
    rng = np.random.default_rng(5)
    first = synthesis.random_profile_heights(waves(64), 1.3, 1e-9, rng)
    second = synthesis.random_profile_heights(waves(64), 1.6, 1e-10, rng)
    np.testing.assert_allclose(made.z[3], first + second[3], rtol=1e-12)


@pytest.mark.parametrize(("D", "G"), [(1.2, 1e-12), (1.4, 1e-8), (1.6, 1e-12), (1.8, 1e-8)])
def test_round_trip_of_isotropic_surfaces(D, G):
    for seed in (1, 2):
        one = identify_surface(
            [synthesis.synthesize_isotropic(waves(512), D + 1, G, 20, seed)]
        ).select_best_result()
        assert one.areal_fractal.D_s.estimated_value == pytest.approx(
            D + 1, abs=0.03
        )  # the tolerance that is promised
        assert (
            one.areal_fractal.G_s.confidence_interval_low < G < one.areal_fractal.G_s.confidence_interval_high
        )


@pytest.mark.parametrize("D", [1.2, 1.4, 1.6, 1.8])
@pytest.mark.parametrize("G", [1e-12, 1e-8])
def test_round_trip_of_profiles(D, G):
    for seed in (1, 2):
        one = identify_surface([synthesis.synthesize_profile(waves(4096), D, G, seed)]).select_best_result()
        assert one.profile_fractal.D.estimated_value == pytest.approx(D, abs=0.03)
        assert (
            one.profile_fractal.G.confidence_interval_low < G < one.profile_fractal.G.confidence_interval_high
        )
        assert one.areal_fractal.D_s.estimated_value == pytest.approx(
            one.profile_fractal.D.estimated_value + 1.0, rel=1e-12
        )


def test_textured_surfaces_are_told_by_direction():
    made = synthesis.synthesize_textured(waves(1024), (1.3, 1.6), (1e-9, 1e-10), 1)
    found = identify_surface([made])
    assert found.is_textured
    assert any("textured" in text for text in found.warnings)
    x, y = found.select_best_result("x"), found.select_best_result("y")
    assert x.profile_fractal.D.estimated_value == pytest.approx(1.3, abs=0.03)
    assert y.profile_fractal.D.estimated_value == pytest.approx(1.6, abs=0.03)
    assert x.profile_fractal.G.confidence_interval_low < 1e-9 < x.profile_fractal.G.confidence_interval_high
    assert y.profile_fractal.G.confidence_interval_low < 1e-10 < y.profile_fractal.G.confidence_interval_high
    assert not identify_surface([synthesis.synthesize_isotropic(waves(128), 2.5, 1e-9, 20, 1)]).is_textured


@pytest.mark.parametrize("method", [structure_function, power_spectrum])
def test_intervals_hold_what_they_promise(method):
    """95 % intervals over 40 Gaussian profiles: fewer than 34 hits have a probability below 1.5 %."""
    H, hits = 0.5, 0
    for seed in range(40):
        found = fit_self_affine_law(
            method(remove_form(gaussian_profile(1024, H, 1e-9, seed)), "profile"), 0.0, 1.0
        )
        hits += abs(found.H - H) < 1.96 * np.sqrt(found.parameter_covariance[0, 0])
    assert hits >= 34


def test_noise_and_tilt_do_not_pull_the_structure_function():
    clean = gaussian_profile(4096, 0.7, 1e-9, 4)
    noise = 1.0 * np.std(np.diff(clean.z)) * np.random.default_rng(0).standard_normal(4096)
    rough = clean.replace_heights(clean.z + noise + 1e3 * np.linspace(0.0, np.ptp(clean.z), 4096))
    before, after = (
        fit_self_affine_law(structure_function(one, "profile"), 0.0, 1.0) for one in (clean, rough)
    )
    assert abs(after.H - before.H) < 2.0 * np.sqrt(before.parameter_covariance[0, 0])
    assert after.relative_offset > 0.2 > 0.0 > before.relative_offset


def test_range_ends_where_the_surface_rolls_off():
    """White below 1/(40 um): the search stays on the straight part; a range set by the user gets a
    warning."""
    n, dx, H = 8192, 1e-6, 0.7
    f = np.maximum(np.fft.rfftfreq(n, dx), 1.0 / 40e-6)
    noise = np.fft.rfft(np.random.default_rng(1).standard_normal(n))
    rolled = Profile(z=np.fft.irfft(noise * f ** (-0.5 - H)), dx=dx, scan_name="rolled")
    z = rolled.replace_heights(rolled.z * 1e-7 / rolled.z.std())
    free = identify_surface([z]).select_best_result(series_method="psd")
    assert free.fitted_law.max_scale < 80e-6
    assert free.profile_fractal.D.estimated_value == pytest.approx(2.0 - H, abs=0.1)
    forced = identify_surface([z], scale_range=(5e-6, 1e-3))
    assert any("not self-affine" in text for text in forced.warnings)


def test_short_range_warns():
    found = identify_surface([synthesis.synthesize_isotropic(waves(64), 2.5, 1e-9, 20, 1)])
    assert any("expected at least one" in text for text in found.warnings)


def smooth_profile(points):
    """Profile with amplitudes proportional to f^-2, steeper than for any D > 1: D is at its bound."""
    f = np.fft.rfftfreq(points, 1e-6)
    f[0] = np.inf
    z = np.fft.irfft(np.fft.rfft(np.random.default_rng(1).standard_normal(points)) / f**2)
    return Profile(z=z * 1e-7 / z.std(), dx=1e-6, scan_name="smooth")


@pytest.mark.parametrize("points", [256, 512])
def test_at_the_bound_of_the_dimension_G_is_not_determined(points):
    found = identify_surface([smooth_profile(points)])
    best = found.select_best_result()
    assert best.profile_fractal.D.estimated_value == pytest.approx(
        1.02, abs=1e-3
    )  # 2 less the bound of H in the fit
    for G in (best.profile_fractal.G, best.areal_fractal.G_s):
        assert not G.is_determined
        assert np.isnan([G.estimated_value, G.confidence_interval_low, G.confidence_interval_high]).all()
        assert 200.0 < G.interval_decades < 1000.0  # ln G = .../(2 (D - 1)), 1/(2 * 0.005) = 100 at most
    (text,) = [text for text in found.warnings if text.startswith("G is not determined")]
    assert f"spans {best.profile_fractal.G.interval_decades:.1f} decades" in text
    assert "lies at the end of 1 to 2" in found.undetermined_reason()
    for joint in KINDS:
        before = load_default(joint)
        after = set_surface_parameters(before, found)
        assert after.values == before.values
        assert after.roughness["Rq1"] == found.combined_rms_height
        with pytest.raises(ValueError, match=r"G of smooth is not determined .*; state --range"):
            set_surface_parameters(before, found, set_undetermined=True)


def test_the_command_says_that_G_is_not_determined(tmp_path, capsys):
    path, written = tmp_path / "smooth.csv", tmp_path / "joint.toml"
    profile = smooth_profile(256)
    x = np.arange(profile.z.size) * profile.dx
    np.savetxt(path, np.stack([x, profile.z], axis=1), delimiter=",")
    assert cli.main(["surface", str(path), "--unit", "m"]) == 0
    out, err = capsys.readouterr()
    assert "1.02" in out
    assert "not determined" in out
    assert "surface.D, surface.G not determined: D = 1.02" in out
    assert "warning: G is not determined" in err
    assert cli.main(["surface", str(path), "--unit", "m", "--json"]) == 0
    said = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)  # no NaN, no Infinity
    assert {"value": None, "low": None, "high": None} in [one["profile"]["G"] for one in said["results"]]
    assert said["joints"]["bolted_joint"]["surface.G"] is None
    assert said["determined"]["bolted_joint"] is False
    assert said["not_determined"]["bolted_joint"].startswith("D = 1.02")
    joint = ("--joint", "bolted_joint", "--law", "zhao2018", "--side", "1")
    command = ("surface", path, "--unit", "m", *joint, "--write", written)
    refused = refused_line(capsys, *command, "--force")
    assert f"surface.G of {path} is not determined" in refused
    assert not written.exists()
    assert cli.main([str(word) for word in command]) == 0
    assert "surface.D, surface.G keep their values" in capsys.readouterr().err
    file = load_parameter_file(written)
    assert file.values == load_default("bolted_joint").values
    assert file.roughness == {"Rq1": said["roughness"]["h"]}


def test_roughness_leaves_the_floating_point_numbers():
    inside = FractalRoughnessEstimate.from_logarithms(-300.0, -700.0, 100.0)
    assert inside.is_determined
    assert (inside.estimated_value, inside.confidence_interval_low, inside.confidence_interval_high) == tuple(
        np.exp([-300.0, -700.0, 100.0])
    )
    for value, low, high in ((-300.0, -800.0, 0.0), (-750.0, -760.0, -740.0), (600.0, 500.0, 800.0)):
        outside = FractalRoughnessEstimate.from_logarithms(value, low, high)
        assert not outside.is_determined
        assert outside.interval_decades == pytest.approx((high - low) / np.log(10.0), rel=1e-14)  # round-off


def test_pair_adds_the_powers():
    """Two surfaces with equal finish: the power doubles, so G^(2(D-1)) doubles; sampling may differ."""
    one, other = (gaussian_profile(4096, 0.5, 1e-9, seed) for seed in (1, 2))
    pair = identify_surface([one, other]).select_best_result(series_method="psd")
    assert (
        pair.profile_fractal.G.confidence_interval_low
        < 2e-9
        < pair.profile_fractal.G.confidence_interval_high
    )  # D = 1.5: G doubles
    coarse = Profile(z=other.z[::2].copy(), dx=2 * other.dx, scan_name="coarse")
    again = identify_surface([one, coarse]).select_best_result(series_method="structure")
    assert again.profile_fractal.D.estimated_value == pytest.approx(1.5, abs=0.1)
    far = Profile(z=other.z, dx=1e3 * other.dx, scan_name="far")
    with pytest.raises(ValueError, match="the scales of the two surfaces do not overlap"):
        identify_surface([one, far])


def test_what_a_pair_is():
    line = gaussian_profile(512, 0.5, 1e-9, 1)
    area = synthesis.synthesize_isotropic(waves(64), 2.5, 1e-9, 20, 1)
    with pytest.raises(ValueError, match="two of the same kind"):
        identify_surface([line, area])
    with pytest.raises(ValueError, match="3 files given"):
        identify_surface([line] * 3)


def test_range_without_values_is_refused():
    with pytest.raises(ValueError, match="range 1e-09 to 2e-09 m holds 0 values"):
        identify_surface([gaussian_profile(512, 0.5, 1e-9, 1)], scale_range=(1e-9, 2e-9))


@pytest.mark.parametrize("joint", list(KINDS))
def test_joint_gets_its_own_dimension(joint, tmp_path):
    found = identify_surface([synthesis.synthesize_isotropic(waves(256), 2.45, 1e-9, 20, 1)])
    values = {name: value for name, (value, _) in fractal_parameters(found, joint).items()}
    best = found.select_best_result()
    if joint == "harmonic_drive":
        assert values == {
            "surface.D": best.areal_fractal.D_s.estimated_value,
            "surface.G": best.areal_fractal.G_s.estimated_value,
        }
    else:
        assert set(values.values()) == {
            best.profile_fractal.D.estimated_value,
            best.profile_fractal.G.estimated_value,
        }
    file = set_surface_parameters(load_default(joint), found)
    path = tmp_path / "joint.toml"
    path.write_text(format_parameter_file(file))
    again = load_parameter_file(path, joint)
    for name in values:
        assert again.origins[name] == "measured"
        assert again.sources[name].startswith("identified from synthetic surface by ")
    assert again.roughness["Rq1"] == found.combined_rms_height
    kept = {n for n in again.origins if not n.startswith(("roughness.", "comparison."))}
    untouched = kept - set(values)
    kinds = load_default(joint).origins
    assert {n: again.origins[n] for n in untouched} == {n: kinds.get(n, "default") for n in untouched}


def test_gear_of_a_texture_takes_both_directions():
    found = identify_surface([synthesis.synthesize_textured(waves(512), (1.3, 1.6), (1e-9, 1e-10), 1)])
    values = fractal_parameters(found, "gear_contact")
    assert values["surface1.D"][1].scan_direction == "x"
    assert values["surface2.D"][1].scan_direction == "y"


def test_spacing_may_differ_along_x_and_y():
    square = synthesis.synthesize_isotropic(waves(512), 2.5, 1e-9, 20, 1)
    oblong = ArealMap(z=square.z[::2].copy(), dx=square.dx, dy=2 * square.dy, scan_name="oblong")
    found = identify_surface([oblong])
    for method in ("structure", "psd"):
        assert found.select_best_result(
            series_method=method
        ).areal_fractal.D_s.estimated_value == pytest.approx(2.5, abs=0.06)


def test_a_value_at_its_bound_is_never_chosen_over_a_free_one():
    """At a bound the error is cut off, so a free value of D is preferred, however small the error."""
    found = identify_surface([gaussian_profile(512, 0.5, 1e-9, 1)])
    sure = np.diag([1e-12, 1e-12])
    for H in (0.02, 0.98):
        clipped = replace(found.fractal_results[0].fitted_law, H=H, parameter_covariance=sure)
        results = (replace(found.fractal_results[0], fitted_law=clipped), found.fractal_results[1])
        changed = replace(found, fractal_results=results)
        assert changed.select_best_result() is found.fractal_results[1]
        assert "(structure) lies at the end of 1 to 2" in changed.undetermined_reason()
    assert found.undetermined_reason() is None


def test_intervals_apart_leave_the_dimension_open():
    found = identify_surface([gaussian_profile(512, 0.5, 1e-9, 1)])
    first, second = found.fractal_results
    D = replace(
        second.profile_fractal.D,
        confidence_interval_low=first.profile_fractal.D.confidence_interval_high + 0.01,
        confidence_interval_high=first.profile_fractal.D.confidence_interval_high + 0.1,
    )
    other = replace(second, profile_fractal=replace(second.profile_fractal, D=D))
    apart = replace(found, fractal_results=(first, other))
    assert apart.undetermined_reason().startswith("the methods disagree, D = ")
    before = load_default("bolted_joint")
    assert set_surface_parameters(before, apart).values == before.values
    forced = set_surface_parameters(before, apart, set_undetermined=True).values.surface
    assert apart.select_best_result().profile_fractal.D.estimated_value == forced.D
    crooked = replace(second, fitted_law=replace(second.fitted_law, excess_deviation=1.0))
    assert replace(found, fractal_results=(first, crooked)).undetermined_reason() == "not self-affine (psd)"


def spectral_profile(points, power, seed, dx=1e-6):
    """Gaussian profile with a given power spectral density: a quarter of a periodic one."""
    f = np.fft.rfftfreq(4 * points, dx)[1:]
    noise = np.fft.rfft(np.random.default_rng(seed).standard_normal(4 * points))
    noise[0] = 0.0
    noise[1:] *= np.sqrt(power(f))
    z = np.fft.irfft(noise)[:points]
    return Profile(z=z * 1e-6 / z.std(), dx=dx, scan_name="made")


def running(f):
    """Local Hurst exponent that rises linearly in ln(frequency), from 0 at 100 um to 1 at 10 um."""
    x, decade = np.log(f / 1e4) / np.log(10.0), np.log(10.0)
    return np.exp(-2.0 * decade * np.where(x < 0.0, 0.0, np.where(x < 1.0, 0.5 * x**2, x - 0.5))) / f


@pytest.mark.parametrize("seed", [50, 51])
@pytest.mark.parametrize(
    "power", [running, lambda f: (1.0 + (3e-5 * f) ** 2) ** -2.0], ids=["running", "rolling"]
)
def test_a_slope_that_runs_through_its_interval_is_not_self_affine(power, seed):
    found = identify_surface([spectral_profile(4096, power, seed)])
    assert found.undetermined_reason() is not None


@pytest.mark.parametrize("H", [0.3, 0.5, 0.8])
def test_a_self_affine_profile_is_determined(H):
    for seed in range(3):
        assert identify_surface([gaussian_profile(4096, H, 1e-9, seed)]).undetermined_reason() is None


def test_both_sides_alike_are_a_pair_of_one_power():
    line = gaussian_profile(1024, 0.5, 1e-9, 1)
    one, both = identify_surface([line]), identify_surface([line], contact_side="both")
    assert both.combined_rms_height == pytest.approx(np.sqrt(2.0) * one.combined_rms_height, rel=1e-12)
    assert both.combined_rms_slope == pytest.approx(np.sqrt(2.0) * one.combined_rms_slope, rel=1e-12)
    for single, pair in zip(one.fractal_results, both.fractal_results, strict=True):
        assert pytest.approx(single.fitted_law.H, abs=1e-4) == pair.fitted_law.H
        # twice the power: the level of ln Phi rises by ln 2
        assert pair.fitted_law.log_height_variance - single.fitted_law.log_height_variance == pytest.approx(
            np.log(2.0), abs=1e-4
        )
        # one surface known once: no surer than alone
        assert pair.fitted_law.parameter_covariance[0, 0] == pytest.approx(
            single.fitted_law.parameter_covariance[0, 0], rel=1e-3
        )
    with pytest.raises(ValueError, match="side = both is given with two files"):
        identify_surface([line, line], contact_side="both")


@pytest.mark.parametrize("shape", ["along x", "binary", "sine", "steps"])
def test_maps_without_any_chance_do_not_crash(shape):
    """Contents of example files of instruments: ridges, steps, quantised heights."""
    x, y = np.meshgrid(np.arange(64), np.arange(80))
    z = {
        "along x": np.sin(y / 3.0) + 0.0 * x,
        "binary": ((x // 2 + y // 2) % 2).astype(float),
        "sine": np.sin(2.0 * np.pi * x / 16.0) * np.sin(2.0 * np.pi * y / 20.0),
        "steps": np.round(x / 20.0) + np.round(y / 20.0),
    }[shape]
    found = identify_surface([ArealMap(z=1e-6 * z, dx=1e-6, dy=1e-6, scan_name=shape)])
    assert (found.undetermined_reason() is None) == (shape == "steps")  # their spectrum is a power law
    assert 0.0 < found.combined_rms_height < 2e-6
    assert set_surface_parameters(load_default("gear_contact"), found).roughness == {
        "Rq1": found.combined_rms_height
    } | {name: value for name, value in load_default("gear_contact").roughness.items() if name != "Rq1"}


def test_many_points_without_a_straight_range_are_identified_with_doubt():
    """Roll-off at long waves, low-pass at short ones, texture, noise, gaps: hundreds of windows."""
    n, rng = 512, np.random.default_rng(1)
    frequency = np.hypot(np.fft.fftfreq(n)[:, None], np.fft.rfftfreq(n))
    amplitude = (frequency**2 + 0.01**2) ** -0.9 * np.exp(-((frequency / 0.15) ** 2))
    z = np.fft.irfft2(amplitude * np.exp(2j * np.pi * rng.random(frequency.shape)), (n, n))
    z *= 1e-6 / z.std()
    z += 3e-7 * np.sin(2.0 * np.pi * np.arange(n) / 37.0)[:, None] + rng.normal(0.0, 2e-8, z.shape)
    z[rng.random(z.shape) < 0.02] = np.nan
    found = identify_surface([ArealMap(z=z, dx=1e-6, dy=1e-6, scan_name="scan")])
    assert found.undetermined_reason() is not None
    assert found.combined_rms_height == pytest.approx(np.nanstd(z), rel=0.05)
