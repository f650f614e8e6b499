"""SVG pictures of a bolted joint: plan view of the interface with pressure and bolts, and section."""

from dataclasses import dataclass, field
from html import escape

import numpy as np

from jointfmu.joints.bolted_joint.bodies import ElasticBodies
from jointfmu.joints.bolted_joint.law import Bolted, pressures, working_preload
from jointfmu.mechanics.footprint.bolts import pressure_shape
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.mechanics.footprint.shape import NodalField
from jointfmu.quantity import Array

from .field import PlaneLayout

WIDE, HIGH = 420.0, 330.0
"""Largest width and height of the drawn joint [px]."""
EDGE, TICK = 64.0, 9.0
"""Margin on all sides, and spacing of the hatching [px]."""
SEAM = 0.6
"""Overlap of neighbouring cells [px], which avoids visible gaps."""
DOT = 0.22
"""Radius of a dot, which marks a node of a field, over the mean distance of the nodes [1]."""
THIN = 70.0
"""Smallest height of both sides together in the section [px]: thinner plates are stretched along z."""
VIRIDIS = np.array(
    [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], dtype=np.float64
)
INK, SOFT, RED, OPEN = "#1d232b", "#5a6572", "#c1442e", "#e3e6ea"


@dataclass
class Svg:
    """SVG drawing on a white background; all lengths in pixels."""

    width: float
    height: float
    parts: list[str] = field(default_factory=list)

    def put(self, kind: str, text: str = "", /, **given: object) -> None:
        """Add an element. An `_` in the name of an attribute becomes `-`."""
        attribute_text = " ".join(
            f'{name.replace("_", "-")}="{f"{value:.1f}" if isinstance(value, float) else value}"'
            for name, value in given.items()
        )
        element = f"<{kind} {attribute_text}"
        self.parts.append(f"{element}>{escape(text)}</{kind}>" if text else f"{element}/>")

    def line(self, x1: float, y1: float, x2: float, y2: float, stroke: str = INK, dash: str = "") -> None:
        more = {"stroke_dasharray": dash} if dash else {}
        self.put("line", x1=x1, y1=y1, x2=x2, y2=y2, stroke=stroke, **more)

    def text(
        self, x: float, y: float, text: str, anchor: str = "middle", fill: str = INK, /, **more: object
    ) -> None:
        self.put("text", text, x=x, y=y, text_anchor=anchor, fill=fill, **more)

    def held(self, x1: float, y1: float, x2: float, y2: float) -> None:
        """Add the symbol of a fixed support along a line: hatching on its left."""
        self.put("line", x1=x1, y1=y1, x2=x2, y2=y2, stroke=RED, stroke_width=2)
        along = np.array([x2 - x1, y2 - y1])
        size = float(np.hypot(*along))
        along = along / size
        out = TICK * (np.array([along[1], -along[0]]) + along)
        for distance in np.arange(0.0, size - 0.5 * TICK, TICK):
            x, y = np.array([x1, y1]) + distance * along
            self.line(x, y, x + out[0], y + out[1], RED)

    def arrow(self, x: float, y: float, dx: float, dy: float) -> None:
        self.put("line", x1=x, y1=y, x2=x + dx, y2=y + dy, stroke=RED, stroke_width=2.5)
        tip, back = np.array([x + dx, y + dy]), np.array([dx, dy]) / np.hypot(dx, dy) * 10.0
        side = 0.4 * np.array([back[1], -back[0]])
        corners = (tip, tip - back + side, tip - back - side)
        self.put("polygon", points=" ".join(f"{a:.1f},{b:.1f}" for a, b in corners), fill=RED)

    def svg(self, label: str) -> str:
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:.0f} {self.height:.0f}" '
            f'width="{self.width:.0f}" role="img" aria-label="{escape(label)}" font-size="13" '
            'font-family="system-ui, sans-serif">'
        )
        paper = f'<rect width="{self.width:.0f}" height="{self.height:.0f}" fill="#fff"/>'
        return head + paper + "".join(self.parts) + "</svg>"


