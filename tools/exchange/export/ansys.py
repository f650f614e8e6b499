"""ANSYS archive file: MATRIX27 stiffness and damping between node pairs (Zhao 2018, section 2), or the
stiffness matrix of a complete joint between two nodes.

KEYOPT(2) = 0 is a symmetric matrix: the real constants C1 to C78 are its upper triangle row by row, with the
degrees of freedom UX UY UZ ROTX ROTY ROTZ of node I, then of node J. KEYOPT(3) = 4 is stiffness, 5 damping.
A spring K along x is C1 = C58 = K, C7 = -K (element reference, MATRIX27).
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .joint_stiffness import JointStiffness
from .target_model import Springs, TargetModel, format_comment_header

MATRIX27_TYPE_NUMBER, STIFFNESS_MATRIX_OPTION, DAMPING_MATRIX_OPTION = 27, 4, 5
_UPPER_TRIANGLE_INDICES = np.triu_indices(12)
"""Row and column indices of the real constants C1 to C78 in the matrix."""


def format_springs(springs: Springs, target_model: TargetModel, comment_lines: Sequence[str]) -> str:
    """Format the springs as an ANSYS archive: for each pair one stiffness and one damping element.

    comment_lines : lines for the head of the file

    All stiffness elements come first. Pairs that agree to nine digits, the precision of the format, share a
    set of real constants.
    """
    first = target_model.first_free_number
    first_set = target_model.first_free_set_number
    units = target_model.unit_set
    count = len(springs.node_labels)
    stiffness = target_model.assign_to_axes(
        units.convert_from_si(springs.K_t, "N/m"), units.convert_from_si(springs.K_n, "N/m")
    )
    damping = target_model.assign_to_axes(
        units.convert_from_si(springs.C_t, "N.s/m"), units.convert_from_si(springs.C_n, "N.s/m")
    )
    sets: dict[tuple[str, ...], int] = {}
    reals = [_assign_real_constant_set_number(sets, row, first_set) for row in (*stiffness, *damping)]
    types = np.repeat([first_set, first_set + 1], count)
    pairs = np.vstack([springs.node_labels, springs.node_labels])
    rows = zip(types, reals, range(first, first + 2 * count), pairs, strict=True)
    lines = [
        *format_comment_header(comment_lines, "!"),
        "/PREP7",
        *(
            _format_nodes(springs.node_labels, target_model.model_coordinates(springs.position))
            if target_model.defines_nodes
            else []
        ),
        *_format_element_type(first_set, STIFFNESS_MATRIX_OPTION),
        *_format_element_type(first_set + 1, DAMPING_MATRIX_OPTION),
        *_format_real_constants(
            {number: compute_matrix27_constants(np.array(v, dtype=np.float64)) for v, number in sets.items()}
        ),
        f"EBLOCK,19,SOLID,{first + 2 * count - 1:10d},{2 * count:10d}",
        "(19i10)",
        *(_format_integers((1, t, r, 1, 0, 0, 0, 0, 2, 0, e, *nodes)) for t, r, e, nodes in rows),
        "        -1",
    ]
    return "\n".join(lines) + "\n"


def format_joint_stiffness(
    joint_stiffness: JointStiffness, target_model: TargetModel, comment_lines: Sequence[str]
) -> str:
    """Format a complete joint as an ANSYS archive: two nodes with one stiffness element.

    comment_lines : lines for the head of the file
    """
    first, first_set = target_model.first_free_number, target_model.first_free_set_number
    labels = np.array([[first, first + 1]])
    constants = joint_stiffness.matrix_between_nodes(target_model)[_UPPER_TRIANGLE_INDICES]
    lines = [
        *format_comment_header(comment_lines, "!"),
        "/PREP7",
        *_format_nodes(labels, joint_stiffness.node_positions_in_model_units(target_model)),
        *_format_element_type(first_set, STIFFNESS_MATRIX_OPTION),
        *_format_real_constants({first_set: constants}),
        f"EBLOCK,19,SOLID,{first:10d},{1:10d}",
        "(19i10)",
        _format_integers((1, first_set, first_set, 1, 0, 0, 0, 0, 2, 0, first, first, first + 1)),
        "        -1",
    ]
    return "\n".join(lines) + "\n"


def compute_matrix27_constants(spring_coefficients: Array) -> Array:
    """Upper triangle C1 to C78 (78) of the element matrix of springs (3) along x, y, z between two nodes."""
    matrix = np.zeros((12, 12))
    axes = np.arange(3)
    matrix[axes, axes] = matrix[axes + 6, axes + 6] = spring_coefficients
    matrix[axes, axes + 6] = matrix[axes + 6, axes] = -spring_coefficients
    return np.asarray(matrix[_UPPER_TRIANGLE_INDICES])


def _assign_real_constant_set_number(
    set_number_by_coefficients: dict[tuple[str, ...], int], spring_coefficients: Array, first_set_number: int
) -> int:
    """Return the number of the set of real constants of three springs (3). New values get a new set."""
    return set_number_by_coefficients.setdefault(
        tuple(f"{v:.8E}" for v in spring_coefficients), first_set_number + len(set_number_by_coefficients)
    )


def _format_real_constants(real_constants_by_set_number: Mapping[int, Array]) -> Iterable[str]:
    """Format sets of real constants of ANSYS: {number: C1 to C78 (78)}."""
    sizes = (
        len(real_constants_by_set_number),
        max(real_constants_by_set_number),
        _UPPER_TRIANGLE_INDICES[0].size,
        7,
    )
    yield ",".join(["RLBLOCK", *(f"{size:8d}" for size in sizes)])
    yield from ("(2i8,6g16.9)", "(7g16.9)")
    for number, constants in real_constants_by_set_number.items():
        cells = [f"{v:16.8E}" for v in constants]
        yield f"{number:8d}{len(cells):8d}" + "".join(cells[:6])
        yield from ("".join(cells[i : i + 7]) for i in range(6, len(cells), 7))


def _format_element_type(type_number: int, matrix_option: int) -> Iterable[str]:
    """Format the definition of a MATRIX27 element type: stiffness or damping."""
    yield f"ET,{type_number:9d},{MATRIX27_TYPE_NUMBER:4d}"
    yield f"KEYOP,{type_number:9d},{2:3d},{0:9d}"
    yield f"KEYOP,{type_number:9d},{3:3d},{matrix_option:9d}"


def _format_nodes(node_labels: NDArray[np.int64], node_coordinates: Array) -> Iterable[str]:
    """Format nodes with labels (n, 2) on side 1 and side 2, with their coordinates.

    node_coordinates : (n, 3) of pairs of coincident nodes, or (2, 3) of the two nodes of one pair
    """
    yield f"NBLOCK,6,SOLID,{node_labels.max():10d},{node_labels.size:10d}"
    yield "(3i9,6e21.13e3)"
    count = len(node_labels)
    for side in (0, 1):
        of_side = node_coordinates if len(node_coordinates) == count else node_coordinates[side : side + 1]
        for node, xyz in zip(node_labels[:, side], of_side, strict=True):
            yield f"{node:9d}{0:9d}{0:9d}" + "".join(_format_exponential(v) for v in xyz)
    yield "N,R5.3,LOC,       -1,"
    for side in (0, 1):
        labels = np.sort(node_labels[:, side])
        yield f"CMBLOCK,JOINT_SIDE_{side + 1},NODE,{labels.size:8d}"
        yield "(8i10)"
        yield from (_format_integers(labels[i : i + 8]) for i in range(0, labels.size, 8))


def _format_integers(integers: Iterable[int]) -> str:
    """Format node and element numbers in fixed columns."""
    return "".join(f"{v:10d}" for v in integers)


def _format_exponential(real_number: float) -> str:
    """Format a number as Fortran does with e21.13e3: three digits of exponent."""
    mantissa, exponent = f"{real_number:.13E}".split("E")
    return f"{mantissa}E{int(exponent):+04d}".rjust(21)
