"""Shanks of the bolts of a lapped beam, as springs between the discs of head and nut."""

import numpy as np
import scipy.sparse as sp


def shanks(beam, bodies):
    """Stiffness matrix [N/m] of half of each bolt shank: a Timoshenko beam between the mean motions of both
    discs."""
    area, inertia = 0.125 * np.pi * beam.shank**2, np.pi * beam.shank**4 / 128.0
    long, shear = beam.side, beam.E / (2.0 * (1.0 + beam.nu)) * 0.9 * area
    soft = 12.0 * beam.E * inertia / (shear * long**2)
    bend = beam.E * inertia / (long**3 * (1.0 + soft))
    four, two = (4.0 + soft) * long**2, (2.0 - soft) * long**2
    matrix = bend * np.array(  # displacement and rotation of half 1, of half 2, along x and about y
        [
            [12.0, 6.0 * long, -12.0, 6.0 * long],
            [6.0 * long, four, -6.0 * long, two],
            [-12.0, -6.0 * long, 12.0, -6.0 * long],
            [6.0 * long, two, -6.0 * long, four],
        ]
    )
    total = sp.csr_matrix((sum(b.unknown_count for b in bodies),) * 2)
    for i, at in enumerate(beam.holes):
        motion = [_disc(body, body.mesh.boundaries[f"head{i}"], at) for body in bodies]
        stretch = sp.hstack([motion[0][2:], -motion[1][2:]])
        bending = sp.block_diag([motion[0][:2], motion[1][:2]])
        total = (
            total + beam.E * area / long * stretch.T @ stretch + bending.T @ sp.csr_matrix(matrix) @ bending
        )
    return total


def _disc(body, facets, at):
    """Mean motion (3, n) of facets: displacement along x, rotation about y, displacement along z."""
    nodes = np.unique(body.finite_element_basis.get_dofs(facets=facets).flatten())
    share = 2.0 - (body.node_positions[1, nodes] < 1e-9)
    share = share / share.sum()
    lever = body.node_positions[0, nodes] - at
    lever = lever - share @ lever
    turn = -share * lever / (share @ lever**2)
    zero = np.zeros_like(nodes)
    index = (
        np.concatenate([zero, zero + 1, zero + 2]),
        np.concatenate([3 * nodes, 3 * nodes + 2, 3 * nodes + 2]),
    )
    return sp.csr_matrix((np.concatenate([share, turn, share]), index), shape=(3, body.unknown_count))
