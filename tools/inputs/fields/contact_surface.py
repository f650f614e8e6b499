"""Extract and check the contact surface of a nodal result: nodes in the joint plane, area, pressure."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from .mesh import FACE_CORNER_COUNTS, compute_nodal_areas
from .nodal_result import ContactPressureField, NodalResult, NodeIndices

AXIS_NAMES = "xyz"
"""Names of the axes of a file."""
PLANARITY_TOLERANCE = 1e-3
"""Largest distance of a node from the contact plane over the size of the contact [1]."""
NODE_COINCIDENCE_TOLERANCE = 1e-6
"""Distance of two nodes over the size of the contact [1], below which they coincide."""
BODY_SIDES = ("below", "above")
"""Sides of the contact plane on which the body may lie whose surface is read."""
OPEN_NODE_OPTIONS = ("refuse", "keep", "drop")
"""Treatment of nodes without pressure: raise an error, keep them as just touching, leave their area out."""


@dataclass(frozen=True, slots=True)
class ContactPlane:
    """Orientation of the contact plane in the coordinate system of a file.

    normal_axis   : axis x, y or z normal to the contact
    bolt_row_axis : axis x, y or z along the bolt rows: the x axis of the joint; None: the axis after
                    `normal_axis`
    body_side     : body whose surface is read, one of BODY_SIDES; None: all bodies with pressure

    The y axis of the joint completes a right-handed system.
    """

    normal_axis: str = "z"
    bolt_row_axis: str | None = None
    body_side: str | None = None

    def axis_indices(self) -> tuple[int, int, int]:
        """Axes of the file (0: x, 1: y, 2: z) that are the joint's x, y and normal.

        Raises ValueError if the bolt rows are along the normal.
        """
        n = AXIS_NAMES.index(self.normal_axis)
        x = (n + 1) % 3 if self.bolt_row_axis is None else AXIS_NAMES.index(self.bolt_row_axis)
        if x == n:
            raise ValueError(
                f"rows = {self.bolt_row_axis!r} is also the normal; state one of the two other axes"
            )
        return x, 3 - n - x, n

    def project_to_contact_plane(self, node_positions: Array) -> Array:
        """Project positions (n, 3) of a file to positions (n, 2) in the plane of the joint."""
        x, y, n = self.axis_indices()
        sign = 1.0 if (x - n) % 3 == 1 else -1.0
        return np.column_stack([node_positions[:, x], sign * node_positions[:, y]])


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """Contact surface: nodes (n) with area, position in the plane of the joint, and pressure.

    source_result  : nodal result from which the nodes come
    node_indices   : (n) indices in the nodal result
    nodal_area     : (n) [m2]
    node_positions : (n, 2) [m] in the plane of the joint
    nodal_pressure : (n) [Pa]
    """

    source_result: NodalResult
    node_indices: NodeIndices
    nodal_area: Array
    node_positions: Array
    nodal_pressure: Array

    def describe_node(self, contact_node_index: int) -> str:
        """Name a contact node in a message: file and node number."""
        return self.source_result.describe_node(int(self.node_indices[contact_node_index]))

    def select_pressure_field(self, node_mask: NDArray[np.bool_]) -> ContactPressureField:
        """Select nodes by a mask (n), and return the pressure field of these nodes."""
        return ContactPressureField(
            self.nodal_area[node_mask], self.node_positions[node_mask], self.nodal_pressure[node_mask]
        )


def extract_contact_surface(nodal_result: NodalResult, contact_plane: ContactPlane) -> ContactSurface:
    """Extract the contact surface from a nodal result.

    Raises ValueError with the node: no node has a pressure, a node lies off the plane, two nodes coincide, a
    pressure is negative or not finite, an area is not positive.
    """
    inside = contact_plane.project_to_contact_plane(nodal_result.node_positions)
    if nodal_result.nodal_area is not None:
        index, area = np.arange(len(inside)), nodal_result.nodal_area
    else:
        faces = _find_contact_faces(nodal_result, contact_plane)
        area = compute_nodal_areas(inside, faces)
        index = np.unique(np.concatenate([block.ravel() for block in faces]))
    pressure = nodal_result.nodal_pressure[index]
    if nodal_result.omits_open_nodes:
        pressure = np.nan_to_num(pressure, nan=0.0)
    contact = ContactSurface(nodal_result, index, area[index], inside[index], pressure)
    _check_contact_surface(contact)
    return contact


def _check_contact_surface(contact_surface: ContactSurface) -> None:
    """Raise ValueError for a nodal pressure or area out of range, and for nodes that coincide."""
    p = contact_surface.nodal_pressure
    for invalid, text in (
        (~np.isfinite(p), "pressure = {p:g} is not a finite number"),
        (p < 0.0, "pressure = {p:g} Pa is outside [0, inf)"),
        (~(contact_surface.nodal_area > 0.0), "area = {a:g} m2 is outside (0, inf)"),
    ):
        if np.any(invalid):
            i = int(np.argmax(invalid))
            raise ValueError(
                f"{contact_surface.describe_node(i)}: {text.format(p=p[i], a=contact_surface.nodal_area[i])}"
            )
    size = float(np.max(np.ptp(contact_surface.node_positions, axis=0)))
    coincident = cKDTree(contact_surface.node_positions).query_pairs(NODE_COINCIDENCE_TOLERANCE * size)
    if coincident:
        first, second = min(coincident)
        raise ValueError(
            f"{contact_surface.describe_node(second)}: is at the same place as "
            f"{contact_surface.source_result.node_label} "
            f"{contact_surface.source_result.node_numbers[contact_surface.node_indices[first]]}; give "
            "each position once"
        )


def _find_contact_faces(nodal_result: NodalResult, contact_plane: ContactPlane) -> list[NodeIndices]:
    """Element faces in the contact plane that belong to bodies with pressure.

    The contact plane contains all nodes with pressure; ValueError if these nodes are not plane.
    """
    loaded = np.flatnonzero(np.nan_to_num(nodal_result.nodal_pressure) != 0.0)
    if not loaded.size:
        raise ValueError(f"{nodal_result.result_path}: all pressures are 0; expected nodes in contact")
    _check_nodes_not_collinear(nodal_result, loaded)
    axis = contact_plane.axis_indices()[2]
    height, size = (
        nodal_result.node_positions[:, axis],
        float(np.max(np.ptp(nodal_result.node_positions, axis=0))),
    )
    level = float(np.median(height[loaded]))
    off_plane = np.abs(height - level) > PLANARITY_TOLERANCE * size
    if np.any(off_plane[loaded]):
        i = int(loaded[np.argmax(off_plane[loaded])])
        raise InputRefusal(
            f"{nodal_result.describe_node(i)}: lies {abs(height[i] - level):.3g} m away from the plane "
            f"{contact_plane.normal_axis} = {level:.6g} m; the contact must be plane; state its normal",
            "normal",
        )
    candidate = ~off_plane & np.isin(
        _body_of_node(nodal_result), _select_bodies(nodal_result, loaded, height - level, contact_plane)
    )
    faces = [block[np.all(candidate[block], axis=1)] for block in nodal_result.boundary_faces]
    faces = _drop_empty_midside_nodes(nodal_result, [block for block in faces if block.size])
    used = np.zeros(len(height), dtype=bool)
    for block in faces:
        used[block] = True
    unused = loaded[~used[loaded] & candidate[loaded]]
    if unused.size:
        raise ValueError(
            f"{nodal_result.describe_node(int(unused[0]))}: has a pressure, but is on no element face in the "
            "contact plane; expected the elements of the bodies in contact"
        )
    return faces


def _check_nodes_not_collinear(nodal_result: NodalResult, loaded_nodes: NodeIndices) -> None:
    """Raise ValueError if the contact nodes lie on a line, as in a two-dimensional model."""
    offset = nodal_result.node_positions[loaded_nodes] - nodal_result.node_positions[loaded_nodes[0]]
    farthest = offset[np.argmax(np.sum(offset**2, axis=1))]
    size = float(np.linalg.norm(farthest))
    distance = np.linalg.norm(np.cross(offset, farthest), axis=1) if size else np.zeros(1)
    if np.max(distance) <= PLANARITY_TOLERANCE * size**2:
        raise ValueError(
            f"{nodal_result.result_path}: all nodes with pressure lie on one line, as in a two-dimensional "
            "or axisymmetric model; give the result of a three-dimensional model"
        )


def _body_of_node(nodal_result: NodalResult) -> NDArray[np.int64]:
    """Index of the body to which each node belongs; 0 if the result has no bodies."""
    return (
        np.zeros(len(nodal_result.node_positions), dtype=np.int64)
        if nodal_result.body_of_node is None
        else nodal_result.body_of_node
    )


def _select_bodies(
    nodal_result: NodalResult,
    loaded_nodes: NodeIndices,
    height_above_plane: Array,
    contact_plane: ContactPlane,
) -> list[int]:
    """Indices of the bodies with pressure; only those on `body_side` of the plane if a side is stated.

    A body lies above the plane if the mean height of its nodes is positive.
    """
    body = _body_of_node(nodal_result)
    with_pressure: list[int] = np.unique(body[loaded_nodes]).tolist()
    if contact_plane.body_side is None:
        return with_pressure
    sign = 1.0 if contact_plane.body_side == "above" else -1.0
    selected = [
        number for number in with_pressure if sign * float(np.mean(height_above_plane[body == number])) > 0.0
    ]
    if not selected:
        raise ValueError(
            f"{nodal_result.result_path}: no body {contact_plane.body_side} the plane has a pressure; state "
            "the other side, or none"
        )
    return selected


def _drop_empty_midside_nodes(
    nodal_result: NodalResult, element_faces: Sequence[NodeIndices]
) -> list[NodeIndices]:
    """Reduce quadratic faces to linear ones if no mid-side node has a value (some programs list corners)."""
    has_value = np.isfinite(nodal_result.nodal_pressure)
    midside = [block[:, FACE_CORNER_COUNTS[block.shape[1]] :].ravel() for block in element_faces]
    nodes = np.concatenate([*midside, np.empty(0, dtype=np.intp)])
    if nodes.size and not np.any(has_value[nodes]):
        return [block[:, : FACE_CORNER_COUNTS[block.shape[1]]] for block in element_faces]
    return list(element_faces)
