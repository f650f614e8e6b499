"""Flanges (FMI terminals) of a joint's FMU, with the names of the Modelica Standard Library."""

from typing import NamedTuple

ROTATIONAL = "Modelica.Mechanics.Rotational.Interfaces.Flange_"
TRANSLATIONAL = "Modelica.Mechanics.Translational.Interfaces.Flange_"


class Terminal(NamedTuple):
    """Flange of an FMU.

    connector_class : class of the Modelica connector without its last letter
    side            : this letter: "a" is left, "b" is right
    members         : {Modelica member: (FMU variable, variableKind of FMI)}
    icon_y          : vertical position at the edge of the icon, from -100 to 100
    """

    name: str
    kind: str
    side: str
    doc: str
    members: dict[str, tuple[str, str]]
    y: float = 0.0


def _members(kind: str, position: str, rate: str, load: str) -> dict[str, tuple[str, str]]:
    """{Modelica member: (variable, variableKind)} of a flange whose inputs are motion."""
    names = ("phi", "w", "tau") if kind == ROTATIONAL else ("s", "v", "f")
    pairs = ((position, "signal"), (rate, "signal"), (load, "outflow"))
    return dict(zip(names, pairs, strict=True))


def axis(axis: str, y: float) -> Terminal:
    """Flange of a joint whose input is the relative translation of its two sides along an axis."""
    members = _members(TRANSLATIONAL, f"s_rel_{axis}", f"v_rel_{axis}", f"f_{axis}")
    return Terminal(f"flange_{axis}", TRANSLATIONAL, "b", f"side 2 along {axis}, side 1 fixed", members, y)


def rotation(axis: str, y: float) -> Terminal:
    """Flange of a joint whose input is the small relative rotation of its two sides about an axis."""
    members = _members(ROTATIONAL, f"theta_{axis}", f"omega_{axis}", f"m_{axis}")
    return Terminal(f"flange_turn_{axis}", ROTATIONAL, "b", f"side 2 about {axis}, side 1 fixed", members, y)


def shaft(number: int, side: str, doc: str) -> Terminal:
    """Flange of one shaft of a joint whose inputs are the motions of its shafts."""
    members = _members(ROTATIONAL, f"phi{number}", f"w{number}", f"tau{number}")
    return Terminal(f"flange{number}", ROTATIONAL, side, doc, members)
