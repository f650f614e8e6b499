"""From a nodal contact result to the parameter file of a joint with bolts that has it; its picture."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from jointfmu.mechanics.footprint.friction import friction_patches
from jointfmu.mechanics.footprint.shape import (
    BOLT_MEANS,
    PATCHES,
    PressureShape,
    as_lists,
    growing,
    means,
)
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, build
from jointfmu.quantity.refusal import Refusal

from .. import plots
from .clamped import BoltedInterface, clamping
from .nodal_result import ContactField
from .reduction import MOST, Reduction, reduce

FORCE_ERROR = 0.01
"""Largest difference of a field's force from the stated preload [1]."""
MOMENT_PART = (0.5, 1.5)
"""What part of a stated moment [1] the pressures may balance; the rest is bolt forces."""
_REPLACED = ("pattern.", "plate.", "field.", "bodies.", "sides")
"""Groups of the file that the field replaces; bodies are those of another contact."""


def with_field(
    file: ParameterFile,
    field: ContactField,
    preload: float,
    source: str,
    tilted: ContactField | None = None,
    moment: float | None = None,
    bolts: Array | None = None,
    tolerance: float = FORCE_ERROR,
) -> tuple[ParameterFile, Reduction]:
    """A joint with the pressure of a field instead of a pattern of bolts, and its contact area.

    Parameters
    ----------
    file    : of a joint of joints.clamped; its `n_bolts`, `row_bolts`, `row_distance` give the forces
              their meaning
    preload : [N] of each bolt, at which the field was computed
    source  : where the field comes from, for the file
    tilted  : the field at the same nodes under a bending moment too; without it the pressure grows in
              proportion to the distance from its centre
    moment  : [N.m] of `tilted`, positive if it raises the pressure at y > 0
    bolts   : (n, 2) [m] places of the bolts, for what their stiffness adds to rotations; None: nothing
    tolerance : [1] by which a field's force may differ from that of the bolts, to which it is scaled

    Raises ValueError if the joint's pressure cannot be a field, if a field's force differs from that of the
    bolts by more than the tolerance, if the two fields do not fit each other, or if the pressures' own moment
    is far from the stated one.
    """
    pressures = clamping(file.joint).pressures
    shape = pressure_shape(file.values, field, preload, tilted, moment, tolerance)
    reduction = reduce(replace(file.values, A_0=float(np.sum(field.area))), shape, preload, pressures)
    begin = reduction.shape if shape.share.size > MOST else None
    patches = friction_patches(shape, PATCHES, begin)
    lists = as_lists(reduction.shape) | as_lists(patches)
    given: dict[str, object] = {f"field.{name}": values for name, values in lists.items()}
    given["A_0"] = float(np.sum(field.area))
    if bolts is not None:
        positions = bolts - field.centroid
        places = means(positions)
        given |= {f"field.{name}": value for name, value in zip(BOLT_MEANS, places, strict=True)}
        given |= {f"field.each_bolt_{a}": tuple(positions[:, i].tolist()) for i, a in enumerate("xy")}
    kept = {n: v for n, v in file.flat.items() if not n.startswith(_REPLACED)}
    text = f"{source}, {preload:g} N per bolt; {reduction.points} points for {reduction.nodes} nodes"
    return replace(
        file,
        values=build(type(file.values), kept | given),
        origins={n: k for n, k in file.origins.items() if not n.startswith(_REPLACED)}
        | dict.fromkeys(given, "derived"),
        sources={n: s for n, s in file.sources.items() if not n.startswith(_REPLACED)}
        | dict.fromkeys(given, text)
        | {"A_0": f"{source}, sum of the nodal areas", "field.tilt": f"{text}; {_rule(tilted, moment)}"},
    ), reduction


def _rule(tilted: ContactField | None, moment: float | None) -> str:
    if tilted is None:
        return "in proportion to the distance from the centre of pressure"
    return f"from the field at {moment:g} N.m"


