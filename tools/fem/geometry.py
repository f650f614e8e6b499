"""Parametric geometry of a bolted assembly: two bodies in contact on a plane, and their bolts.

The contact lies in the plane z = 0, with side 1 below and side 2 above. A body is a stack of layers. Each
layer is a rectangle with an optional rectangular opening. All rectangles are centred on the z axis.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import (
    Array,
    CheckedParameters,
    check_fields,
    choice_field,
    quantity_field,
    series_field,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltGrid:
    """Bolts of an assembly in rows along x, centred on the z axis."""

    rows: float = quantity_field("1", "rows of bolts", ge=1.0, is_integer=True)
    columns: float = quantity_field("1", "bolts in a row", ge=1.0, is_integer=True)
    row_spacing: float = quantity_field("m", "distance between the two outermost rows", ge=0.0)
    column_spacing: float = quantity_field("m", "distance between the outermost bolts of a row", ge=0.0)
    inside: bool = choice_field(False, True, doc="whether there are bolts inside the outer frame of the grid")
    hole_diameter: float = quantity_field("m", "clearance hole", gt=0.0)
    head_diameter: float = quantity_field("m", "outer diameter of the bolt head or washer", gt=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        for count, name in ((self.rows, "row_spacing"), (self.columns, "column_spacing")):
            if count > 1.0 and getattr(self, name) == 0.0:
                raise ValueError(
                    f"{name} = 0 m is outside (0, inf): with more than one row or column it must be positive"
                )

    @property
    def bolt_positions(self) -> Array:
        """Bolt positions (n, 2) [m], row by row."""
        rows, columns = int(self.rows), int(self.columns)
        y = 0.5 * self.row_spacing * _equidistant_coordinates(rows)
        x = 0.5 * self.column_spacing * _equidistant_coordinates(columns)
        edge = np.zeros((rows, columns), dtype=bool)
        edge[[0, -1], :], edge[:, [0, -1]] = True, True
        row, column = np.nonzero(edge | self.inside)
        return np.stack([x[column], y[row]], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltList:
    """Bolts at listed positions (x, y), with the diameters of hole and head."""

    x: tuple[float, ...] = series_field("m", "positions along x")
    y: tuple[float, ...] = series_field("m", "positions along y")
    hole_diameter: float = quantity_field("m", "clearance hole", gt=0.0)
    head_diameter: float = quantity_field("m", "outer diameter of the bolt head or washer", gt=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        if len(self.x) != len(self.y):
            raise ValueError(f"y has {len(self.y)} values, x has {len(self.x)}; expected one for each bolt")

    @property
    def bolt_positions(self) -> Array:
        """Bolt positions (n, 2) [m]."""
        return np.stack([self.x, self.y], axis=1).astype(np.float64)


BoltArrangement = BoltGrid | BoltList
"""Positions of bolts: a grid or a list."""


def _equidistant_coordinates(coordinate_count: int) -> Array:
    """Equidistant coordinates from -1 to 1, as many as `coordinate_count`; for one, the coordinate 0."""
    return np.linspace(-1.0, 1.0, coordinate_count) if coordinate_count > 1 else np.zeros(1)


LENGTH_TOLERANCE = 1e-9
"""Difference [m] below which two lengths are equal."""


@dataclass(frozen=True, slots=True)
class Layer:
    """Layer of a body: a rectangular slab with an optional opening.

    bottom_distance, top_distance : distances from the contact plane [m]
    outline_half_lengths : half lengths (2) of the outer rectangle along x and y [m]
    opening_half_lengths : half lengths (2) of the rectangular opening along x and y [m]; 0: no opening
    has_bolt_holes : whether the bolt holes pass through the layer
    """

    bottom_distance: float
    top_distance: float
    outline_half_lengths: tuple[float, float]
    opening_half_lengths: tuple[float, float] = (0.0, 0.0)
    has_bolt_holes: bool = False

    def is_in_material(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Whether points (...) [m] of the plan view lie in the material of the layer; ignores bolt holes."""
        inside = (np.abs(x) < self.outline_half_lengths[0]) & (np.abs(y) < self.outline_half_lengths[1])
        return np.asarray(
            inside
            & ~((np.abs(x) < self.opening_half_lengths[0]) & (np.abs(y) < self.opening_half_lengths[1]))
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Plate(CheckedParameters):
    """A rectangular plate. Its whole face, without the bolt holes, is in contact."""

    length: float = quantity_field("m", "length along x", gt=0.0)
    width: float = quantity_field("m", "width along y", gt=0.0)
    thickness: float = quantity_field("m", "thickness", gt=0.0)
    E: float = quantity_field("Pa", "Young's modulus", gt=0.0)
    nu: float = quantity_field("1", "Poisson's ratio", gt=-1.0, lt=0.5)
    density: float = quantity_field("kg/m3", "density", gt=0.0)

    @property
    def clamped_thickness(self) -> float:
        """Thickness [m] of the plate under the head of a bolt."""
        return self.thickness

    def list_rectangular_layers(self) -> tuple[Layer, ...]:
        """Rectangular slab of which the plate consists, as a tuple of one layer."""
        return (Layer(0.0, self.thickness, (0.5 * self.length, 0.5 * self.width), has_bolt_holes=True),)


@dataclass(frozen=True, slots=True, kw_only=True)
class TappedPlate(Plate):
    """A plate with blind tapped holes: the bolts are screwed into it."""

    depth: float = quantity_field("m", "depth of the threads from the contact", gt=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.depth < self.thickness:
            raise ValueError(
                f"thickness = {self.thickness:g} m: the tapped plate must be thicker than its thread depth, "
                f"{self.depth:g} m; increase thickness or reduce depth"
            )

    def list_rectangular_layers(self) -> tuple[Layer, ...]:
        """Rectangular slabs of the tapped plate, from the contact plane outward: with bolt holes, without."""
        half = (0.5 * self.length, 0.5 * self.width)
        return Layer(0.0, self.depth, half, has_bolt_holes=True), Layer(self.depth, self.thickness, half)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxSection:
    """A rectangular box, open towards the contact: a flange there, four walls, a floor at the far end."""

    length: float = quantity_field("m", "outer length of the flange along x", gt=0.0)
    width: float = quantity_field("m", "outer width of the flange along y", gt=0.0)
    height: float = quantity_field("m", "height from the contact to the far end", gt=0.0)
    wall: float = quantity_field("m", "thickness of the walls", gt=0.0)
    flange_width: float = quantity_field("m", "width of the contact frame", gt=0.0)
    flange_thickness: float = quantity_field("m", "thickness of the flange", gt=0.0)
    floor: float = quantity_field("m", "thickness of the floor at the far end; 0: open", ge=0.0)
    wall_inset: float = quantity_field(
        "m", "from the outer edge of the flange to the wall's outer face", ge=0.0
    )
    E: float = quantity_field("Pa", "Young's modulus", gt=0.0)
    nu: float = quantity_field("1", "Poisson's ratio", gt=-1.0, lt=0.5)
    density: float = quantity_field("kg/m3", "density", gt=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        low, high = self.wall_inset + self.wall, 0.5 * min(self.length, self.width)
        if not low - LENGTH_TOLERANCE <= self.flange_width < high:
            raise ValueError(
                f"flange_width = {self.flange_width:g} m is outside [{low:g}, {high:g}): "
                "the flange must carry the walls and leave the middle open"
            )
        if not self.flange_thickness < self.height - self.floor:
            raise ValueError(
                f"flange_thickness = {self.flange_thickness:g} m is outside "
                f"(0, {self.height - self.floor:g}): flange, walls and floor must fit into the height"
            )

    @property
    def clamped_thickness(self) -> float:
        """Thickness [m] of the flange under the head of a bolt."""
        return self.flange_thickness

    def list_rectangular_layers(self) -> tuple[Layer, ...]:
        """Rectangular slabs of the box, from the contact plane outward: flange, walls, floor (if any)."""
        opening = self._half_lengths(self.flange_width)
        outside, inside = self._half_lengths(self.wall_inset), self._half_lengths(self.wall_inset + self.wall)
        base, end = self.flange_thickness, self.height - self.floor
        flange = Layer(0.0, base, self._half_lengths(0.0), opening, has_bolt_holes=True)
        walls = Layer(base, end, outside, inside)
        return (flange, walls, Layer(end, self.height, outside)) if self.floor else (flange, walls)

    def _half_lengths(self, edge_inset: float) -> tuple[float, float]:
        """Half lengths (2) [m] of a rectangle with this inset from the edge of the flange."""
        return 0.5 * self.length - edge_inset, 0.5 * self.width - edge_inset


BodyGeometry = Plate | TappedPlate | BoxSection
"""Geometry of one body of an assembly."""


@dataclass(frozen=True, slots=True)
class Assembly:
    """Two bodies and their bolts. Raises ValueError if the bolts do not fit on the bodies."""

    name: str
    side1: BodyGeometry
    side2: BodyGeometry
    bolts: BoltArrangement

    def __post_init__(self) -> None:
        check_bolt_heads(self)

    @property
    def row_distance(self) -> float:
        """Distance L_a [m] of the two outermost rows of bolts, which carry a moment about x."""
        return float(np.ptp(self.bolts.bolt_positions[:, 1]))

    def find_outer_rows(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]] | None:
        """Masks (n) of the bolts in the outermost row at y > 0 and in the opposite row.

        None if there is only one row, or if the two rows have different numbers of bolts.
        """
        y, size = self.bolts.bolt_positions[:, 1], self.row_distance
        high, low = (np.abs(y - end) < LENGTH_TOLERANCE + 1e-6 * size for end in (y.max(), y.min()))
        return (high, low) if size > 0.0 and high.sum() == low.sum() else None

    @property
    def contact_area(self) -> float:
        """Nominal contact area [m2] of the two bodies, without the bolt holes."""
        layers = [body.list_rectangular_layers()[0] for body in (self.side1, self.side2)]
        outer = np.min([layer.outline_half_lengths for layer in layers], axis=0)
        inner1, inner2 = (np.minimum(layer.opening_half_lengths, outer) for layer in layers)
        opening = 4.0 * (inner1.prod() + inner2.prod() - np.minimum(inner1, inner2).prod())
        holes = len(self.bolts.bolt_positions) * 0.25 * np.pi * self.bolts.hole_diameter**2
        return float(4.0 * outer.prod() - opening - holes)

    def bolt_forces(self, preload: float, moment: float = 0.0) -> Array:
        """Force (n) [N] of each bolt for a preload [N] per bolt and a moment [N.m] about x.

        The moment M adds M/(L_a N_b) to the force of each bolt in the outermost row at y > 0 and subtracts it
        in the opposite row: L_a distance of the rows, N_b bolts in each (Zhao 2018, section 3).

        Raises ValueError if the preload is not positive, if the two outer rows do not match, or if a row of
        bolts would lose its force.
        """
        if not (np.isfinite(preload) and preload > 0.0):
            raise ValueError(f"preload = {preload:g} N is outside (0, inf): force of each bolt")
        force = np.full(len(self.bolts.bolt_positions), float(preload))
        if moment == 0.0:
            return force
        rows, limit = self.find_outer_rows(), self.max_moment(preload)
        if rows is None:
            raise ValueError(
                f"moment = {moment:g} N.m needs two outer rows of bolts with equal numbers of bolts; "
                "expected 0 N.m here"
            )
        if not abs(moment) < limit:
            reason = "a row of bolts would lose its force"
            raise ValueError(f"moment = {moment:g} N.m is outside ({-limit:g}, {limit:g}): {reason}")
        for row, sign in zip(rows, (1.0, -1.0), strict=True):
            force[row] += sign * preload * moment / limit
        return force

    def max_moment(self, preload: float) -> float:
        """Moment [N.m] that cancels the preload in an outer row of bolts, if only the outer rows carry it.

        It is 0 if the two outer rows do not have the same number of bolts.
        """
        rows = self.find_outer_rows()
        return 0.0 if rows is None else preload * self.row_distance * float(rows[0].sum())


def check_bolt_heads(assembly: Assembly) -> None:
    """Raise ValueError if a bolt head does not lie flat on its body, or if two heads overlap."""
    bolts = assembly.bolts
    hole, head, positions = 0.5 * bolts.hole_diameter, 0.5 * bolts.head_diameter, bolts.bolt_positions
    if hole >= head:
        raise ValueError(
            f"hole_diameter = {2 * hole:g} m is outside (0, {2 * head:g}): the hole must be smaller than the "
            "head"
        )
    for i, (x, y) in enumerate(positions):
        for side in ("side1", "side2"):
            if text := _find_bolt_head_obstacle(getattr(assembly, side), x, y, head):
                raise ValueError(
                    f"bolt {i + 1} at ({1e3 * x:.4g}, {1e3 * y:.4g}) mm with a head of {2e3 * head:.4g} mm "
                    f"{text} of {side}"
                )
        distance = np.hypot(*(positions[:i] - positions[i]).T)
        if distance.size and distance.min() < 2.0 * head:
            raise ValueError(
                f"heads of {2e3 * head:.4g} mm are outside (0, {1e3 * distance.min():.4g}] mm: "
                f"those of bolts {distance.argmin() + 1} and {i + 1} overlap"
            )


def check_thickness(assembly: Assembly) -> None:
    """Raise ValueError if a body under a bolt head is thinner than the bearing ring of the head is wide."""
    min_thickness = 0.5 * (assembly.bolts.head_diameter - assembly.bolts.hole_diameter)
    for name, body in (("side1", assembly.side1), ("side2", assembly.side2)):
        if not body.clamped_thickness >= min_thickness:
            raise ValueError(
                f"{name} is {1e3 * body.clamped_thickness:.4g} mm thick, expected at least "
                f"{1e3 * min_thickness:.4g} mm: the width of the bearing ring under a head; thinner plates "
                "would punch through"
            )


def _find_bolt_head_obstacle(
    body: BodyGeometry, bolt_x: float, bolt_y: float, head_radius: float
) -> str | None:
    """Reason why a bolt head (a disc) does not lie flat on a body; None if it does."""
    flange, *rest = body.list_rectangular_layers()
    if isinstance(body, TappedPlate):
        return None  # no head lies on a tapped plate
    if not _contains_disc(bolt_x, bolt_y, head_radius, flange.outline_half_lengths) or _overlaps_disc(
        bolt_x, bolt_y, head_radius, flange.opening_half_lengths
    ):
        return f"reaches beyond the {'plate' if isinstance(body, Plate) else 'flange'}"
    if (
        rest
        and _overlaps_disc(bolt_x, bolt_y, head_radius, rest[0].outline_half_lengths)
        and not _contains_disc(bolt_x, bolt_y, head_radius, rest[0].opening_half_lengths)
    ):
        return "runs into a wall"
    return None


def _contains_disc(
    disc_x: float, disc_y: float, disc_radius: float, rectangle_half_lengths: tuple[float, float]
) -> bool:
    """Whether a disc lies inside a rectangle of these half lengths [m]; touching counts as inside."""
    return (
        abs(disc_x) + disc_radius <= rectangle_half_lengths[0] + LENGTH_TOLERANCE
        and abs(disc_y) + disc_radius <= rectangle_half_lengths[1] + LENGTH_TOLERANCE
    )


def _overlaps_disc(
    disc_x: float, disc_y: float, disc_radius: float, rectangle_half_lengths: tuple[float, float]
) -> bool:
    """Whether a disc overlaps the interior of a rectangle of these half lengths [m]."""
    gap = np.hypot(
        max(abs(disc_x) - rectangle_half_lengths[0], 0.0), max(abs(disc_y) - rectangle_half_lengths[1], 0.0)
    )
    return min(rectangle_half_lengths) > 0.0 and bool(gap < disc_radius - LENGTH_TOLERANCE)


def layer_rectangles(assembly: Assembly) -> Iterator[tuple[float, float]]:
    """Half lengths (2) [m] of all outlines and openings of the layers of both bodies, without duplicates."""
    known_keys: set[tuple[float, float]] = set()
    for body in (assembly.side1, assembly.side2):
        for layer in body.list_rectangular_layers():
            for half in (layer.outline_half_lengths, layer.opening_half_lengths):
                key = (round(half[0], 9), round(half[1], 9))
                if min(half) > 0.0 and key not in known_keys:
                    known_keys.add(key)
                    yield half
