"""The bolted joint's points as data: whatever gives the pressure, its C has a field of points."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from jointfmu.joints.bolted_joint import spring
from jointfmu.joints.bolted_joint.law import Bolted
from jointfmu.mechanics.footprint.shape import BOLT_MEANS, PressureShape
from jointfmu.mechanics.sliders import offsets
from jointfmu.quantity import flatten

from ...joint_parts.data import DataPart, DataTable

_SECTIONS = ("pattern.", "plate.", "field.")
_ONE = {"share": (1.0,), "x": (0.0,), "y": (0.0,), "equal": (1.0,), "tilt": (0.0,)}
"""A field of one point."""


def _stands(joint: Bolted) -> Mapping[str, object]:
    """The joint with one point, as its C is generated, and the place of its bolts."""
    own = {name: value for name, value in flatten(joint).items() if not name.startswith(_SECTIONS)}
    spread = dict(zip(BOLT_MEANS, joint.pattern.bolt_means, strict=True))
    return own | {f"field.{name}": value for name, value in (_ONE | spread).items()}


def _tables(joint: Bolted) -> Mapping[str, DataTable]:
    patches = spring.patches(joint.pattern)
    return {
        "nodes": DataTable(_rows(spring.points(joint.pattern)), spring.POINTS),
        "patches": DataTable(_rows(patches), spring.PATCHES),
        "offsets": DataTable(offsets(patches.equal)[:, None], spring.PATCHES),
    }


def _rows(shape: PressureShape) -> Any:
    """Share, x, y, equal, tilt (n, 5)."""
    return np.column_stack([shape.share, shape.position, shape.equal, shape.tilt])


DATA = DataPart(_stands, tables=_tables)
