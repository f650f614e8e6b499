"""Decimation of a table with many nodes: selection of the nodes that a table with fewer nodes keeps."""

from collections.abc import Callable, Collection

import numpy as np
from numpy.typing import NDArray


def decimate_table(
    required_nodes: Collection[int], is_segment_allowed: Callable[[int, int], bool]
) -> NDArray[np.intp]:
    """Select nodes of a table, from 0 to the last required node, so that segments are as long as allowed.

    required_nodes     : indices of nodes that must be kept
    is_segment_allowed : (i, j) -> whether one segment may replace the table from node i to node j > i + 1

    Returns the indices of the selected nodes. The length of a segment is doubled while the segment fits, then
    refined by halving the increment. Neighbouring nodes are always a valid segment.
    """
    ends = sorted(required_nodes)
    nodes = [0]
    while nodes[-1] < ends[-1]:
        i = nodes[-1]
        stop = next(s for s in ends if s > i)
        j, step = i + 1, 1
        while step:
            end = min(j + step, stop)
            if end > j and is_segment_allowed(i, end):
                j, step = end, 2 * step
            else:
                step //= 2
        nodes.append(j)
    return np.array(nodes)
