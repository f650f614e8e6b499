"""Flanges (FMI terminals) of a joint's FMU, with the names of the Modelica Standard Library."""

from typing import NamedTuple

ROTATIONAL_FLANGE_CLASS = "Modelica.Mechanics.Rotational.Interfaces.Flange_"
"""Modelica class of a rotational flange, without its last letter a or b."""
TRANSLATIONAL_FLANGE_CLASS = "Modelica.Mechanics.Translational.Interfaces.Flange_"
"""Modelica class of a translational flange, without its last letter a or b."""


class Terminal(NamedTuple):
    """Flange (FMI terminal) of an FMU: the variables of one mechanical connection.

    connector_class  : class of the Modelica connector without its last letter a or b
    flange_side      : last letter of this class: "a" is drawn left, "b" right
    member_variables : {Modelica member: (FMU variable, variableKind of FMI)}
    icon_y_position  : vertical position at the edge of the FMU's icon, from -100 to 100
    """

    terminal_name: str
    connector_class: str
    flange_side: str
    flange_description: str
    member_variables: dict[str, tuple[str, str]]
    icon_y_position: float = 0.0


def _make_motion_member_variables(
    connector_class: str, position_name: str, rate_name: str, load_name: str
) -> dict[str, tuple[str, str]]:
    """{Modelica member: (FMU variable, variableKind)} of a flange with motion as input and load as output."""
    names = ("phi", "w", "tau") if connector_class == ROTATIONAL_FLANGE_CLASS else ("s", "v", "f")
    pairs = ((position_name, "signal"), (rate_name, "signal"), (load_name, "outflow"))
    return dict(zip(names, pairs, strict=True))


def make_translation_flange(axis_name: str, icon_y_position: float) -> Terminal:
    """Make the flange of a joint whose input is the relative translation of its two sides along an axis."""
    members = _make_motion_member_variables(
        TRANSLATIONAL_FLANGE_CLASS, f"s_rel_{axis_name}", f"v_rel_{axis_name}", f"f_{axis_name}"
    )
    return Terminal(
        f"flange_{axis_name}",
        TRANSLATIONAL_FLANGE_CLASS,
        "b",
        f"side 2 along {axis_name}, side 1 fixed",
        members,
        icon_y_position,
    )


def make_rotation_flange(axis_name: str, icon_y_position: float) -> Terminal:
    """Make a flange of a joint whose input is the small relative rotation of its two sides about an axis."""
    members = _make_motion_member_variables(
        ROTATIONAL_FLANGE_CLASS, f"theta_{axis_name}", f"omega_{axis_name}", f"m_{axis_name}"
    )
    return Terminal(
        f"flange_turn_{axis_name}",
        ROTATIONAL_FLANGE_CLASS,
        "b",
        f"side 2 about {axis_name}, side 1 fixed",
        members,
        icon_y_position,
    )


def make_shaft_flange(shaft_number: int, flange_side: str, flange_description: str) -> Terminal:
    """Make the flange of one shaft of a joint whose inputs are the motions of its shafts."""
    members = _make_motion_member_variables(
        ROTATIONAL_FLANGE_CLASS, f"phi{shaft_number}", f"w{shaft_number}", f"tau{shaft_number}"
    )
    return Terminal(
        f"flange{shaft_number}", ROTATIONAL_FLANGE_CLASS, flange_side, flange_description, members
    )
