"""Flanges of a joint's FMU, as in the Modelica Standard Library."""

from typing import NamedTuple

ROTATIONAL = "Modelica.Mechanics.Rotational.Interfaces.Flange_"
TRANSLATIONAL = "Modelica.Mechanics.Translational.Interfaces.Flange_"


class Terminal(NamedTuple):
    """One flange.

    kind, side : of Modelica's connector, side "a" left and "b" right
    members    : {member: (variable, variableKind)}
    y          : height on the icon's edge, from -100 to 100
    """

    name: str
    kind: str
    side: str
    doc: str
    members: dict[str, tuple[str, str]]
    y: float = 0.0


def _members(kind: str, position: str, rate: str, load: str) -> dict[str, tuple[str, str]]:
    """Variables of a flange that takes motion, by the names that Modelica has for its members."""
    names = ("phi", "w", "tau") if kind == ROTATIONAL else ("s", "v", "f")
    pairs = ((position, "signal"), (rate, "signal"), (load, "outflow"))
    return dict(zip(names, pairs, strict=True))


def axis(axis: str, y: float) -> Terminal:
    """Flange of a joint that takes the relative motion of its two sides along an axis."""
    members = _members(TRANSLATIONAL, f"s_rel_{axis}", f"v_rel_{axis}", f"f_{axis}")
    return Terminal(f"flange_{axis}", TRANSLATIONAL, "b", f"side 2 along {axis}, side 1 fixed", members, y)


def rotation(axis: str, y: float) -> Terminal:
    """Flange of a joint that takes the small turn of its two sides against each other about an axis."""
    members = _members(ROTATIONAL, f"theta_{axis}", f"omega_{axis}", f"m_{axis}")
    return Terminal(f"flange_turn_{axis}", ROTATIONAL, "b", f"side 2 about {axis}, side 1 fixed", members, y)


def shaft(number: int, side: str, doc: str) -> Terminal:
    """Flange of a joint that takes the motion of each of its shafts."""
    members = _members(ROTATIONAL, f"phi{number}", f"w{number}", f"tau{number}")
    return Terminal(f"flange{number}", ROTATIONAL, side, doc, members)
