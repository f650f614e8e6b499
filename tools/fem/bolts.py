"""Where the bolts of an assembly are, and how wide their holes and heads."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import check, choice, quantity, series

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltGrid:
    """Bolts in rows along x, centred on the z axis."""

    rows: float = quantity("1", "rows of bolts", ge=1.0, whole=True)
    columns: float = quantity("1", "bolts in a row", ge=1.0, whole=True)
    row_spacing: float = quantity("m", "distance of the two outermost rows", ge=0.0)
    column_spacing: float = quantity("m", "distance of the outermost bolts of a row", ge=0.0)
    inside: bool = choice(False, True, doc="whether there are bolts inside the outer frame of the grid")
    hole_diameter: float = quantity("m", "clearance hole", gt=0.0)
    head_diameter: float = quantity("m", "outer diameter of what presses on the bodies", gt=0.0)

    def __post_init__(self) -> None:
        check(self)
        for count, name in ((self.rows, "row_spacing"), (self.columns, "column_spacing")):
            if count > 1.0 and getattr(self, name) == 0.0:
                raise ValueError(f"{name} = 0 m is outside (0, inf): there is more than one row or column")

    @property
    def positions(self) -> Array:
        """Bolt positions (n, 2) [m], row by row."""
        rows, columns = int(self.rows), int(self.columns)
        y = 0.5 * self.row_spacing * _spread(rows)
        x = 0.5 * self.column_spacing * _spread(columns)
        edge = np.zeros((rows, columns), dtype=bool)
        edge[[0, -1], :], edge[:, [0, -1]] = True, True
        keep = edge | self.inside
        row, column = np.nonzero(keep)
        return np.stack([x[column], y[row]], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltList:
    """Bolts at given places."""

    x: tuple[float, ...] = series("m", "positions along x")
    y: tuple[float, ...] = series("m", "positions along y")
    hole_diameter: float = quantity("m", "clearance hole", gt=0.0)
    head_diameter: float = quantity("m", "outer diameter of what presses on the bodies", gt=0.0)

    def __post_init__(self) -> None:
        check(self)
        if len(self.x) != len(self.y):
            raise ValueError(f"y has {len(self.y)} values, x has {len(self.x)}; expected one for each bolt")

    @property
    def positions(self) -> Array:
        """Bolt positions (n, 2) [m]."""
        return np.stack([self.x, self.y], axis=1).astype(np.float64)


Bolts = BoltGrid | BoltList


def _spread(count: int) -> Array:
    """`count` places from -1 to 1; the middle for one."""
    return np.linspace(-1.0, 1.0, count) if count > 1 else np.zeros(1)
