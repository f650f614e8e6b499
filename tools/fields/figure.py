"""Picture of a field: pressure at its nodes, and the points that stand for them."""

from pathlib import Path

import numpy as np

from .. import plots
from .contact import ContactField
from .reduction import Reduction


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
