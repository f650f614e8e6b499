"""Code_Aster commands: stiffness of a complete joint as DISCRET with K_TR_L.

K_TR_L has 78 values: the upper triangle of the 12 x 12 matrix, column by column, with the degrees of freedom
DX DY DZ DRX DRY DRZ of the first node of the segment, then of the second.
"""

from collections.abc import Sequence

from .joint_stiffness import JointStiffness
from .target_model import TargetModel, format_comment_header

MESH_GROUP_NAME = "JOINT"
"""Name of the group in the user's mesh with the segment (SEG2) of the joint."""


def format_joint_stiffness(
    joint_stiffness: JointStiffness, target_model: TargetModel, comment_lines: Sequence[str]
) -> str:
    """Format the stiffness matrix of a complete joint as Python variables for AFFE_CARA_ELEM of Code_Aster.

    comment_lines : lines for the head of the file
    """
    K = joint_stiffness.matrix_between_nodes(target_model)
    values = [float(K[i, j]) for j in range(12) for i in range(j + 1)]
    first = target_model.first_free_number
    notes = [
        f"mesh: one SEG2 in the group {MESH_GROUP_NAME}; its first node is {first} (side 1), its second node "
        f"{first + 1} (side 2)",
        f"AFFE_MODELE: _F(GROUP_MA='{MESH_GROUP_NAME}', PHENOMENE='MECANIQUE', MODELISATION='DIS_TR')",
        "AFFE_CARA_ELEM: DISCRET=JOINT_DISCRET",
    ]
    rows = [", ".join(f"{value:.9E}" for value in values[i : i + 4]) for i in range(0, len(values), 4)]
    return "\n".join(
        [
            *format_comment_header([*comment_lines, *notes], "#"),
            "JOINT_STIFFNESS = (",
            *(f"    {row}," for row in rows),
            ")",
            f"JOINT_DISCRET = _F(GROUP_MA='{MESH_GROUP_NAME}', CARA='K_TR_L', REPERE='GLOBAL', SYME='OUI',",
            "                   VALE=JOINT_STIFFNESS)",
            "",
        ]
    )
