"""The icons, drawn: one picture per joint as PNG and SVG, and the flanges."""

import io
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse, FancyBboxPatch, Polygon, Rectangle
from numpy.typing import NDArray
from PIL import Image

from ..drawing import short, svg

Array = NDArray[np.float64]

INK, STEEL, LIGHT, BLUE, RED = "#2b3a4a", "#aebdcb", "#d3dde6", "#1f5fa8", "#d1432b"
_PIXELS, _INCHES, _COLORS = 200, 2.0, 32
_PRESSURE = np.radians(25.0)


def icon(name: str) -> tuple[bytes, str]:
    """PNG of 200 x 200 pixels and SVG of an FMU's joint, on a transparent background."""
    draw = _DRAWINGS[name]
    return _png(draw, _PIXELS), short(svg(_fill(draw), (_INCHES, _INCHES), layout=None))


def flange_icon(rotational: bool, filled: bool) -> bytes:
    """PNG of 32 x 32 pixels: Modelica's circle or square, filled for side a, open for side b."""

    def draw(axes: Axes) -> None:
        edge, face = ("#000000", "#5f5f5f") if rotational else ("#007f00", "#007f00")
        style: Any = {"ec": edge, "fc": face if filled else "white", "lw": 1.2}
        square = Rectangle((-0.9, -0.9), 1.8, 1.8, **style)
        axes.add_patch(Circle((0, 0), 0.9, **style) if rotational else square)

    return _png(draw, 32)


def _fill(draw: Callable[[Axes], None]) -> Callable[[Figure], None]:
    """Draw on axes from -1 to 1 that fill the figure, without background."""

    def fill(figure: Figure) -> None:
        figure.patch.set_alpha(0.0)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(-1.0, 1.0)
        axes.set_ylim(-1.0, 1.0)
        draw(axes)

    return fill


def _png(draw: Callable[[Axes], None], pixels: int) -> bytes:
    """Few colours keep the file small."""
    figure = Figure(figsize=(_INCHES * pixels / _PIXELS, _INCHES * pixels / _PIXELS), dpi=_PIXELS / _INCHES)
    _fill(draw)(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    image = Image.open(buffer).convert("RGBA").quantize(_COLORS, method=Image.Quantize.FASTOCTREE)
    packed = io.BytesIO()
    image.save(packed, format="PNG", optimize=True)
    return packed.getvalue()


def _circle(radius: Array | float, angle: Array) -> Array:
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def _drive(axes: Axes) -> None:
    """Toothed ring, flexspline and elliptical wave generator on balls, major axis tilted."""
    tilt, teeth = 25.0, 36
    axes.add_patch(Circle((0, 0), 0.96, fc=STEEL, ec=INK, lw=1.6))
    step = 2.0 * np.pi / teeth
    angle = (np.arange(teeth)[:, None] * step + np.array([0.0, 0.3, 0.5, 0.8]) * step).ravel()
    radius = np.tile([0.78, 0.78, 0.71, 0.71], teeth)
    axes.add_patch(Polygon(_circle(radius, angle), fc="white", ec=INK, lw=1.0))
    axes.add_patch(Ellipse((0, 0), 1.42, 1.18, angle=tilt, fc="white", ec=BLUE, lw=4.0))
    axes.add_patch(Ellipse((0, 0), 1.04, 0.80, angle=tilt, fc=LIGHT, ec=INK, lw=1.4))
    turn = np.radians(tilt)
    x, y = np.array([[0.605], [0.485]]) * _circle(1.0, np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False)).T
    axes.plot(
        x * np.cos(turn) - y * np.sin(turn),
        x * np.sin(turn) + y * np.cos(turn),
        "o",
        color=INK,
        ms=8.0,
        mew=0.0,
    )


def _spring(axes: Axes) -> None:
    """A spiral spring between the wave generator and its shaft."""
    _drive(axes)
    t = np.linspace(0.0, 5.0 * np.pi, 90)
    axes.plot(*_circle(0.05 + 0.27 * t / t[-1], t).T, color=RED, lw=2.6, solid_capstyle="round")


def _compliance(axes: Axes) -> None:
    """The wave generator is locked: a padlock; a torque winds up the output."""
    _drive(axes)
    t = np.linspace(0.0, np.pi, 20)
    axes.plot(0.12 * np.cos(t), 0.05 + 0.15 * np.sin(t), color=RED, lw=3.0)
    axes.add_patch(Rectangle((-0.2, -0.24), 0.4, 0.31, fc=RED, ec="none"))
    axes.add_patch(Circle((0, -0.06), 0.05, fc="white", ec="none"))
    arrow = _circle(0.87, np.radians(np.linspace(60.0, 128.0, 12)))
    axes.plot(*arrow.T, color=RED, lw=4.0)
    axes.add_patch(Polygon([(-0.72, 0.62), (-0.64, 0.84), (-0.43, 0.62)], fc=RED, ec="none"))


