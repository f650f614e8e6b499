"""Tick labels of logarithmic axes in plots."""

from itertools import pairwise

import pytest
from jointfmu_tools.common import plots
from matplotlib.figure import Figure


@pytest.mark.parametrize("ends", [(0.93, 5.4), (3.1, 4.4), (1.3e-3, 0.2), (1e-6, 1e3)])
def test_labels_of_a_logarithmic_axis_do_not_overlap(ends):
    """At least two labels, in a panel of the size of a loop plot; matplotlib labels 2, 3, 4 of a decade."""
    with plots.apply_plot_style():
        figure = Figure(figsize=(3.8, 3.8), layout="constrained")
        axes = figure.subplots()
        axes.set(xscale="log", xlim=ends)
        plots.set_log_axis_ticks(axes.xaxis)
        figure.draw_without_rendering()
        boxes = [
            label.get_window_extent()
            for label in axes.get_xticklabels(which="both")
            if label.get_text() and ends[0] <= label.get_position()[0] <= ends[1]
        ]
    assert len(boxes) >= 2
    boxes.sort(key=lambda box: box.x0)
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