def pressure_shape(
    joint: BoltedInterface,
    field: ContactField,
    preload: float,
    tilted: ContactField | None = None,
    moment: float | None = None,
    tolerance: float = FORCE_ERROR,
) -> PressureShape:
    """All nodes of a field as the shape of a joint's pressure; arguments as in `with_field`.

    With `mean` the bolts' force over the area and L_a the distance of the rows, a node's pressure is
    mean equal + M/(L_a A_0) tilt. Equilibrium asks for a sum of share tilt y of L_a. Without a second
    field tilt = L_a equal (y - y_p)/sum(share equal (y - y_p)^2), y_p the centre of pressure.
    """
    scale = _force(joint, field, preload, "the field", tolerance)
    area = float(np.sum(field.area))
    share, position = field.area / area, field.position - field.centroid
    mean = preload * joint.n_bolts / area
    equal = scale * field.pressure / mean
    if tilted is None:
        tilt = joint.row_distance * growing(share, position[:, 1], equal)
        return PressureShape(share, position, equal, tilt)
    if moment is None or not np.isfinite(moment) or moment == 0.0:
        raise ValueError(f"moment = {moment} N.m is outside (-inf, 0) and (0, inf): of the second field")
    scale = _force(joint, tilted, preload, "the field with a moment", tolerance)
    _same_nodes(field, tilted)
    added = scale * tilted.pressure - mean * equal
    part = area * float(share @ (added * position[:, 1])) / moment
    if not MOMENT_PART[0] <= part <= MOMENT_PART[1]:
        low, high = MOMENT_PART
        raise ValueError(
            f"the pressures of the second field balance {part:.3g} of the moment of {moment:g} N.m, "
            f"allowed is {low:g} to {high:g}: a positive moment raises the pressure at y > 0"
        )
    return PressureShape(share, position, equal, added * joint.row_distance * area / moment)


def _force(joint: BoltedInterface, field: ContactField, preload: float, name: str, tolerance: float) -> float:
    """The bolts' force over the field's [1], 1 within the tolerance."""
    if not 0.0 < tolerance < 1.0:
        raise Refusal(f"force_tolerance = {tolerance:g} is outside (0, 1)", "force_tolerance")
    if not 0.0 < preload < np.inf:
        raise ValueError(f"preload = {preload:g} N is outside (0, inf)")
    expected = preload * joint.n_bolts
    if not abs(field.force / expected - 1.0) <= tolerance:
        raise Refusal(
            f"the force of {name} is {field.force:.6g} N, expected {expected:.6g} N within "
            f"{100.0 * tolerance:.3g} %: {joint.n_bolts:g} bolts of {preload:g} N; a larger tolerance scales "
            "it to theirs",
            "force_tolerance",
        )
    return expected / field.force


def _same_nodes(field: ContactField, tilted: ContactField) -> None:
    """Raise ValueError naming the first node that the two fields do not share."""
    if field.area.size != tilted.area.size:
        raise ValueError(
            f"the field with a moment has {tilted.area.size} nodes, "
            f"expected those of the first: {field.area.size}"
        )
    size = float(np.ptp(field.position, axis=0).max())
    apart = np.max(np.abs(tilted.position - field.position), axis=1) > 1e-6 * size
    apart |= np.abs(tilted.area - field.area) > 1e-6 * np.max(field.area)
    if np.any(apart):
        i = int(np.argmax(apart))
        raise ValueError(
            f"node {i + 1} of the field with a moment is at {tilted.position[i].tolist()} m with "
            f"{tilted.area[i]:g} m2, expected {field.position[i].tolist()} m with {field.area[i]:g} m2"
        )


def draw(field: ContactField, reduction: Reduction, path: str | Path) -> None:
    """Save the picture as .png or .svg."""
    place = 1e3 * (field.position - field.centroid)
    wide, high = np.ptp(place, axis=0)
    with plots.drawing(path, (10.4, float(np.clip(4.6 * high / wide, 3.0, 7.0)))) as figure:
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        size = 20.0 * field.area / np.max(field.area) * min(1.0, 3000.0 / field.area.size)
        shown = left.scatter(*place.T, c=1e-6 * field.pressure, s=size, cmap="viridis", lw=0.0)
        figure.colorbar(shown, ax=left, label="pressure [MPa]", shrink=0.85)
        left.set_title(f"{field.area.size} nodes, {field.force / 1e3:.4g} kN", loc="left", fontsize=10)
        points = reduction.shape
        mean = field.force / float(np.sum(field.area))
        shown = right.scatter(
            *(1e3 * points.position.T),
            c=1e-6 * mean * points.equal,
            s=np.clip(2000.0 * points.share, 4.0, 400.0),
            cmap="viridis",
            alpha=0.75,
        )
        figure.colorbar(shown, ax=right, label="pressure [MPa]", shrink=0.85)
        right.set_title(f"{reduction.points} points, by their share of the area", loc="left", fontsize=10)
        left.set_ylabel("y, across the bolt rows [mm]")
        for axes in (left, right):
            axes.set_xlabel("x, along the bolt rows [mm]")
            axes.set_aspect("equal")
