"""Periodic surfaces with heights as processes leave them, on the unit square with rms height 1."""

import numpy as np
from jointfmu_tools.inputs.surfaces.bearing_curve import HeightSample


def gaussian(seed, points, roll_off=8, hurst=0.8, anisotropy=1.0):
    """Gaussian heights with waves from side/roll_off down to four spacings.

    anisotropy : ratio of the lengths of the hills along the second and the first axis
    """
    f = np.fft.fftfreq(points, 1.0 / points)
    wave = np.hypot(anisotropy * f[:, None], f)
    inside = (wave >= roll_off * (1.0 - 1e-9)) & (np.hypot(f[:, None], f) <= points / 4)
    amplitude = np.where(inside, np.where(inside, wave, 1.0) ** -(1.0 + hurst), 0.0)
    noise = np.fft.fft2(np.random.default_rng(seed).standard_normal((points, points)))
    return standard(np.fft.ifft2(noise / np.abs(noise) * amplitude).real)


def standard(z):
    """Heights with mean 0 and rms 1."""
    return (z - z.mean()) / z.std()


def turned(seed, points, grooves, roughness, scale=1):
    """Parabolic feed grooves with isotropic Gaussian roughness; `scale` times as many grooves and hills."""
    x = np.arange(points) * grooves * scale / points % 1.0 - 0.5
    groove = standard(np.broadcast_to(x[:, None] ** 2, (points, points)))
    return standard(groove + roughness * gaussian(seed, points, 8 * scale))


def plateau(seed, points, quantile, fine, scale=1):
    """Gaussian heights cut at a quantile, with fine roughness on the plateau."""
    z = gaussian(seed, points, 8 * scale)
    cut = np.minimum(z, np.quantile(z, quantile))
    return standard(cut + fine * gaussian(seed + 7777, points, 16 * scale))


def lognormal(seed, points, exponent, scale=1):
    """exp(exponent z) of Gaussian heights z: peaky; with a negative exponent pitted (then -exp)."""
    return standard(np.sign(exponent) * np.exp(exponent * gaussian(seed, points, 8 * scale)))


def two_processes(seed, points, ratio, shift, scale=1):
    """The lower of two Gaussian surfaces: a rough one, and a finer one (rms ratio) above it by a shift."""
    fine = ratio * gaussian(seed + 5555, points, 8 * scale) + shift
    return standard(np.minimum(gaussian(seed, points, 8 * scale), fine))


def honed(seed, points, scale=1):
    """Crossed narrow grooves of random depth and place in a Gaussian plateau."""
    rng, x = np.random.default_rng(seed), np.arange(points) / points
    z = 0.35 * gaussian(seed + 333, points, 8 * scale)
    for side in (1, -1) * 7:
        place = (2.0 * (x[:, None] + side * x) + rng.random()) % 1.0 - 0.5
        z = z - rng.uniform(1.0, 4.0) * np.exp(-((place / rng.uniform(0.02, 0.06)) ** 2))
    return standard(z)


KINDS = {
    "Gaussian, waves up to side/8": lambda s, n, m=1: gaussian(s, n, 8 * m),
    "Gaussian, side/4, H 0.5": lambda s, n, m=1: gaussian(s, n, 4 * m, 0.5),
    "Gaussian, side/4, H 0.3": lambda s, n, m=1: gaussian(s, n, 4 * m, 0.3),
    "Gaussian, side/16": lambda s, n, m=1: gaussian(s, n, 16 * m),
    "anisotropic 6:1": lambda s, n, m=1: gaussian(s, n, 8 * m, anisotropy=6.0),
    "turned, 8 grooves, roughness 0.3": lambda s, n, m=1: turned(s, n, 8, 0.3, m),
    "turned, 12 grooves, roughness 0.1": lambda s, n, m=1: turned(s, n, 12, 0.1, m),
    "turned, 6 grooves, roughness 0.8": lambda s, n, m=1: turned(s, n, 6, 0.8, m),
    "plateau, cut at 55 %, fine 0.1": lambda s, n, m=1: plateau(s, n, 0.55, 0.1, m),
    "plateau, cut at 30 %, fine 0.1": lambda s, n, m=1: plateau(s, n, 0.3, 0.1, m),
    "plateau, cut at 55 %, fine 0.3": lambda s, n, m=1: plateau(s, n, 0.55, 0.3, m),
    "peaky, exp(0.6 z)": lambda s, n, m=1: lognormal(s, n, 0.6, m),
    "peaky, exp(0.3 z)": lambda s, n, m=1: lognormal(s, n, 0.3, m),
    "pitted, -exp(0.6 z)": lambda s, n, m=1: lognormal(s, n, -0.6, m),
    "pitted, -exp(0.3 z)": lambda s, n, m=1: lognormal(s, n, -0.3, m),
    "two processes, 0.25 above 0.5": lambda s, n, m=1: two_processes(s, n, 0.25, 0.5, m),
    "two processes, 0.5 above 0": lambda s, n, m=1: two_processes(s, n, 0.5, 0.0, m),
    "honed": lambda s, n, m=1: honed(s, n, m),
}
"""{kind: function of seed, points along a side and scale}; the scale divides all lengths of waves."""
FEW_HILLS = {
    "one wave as long as the side": lambda s, n: gaussian(s, n, 1),
    "long waves (side/2) and fine roughness": lambda s, n: standard(
        gaussian(s, n, 2) + 0.3 * gaussian(s + 99, n, 16)
    ),
}
"""{kind: function of seed and points} of surfaces with fewer than 16 hills."""


def sample_periodic(z):
    """Heights and squared gradients of periodic heights on the unit square."""
    f = 2j * np.pi * np.fft.fftfreq(z.shape[0], 1.0 / z.shape[0])
    waves = np.fft.fft2(z)
    squared = np.fft.ifft2(f[:, None] * waves).real ** 2 + np.fft.ifft2(f * waves).real ** 2
    return HeightSample(z.ravel() - z.mean(), squared.ravel())
