"""Synthesis of Weierstrass-Mandelbrot surfaces with given D, G and seed: isotropic (Hu 2023, Eq. 1), textured
(Yu 2022, Eq. 3), profiles.
"""

from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array, CheckedParameters, Interval, ParameterLimit, quantity_field

from .heights import ArealMap, Profile


@dataclass(frozen=True, slots=True, kw_only=True)
class FractalWaves(CheckedParameters):
    """Waves and points of a Weierstrass-Mandelbrot function, which describes a fractal rough surface.

    size   : longest wavelength and length of the sample L [m]
    points : number of points along the length
    gamma  : frequency ratio of neighbouring waves [1]

    The shortest wavelength is at least twice the spacing.
    """

    size: float = quantity_field("m", "side length of the surface, and its longest wave", gt=0.0)
    points: int = quantity_field("1", "points along a side", ge=2.0, is_integer=True)
    gamma: float = quantity_field("1", "frequency ratio of the Weierstrass-Mandelbrot function", gt=1.0)

    @property
    def point_positions(self) -> Array:
        """Positions (points,) [m] along one side."""
        return np.asarray(np.arange(self.points) * (self.size / self.points), dtype=np.float64)

    @property
    def wave_frequencies(self) -> Array:
        """Spatial frequencies gamma^n/L [1/m] of the waves, n = 0 ... ln(points/2)/ln gamma; L is `size`."""
        count = int(np.log(0.5 * self.points) / np.log(self.gamma) * (1.0 + 1e-12)) + 1
        return np.asarray(self.gamma ** np.arange(count) / self.size, dtype=np.float64)

    def wave_amplitudes(self, H: float, G: float) -> Array:
        """Amplitude G^(1-H) sqrt(ln gamma) l^H [m] of each wave of length l [m].

        H, G : Hurst exponent [1] and fractal roughness [m]
        """
        return np.asarray(G ** (1.0 - H) * np.sqrt(np.log(self.gamma)) * self.wave_frequencies**-H)


def synthesize_isotropic(
    waves: FractalWaves, D: float, G: float, direction_count: int, seed: int
) -> ArealMap:
    """Random isotropic Weierstrass-Mandelbrot surface (Hu 2023, Eq. 1).

    D               : fractal dimension of the surface [1], 2 < D < 3
    G               : fractal roughness [m]
    direction_count : number M of wave directions pi m/M, m = 1 ... M
    seed            : seed of the random phases, uniform in [0, 2 pi)

    Because cos(a x + b y + c) = Re(exp(i a x) exp(i (b y + c))), the sum over M (n_max + 1) waves is one
    product of two matrices. Its cost is hardly more than the cost of the cosines along the sides.
    """
    _check_open_interval("D", D, 2.0, 3.0, "fractal dimension of the surface")
    phases = np.random.default_rng(seed).uniform(
        0.0, 2.0 * np.pi, (direction_count, waves.wave_frequencies.size)
    )
    angle = np.pi * np.arange(1, direction_count + 1)[:, None] / direction_count
    wave = 2.0 * np.pi * waves.wave_frequencies
    amplitude = np.broadcast_to(
        waves.wave_amplitudes(3.0 - D, G) / np.sqrt(direction_count), phases.shape
    ).ravel()
    along_x = np.multiply.outer(waves.point_positions, (wave * np.cos(angle)).ravel())
    along_y = np.multiply.outer(waves.point_positions, (wave * np.sin(angle)).ravel()) + phases.ravel()
    z = (amplitude * np.sin(along_y)) @ np.sin(along_x).T - (amplitude * np.cos(along_y)) @ np.cos(along_x).T
    z += float(np.sum(amplitude * np.cos(phases.ravel())))
    spacing = waves.size / waves.points
    return ArealMap(z=z, dx=spacing, dy=spacing, scan_name="synthetic surface")


def random_profile_heights(waves: FractalWaves, D: float, G: float, rng: np.random.Generator) -> Array:
    """Heights [m] at the points of a random Weierstrass-Mandelbrot profile (Hu 2023, Eq. 2; Yu 2022, Eq. 2).

    D   : fractal dimension of the profile [1], 1 < D < 2
    G   : fractal roughness [m]
    rng : generator of the random phases
    """
    _check_open_interval("D", D, 1.0, 2.0, "fractal dimension of the profile")
    z = np.zeros(waves.points)
    x, amplitudes = waves.point_positions, waves.wave_amplitudes(2.0 - D, G)
    for f, a, phase in zip(
        waves.wave_frequencies, amplitudes, rng.uniform(0.0, 2.0 * np.pi, amplitudes.size), strict=True
    ):
        z += a * (np.cos(phase) - np.cos(2.0 * np.pi * f * x - phase))
    return z


def synthesize_profile(waves: FractalWaves, D: float, G: float, seed: int) -> Profile:
    """Random Weierstrass-Mandelbrot profile from a seed; D and G as in `random_profile_heights`."""
    z = random_profile_heights(waves, D, G, np.random.default_rng(seed))
    return Profile(z=z, dx=waves.size / waves.points, scan_name="synthetic profile")


def synthesize_textured(
    waves: FractalWaves, D: tuple[float, float], G: tuple[float, float], seed: int
) -> ArealMap:
    """Random textured surface with two directions, Yu 2022, Eq. 3 (corrected): z(x, y) = z_1(x) + z_2(y).

    D, G : fractal dimension [1] and roughness [m] of the profiles along x and y
    """
    rng = np.random.default_rng(seed)
    along_x, along_y = (random_profile_heights(waves, d, g, rng) for d, g in zip(D, G, strict=True))
    spacing = waves.size / waves.points
    z = along_x[None, :] + along_y[:, None]
    return ArealMap(z=z, dx=spacing, dy=spacing, scan_name="synthetic textured surface")


def _check_open_interval(
    quantity_name: str, quantity_value: float, lower_limit: float, upper_limit: float, quantity_meaning: str
) -> None:
    """Raise ValueError if a value is outside the open interval (low, high)."""
    if text := ParameterLimit(
        quantity_name, Interval(lower_limit, upper_limit), quantity_meaning
    ).find_problem(quantity_value, "1"):
        raise ValueError(text)
