"""SVG pictures of a bolted joint: plan view of the interface with pressure and bolts, and section."""

from dataclasses import dataclass, field
from html import escape

import numpy as np

from jointfmu.joints.bolted_joint.law import AnyBoltedJoint, ElasticBodies, preload_pressure, working_preload
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import NodalField
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.quantity import Array

from .field import PlaneLayout

MAX_PICTURE_WIDTH, MAX_PICTURE_HEIGHT = 420.0, 330.0
"""Largest width and height of the drawn joint [px]."""
PICTURE_MARGIN, HATCH_SPACING = 64.0, 9.0
"""Margin on all sides, and spacing of the hatching [px]."""
AREA_CELL_OVERLAP = 0.6
"""Overlap of neighbouring area cells of the pressure map [px], which avoids visible gaps."""
DOT_RADIUS_OVER_NODE_DISTANCE = 0.22
"""Radius of a dot, which marks a node of a field, over the mean distance of the nodes [1]."""
MIN_SECTION_HEIGHT = 70.0
"""Smallest height of both sides together in the section [px]: thinner plates are stretched along z."""
VIRIDIS_COLOURS = np.array(
    [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], dtype=np.float64
)
"""Colours of the map Viridis (n, 3), from low to high pressure."""
LINE_COLOUR, GREY_COLOUR, RED_COLOUR, OPEN_CONTACT_COLOUR = "#1d232b", "#5a6572", "#c1442e", "#e3e6ea"


