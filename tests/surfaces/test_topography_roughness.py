"""h and slope up to a longest wave: scans against sums of waves, D and G against synthesized surfaces."""

import numpy as np
import pytest
from jointfmu_tools.inputs import fractal
from jointfmu_tools.inputs.surfaces import form, synthesis
from jointfmu_tools.inputs.surfaces.form import remove_form
from jointfmu_tools.inputs.surfaces.heights import ArealMap, Profile
from oracles import rough_surfaces

SIZE, POINTS, G = 1e-3, 256, 1e-9


def sine(wave, amplitude, points=1000, length=1e-3):
    x = (np.arange(points) + 0.5) * (length / points)
    return Profile(z=amplitude * np.cos(2.0 * np.pi * x / wave), dx=length / points, scan_name="sine")


@pytest.mark.parametrize("D", [2.2, 2.5, 2.8])
def test_height_and_slope_of_D_and_G_are_those_of_a_made_surface(D):
    """Surfaces with all waves of a band; 1 % is the difference between sum over a grid and integral."""
    longest, shortest = SIZE / 8.0, SIZE / 32.0
    z = rough_surfaces.periodic(SIZE, POINTS, D, G, (longest, shortest), 1).z
    h = np.sqrt(
        fractal.rms_height(D, G, longest, is_areal=True) ** 2
        - fractal.rms_height(D, G, shortest, is_areal=True) ** 2
    )
    assert z.std() == pytest.approx(h, rel=0.02)
    step = 2.0 * np.pi * np.fft.fftfreq(POINTS, SIZE / POINTS)
    squared = np.abs(np.fft.fft2(z) / z.size) ** 2 * (step[:, None] ** 2 + step**2)
    slope = rough_surfaces.rms_slope(3.0 - D, G, longest, shortest)
    assert np.sqrt(squared.sum()) == pytest.approx(slope, rel=0.02)


@pytest.mark.parametrize("D", [1.2, 1.42, 1.8])
@pytest.mark.parametrize("gamma", [2.0, 3.0])
def test_height_of_a_function_with_a_wave_of_the_longest_length(D, gamma):
    """Integer frequency ratios: every wave fits the length, and variances add up to the last digit.

    A line has profile_share of the power of the surface that it is cut from.
    """
    H = fractal.hurst_exponent(D)
    waves = synthesis.FractalWaves(size=SIZE, points=5000, gamma=gamma)
    missing = gamma ** (-2.0 * H * waves.wave_frequencies.size)  # waves shorter than two spacings
    h = fractal.rms_height(D, G, SIZE, gamma=gamma) * np.sqrt(
        fractal.profile_variance_ratio(H) * (1.0 - missing)
    )
    assert synthesis.synthesize_profile(waves, D, G, 3).z.std() == pytest.approx(h, rel=1e-9)


def test_one_surface_has_one_height():
    """The height from D and G of the profiles, or from D_s and G_s of the surface, is the same; for gamma
    near 1 it is from the spectrum."""
    H = 0.58
    profile = fractal.rms_height(2.0 - H, G, SIZE)
    assert fractal.rms_height(
        3.0 - H, fractal.areal_fractal_roughness(G, H), SIZE, is_areal=True
    ) == pytest.approx(profile)
    assert fractal.rms_height(2.0 - H, G, SIZE, gamma=1.0001) == pytest.approx(profile, rel=1e-4)
    assert fractal.hurst_exponent(1.42) == pytest.approx(0.58)
    assert fractal.hurst_exponent(2.42, is_areal=True) == pytest.approx(0.58)


def test_specimen_of_zhao():
    """Waves up to 1 mm for its D and G: 7.2 um, the figure of docs/validity_stiffness.md."""
    assert fractal.rms_height(1.42, 1.21e-8, 1e-3) == pytest.approx(7.2e-6, rel=0.01)


def test_a_sine_counts_up_to_its_wavelength():
    line = sine(5e-5, 2e-6)
    over, under = (form.compute_scan_roughness(line, line, wave) for wave in (5.1e-5, 4.9e-5))
    assert over.long_wave_rms_height == pytest.approx(2e-6 / np.sqrt(2.0), rel=1e-6)
    assert under.long_wave_rms_height < 1e-9 * over.long_wave_rms_height
    assert (over.rms_height, over.mean_absolute_height) == (
        pytest.approx(2e-6 / np.sqrt(2.0), rel=1e-6),
        pytest.approx(4e-6 / np.pi, rel=1e-2),
    )
    # rms slope of the line times sqrt(2): that of the isotropic surface
    assert over.rms_slope == pytest.approx(2.0 * np.pi / 5e-5 * 2e-6, rel=1e-6)
    assert under.rms_slope < 1e-9 * over.rms_slope
    with pytest.raises(ValueError, match=r"longest wave = 1e-05 m is outside \[2e-05, 0.001\]"):
        form.compute_scan_roughness(line, line, 1e-5)
    with pytest.raises(ValueError, match=r"longest wave = 0\.002 m is outside"):
        form.compute_scan_roughness(line, line, 2e-3)


@pytest.mark.parametrize("D", [2.3, 2.7])
def test_height_of_a_scan_over_a_longest_wave(D):
    """Scan of a surface with longer waves: the height below the longest wave is that of the spectrum within 6
    %."""
    made = rough_surfaces.periodic(SIZE, POINTS, D, G, (SIZE / 2.0, 2.0 * SIZE / POINTS), 2)
    cut = ArealMap(z=made.z[:160, :200].copy(), dx=made.dx, dy=made.dy, scan_name="cut")
    flat = remove_form(cut)
    shortest = 2.0 * SIZE / POINTS
    for longest in (SIZE / 5.0, SIZE / 10.0):
        found = form.compute_scan_roughness(flat, flat, longest)
        H = 3.0 - D
        assert found.long_wave_rms_height == pytest.approx(
            rough_surfaces.rms_height(H, G, longest, shortest), rel=0.06
        )
        slope = rough_surfaces.rms_slope(H, G, longest, found.shortest_wave)
        assert found.rms_slope == pytest.approx(slope, rel=0.06)


def test_missing_points_count_in_h_as_filled():
    line = sine(5e-5, 1e-6)
    z = line.z.copy()
    z[100:110] = np.nan
    found = form.compute_scan_roughness(line.replace_heights(z), line, 1e-3)
    assert found.rms_height == pytest.approx(1e-6 / np.sqrt(2.0), rel=0.02)
    assert np.isfinite(found.long_wave_rms_height)
