"""Self-affine rough surfaces with wavelengths in a band: rms height, rms slope, periodic samples."""

import numpy as np
from jointfmu_tools.inputs.fractal import height_variance_density
from jointfmu_tools.inputs.surfaces.heights import ArealMap


def rms_height(H, G, longest, shortest):
    """rms height [m] of the waves between two wavelengths [m]: the integral of Phi over ln(frequency)."""
    return np.sqrt(
        (height_variance_density(1.0 / longest, H, G) - height_variance_density(1.0 / shortest, H, G))
        / (2.0 * H)
    )


def rms_slope(H, G, longest, shortest):
    """rms gradient [1] of the waves between two wavelengths [m]: the integral of (2 pi frequency)^2 Phi over
    ln(frequency)."""
    high, low = (height_variance_density(1.0 / wave, H, G) / wave**2 for wave in (shortest, longest))
    return 2.0 * np.pi * np.sqrt((high - low) / (2.0 - 2.0 * H))


def periodic(size, points, D, G, band, seed):
    """Heights of an isotropic surface with all waves of a band that fit a periodic square, and no others.

    size   : [m]  side of the square; points : along a side
    D      : 1    fractal dimension of the surface, 2 < D < 3
    G      : [m]  fractal roughness in the sense of `isotropic`
    band   : [m]  longest and shortest wave, size >= longest > shortest >= 2 spacings
    seed   : random seed of the phases; the amplitudes are those of
             `fractal.height_variance_density` without scatter

    Raises ValueError if D is outside its interval or the band does not fit the square and its grid.
    """
    if not 2.0 < D < 3.0:
        raise ValueError(f"D = {D:g} is outside (2, 3): fractal dimension of the surface")
    longest, shortest = band
    spacing = size / points
    if not size >= longest > shortest >= 2.0 * spacing * (1.0 - 1e-9):
        raise ValueError(
            f"band = {longest:g} to {shortest:g} m is not allowed: the longest wave is at most the side "
            f"{size:g} m, the shortest below it and at least two spacings, {2.0 * spacing:g} m"
        )
    f = np.hypot(np.fft.fftfreq(points, spacing)[:, None], np.fft.rfftfreq(points, spacing))
    inside = (f >= (1.0 - 1e-9) / longest) & (f <= (1.0 + 1e-9) / shortest)
    f[~inside] = np.inf
    cell = 1.0 / (2.0 * np.pi * f**2 * size**2)  # share of ln f of one mode
    noise = np.fft.rfft2(np.random.default_rng(seed).standard_normal((points, points)))
    waves = noise / np.abs(noise) * np.sqrt(height_variance_density(f, 3.0 - D, G) * cell)
    z = np.fft.irfft2(waves, s=(points, points)) * points**2
    return ArealMap(z=z, dx=spacing, dy=spacing, scan_name="synthetic periodic surface")
