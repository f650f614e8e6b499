"""Flanges (FMI terminals) of a joint's FMU, with the names of the Modelica Standard Library."""

from typing import NamedTuple

ROTATIONAL_FLANGE_CLASS = "Modelica.Mechanics.Rotational.Interfaces.Flange_"
"""Modelica class of a rotational flange, without its last letter a or b."""
TRANSLATIONAL_FLANGE_CLASS = "Modelica.Mechanics.Translational.Interfaces.Flange_"
"""Modelica class of a translational flange, without its last letter a or b."""


class Terminal(NamedTuple):
    """Flange (FMI terminal) of an FMU: the variables of one mechanical connection.

    connector_class : class of the Modelica connector without its last letter
    side            : this letter: "a" is left, "b" is right
    members         : {Modelica member: (FMU variable, variableKind of FMI)}
    icon_y          : vertical position at the edge of the icon, from -100 to 100
    """

    name: str
    connector_class: str
    side: str
    doc: str
    members: dict[str, tuple[str, str]]
    icon_y: float = 0.0


def _motion_members(
    connector_class: str, position_name: str, rate_name: str, load_name: str
) -> dict[str, tuple[str, str]]:
    """{Modelica member: (variable, variableKind)} of a flange whose inputs are motion."""
    names = ("phi", "w", "tau") if connector_class == ROTATIONAL_FLANGE_CLASS else ("s", "v", "f")
    pairs = ((position_name, "signal"), (rate_name, "signal"), (load_name, "outflow"))
    return dict(zip(names, pairs, strict=True))


def make_translation_flange(direction: str, icon_y: float) -> Terminal:
    """Make the flange of a joint whose input is the relative translation of its two sides along an axis."""
    members = _motion_members(
        TRANSLATIONAL_FLANGE_CLASS, f"s_rel_{direction}", f"v_rel_{direction}", f"f_{direction}"
    )
    return Terminal(
        f"flange_{direction}",
        TRANSLATIONAL_FLANGE_CLASS,
        "b",
        f"side 2 along {direction}, side 1 fixed",
        members,
        icon_y,
    )


def make_rotation_flange(direction: str, icon_y: float) -> Terminal:
    """Make a flange of a joint whose input is the small relative rotation of its two sides about an axis."""
    members = _motion_members(
        ROTATIONAL_FLANGE_CLASS, f"theta_{direction}", f"omega_{direction}", f"m_{direction}"
    )
    return Terminal(
        f"flange_turn_{direction}",
        ROTATIONAL_FLANGE_CLASS,
        "b",
        f"side 2 about {direction}, side 1 fixed",
        members,
        icon_y,
    )


def make_shaft_flange(shaft_number: int, side: str, doc: str) -> Terminal:
    """Make the flange of one shaft of a joint whose inputs are the motions of its shafts."""
    members = _motion_members(
        ROTATIONAL_FLANGE_CLASS, f"phi{shaft_number}", f"w{shaft_number}", f"tau{shaft_number}"
    )
    return Terminal(f"flange{shaft_number}", ROTATIONAL_FLANGE_CLASS, side, doc, members)