@dataclass
class SvgDrawing:
    """SVG drawing on a white background; all lengths in pixels."""

    pixel_width: float
    pixel_height: float
    svg_elements: list[str] = field(default_factory=list)

    def add_element(self, svg_tag: str, element_text: str = "", /, **attributes: object) -> None:
        """Add an SVG element. An `_` in the name of an attribute becomes `-`."""
        attribute_text = " ".join(
            f'{name.replace("_", "-")}="{f"{value:.1f}" if isinstance(value, float) else value}"'
            for name, value in attributes.items()
        )
        element = f"<{svg_tag} {attribute_text}"
        self.svg_elements.append(
            f"{element}>{escape(element_text)}</{svg_tag}>" if element_text else f"{element}/>"
        )

    def add_line(
        self, x1: float, y1: float, x2: float, y2: float, stroke: str = LINE_COLOUR, dash_pattern: str = ""
    ) -> None:
        """Add a straight line between two points."""
        more = {"stroke_dasharray": dash_pattern} if dash_pattern else {}
        self.add_element("line", x1=x1, y1=y1, x2=x2, y2=y2, stroke=stroke, **more)

    def add_text(
        self,
        x: float,
        y: float,
        label_text: str,
        anchor: str = "middle",
        fill: str = LINE_COLOUR,
        /,
        **attributes: object,
    ) -> None:
        """Add a text at a point."""
        self.add_element("text", label_text, x=x, y=y, text_anchor=anchor, fill=fill, **attributes)

    def add_support(self, x1: float, y1: float, x2: float, y2: float) -> None:
        """Add the symbol of a fixed support along a line: hatching on its left."""
        self.add_element("line", x1=x1, y1=y1, x2=x2, y2=y2, stroke=RED_COLOUR, stroke_width=2)
        along = np.array([x2 - x1, y2 - y1])
        size = float(np.hypot(*along))
        along = along / size
        out = HATCH_SPACING * (np.array([along[1], -along[0]]) + along)
        for distance in np.arange(0.0, size - 0.5 * HATCH_SPACING, HATCH_SPACING):
            x, y = np.array([x1, y1]) + distance * along
            self.add_line(x, y, x + out[0], y + out[1], RED_COLOUR)

    def add_arrow(self, x: float, y: float, dx: float, dy: float) -> None:
        """Add an arrow that starts at a point."""
        self.add_element("line", x1=x, y1=y, x2=x + dx, y2=y + dy, stroke=RED_COLOUR, stroke_width=2.5)
        tip, back = np.array([x + dx, y + dy]), np.array([dx, dy]) / np.hypot(dx, dy) * 10.0
        side = 0.4 * np.array([back[1], -back[0]])
        corners = (tip, tip - back + side, tip - back - side)
        self.add_element("polygon", points=" ".join(f"{a:.1f},{b:.1f}" for a, b in corners), fill=RED_COLOUR)

    def render_svg(self, accessible_label: str) -> str:
        """Render the picture as text of an SVG file, with a label for screen readers."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.pixel_width:.0f} '
            f'{self.pixel_height:.0f}" '
            f'width="{self.pixel_width:.0f}" role="img" aria-label="{escape(accessible_label)}" '
            'font-size="13" '
            'font-family="system-ui, sans-serif">'
        )
        paper = f'<rect width="{self.pixel_width:.0f}" height="{self.pixel_height:.0f}" fill="#fff"/>'
        return head + paper + "".join(self.svg_elements) + "</svg>"


def draw_plan(joint_parameters: AnyBoltedJoint, preload: float, bending_moment: float) -> str:
    """Draw the plan view of the tightened interface, seen from side 2, as SVG: pressure, bolts, attachments.

    preload        : [N] of each bolt
    bending_moment : [N.m]
    """
    shape, layout = (
        pressure_distribution(joint_parameters.pattern),
        PlaneLayout.from_joint_parameters(joint_parameters),
    )
    p = np.asarray(preload_pressure(joint_parameters, shape, preload, bending_moment))
    low, high = layout.bounding_box
    scale = min(MAX_PICTURE_WIDTH / (high - low)[0], MAX_PICTURE_HEIGHT / (high - low)[1])
    size = scale * (high - low)
    sheet = SvgDrawing(
        max(size[0], 260.0) + 2.0 * PICTURE_MARGIN + 90.0, max(size[1], 150.0) + 2.0 * PICTURE_MARGIN
    )

    def to_pixels(position_in_metres: Array) -> Array:
        """Convert a position [m] to pixels."""
        return np.array([PICTURE_MARGIN, PICTURE_MARGIN]) + scale * np.array(
            [position_in_metres[0] - low[0], high[1] - position_in_metres[1]]
        )

    points, top = isinstance(joint_parameters.pattern, NodalField), float(p.max())
    dot = DOT_RADIUS_OVER_NODE_DISTANCE * float(np.sqrt(np.prod(size) / len(p)))
    cells = scale * _area_cell_sizes(joint_parameters, shape.area_share) + AREA_CELL_OVERLAP
    for i in np.argsort(p if points else -shape.area_share, kind="stable"):
        (x, y), value = to_pixels(shape.position[i]), float(p[i])
        fill = _pressure_colour(value / top) if value > 0.0 else OPEN_CONTACT_COLOUR
        if points:
            sheet.add_element("circle", cx=x, cy=y, r=dot, fill=fill)
        else:
            dx, dy = cells[i]
            sheet.add_element("rect", x=x - 0.5 * dx, y=y - 0.5 * dy, width=dx, height=dy, fill=fill)
    for lower, upper in layout.contact_outline:
        (x1, y2), (x2, y1) = to_pixels(lower), to_pixels(upper)
        sheet.add_element("rect", x=x1, y=y1, width=x2 - x1, height=y2 - y1, fill="none", stroke=LINE_COLOUR)
    attached = _attachment_name(joint_parameters)
    _draw_bolts(
        sheet,
        np.array([to_pixels(bolt) for bolt in layout.bolt_positions]),
        layout,
        scale,
        attached == "heads",
    )
    (x1, y2), (x2, y1) = to_pixels(low), to_pixels(high)
    if attached == "edge":
        sheet.add_support(x1, y2, x1, y1)
        sheet.add_support(x2, y1, x2, y2)
        sheet.add_text(x1 - 14.0, y1 - 10.0, "edge of side 1", "start", RED_COLOUR)
        sheet.add_text(x2 + 14.0, y1 - 10.0, "edge of side 2", "end", RED_COLOUR)
    if attached == "faces":
        for ends in ((x1, y1, x2, y1), (x2, y1, x2, y2), (x2, y2, x1, y2), (x1, y2, x1, y1)):
            sheet.add_support(*ends)
    notes = {
        "faces": "attached: outer faces of both sides",
        "heads": f"attached: {_bearing_surface_text(joint_parameters)}",
    }
    if attached in notes:
        sheet.add_text(x1, y1 - 22.0, notes[attached], "start", RED_COLOUR)
    prefix = "" if layout.contact_outline else "points over "
    width, height = (f"{prefix}{1e3 * extent:.4g} mm" for extent in high - low)
    sheet.add_text(0.5 * (x1 + x2), y2 + 26.0, f"{width}, x to the right", "middle", GREY_COLOUR)
    rotation = f"rotate(-90 {x1 - 26.0:.1f} {0.5 * (y1 + y2):.1f})"
    sheet.add_text(x1 - 26.0, 0.5 * (y1 + y2), f"{height}, y up", "middle", GREY_COLOUR, transform=rotation)
    _draw_colour_bar(
        sheet, sheet.pixel_width - 98.0, PICTURE_MARGIN, sheet.pixel_height - 2.0 * PICTURE_MARGIN, top
    )
    moment_text = f", {bending_moment:g} N m" if bending_moment else ""
    remaining_preload = float(working_preload(joint_parameters, preload))
    sheet.add_text(
        PICTURE_MARGIN,
        22.0,
        f"{remaining_preload / 1e3:.4g} kN in each bolt{moment_text}: up to {top / 1e6:.4g} MPa",
        "start",
    )
    return sheet.render_svg("The interface from above: pressure, bolts, attachments")


def _area_cell_sizes(joint_parameters: AnyBoltedJoint, area_share: Array) -> Array:
    """Width and height (n, 2) [m] of the area cells of a plate or a frame."""
    side, plate = np.sqrt(joint_parameters.A_0 * area_share)[:, None], joint_parameters.pattern
    if not isinstance(plate, BoltedPlate):
        return side * np.ones(2)
    step = np.array([plate.length, plate.width]) / plate.coarse_cell_counts
    return np.asarray(side * step / np.sqrt(np.prod(step)))


def _attachment_name(joint_parameters: AnyBoltedJoint) -> str:
    """Name of the surfaces that move rigidly with the connected bodies; empty for rigid sides."""
    bodies = joint_parameters.bodies
    return (
        bodies.attached if joint_parameters.has_elastic_members and isinstance(bodies, ElasticBodies) else ""
    )


def _bearing_surface_text(joint_parameters: AnyBoltedJoint) -> str:
    """Text on the size of the bearing surfaces under the heads."""
    return "under heads and " + (
        "at threads" if getattr(joint_parameters.bodies, "thread_depth", 0.0) else "nuts"
    )


def _pressure_colour(pressure_over_maximum: float) -> str:
    """Colour (map Viridis) for the ratio [1] of a contact pressure to the largest pressure."""
    place = np.linspace(0.0, 1.0, len(VIRIDIS_COLOURS))
    return "#" + "".join(
        f"{round(float(np.interp(pressure_over_maximum, place, column))):02x}" for column in VIRIDIS_COLOURS.T
    )


def _draw_colour_bar(svg_drawing: SvgDrawing, x: float, y: float, height: float, max_pressure: float) -> None:
    """Draw the colour bar of the pressure."""
    steps = 40
    for k in range(steps):
        place = y + height * (1.0 - (k + 1) / steps)
        svg_drawing.add_element(
            "rect",
            x=x,
            y=place,
            width=16.0,
            height=height / steps + 0.6,
            fill=_pressure_colour((k + 0.5) / steps),
        )
    for fraction in (0.0, 0.25, 0.5, 0.75, 1.0):
        svg_drawing.add_text(
            x + 22.0, y + height * (1.0 - fraction) + 4.0, f"{fraction * max_pressure / 1e6:.3g}", "start"
        )
    svg_drawing.add_text(x - 8.0, y - 12.0, "pressure [MPa]", "start")


def _draw_bolts(
    svg_drawing: SvgDrawing,
    bolt_positions_in_pixels: Array,
    plane_layout: PlaneLayout,
    pixels_per_metre: float,
    is_load_at_heads: bool,
) -> None:
    """Draw holes, heads, centre lines and numbers of bolts at positions (b, 2) [px]."""
    hole, head = (
        0.5 * pixels_per_metre * plane_layout.hole_diameter,
        0.5 * pixels_per_metre * plane_layout.head_diameter,
    )
    for number, (x, y) in enumerate(bolt_positions_in_pixels, start=1):
        reach = max(hole, head, 6.0) + 7.0
        if hole:
            svg_drawing.add_element("circle", cx=x, cy=y, r=hole, fill="#fff", stroke=LINE_COLOUR)
        if head and is_load_at_heads:
            wide = max(head - hole, 4.0) if hole else 4.0
            ring = {"stroke_width": wide, "stroke_dasharray": "2 4", "stroke_opacity": 0.9}
            svg_drawing.add_element(
                "circle", cx=x, cy=y, r=head - 0.5 * wide, fill="none", stroke=RED_COLOUR, **ring
            )
        if head:
            svg_drawing.add_element(
                "circle", cx=x, cy=y, r=head, fill="none", stroke=LINE_COLOUR, stroke_width=1.5
            )
        for dx, dy in ((reach, 0.0), (0.0, reach)):
            svg_drawing.add_line(x - dx, y - dy, x + dx, y + dy, LINE_COLOUR, "9 3 2 3")
        side = reach * 0.72
        halo = {"stroke": "#fff", "stroke_width": 3, "paint_order": "stroke", "font_weight": 600}
        svg_drawing.add_text(x + side, y - side, str(number), "start", **halo)


def draw_section(joint_parameters: AnyBoltedJoint) -> str:
    """Draw the section of both sides as SVG: thicknesses, bolts, surfaces where the load is applied."""
    bodies = joint_parameters.bodies
    assert isinstance(bodies, ElasticBodies)
    layout, attached = PlaneLayout.from_joint_parameters(joint_parameters), _attachment_name(joint_parameters)
    (low, _), (high, _) = layout.bounding_box
    first, second = bodies.thickness
    scale = min(MAX_PICTURE_WIDTH / (high - low), MAX_PICTURE_HEIGHT / (first + second))
    up = max(scale, MIN_SECTION_HEIGHT / (first + second))
    head = max(0.35 * scale * layout.head_diameter, 7.0)
    middle = PICTURE_MARGIN + head + up * second
    bottom, top = middle + up * first, middle - up * second
    x1, x2 = PICTURE_MARGIN, PICTURE_MARGIN + scale * (high - low)
    sheet = SvgDrawing(max(x2 - x1, 300.0) + 2.0 * PICTURE_MARGIN + 60.0, bottom + head + PICTURE_MARGIN)
    for y, height, fill in ((top, up * second, "#dfe6ef"), (middle, up * first, "#eef1f5")):
        sheet.add_element("rect", x=x1, y=y, width=x2 - x1, height=height, fill=fill, stroke=LINE_COLOUR)
    for y, name, thickness in (
        (0.5 * (top + middle), "side 2", second),
        (0.5 * (middle + bottom), "side 1", first),
    ):
        sheet.add_text(x2 + 20.0, y + 4.0, f"{name}: {1e3 * thickness:.4g} mm", "start", GREY_COLOUR)
    places = x1 + scale * (layout.bolt_positions[:, 0] - low)
    for x in np.unique(np.round(places, 1)):
        thread = up * bodies.thread_depth
        ends = (middle - thread if thread else top, bottom)
        _draw_bolt_section(
            sheet, x, ends, 0.5 * scale * layout.head_diameter, head, attached == "heads", thread
        )
        names = ", ".join(str(j + 1) for j in np.flatnonzero(np.abs(places - x) < 0.1))
        sheet.add_text(x, bottom + head + 24.0, names)
    surfaces = {
        "faces": "the outer faces",
        "edge": "the edges",
        "heads": f"what lies {_bearing_surface_text(joint_parameters)}",
    }
    if attached == "edge":
        sheet.add_support(x1, bottom, x1, middle)
        sheet.add_support(x2, top, x2, middle)
        sheet.add_arrow(x2 + 14.0, top - 14.0, 40.0, 0.0)
        sheet.add_arrow(x1 - 14.0, bottom + 14.0, -40.0, 0.0)
    elif attached in surfaces:
        if attached == "faces":
            sheet.add_support(x1, top, x2, top)
            sheet.add_support(x2, bottom, x1, bottom)
        for x in (x1, x2) if attached == "faces" else (np.min(places), np.max(places)):
            offset = 0.5 * scale * layout.head_diameter + 12.0 if attached == "heads" else 0.0
            seat = middle - 0.5 * up * bodies.thread_depth if offset and bodies.thread_depth else top - 14.0
            sheet.add_arrow(x + offset, seat, 0.0, -34.0)
            sheet.add_arrow(x + offset, bottom + 14.0, 0.0, 34.0)
    if attached in surfaces:
        sheet.add_text(x1, 22.0, f"the load enters at {surfaces[attached]} (hatched)", "start", RED_COLOUR)
    if up > 1.01 * scale:
        sheet.add_text(
            x1,
            sheet.pixel_height - 10.0,
            f"z drawn {up / scale:.2g} times as large as x",
            "start",
            GREY_COLOUR,
        )
    return sheet.render_svg("Both sides from the front, with bolts and attachments")


def _draw_bolt_section(
    svg_drawing: SvgDrawing,
    x: float,
    vertical_range: tuple[float, float],
    head_radius: float,
    head_height: float,
    is_load_at_heads: bool,
    thread_depth: float,
) -> None:
    """Draw one bolt, schematic [px]: with head and nut, or with head and tapped thread."""
    (top, bottom), shank = vertical_range, 0.6 * head_radius
    svg_drawing.add_element(
        "rect", x=x - shank, y=top, width=2.0 * shank, height=bottom - top, fill="#fff", stroke=LINE_COLOUR
    )
    for y in (bottom,) if thread_depth else (top - head_height, bottom):
        svg_drawing.add_element(
            "rect",
            x=x - head_radius,
            y=y,
            width=2.0 * head_radius,
            height=head_height,
            fill="#fff",
            stroke=LINE_COLOUR,
        )
    if is_load_at_heads:
        under = {"stroke": RED_COLOUR, "stroke_width": 5, "stroke_dasharray": "2 3"}
        for y in (bottom,) if thread_depth else vertical_range:
            svg_drawing.add_element("line", x1=x - head_radius, y1=y, x2=x + head_radius, y2=y, **under)
        for wall in (x - shank, x + shank) if thread_depth else ():
            svg_drawing.add_element("line", x1=wall, y1=top, x2=wall, y2=top + thread_depth, **under)
    svg_drawing.add_line(x, top - head_height - 8.0, x, bottom + head_height + 8.0, LINE_COLOUR, "9 3 2 3")