def plan(joint: Bolted, preload: float, moment: float) -> str:
    """Plan view of the tightened interface from side 2, as SVG: pressure, numbered bolts, attachments.

    preload : [N] of each bolt
    moment  : [N.m]
    """
    shape, layout = pressure_shape(joint.pattern), PlaneLayout.of(joint)
    p = np.asarray(pressures(joint, shape, preload, moment))
    low, high = layout.extent
    scale = min(WIDE / (high - low)[0], HIGH / (high - low)[1])
    size = scale * (high - low)
    sheet = Svg(max(size[0], 260.0) + 2.0 * EDGE + 90.0, max(size[1], 150.0) + 2.0 * EDGE)

    def at(place: Array) -> Array:
        return np.array([EDGE, EDGE]) + scale * np.array([place[0] - low[0], high[1] - place[1]])

    points, top = isinstance(joint.pattern, NodalField), float(p.max())
    dot = DOT * float(np.sqrt(np.prod(size) / len(p)))
    cells = scale * _cells(joint, shape.share) + SEAM
    for i in np.argsort(p if points else -shape.share, kind="stable"):
        (x, y), value = at(shape.position[i]), float(p[i])
        fill = _colour(value / top) if value > 0.0 else OPEN
        if points:
            sheet.put("circle", cx=x, cy=y, r=dot, fill=fill)
        else:
            dx, dy = cells[i]
            sheet.put("rect", x=x - 0.5 * dx, y=y - 0.5 * dy, width=dx, height=dy, fill=fill)
    for lower, upper in layout.outline:
        (x1, y2), (x2, y1) = at(lower), at(upper)
        sheet.put("rect", x=x1, y=y1, width=x2 - x1, height=y2 - y1, fill="none", stroke=INK)
    attached = _attached(joint)
    _bolts(sheet, np.array([at(bolt) for bolt in layout.bolts]), layout, scale, attached == "heads")
    (x1, y2), (x2, y1) = at(low), at(high)
    if attached == "edge":
        sheet.held(x1, y2, x1, y1)
        sheet.held(x2, y1, x2, y2)
        sheet.text(x1 - 14.0, y1 - 10.0, "edge of side 1", "start", RED)
        sheet.text(x2 + 14.0, y1 - 10.0, "edge of side 2", "end", RED)
    if attached == "faces":
        for ends in ((x1, y1, x2, y1), (x2, y1, x2, y2), (x2, y2, x1, y2), (x1, y2, x1, y1)):
            sheet.held(*ends)
    notes = {"faces": "attached: outer faces of both sides", "heads": f"attached: {_seats(joint)}"}
    if attached in notes:
        sheet.text(x1, y1 - 22.0, notes[attached], "start", RED)
    prefix = "" if layout.outline else "points over "
    width, height = (f"{prefix}{1e3 * extent:.4g} mm" for extent in high - low)
    sheet.text(0.5 * (x1 + x2), y2 + 26.0, f"{width}, x to the right", "middle", SOFT)
    rotation = f"rotate(-90 {x1 - 26.0:.1f} {0.5 * (y1 + y2):.1f})"
    sheet.text(x1 - 26.0, 0.5 * (y1 + y2), f"{height}, y up", "middle", SOFT, transform=rotation)
    _bar(sheet, sheet.width - 98.0, EDGE, sheet.height - 2.0 * EDGE, top)
    moment_text, remaining_preload = (
        f", {moment:g} N m" if moment else "",
        float(working_preload(joint, preload)),
    )
    sheet.text(
        EDGE,
        22.0,
        f"{remaining_preload / 1e3:.4g} kN in each bolt{moment_text}: up to {top / 1e6:.4g} MPa",
        "start",
    )
    return sheet.svg("The interface from above: pressure, bolts, attachments")


def _cells(joint: Bolted, share: Array) -> Array:
    """Width and height (n, 2) [m] of the cells of a plate or a frame."""
    side, plate = np.sqrt(joint.A_0 * share)[:, None], joint.pattern
    if not isinstance(plate, BoltedPlate):
        return side * np.ones(2)
    step = np.array([plate.length, plate.width]) / plate.coarse
    return np.asarray(side * step / np.sqrt(np.prod(step)))


def _attached(joint: Bolted) -> str:
    bodies = joint.bodies
    return bodies.attached if joint.elastic and isinstance(bodies, ElasticBodies) else ""


def _seats(joint: Bolted) -> str:
    return "under heads and " + ("at threads" if getattr(joint.bodies, "thread_depth", 0.0) else "nuts")


def _colour(part: float) -> str:
    """Colour of the map Viridis for a pressure over the largest pressure [1]."""
    place = np.linspace(0.0, 1.0, len(VIRIDIS))
    return "#" + "".join(f"{round(float(np.interp(part, place, column))):02x}" for column in VIRIDIS.T)


def _bar(sheet: Svg, x: float, y: float, height: float, top: float) -> None:
    steps = 40
    for k in range(steps):
        place = y + height * (1.0 - (k + 1) / steps)
        sheet.put(
            "rect", x=x, y=place, width=16.0, height=height / steps + 0.6, fill=_colour((k + 0.5) / steps)
        )
    for fraction in (0.0, 0.25, 0.5, 0.75, 1.0):
        sheet.text(x + 22.0, y + height * (1.0 - fraction) + 4.0, f"{fraction * top / 1e6:.3g}", "start")
    sheet.text(x - 8.0, y - 12.0, "pressure [MPa]", "start")


