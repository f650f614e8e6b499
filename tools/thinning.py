"""Which nodes of a fine table a coarser one keeps."""

from collections.abc import Callable, Collection

import numpy as np
from numpy.typing import NDArray


def kept(stops: Collection[int], fits: Callable[[int, int], bool]) -> NDArray[np.intp]:
    """Places of the nodes kept, from 0 to the last of `stops`: each as far from the one before as it fits.

    stops : places that stay
    fits  : whether one segment may lead from a node to another, further than the next; neighbours always join

    A segment is doubled while it fits, then halved to the last that does.
    """
    ends = sorted(stops)
    nodes = [0]
    while nodes[-1] < ends[-1]:
        i = nodes[-1]
        stop = next(s for s in ends if s > i)
        j, step = i + 1, 1
        while step:
            further = min(j + step, stop)
            if further > j and fits(i, further):
                j, step = further, 2 * step
            else:
                step //= 2
        nodes.append(j)
    return np.array(nodes)
