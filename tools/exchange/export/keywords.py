"""CalculiX and Abaqus keywords: springs and dashpots between node pairs, stiffness of a complete joint, and
tabular contact.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from jointfmu.quantity.refusal import InputRefusal

from .joint_stiffness import JointStiffness
from .tables import LoadTable
from .target_model import Springs, TargetModel, UnitSet, format_comment_header

MAX_CALCULIX_TABLE_ROWS = 200
"""Largest number of rows of a table in CalculiX (its arrays `xiso(200)`)."""
USER_ELEMENT_TYPE = "U901"
"""Type name of the linear user element of a complete joint in Abaqus."""
TABLE_EXTENSION_OVERCLOSURE = 1.0
"""Overclosure [m] by which the table is extended linearly, so that no solver evaluates beyond its end."""


def format_springs(
    springs: Springs, target_model: TargetModel, comment_lines: Sequence[str], writes_dashpots: bool
) -> str:
    """Format the springs as SPRING2 elements along the model's axes, and for Abaqus also DASHPOT2 elements.

    comment_lines   : lines for the head of the file
    writes_dashpots : whether to write dashpots

    Pairs that agree to nine digits share an element set.
    """
    units = target_model.unit_set
    lines = [
        *format_comment_header(comment_lines, "**"),
        *(_format_nodes(springs, target_model) if target_model.defines_nodes else []),
    ]
    elements = [
        (
            "SPRING",
            "K",
            target_model.assign_to_axes(
                units.convert_from_si(springs.K_t, "N/m"), units.convert_from_si(springs.K_n, "N/m")
            ),
        )
    ]
    if writes_dashpots:
        values = target_model.assign_to_axes(
            units.convert_from_si(springs.C_t, "N.s/m"), units.convert_from_si(springs.C_n, "N.s/m")
        )
        elements.append(("DASHPOT", "C", values))
    element = target_model.first_free_number
    for keyword, symbol, columns in elements:
        for axis in range(3):
            groups: dict[str, list[int]] = {}
            for pair, value in enumerate(columns[:, axis]):
                groups.setdefault(f"{value:.8E}", []).append(pair)
            for number, (value, members) in enumerate(groups.items(), 1):
                name = f"JOINT_{symbol}{'XYZ'[axis]}_{number}"
                lines.append(f"*ELEMENT, TYPE={keyword}2, ELSET={name}")
                for pair in members:
                    lines.append(f"{element}, {springs.node_labels[pair, 0]}, {springs.node_labels[pair, 1]}")
                    element += 1
                lines += [f"*{keyword}, ELSET={name}", f"{axis + 1}, {axis + 1}", value]
    return "\n".join(lines) + "\n"


def _format_nodes(springs: Springs, target_model: TargetModel) -> Iterable[str]:
    """Format the nodes of all pairs as keywords."""
    coordinates = target_model.model_coordinates(springs.position)
    for side in (0, 1):
        yield f"*NODE, NSET=JOINT_SIDE_{side + 1}"
        for node, xyz in zip(springs.node_labels[:, side], coordinates, strict=True):
            yield f"{node}, " + ", ".join(f"{v:.12E}" for v in xyz)


def format_user_element(
    joint_stiffness: JointStiffness, target_model: TargetModel, comment_lines: Sequence[str]
) -> str:
    """Format a complete joint for Abaqus: two nodes with a linear user element.

    comment_lines : lines for the head of the file

    The matrix is the upper triangle column by column. Each column begins a new line; a line has four entries.
    """
    first = target_model.first_free_number
    K = joint_stiffness.matrix_between_nodes(target_model)
    columns = [[f"{K[i, j]:.9E}" for i in range(j + 1)] for j in range(12)]
    lines = [
        *format_comment_header(comment_lines, "**"),
        *_format_joint_nodes(joint_stiffness, target_model),
        f"*USER ELEMENT, TYPE={USER_ELEMENT_TYPE}, NODES=2, LINEAR, COORDINATES=3",
        "1, 2, 3, 4, 5, 6",
        "*MATRIX, TYPE=STIFFNESS",
        *(", ".join(column[i : i + 4]) for column in columns for i in range(0, len(column), 4)),
        f"*ELEMENT, TYPE={USER_ELEMENT_TYPE}, ELSET=JOINT",
        f"{first}, {first}, {first + 1}",
        "*UEL PROPERTY, ELSET=JOINT",
    ]
    return "\n".join(lines) + "\n"


def format_coupled_springs(
    joint_stiffness: JointStiffness, target_model: TargetModel, comment_lines: Sequence[str]
) -> str:
    """Format a complete joint for CalculiX: springs between the degrees of freedom of four nodes.

    comment_lines : lines for the head of the file

    In CalculiX, the rotations of a rigid body are the displacements of its ROT NODE. The degrees of freedom
    u_i (12) are those of the two reference nodes and the two rotation nodes. A spring -K_ij between each two
    of them (SPRING2) and a spring sum_j K_ij at each of them (SPRING1) have the energy u^T K u/2.
    """
    first = target_model.first_free_number
    K = joint_stiffness.matrix_between_nodes(target_model)
    node = [first + i // 6 + 2 * (i % 6 // 3) for i in range(12)]
    lines = [
        *format_comment_header(
            [
                *comment_lines,
                f"rotations: nodes {first + 2} (side 1) and {first + 3} (side 2); in your model, write",
                f"*RIGID BODY, NSET=your nodes of side 1, REF NODE={first}, ROT NODE={first + 2}",
                f"*RIGID BODY, NSET=your nodes of side 2, REF NODE={first + 1}, ROT NODE={first + 3}",
            ],
            "**",
        ),
        *_format_joint_nodes(joint_stiffness, target_model),
        "*NODE, NSET=JOINT_ROTATIONS",
        f"{first + 2}, 0., 0., 0.",
        f"{first + 3}, 0., 0., 0.",
    ]
    element = first
    for i in range(12):
        for j in range(i, 12):
            value = float(K[i].sum() if i == j else -K[i, j])
            if not value:
                continue
            name = f"JOINT_{i + 1}_{j + 1}"
            ends = [i] if i == j else [i, j]
            lines += [
                f"*ELEMENT, TYPE=SPRING{len(ends)}, ELSET={name}",
                ", ".join(map(str, (element, *(node[end] for end in ends)))),
                f"*SPRING, ELSET={name}",
                ", ".join(str(end % 3 + 1) for end in ends),
                f"{value:.12E}",
            ]
            element += 1
    return "\n".join(lines) + "\n"


def _format_joint_nodes(joint_stiffness: JointStiffness, target_model: TargetModel) -> Iterable[str]:
    """Format the two nodes of a complete joint as keywords."""
    for side, xyz in enumerate(joint_stiffness.node_positions_in_model_units(target_model)):
        yield f"*NODE, NSET=JOINT_SIDE_{side + 1}"
        yield f"{target_model.first_free_number + side}, " + ", ".join(f"{v:.12E}" for v in xyz)


def format_contact(
    pressure_table: LoadTable,
    unit_set: UnitSet,
    comment_lines: Sequence[str],
    max_table_rows: int | None = None,
) -> str:
    """Format the surface interaction named JOINT: a table of pressure as a function of overclosure.

    comment_lines  : lines for the head of the file
    max_table_rows : largest number of rows that the solver can read; None: no limit

    Raises ValueError if the table has more rows.
    """
    x, p, k = pressure_table.table_rows[-1]
    rows = np.vstack(
        [
            pressure_table.table_rows[:, :2],
            [x + TABLE_EXTENSION_OVERCLOSURE, p + k * TABLE_EXTENSION_OVERCLOSURE],
        ]
    )
    if max_table_rows is not None and len(rows) > max_table_rows:
        raise InputRefusal(
            f"the table has {len(rows)} rows, CalculiX holds {max_table_rows}; state a larger error",
            "error",
        )
    lines = [
        *format_comment_header(comment_lines, "**"),
        "*SURFACE INTERACTION, NAME=JOINT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        *(
            f"{unit_set.convert_from_si(y, 'Pa'):.10E}, {unit_set.convert_from_si(s, 'm'):.10E}"
            for s, y in rows.tolist()
        ),
    ]
    return "\n".join(lines) + "\n"