def _bolted(axes: Axes) -> None:
    """Two flanges with a rough interface, held by a bolt."""
    x = np.linspace(-0.95, 0.95, 20)
    tenths = [0, 10, -10, 6, -3, 10, -8, 3, -10, 9, -2, 10, -6, 2, -10, 8, -4, 7, -10, 0]
    height = 0.0055 * np.array(tenths, dtype=np.float64)
    gap = 0.045 * np.abs(np.sin(2.3 * np.arange(x.size)))
    upper, lower = np.column_stack([x, height + gap]), np.column_stack([x, height - gap])
    axes.add_patch(Polygon([(-0.95, 0.42), *upper, (0.95, 0.42)], fc=STEEL, ec=INK, lw=1.6))
    axes.add_patch(Polygon([(-0.95, -0.42), *lower, (0.95, -0.42)], fc=LIGHT, ec=INK, lw=1.6))
    for side in (1.0, -1.0):
        axes.add_patch(Rectangle((-0.4, min(0.42 * side, 0.5 * side)), 0.8, 0.08, fc="white", ec=INK, lw=1.4))
    axes.add_patch(Rectangle((-0.17, -0.5), 0.34, 1.0, fc=BLUE, ec=INK, lw=1.4))
    axes.add_patch(Rectangle((-0.17, -0.93), 0.34, 0.3, fc=BLUE, ec=INK, lw=1.4))
    for low, tall in ((0.5, 0.36), (-0.8, 0.3)):
        axes.add_patch(Rectangle((-0.32, low), 0.64, tall, fc=BLUE, ec=INK, lw=1.6))
        for edge in (-0.14, 0.14):
            axes.plot([edge, edge], [low, low + tall], color=INK, lw=1.2)
    for y in np.arange(-0.91, -0.82, 0.05):
        axes.plot([-0.17, 0.17], [y, y + 0.02], color=INK, lw=0.8)
    for left in (-1.0, 1.0):
        points = np.column_stack([x, height])[(x * left > 0.2)]
        axes.plot(*points.T, color=RED, lw=2.6, solid_joinstyle="round")


def _gear(axes: Axes, up: float, color: str) -> None:
    """A gear below (up = 1) or above (up = -1) the pitch point at the origin, one flank through it."""
    pitch, teeth, base = 2.0, 15, 2.0 * np.cos(_PRESSURE)
    module = 2.0 * pitch / teeth
    radius = np.linspace(base, pitch + 0.95 * module, 7)
    roll = np.sqrt((radius / base) ** 2 - 1.0)
    involute = roll - np.arctan(roll) - (np.tan(_PRESSURE) - _PRESSURE)  # polar angle, 0 at the pitch circle
    root, half = pitch - 1.2 * module, 0.46 * np.pi / teeth
    points = []
    for tooth in (-2, -1, 0, 1):
        middle = half + 2.0 * np.pi * tooth / teeth
        left, right = middle - half + involute, middle + half - involute
        points += [(root, left[0]), *zip(radius, left, strict=True)]
        points += [*zip(radius[::-1], right[::-1], strict=True), (root, right[0])]
    r, angle = np.array(points).T
    outline = np.column_stack([r * np.sin(angle), r * np.cos(angle) - pitch])
    gear = Polygon(up * np.vstack([outline, [(1.6, -1.2), (-1.6, -1.2)]]), fc=color, ec=INK, lw=1.8)
    axes.add_patch(gear)
    gear.set_clip_path(_frame(axes))


def _frame(axes: Axes, **style: Any) -> FancyBboxPatch:
    return FancyBboxPatch(
        (-0.8, -0.8), 1.6, 1.6, boxstyle="round,pad=0.16", transform=axes.transData, **{"fc": "white"} | style
    )


def _contact(axes: Axes) -> None:
    """Two gears in mesh, the contact of two flanks, and the load on it along the line of action."""
    axes.add_patch(_frame(axes, ec="none"))
    _gear(axes, 1.0, STEEL)
    _gear(axes, -1.0, LIGHT)
    axes.add_patch(_frame(axes, fc="none", ec=INK, lw=1.6))
    x, y = np.cos(_PRESSURE), np.sin(_PRESSURE)
    for sign in (1.0, -1.0):
        along, across = sign * np.array([x, y]), 0.13 * np.array([-y, x])
        axes.plot(*np.array([0.34 * along, 0.74 * along]).T, color=RED, lw=4.0)
        head = [0.13 * along, 0.38 * along + across, 0.38 * along - across]
        axes.add_patch(Polygon(head, fc=RED, ec="none"))
    axes.add_patch(Ellipse((0, 0), 0.12, 0.3, angle=np.degrees(_PRESSURE), fc=RED, ec="white", lw=1.2))


def _inertia(axes: Axes) -> None:
    """A disk on a shaft."""
    axes.add_patch(Rectangle((-0.95, -0.1), 1.9, 0.2, fc=LIGHT, ec=INK, lw=1.6))
    axes.add_patch(FancyBboxPatch((-0.35, -0.7), 0.7, 1.4, "round,pad=0.05", fc=STEEL, ec=INK, lw=1.6))


def _mass(axes: Axes) -> None:
    """A block on a line."""
    axes.add_patch(FancyBboxPatch((-0.55, -0.4), 1.1, 0.8, "round,pad=0.05", fc=STEEL, ec=INK, lw=1.6))
    axes.plot([-0.95, 0.95], [-0.47, -0.47], color=INK, lw=1.6)


def _load(axes: Axes) -> None:
    """A ramp and a pulse over time."""
    x = np.linspace(0.0, np.pi, 30)
    rise = 0.4 * (1.0 - np.cos(x))
    axes.plot([-0.9, -0.9, 0.95], [0.9, -0.8, -0.8], color=INK, lw=1.6)
    axes.plot(-0.8 + 0.25 * x, rise - 0.7, color=BLUE, lw=3.0)
    axes.plot(0.05 + 0.25 * x, 0.1 + 0.7 * np.sin(x) ** 2, color=RED, lw=3.0)


_DRAWINGS: dict[str, Callable[[Axes], None]] = {
    "HarmonicDriveSpring": _spring,
    "HarmonicDriveCompliance": _compliance,
    "BoltedJoint": _bolted,
    "GearContact": _contact,
    "RotationalInertia": _inertia,
    "TranslationalMass": _mass,
    "TorqueProfile": _load,
    "ForceProfile": _load,
}
