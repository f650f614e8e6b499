"""The bolted joint's points as data: whatever gives the pressure, its C has a field of points."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from jointfmu.joints.bolted_joint import spring
from jointfmu.joints.bolted_joint.bodies import DIGITS, MODES, ElasticBodies, Modes, RigidBodies
from jointfmu.joints.bolted_joint.contact import MOST_PARTS, PART_DIGITS, parts
from jointfmu.joints.bolted_joint.law import Bolted
from jointfmu.mechanics.footprint.shape import BOLT_MEANS, PATCHES, PressureShape
from jointfmu.mechanics.sliders import SLIDERS, offsets, turning
from jointfmu.quantity import flatten

from ...joint_parts.data import DataPart, DataTable

_SECTIONS = ("pattern.", "plate.", "field.", "bodies.")
_ONE = {"share": (1.0,), "x": (0.0,), "y": (0.0,), "equal": (1.0,), "tilt": (0.0,)}
"""A field of one point."""


def _stands(joint: Bolted) -> Mapping[str, object]:
    """The joint with one point, as its C is generated, and the place of its bolts."""
    own = {name: value for name, value in flatten(joint).items() if not name.startswith(_SECTIONS)}
    spread = dict(zip(BOLT_MEANS, joint.pattern.bolt_means, strict=True))
    points: dict[str, object] = {f"field.{name}": value for name, value in (_ONE | spread).items()}
    return own | points | (_one_mode(round(joint.n_bolts)) if joint.elastic else {})


def _one_mode(bolts: int) -> dict[str, object]:
    """Bodies of one mode, one patch and so many bolts."""
    stated = [item.name for item in fields(ElasticBodies) if item.default is MISSING]
    values: dict[str, tuple[float, ...]] = dict.fromkeys(stated, (0.0,))
    values |= {"stiffness": (1.0,), **dict.fromkeys(("stretch", "bolt_x", "bolt_y"), (0.0,) * bolts)}
    return {f"bodies.{name}": value for name, value in values.items()}


def _tables(joint: Bolted) -> Mapping[str, DataTable]:
    patches = spring.patches(joint.pattern)
    return {
        "nodes": DataTable(_rows(spring.points(joint.pattern)), spring.POINTS),
        "patches": DataTable(np.column_stack([_rows(patches), patches.radius]), PATCHES),
        "turning": DataTable(turning(SLIDERS), 2),
        "offsets": DataTable(offsets(patches.equal)[:, None], PATCHES),
        **_bodies(joint),
    }


def _bodies(joint: Bolted) -> Mapping[str, DataTable]:
    """Modes in rows of all of them, as whole numbers of two bytes.

    A joint with rigid sides has room for one row.
    """
    modes, lever, most = Modes.of(RigidBodies(), 0, np.zeros((0, 2))), np.zeros(0), (1, 1, 1, 1)
    pressing, pairs = np.zeros((0, 4)), 1
    if joint.elastic:
        points, patches = spring.points(joint.pattern), spring.patches(joint.pattern)
        modes = Modes.of(joint.bodies, len(points.share), patches.position)
        lever, pressing = modes.lever, _pressing(parts(points, patches))
        pairs = MOST_PARTS * spring.POINTS + PATCHES
        most = MODES, spring.POINTS, PATCHES, len(modes.bolts)
    patch = dict(zip(("patch_x", "patch_y", "patch_around"), modes.patch, strict=True))
    moved = {"opening": modes.opening, **patch, "stretch": modes.stretch}
    room = dict(zip(moved, (most[1], *(most[2],) * 3, most[3]), strict=True))
    return {
        "modes": DataTable(modes.stiffness[:, None], most[0]),
        "bolts": DataTable(np.column_stack([modes.bolts, lever]), most[3]),
        **{name: DataTable(_padded(rows), room[name], digits=True) for name, rows in moved.items()},
        "pressing": DataTable(pressing, pairs, digits=True),
    }


def _pressing(part: Any) -> Any:
    """Patch, point, and its part in units of the last digit (n, 4)."""
    patch, point = np.nonzero(part)
    digits = np.round(part[patch, point] * 10.0**PART_DIGITS)
    return np.column_stack([patch, point, digits, 0 * patch])


def _padded(rows: Any) -> Any:
    """Of all MODES, in units of the last digit."""
    return np.pad(np.round(rows * 10.0**DIGITS), ((0, 0), (0, MODES - rows.shape[1])))


def _rows(shape: PressureShape) -> Any:
    """Share, x, y, equal, tilt (n, 5)."""
    return np.column_stack([shape.share, shape.position, shape.equal, shape.tilt])


DATA = DataPart(_stands, tables=_tables)
