"""What is identified: of profiles and of surfaces, never one for the other; warnings, picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.quantity import Array

from .. import plots
from ..fractal import second_difference
from .fit import SelfAffineLaw
from .form import Repair, ScanRoughness
from .heights import Areal
from .spectrum import ScaleSeries, power_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes


TEXTURE = 0.3
"""Share of the mean line in the lines of a map above which the map is textured."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with the ends of its confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class RoughnessEstimate(Estimate):
    """A roughness G [m] with its interval, worked out in logarithms.

    As D goes to 1 the interval spans hundreds of decades. Where it leaves the positive floating-point numbers
    G is not determined: value, low and high are nan.

    decades : [1] length of the interval, whether or not G is determined
    """

    decades: float

    @property
    def determined(self) -> bool:
        """Whether the whole interval consists of positive floating-point numbers."""
        return bool(np.isfinite(self.value))

    @classmethod
    def of_logarithms(cls, value: float, low: float, high: float) -> "RoughnessEstimate":
        """From the natural logarithms of the value and of the ends of its interval."""
        decades = (high - low) / np.log(10.0)
        least, most = np.log([np.finfo(float).tiny, np.finfo(float).max])
        if not least <= min(value, low) <= max(value, high) <= most:
            return cls(np.nan, np.nan, np.nan, float(decades))
        return cls(float(np.exp(value)), float(np.exp(low)), float(np.exp(high)), float(decades))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileFractal:
    """Fractal parameters of a profile, 1 < D < 2 (Zhao 2018, Yu 2022)."""

    D: Estimate
    G: RoughnessEstimate


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealFractal:
    """Fractal parameters of an isotropic surface, 2 < D_s < 3 (Hu 2023, Eq. 1)."""

    D_s: Estimate
    G_s: RoughnessEstimate


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What one method finds along one direction ("profile", "x", "y" or "areal")."""

    method: str
    direction: str
    series: ScaleSeries
    fit: SelfAffineLaw
    profile: ProfileFractal
    areal: ArealFractal


@dataclass(frozen=True, slots=True)
class Identification:
    """All results, the repairs per file, the warnings, and the roughness of every file.

    side : of a single surface, the side of the contact that it is, one of SIDES
    """

    names: tuple[str, ...]
    results: tuple[Result, ...]
    repairs: tuple[tuple[str, Repair], ...]
    warnings: tuple[str, ...]
    textured: bool
    scans: tuple[ScanRoughness, ...]
    side: str | None = None

    @property
    def sides(self) -> dict[int, ScanRoughness]:
        """The roughness of every known side of the contact; a single one of no stated side is the first."""
        if len(self.scans) == 2 or self.side == "both":
            return {1: self.scans[0], 2: self.scans[-1]}
        return {int(self.side or 1): self.scans[0]}

    @property
    def h(self) -> float:
        """Rms height [m] of both sides together over the longest wave; one that is not known is smooth."""
        return float(np.sqrt(sum(scan.h**2 for scan in self.sides.values())))

    @property
    def slope(self) -> float:
        """Rms slope [1] of both sides together."""
        return float(np.sqrt(sum(scan.slope**2 for scan in self.sides.values())))

    @property
    def longest_wave(self) -> float:
        """Longest wave [m] of h and slope."""
        return self.scans[0].longest_wave

    def best(self, direction: str | None = None, method: str | None = None) -> Result:
        """The result with the smaller standard error of D; of a direction, by default the whole surface.

        One at the end of D's interval comes last, as that end cuts its error off; then one not self-affine.
        """
        fitting = [r for r in self.along(direction) if method in (None, r.method)]
        return min(fitting, key=lambda r: (r.fit.at_bound, not r.fit.straight, r.fit.covariance[0, 0]))

    def along(self, direction: str | None = None) -> list[Result]:
        """The results of all methods along a direction, by default of the whole surface."""
        direction = direction or self.results[0].direction
        return [r for r in self.results if r.direction == direction]

    def doubt(self, direction: str | None = None) -> str | None:
        """Why D and G along a direction are not determined; None if they are.

        Every method must find the surface self-affine with a D inside its interval, the intervals of all
        methods must overlap, and that of G must be one of positive numbers.
        """
        found = self.along(direction)
        for result in found:
            D = result.profile.D.value
            if result.fit.at_bound:
                return f"D = {D:.2f} ({result.method}) lies at the end of 1 to 2"
            if not result.fit.straight:
                return f"not self-affine ({result.method})"
        if max(r.profile.D.low for r in found) > min(r.profile.D.high for r in found):
            values = ", ".join(
                f"{r.profile.D.value:.2f} [{r.profile.D.low:.2f}, {r.profile.D.high:.2f}] ({r.method})"
                for r in found
            )
            return f"the methods disagree, D = {values}"
        G = self.best(direction).profile.G
        return None if G.determined else f"the interval of G spans {G.decades:.0f} decades"


def texture(heights: Areal) -> tuple[float, float]:
    """Share of the mean line in the lines along x and along y: near 0 isotropic, 1 all lines alike."""
    shares = []
    for z in (heights.z, heights.z.T):
        lag = max(2, z.shape[1] // 32)
        second = z[:, 2 * lag :] - 2.0 * z[:, lag:-lag] + z[:, : -2 * lag]
        whole = float(np.mean(second**2))
        shares.append(float(np.mean(second.mean(axis=0) ** 2)) / whole if whole > 0.0 else 1.0)
    return shares[0], shares[1]


def warnings(results: Sequence[Result], textured: bool) -> list[str]:
    """What a user must know about results of one surface, whole surface first."""
    lines = []
    if textured:
        lines.append(
            "the surface is textured (its lines repeat): D_s and G_s of an isotropic surface do not describe "
            "it, use D and G along x and y"
        )
    for result in results:
        where = f"{result.method}, {result.direction}"
        if not (result.fit.straight or result.fit.runs):
            lines.append(
                f"{where}: not self-affine over {result.fit.low:.3g} to {result.fit.high:.3g} m: D drifts by "
                f"{result.fit.drift:+.2f}, deviation from the law {100.0 * result.fit.deviation:.0f} %"
            )
        if result.fit.decades < 1.0:
            lines.append(f"{where}: the range spans {result.fit.decades:.2f} decades, less than one")
        if result.fit.runs:
            lines.append(
                f"{where}: over all scales D runs through its interval from 1 to 2, and only a piece of "
                f"{result.fit.decades:.2f} decades is straight; state a range to take it"
            )
        if result.fit.at_bound:
            lines.append(f"{where}: D = {result.profile.D.value:.2f} lies at the end of 1 to 2; no fractal")
    G = min(results[:2], key=lambda result: result.fit.covariance[0, 0]).profile.G
    if G.decades > 4.0:
        lines.append(
            f"G is {'hardly' if G.determined else 'not'} determined: its interval spans {G.decades:.1f} "
            "decades; a larger patch or more decades are needed"
        )
    structures, spectra = results[0].profile.D, results[1].profile.D
    if structures.low > spectra.high or spectra.low > structures.high:
        lines.append(f"the methods disagree: D = {structures.value:.3f} and {spectra.value:.3f}")
    return lines


COLOURS = {"profile": plots.BLUE, "areal": plots.BLUE, "x": plots.RED, "y": plots.GREEN}


def draw(identified: Identification, path: str | Path) -> None:
    """Save the picture as .png or .svg."""
    with plots.drawing(path, (9.6, 5.0)) as figure:
        axes = dict(zip(("structure", "psd"), figure.subplots(1, 2), strict=True))
        for result in identified.results:
            _one(axes[result.method], result)
        axes["structure"].set_title("structure function", loc="left")
        axes["structure"].set_xlabel("lag τ [m]")
        axes["structure"].set_ylabel("S(τ) [m²]")
        axes["psd"].set_title("power spectral density, one-sided", loc="left")
        axes["psd"].set_xlabel("frequency ω [1/m]")
        axes["psd"].set_ylabel("P(ω) [m³]")
        label = f"h = {1e6 * identified.h:.3g} µm: all waves to the right"
        axes["psd"].axvline(1.0 / identified.longest_wave, color=plots.GREY, ls="--", lw=1.0, label=label)
        for panel in axes.values():
            panel.set_xscale("log")
            panel.set_yscale("log")
            _ticks(panel.xaxis)
            _ticks(panel.yaxis)
            panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14))


def _one(axes: "Axes", result: Result) -> None:
    x, y, law = _shown(result)
    inside = (result.series.scale >= result.fit.low * 0.999) & (
        result.series.scale <= result.fit.high * 1.001
    )
    colour = COLOURS[result.direction]
    D, low, high = (
        (result.areal.D_s.value, result.areal.D_s.low, result.areal.D_s.high)
        if result.direction == "areal"
        else (result.profile.D.value, result.profile.D.low, result.profile.D.high)
    )
    name = "D_s" if result.direction == "areal" else "D"
    label = (
        f"{result.direction}: {name} = {D:.3f} ({low:.3f} to {high:.3f}), "
        f"{1e6 * result.fit.low:.3g} to {1e6 * result.fit.high:.3g} µm"
    )
    axes.plot(x, y, "o", ms=3.5, mfc="none", color=colour, alpha=0.5)
    axes.plot(x[inside], y[inside], "o", ms=3.5, color=colour)
    axes.plot(x[inside], law[inside], "-", lw=1.2, color=colour, label=label)


def _ticks(axis: Any) -> None:
    """Labels at 1, 2, 5 of a decade where there are few decades, else at the decades."""
    from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    if high < 100.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(LogFormatterSciNotation(minor_thresholds=(10, 10)))
    axis.set_minor_formatter(NullFormatter())


def _shown(result: Result) -> tuple[Array, Array, Array]:
    """Abscissa, data and law, both freed of what the smoothing over scales does to a power law.

    The structure function is that without tilt, V/(4 - 4^H).
    """
    series, fit = result.series, result.fit
    expected = series.expected(fit.H)
    structure = series.method == "structure"
    pure = power_law(series.scale, fit.H) if structure else series.scale ** (2.0 * fit.H)
    first = expected[np.argmin(np.abs(series.scale - fit.low))]
    law = np.exp(fit.level) * fit.reference ** (-2.0 * fit.H) * (expected + fit.offset * first)
    data, law = series.value * pure / expected, law * pure / expected
    if structure:
        return series.scale, data / second_difference(fit.H), law / second_difference(fit.H)
    return 1.0 / series.scale, data * series.scale, law * series.scale
