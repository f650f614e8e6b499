"""Plots of the documentation page as SVG text, without a plotting package: the same bytes everywhere."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import NamedTuple

WIDTH, HEIGHT = 690.0, 270.0
"""Of a row of plots."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 14.0, 12.0, 44.0
_GREY, _GRID = "#444", "#e4e4e4"
_TICKS = 5
"""About so many on an axis [1]."""
_MARGIN = 0.05
"""Empty part of an axis that does not begin at zero [1]."""
_LINE = 14.0
"""Height of a line of text."""


class Curve(NamedTuple):
    """A line of a plot."""

    x: Sequence[float]
    y: Sequence[float]
    color: str
    label: str
    dashed: bool


@dataclass
class Plot:
    """Curves over one x; labels of the axes carry their units."""

    x: str
    y: str
    logarithmic: bool = False
    curves: list[Curve] = field(default_factory=list)

    def add(
        self, x: Iterable[float], y: Iterable[float], color: str, label: str = "", dashed: bool = False
    ) -> None:
        """Add a curve."""
        self.curves.append(Curve([float(v) for v in x], [float(v) for v in y], color, label, dashed))


def svg(plots: Sequence[Plot]) -> str:
    """The SVG element of plots side by side."""
    width = WIDTH / len(plots)
    parts = [_drawn(plot, k * width, width) for k, plot in enumerate(plots)]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}"'
    return f'{head} height="{HEIGHT:g}" font-size="12" fill="{_GREY}">\n' + "".join(parts) + "</svg>\n"


class _Axis(NamedTuple):
    """From values to places."""

    low: float
    high: float
    begin: float
    end: float
    logarithmic: bool

    @property
    def ticks(self) -> list[float]:
        if self.logarithmic:
            return [10.0**k for k in range(math.ceil(self.low - 1e-9), math.floor(self.high + 1e-9) + 1)]
        step = _step((self.high - self.low) / _TICKS)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [k * step for k in range(first, last + 1)]

    def at(self, value: float) -> float:
        shown = math.log10(value) if self.logarithmic else value
        return self.begin + (shown - self.low) / (self.high - self.low) * (self.end - self.begin)


def _axis(values: Iterable[float], begin: float, end: float, logarithmic: bool) -> _Axis:
    """The axis of some values: from zero if none is below."""
    shown = [math.log10(v) if logarithmic else v for v in values if math.isfinite(v)]
    low, high = min(shown), max(shown)
    if not logarithmic and low >= 0.0:
        low = 0.0
    spread = high - low or abs(high) or 1.0
    low = low if low == 0.0 and not logarithmic else low - _MARGIN * spread
    return _Axis(low, high + _MARGIN * spread, begin, end, logarithmic)


def _step(size: float) -> float:
    """1, 2 or 5 times a power of ten, at least about `size`."""
    power = 10.0 ** math.floor(math.log10(size))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= size * (1.0 - 1e-9))


def _drawn(plot: Plot, left: float, width: float) -> str:
    x = _axis([v for c in plot.curves for v in c.x], left + _LEFT, left + width - _RIGHT, plot.logarithmic)
    y = _axis([v for c in plot.curves for v in c.y], HEIGHT - _BOTTOM, _TOP, plot.logarithmic)
    lines = [_vertical(x, y, tick) for tick in x.ticks] + [_horizontal(x, y, tick) for tick in y.ticks]
    axes = f"M{x.begin:g} {_TOP:g}V{y.begin:g}H{x.end:g}"
    lines.append(f'<path d="{axes}" fill="none" stroke="{_GREY}"/>\n')
    lines += [_line(x, y, curve) for curve in plot.curves]
    lines.append(_text((x.begin + x.end) / 2, HEIGHT - 8, plot.x, "middle"))
    middle = (y.begin + y.end) / 2
    turned = f' transform="rotate(-90 {left + 14:g} {middle:g})"'
    lines.append(_text(left + 14, middle, plot.y, "middle", turned))
    named = [curve for curve in plot.curves if curve.label]
    if len(named) > 1:
        lines += [_legend(x, k, len(named), curve) for k, curve in enumerate(named)]
    return "".join(lines)


def _vertical(x: _Axis, y: _Axis, tick: float) -> str:
    at = f"{x.at(tick):.1f}"
    line = f'<path d="M{at} {y.end:g}V{y.begin:g}" stroke="{_GRID}"/>\n'
    return line + _text(x.at(tick), y.begin + 16, f"{tick:.6g}", "middle")


def _horizontal(x: _Axis, y: _Axis, tick: float) -> str:
    line = f'<path d="M{x.begin:g} {y.at(tick):.1f}H{x.end:g}" stroke="{_GRID}"/>\n'
    return line + _text(x.begin - 6, y.at(tick) + 4, f"{tick:.6g}", "end")


def _line(x: _Axis, y: _Axis, curve: Curve) -> str:
    points = " ".join(f"{x.at(a):.1f},{y.at(b):.1f}" for a, b in zip(curve.x, curve.y, strict=True))
    dashes = ' stroke-dasharray="6 3"' if curve.dashed else ""
    return f'<polyline points="{points}" fill="none" stroke="{curve.color}" stroke-width="1.5"{dashes}/>\n'


def _legend(x: _Axis, k: int, count: int, curve: Curve) -> str:
    """In the corner of the plot that rising curves leave free."""
    height, left = HEIGHT - _BOTTOM - _LINE * (count - k - 0.3), x.end - 100.0
    line = f'<path d="M{left:g} {height - 4:g}h20" stroke="{curve.color}" stroke-width="1.5"/>\n'
    return line + _text(left + 26, height, curve.label, "start")


def _text(x: float, y: float, text: str, anchor: str, more: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{escape(text)}</text>\n'
