"""From a nodal result to the contact's plane: its faces, the area of each node, and what is refused."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal

from .mesh import CORNERS, nodal_areas
from .nodal_result import ContactField, NodalResult, Nodes

AXES = "xyz"
FLAT = 1e-3
"""Largest distance of a node from the plane [1], over the size of the contact."""
SAME = 1e-6
"""Distance [1], over the size of the contact, below which two nodes are at the same place."""
SIDES = ("below", "above")
OPEN = ("refuse", "keep", "drop")
"""What to do with nodes without pressure: refuse them, take them as just touching, leave their area out."""


@dataclass(frozen=True, slots=True)
class Plane:
    """The joint's plane in the coordinates of a file.

    normal, rows : axes, one of x, y, z: normal to the contact, and along the bolt rows (the joint's x);
                   the joint's y makes them right-handed
    side         : which body's surface is taken where both have pressure, one of SIDES; None: there is one
    """

    normal: str = "z"
    rows: str | None = None
    side: str | None = None

    def axes(self) -> tuple[int, int, int]:
        """Places of x, y and the normal; ValueError if the rows run along the normal."""
        n = AXES.index(self.normal)
        x = (n + 1) % 3 if self.rows is None else AXES.index(self.rows)
        if x == n:
            raise ValueError(f"rows = {self.rows!r} is the normal too, allowed are the two other axes")
        return x, 3 - n - x, n

    def inside(self, place: Array) -> Array:
        """Places (n, 2) in the plane."""
        x, y, n = self.axes()
        sign = 1.0 if (x - n) % 3 == 1 else -1.0
        return np.column_stack([place[:, x], sign * place[:, y]])


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """Nodes of the contact: places in the result, area (n) [m2], place (n, 2) [m], pressure (n) [Pa]."""

    result: NodalResult
    index: Nodes
    area: Array
    place: Array
    pressure: Array

    def at(self, i: int) -> str:
        """The file and the place of a node, for messages."""
        return self.result.at(int(self.index[i]))

    def field(self, kept: NDArray[np.bool_]) -> ContactField:
        """The kept nodes."""
        return ContactField(self.area[kept], self.place[kept], self.pressure[kept])


def contact_surface(result: NodalResult, plane: Plane) -> ContactSurface:
    """The contact of a result.

    Raises ValueError naming the node: no pressure at all, a node off the plane, two at one place, a
    pressure that is negative or no number, an area that is not positive.
    """
    inside = plane.inside(result.place)
    if result.area is not None:
        index, area = np.arange(len(inside)), result.area
    else:
        faces = _faces(result, plane)
        area = nodal_areas(inside, faces)
        index = np.unique(np.concatenate([block.ravel() for block in faces]))
    pressure = result.pressure[index]
    if result.left_out:
        pressure = np.nan_to_num(pressure, nan=0.0)
    contact = ContactSurface(result, index, area[index], inside[index], pressure)
    _check(contact)
    return contact


def _check(contact: ContactSurface) -> None:
    p = contact.pressure
    for bad, text in (
        (~np.isfinite(p), "pressure = {p:g} is no finite number"),
        (p < 0.0, "pressure = {p:g} Pa is outside [0, inf)"),
        (~(contact.area > 0.0), "area = {a:g} m2 is outside (0, inf)"),
    ):
        if np.any(bad):
            i = int(np.argmax(bad))
            raise ValueError(f"{contact.at(i)}: {text.format(p=p[i], a=contact.area[i])}")
    size = float(np.max(np.ptp(contact.place, axis=0)))
    twice = cKDTree(contact.place).query_pairs(SAME * size)
    if twice:
        first, second = min(twice)
        raise ValueError(
            f"{contact.at(second)}: is at the same place as {contact.result.word} "
            f"{contact.result.names[contact.index[first]]}; expected each place once"
        )


def _faces(result: NodalResult, plane: Plane) -> list[Nodes]:
    """Faces of the contact: in the plane of the nodes with pressure, of a body that has some."""
    touched = np.flatnonzero(np.nan_to_num(result.pressure) != 0.0)
    if not touched.size:
        raise ValueError(f"{result.path}: no node has a pressure")
    _refuse_line(result, touched)
    axis = plane.axes()[2]
    height, size = result.place[:, axis], float(np.max(np.ptp(result.place, axis=0)))
    level = float(np.median(height[touched]))
    off = np.abs(height - level) > FLAT * size
    if np.any(off[touched]):
        i = int(touched[np.argmax(off[touched])])
        raise Refusal(
            f"{result.at(i)}: lies {abs(height[i] - level):.3g} m off the plane {plane.normal} = "
            f"{level:.6g} m; expected a plane contact and its normal",
            "normal",
        )
    allowed = ~off & np.isin(_body(result), _bodies(result, touched, height - level, plane))
    faces = [block[np.all(allowed[block], axis=1)] for block in result.faces]
    faces = _with_values(result, [block for block in faces if block.size])
    used = np.zeros(len(height), dtype=bool)
    for block in faces:
        used[block] = True
    lost = touched[~used[touched] & allowed[touched]]
    if lost.size:
        raise ValueError(f"{result.at(int(lost[0]))}: has a pressure and is on no face of the contact")
    return faces


def _refuse_line(result: NodalResult, touched: Nodes) -> None:
    """Refuse a result of two dimensions, in which the contact is a line."""
    place = result.place[touched] - result.place[touched[0]]
    far = place[np.argmax(np.sum(place**2, axis=1))]
    size = float(np.linalg.norm(far))
    off = np.linalg.norm(np.cross(place, far), axis=1) if size else np.zeros(1)
    if np.max(off) <= FLAT * size**2:
        raise ValueError(
            f"{result.path}: all nodes with pressure lie on one line, as in a two-dimensional or "
            "axisymmetric model; expected a three-dimensional one, whose contact is a surface"
        )


def _body(result: NodalResult) -> NDArray[np.int64]:
    return np.zeros(len(result.place), dtype=np.int64) if result.body is None else result.body


def _bodies(result: NodalResult, touched: Nodes, height: Array, plane: Plane) -> list[int]:
    """Bodies with pressure, of the stated side if there is one.

    A body lies above the plane if its nodes do on average.
    """
    body = _body(result)
    there: list[int] = np.unique(body[touched]).tolist()
    if plane.side is None:
        return there
    sign = 1.0 if plane.side == "above" else -1.0
    chosen = [number for number in there if sign * float(np.mean(height[body == number])) > 0.0]
    if not chosen:
        raise ValueError(f"{result.path}: no body {plane.side} the plane has a pressure")
    return chosen


def _with_values(result: NodalResult, faces: Sequence[Nodes]) -> list[Nodes]:
    """The faces; only their corners if no node but corners has a value, as some programs list them."""
    valued = np.isfinite(result.pressure)
    middles = [block[:, CORNERS[block.shape[1]] :].ravel() for block in faces]
    nodes = np.concatenate([*middles, np.empty(0, dtype=np.intp)])
    if nodes.size and not np.any(valued[nodes]):
        return [block[:, : CORNERS[block.shape[1]]] for block in faces]
    return list(faces)
