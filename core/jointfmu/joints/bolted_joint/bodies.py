"""Bodies that give way: how the members of a bolted joint deform between their attachments, in few modes.

A mode is a displacement field of both bodies with their attachments held, of unit amplitude [m]. What
tractions and bolt forces change from the tightened state pulls at its amplitude a; the elastic energy of the
bodies is the sum of stiffness a^2/2.
"""

from dataclasses import dataclass

import numpy as np

from ...quantity import Array, check_fields, choice_field, quantity_field, series_field

MODES = 16
"""Most modes of the bodies [1]."""
DIGITS = 4
"""Decimals of what modes move [1]: at most 1, and as many as the reduction is worth."""
POSITION_TOLERANCE = 1e-6
"""Distance [m] by which patches may lie beside those that the modes were computed for."""
_MODAL_SERIES = ("opening", "patch_x", "patch_y", "patch_around", "stretch")
_POSITION_SERIES = ("x", "y", "bolt_x", "bolt_y")


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBodies:
    """Bodies that do not give way."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticBodies:
    """Bodies by their modes, computed for the points, patches and bolts of one contact.

    Raises ValueError if the lists do not fit together.
    """

    stiffness: tuple[float, ...] = series_field("N/m", "stiffness of each mode", gt=0.0)
    opening: tuple[float, ...] = series_field(
        "1",
        "modal matrix of the opening at the contact points: all modes of point 1, of point 2, ...",
        ge=-1.0,
        le=1.0,
    )
    patch_x: tuple[float, ...] = series_field(
        "1",
        "modal matrix of the relative displacement along x at the friction patches, same order",
        ge=-1.0,
        le=1.0,
    )
    patch_y: tuple[float, ...] = series_field("1", "as patch_x, along y", ge=-1.0, le=1.0)
    patch_around: tuple[float, ...] = series_field(
        "1",
        "as patch_x, for the mean displacement around the centre of a patch, on the circle of its sliders",
        ge=-1.0,
        le=1.0,
    )
    stretch: tuple[float, ...] = series_field(
        "1",
        "modal matrix of the elongation of the bolts between their seats: all modes of bolt 1, of bolt 2, "
        "...",
        ge=-1.0,
        le=1.0,
    )
    x: tuple[float, ...] = series_field(
        "m", "positions of the friction patches along the bolt rows, from the centroid"
    )
    y: tuple[float, ...] = series_field(
        "m", "positions of the friction patches across the bolt rows, from the centroid"
    )
    bolt_x: tuple[float, ...] = series_field(
        "m", "positions of the bolts along the bolt rows, from the centroid"
    )
    bolt_y: tuple[float, ...] = series_field(
        "m", "positions of the bolts across the bolt rows, from the centroid"
    )
    attached: str = choice_field(
        "unstated",
        "faces",
        "edge",
        "heads",
        doc="surfaces of the bodies that move rigidly with the connected parts",
    )
    thickness: tuple[float, ...] = series_field(
        "m", "thickness of side 1 and 2 at the bolts, for pictures", gt=0.0, optional=True
    )
    outline: tuple[float, ...] = series_field(
        "m",
        "smallest x and y, largest x and y of the contact, from its centroid, for pictures",
        optional=True,
    )
    hole_diameter: float = quantity_field("m", "clearance hole, for pictures", ge=0.0, default=0.0)
    head_diameter: float = quantity_field(
        "m", "outer diameter of the bearing surfaces of heads and nuts, for pictures", ge=0.0, default=0.0
    )
    thread_depth: float = quantity_field(
        "m", "depth of the threads in side 2, for pictures; 0: bolts go through", ge=0.0, default=0.0
    )

    def __post_init__(self) -> None:
        check_fields(self)
        modes, patches, bolts = len(self.stiffness), len(self.x), len(self.bolt_x)
        if modes > MODES:
            raise ValueError(f"bodies.stiffness has {modes} numbers, expected at most {MODES}")
        counts = {"y": patches, "bolt_y": bolts, "stretch": bolts * modes}
        counts |= {name: patches * modes for name in _MODAL_SERIES if name.startswith("patch_")}
        counts["opening"] = modes * max(len(self.opening) // modes, 1)
        counts |= {name: n for name, n in (("thickness", 2), ("outline", 4)) if getattr(self, name)}
        for name, count in counts.items():
            if (given := len(getattr(self, name))) != count:
                raise ValueError(f"bodies.{name} has {given} numbers, expected {count} with {modes} modes")


@dataclass(frozen=True)
class Modes:
    """Modes of the bodies at the points of a contact.

    stiffness : (k) [N/m]
    opening   : (n, k) [1] of the points
    patch     : (3, m, k) [1] `shifts` of the patches, along x, along y and around their centres
    stretch   : (b, k) [1] of the bolts
    bolts     : (b, 2) [m] their places
    """

    stiffness: Array
    opening: Array
    patch_displacement: Array
    bolt_elongation: Array
    bolts: Array

    @classmethod
    def for_rigid_bodies(cls, points: int, patches: int) -> "Modes":
        """Of rigid bodies."""
        shear = np.zeros((3, patches, 0))
        return cls(np.zeros(0), np.zeros((points, 0)), shear, np.zeros((0, 0)), np.zeros((0, 2)))

    @classmethod
    def of(cls, bodies: RigidBodies | ElasticBodies, points: int, patches: Array) -> "Modes":
        """Of the bodies of a parameter file, at so many points and patches at (m, 2) [m].

        Raises ValueError if they were computed for others.
        """
        if isinstance(bodies, RigidBodies):
            return cls.for_rigid_bodies(points, len(patches))
        each = {
            name: np.array(getattr(bodies, name)) for name in (*_MODAL_SERIES, *_POSITION_SERIES, "stiffness")
        }
        count = len(bodies.stiffness)
        there = np.stack([each["x"], each["y"]], axis=1)
        if len(each["opening"]) != points * count or there.shape != patches.shape:
            stated = f"{len(each['opening']) // count} points and {len(there)} patches"
            raise ValueError(f"[bodies] has {stated}, the contact {points} and {len(patches)}")
        if (away := float(np.max(np.abs(there - patches)))) > POSITION_TOLERANCE:
            raise ValueError(
                f"[bodies] lies {away:.3g} m away from the contact: it was computed for another contact; "
                f"expected at most {POSITION_TOLERANCE:g} m"
            )
        moved = {name: each[name].reshape(-1, count) for name in _MODAL_SERIES}
        return cls(
            each["stiffness"],
            moved["opening"],
            np.stack([moved[f"patch_{way}"] for way in ("x", "y", "around")]),
            moved["stretch"],
            np.stack([each["bolt_x"], each["bolt_y"]], axis=1),
        )