def _bolts(sheet: Svg, at: Array, layout: PlaneLayout, scale: float, held: bool) -> None:
    """Draw holes, heads, centre lines and numbers of bolts at positions (b, 2) [px]."""
    hole, head = 0.5 * scale * layout.hole, 0.5 * scale * layout.head
    for number, (x, y) in enumerate(at, start=1):
        reach = max(hole, head, 6.0) + 7.0
        if hole:
            sheet.put("circle", cx=x, cy=y, r=hole, fill="#fff", stroke=INK)
        if head and held:
            wide = max(head - hole, 4.0) if hole else 4.0
            ring = {"stroke_width": wide, "stroke_dasharray": "2 4", "stroke_opacity": 0.9}
            sheet.put("circle", cx=x, cy=y, r=head - 0.5 * wide, fill="none", stroke=RED, **ring)
        if head:
            sheet.put("circle", cx=x, cy=y, r=head, fill="none", stroke=INK, stroke_width=1.5)
        for dx, dy in ((reach, 0.0), (0.0, reach)):
            sheet.line(x - dx, y - dy, x + dx, y + dy, INK, "9 3 2 3")
        side = reach * 0.72
        halo = {"stroke": "#fff", "stroke_width": 3, "paint_order": "stroke", "font_weight": 600}
        sheet.text(x + side, y - side, str(number), "start", **halo)


def section(joint: Bolted) -> str:
    """Section of both sides, as SVG: thicknesses, bolts, and surfaces at which the load is applied."""
    bodies = joint.bodies
    assert isinstance(bodies, ElasticBodies)
    layout, attached = PlaneLayout.of(joint), _attached(joint)
    (low, _), (high, _) = layout.extent
    first, second = bodies.thickness
    scale = min(WIDE / (high - low), HIGH / (first + second))
    up = max(scale, THIN / (first + second))
    head = max(0.35 * scale * layout.head, 7.0)
    middle = EDGE + head + up * second
    bottom, top = middle + up * first, middle - up * second
    x1, x2 = EDGE, EDGE + scale * (high - low)
    sheet = Svg(max(x2 - x1, 300.0) + 2.0 * EDGE + 60.0, bottom + head + EDGE)
    for y, height, fill in ((top, up * second, "#dfe6ef"), (middle, up * first, "#eef1f5")):
        sheet.put("rect", x=x1, y=y, width=x2 - x1, height=height, fill=fill, stroke=INK)
    for y, name, thickness in (
        (0.5 * (top + middle), "side 2", second),
        (0.5 * (middle + bottom), "side 1", first),
    ):
        sheet.text(x2 + 20.0, y + 4.0, f"{name}: {1e3 * thickness:.4g} mm", "start", SOFT)
    places = x1 + scale * (layout.bolts[:, 0] - low)
    for x in np.unique(np.round(places, 1)):
        thread = up * bodies.thread_depth
        ends = (middle - thread if thread else top, bottom)
        _bolt(sheet, x, ends, 0.5 * scale * layout.head, head, attached == "heads", thread)
        names = ", ".join(str(j + 1) for j in np.flatnonzero(np.abs(places - x) < 0.1))
        sheet.text(x, bottom + head + 24.0, names)
    surfaces = {"faces": "the outer faces", "edge": "the edges", "heads": f"what lies {_seats(joint)}"}
    if attached == "edge":
        sheet.held(x1, bottom, x1, middle)
        sheet.held(x2, top, x2, middle)
        sheet.arrow(x2 + 14.0, top - 14.0, 40.0, 0.0)
        sheet.arrow(x1 - 14.0, bottom + 14.0, -40.0, 0.0)
    elif attached in surfaces:
        if attached == "faces":
            sheet.held(x1, top, x2, top)
            sheet.held(x2, bottom, x1, bottom)
        for x in (x1, x2) if attached == "faces" else (np.min(places), np.max(places)):
            offset = 0.5 * scale * layout.head + 12.0 if attached == "heads" else 0.0
            seat = middle - 0.5 * up * bodies.thread_depth if offset and bodies.thread_depth else top - 14.0
            sheet.arrow(x + offset, seat, 0.0, -34.0)
            sheet.arrow(x + offset, bottom + 14.0, 0.0, 34.0)
    if attached in surfaces:
        sheet.text(x1, 22.0, f"the load enters at {surfaces[attached]} (hatched)", "start", RED)
    if up > 1.01 * scale:
        sheet.text(x1, sheet.height - 10.0, f"z drawn {up / scale:.2g} times as large as x", "start", SOFT)
    return sheet.svg("Both sides from the front, with bolts and attachments")


def _bolt(
    sheet: Svg, x: float, ends: tuple[float, float], half: float, head: float, held: bool, thread: float
) -> None:
    """Draw one bolt, schematic [px]: with head and nut, or with head and tapped thread."""
    (top, bottom), shank = ends, 0.6 * half
    sheet.put("rect", x=x - shank, y=top, width=2.0 * shank, height=bottom - top, fill="#fff", stroke=INK)
    for y in (bottom,) if thread else (top - head, bottom):
        sheet.put("rect", x=x - half, y=y, width=2.0 * half, height=head, fill="#fff", stroke=INK)
    if held:
        under = {"stroke": RED, "stroke_width": 5, "stroke_dasharray": "2 3"}
        for y in (bottom,) if thread else ends:
            sheet.put("line", x1=x - half, y1=y, x2=x + half, y2=y, **under)
        for wall in (x - shank, x + shank) if thread else ():
            sheet.put("line", x1=wall, y1=top, x2=wall, y2=top + thread, **under)
    sheet.line(x, top - head - 8.0, x, bottom + head + 8.0, INK, "9 3 2 3")
