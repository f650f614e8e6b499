"""The folder terminalsAndIcons: flanges as in the Modelica Standard Library, and the icons.

FMI 3.0 defines the folder; FMI 2.0 takes it over unchanged since 2.0.4. Flow variables are signed as
the standard asks: an outflow is a force or torque that the element applies to what is connected, an
inflow one that is applied to the element.
"""

from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.joints.model import Model

from ..folders import asset, part
from ..xml_parts import serialized

ROTATIONAL = "Modelica.Mechanics.Rotational.Interfaces.Flange_"
TRANSLATIONAL = "Modelica.Mechanics.Translational.Interfaces.Flange_"
_COLORS = {ROTATIONAL: "0 0 0", TRANSLATIONAL: "0 127 0"}
_HALF_SIZE = 10.0
_FLANGES = Path(__file__).with_name("flanges")
"""Their icons, 32 x 32 pixels: circle or square as in Modelica, filled for side a, open for side b."""


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


def axis(axis: str, y: float) -> Terminal:
    """Flange of a joint that takes the relative motion of its two sides along an axis."""
    members = {
        "s": (f"s_rel_{axis}", "signal"),
        "v": (f"v_rel_{axis}", "signal"),
        "f": (f"f_{axis}", "outflow"),
    }
    return Terminal(f"flange_{axis}", TRANSLATIONAL, "b", f"side 2 along {axis}, side 1 fixed", members, y)


def turn(axis: str, y: float) -> Terminal:
    """Flange of a joint that takes the small turn of its two sides against each other about an axis."""
    members = {
        "phi": (f"theta_{axis}", "signal"),
        "w": (f"omega_{axis}", "signal"),
        "tau": (f"m_{axis}", "outflow"),
    }
    return Terminal(f"flange_turn_{axis}", ROTATIONAL, "b", f"side 2 about {axis}, side 1 fixed", members, y)


def shaft(number: int, side: str, doc: str) -> Terminal:
    """Flange of a joint that takes the motion of each of its shafts."""
    members = {
        "phi": (f"phi{number}", "signal"),
        "w": (f"w{number}", "signal"),
        "tau": (f"tau{number}", "outflow"),
    }
    return Terminal(f"flange{number}", ROTATIONAL, side, doc, members)


def terminals(model: Model) -> tuple[Terminal, ...]:
    """The flanges of an FMU: TERMINALS, {FMU: flanges}, of terminals.py in its folder; there may be none."""
    own = part(model, "terminals")
    return own.TERMINALS.get(model.name, ()) if own else ()


def terminals_and_icons(model: Model) -> dict[str, bytes]:
    """{file name: content} of the folder terminalsAndIcons."""
    files = {"terminalsAndIcons.xml": terminals_xml(model)}
    files |= {f"icon.{kind}": asset(model, f"{model.name}.{kind}").read_bytes() for kind in ("png", "svg")}
    flanges = {f"{_icon_name(terminal)}.png" for terminal in terminals(model)}
    return files | {name: (_FLANGES / name).read_bytes() for name in sorted(flanges)}


def terminals_xml(model: Model) -> bytes:
    """terminalsAndIcons.xml."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    graphics = SubElement(root, "GraphicalRepresentation")
    SubElement(graphics, "CoordinateSystem", corners | {"suggestedScalingFactorTo_mm": "0.1"})
    SubElement(graphics, "Icon", corners)
    flanges = terminals(model)
    group = SubElement(root, "Terminals") if flanges else root
    for terminal in flanges:
        node = SubElement(
            group,
            "Terminal",
            name=terminal.name,
            matchingRule="plug",
            terminalKind=terminal.kind + terminal.side,
            description=terminal.doc,
        )
        for member, (variable, kind) in terminal.members.items():
            SubElement(
                node, "TerminalMemberVariable", variableName=variable, memberName=member, variableKind=kind
            )
        x = -100.0 if terminal.side == "a" else 100.0
        SubElement(
            node,
            "TerminalGraphicalRepresentation",
            defaultConnectionColor=_COLORS[terminal.kind],
            x1=f"{x - _HALF_SIZE:g}",
            y1=f"{terminal.y - _HALF_SIZE:g}",
            x2=f"{x + _HALF_SIZE:g}",
            y2=f"{terminal.y + _HALF_SIZE:g}",
            iconBaseName=_icon_name(terminal),
        )
    return serialized(root)


def _icon_name(terminal: Terminal) -> str:
    domain = "rotational" if terminal.kind == ROTATIONAL else "translational"
    return f"{domain}_{terminal.side}"
