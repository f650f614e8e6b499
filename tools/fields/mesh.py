"""The mesh that belongs to a listing of nodal values, from a file of its own."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .areas import CORNERS
from .bodies import bodies, boundary
from .nodal_result import NodalResult, Nodes


@dataclass(frozen=True, slots=True)
class FiniteElementMesh:
    """Nodes and cells of a file.

    names : (n) number of each node; `place` (n, 3) in the file's unit
    cells : {name of meshio: (k, m) places of nodes in these arrays}, surfaces or volumes
    """

    names: NDArray[np.int64]
    place: Array
    cells: Mapping[str, Nodes]

    def faces(self) -> list[Nodes]:
        """The surfaces, or the boundary of the volumes."""
        return boundary(self.cells)

    def body(self) -> NDArray[np.int64]:
        """(n) number of the body that a node belongs to."""
        return bodies(self.cells, self.names.size)

    def values(self, listed: Mapping[int, float]) -> Array:
        """(n) values of nodes by their numbers, NaN where there is none."""
        return np.array([listed.get(name, np.nan) for name in self.names.tolist()])

    def stray(self, nodes: Iterable[int]) -> set[int]:
        """Those of the nodes that the mesh has not."""
        return set(nodes) - set(self.names.tolist())

    def result(
        self, path: Path, listed: Mapping[int, float], length: float, pressure: float, left_out: bool = False
    ) -> NodalResult:
        """The contact result of pressures at nodes, listed in `path`; SI units per those of mesh and listing.

        left_out : whether the listing leaves open nodes out; else the contact is where all corners are listed
        """
        p = self.values(listed)
        return NodalResult(
            path=path,
            word="node",
            names=self.names,
            place=self.place * length,
            pressure=p * pressure,
            faces=self.faces() if left_out else listed_faces(self.faces(), p),
            body=self.body(),
            left_out=left_out,
        )


def listed_faces(faces: Sequence[Nodes], values: Array) -> list[Nodes]:
    """The faces all of whose corners have a value (n)."""
    there = np.isfinite(values)
    kept = [block[np.all(there[block[:, : CORNERS[block.shape[1]]]], axis=1)] for block in faces]
    return [block for block in kept if block.size]


def cells_of(rows: Mapping[str, Sequence[Sequence[int]]], names: NDArray[np.int64]) -> dict[str, Nodes]:
    """{kind: (k, m) places of nodes}, from their numbers.

    Raises ValueError naming a node that is missing.
    """
    order = np.argsort(names)
    cells = {}
    for kind, numbers in rows.items():
        wanted = np.array(numbers, dtype=np.int64)
        at = order[np.minimum(np.searchsorted(names, wanted, sorter=order), names.size - 1)]
        if np.any(missing := names[at] != wanted):
            raise ValueError(f"node {wanted[missing][0]} of an element is not there")
        cells[kind] = at.astype(np.intp)
    return cells


def no_reader(path: Path, error: ImportError) -> ValueError:
    """What is raised where the package that reads a file is missing."""
    return ValueError(
        f"the package {error.name} is missing, needed to read {path}; "
        "install it with: pip install 'jointfmu[field]'"
    )
