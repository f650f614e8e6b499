"""Contexts for commands that compute much: coarse elements and grids, kept results.

Coarse ones are for tests of what does not depend on the resolution.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from inspect import signature
from typing import Any

import pytest


@contextmanager
def _replaced(owner: Any, name: str, value: Any) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(owner, name, value)
        yield


def elements(of: Any, refinement: float) -> Any:
    """Mesh the bodies of a class, `BoltedContact` or `JointFiniteElements`, with this refinement [1]."""
    own = of.from_assembly
    count = len(signature(own).parameters) - 1  # without the refinement, which is the last one

    def from_assembly(*arguments: Any, **_: Any) -> Any:
        return own(*arguments[:count], refinement)

    return _replaced(of, "from_assembly", from_assembly)


def contact_cells(count: int) -> Any:
    """Divide the flange of a bolted joint into this number of cells."""
    from jointfmu.mechanics.footprint import bolts

    return _replaced(bolts, "CELLS_ACROSS_FLANGE", count)


def poses() -> Any:
    """Draw a robot in 7 poses of each axis."""
    from jointfmu_tools.exchange.robots import pictures

    return _replaced(pictures, "ANGLES_PER_GRID_AXIS", 7)


@contextmanager
def computed_joints() -> Iterator[list[Any]]:
    """List of the results of finite elements (`ComputedJoint`) of the joints that `jointfmu new` makes."""
    from jointfmu_tools.joints.bolted_joint.new import plate_finite_elements as plates

    found, compute = [], plates.compute_joint

    def computed(*arguments: Any) -> Any:
        found.append(compute(*arguments))
        return found[-1]

    with _replaced(plates, "compute_joint", computed):
        yield found
