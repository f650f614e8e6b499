"""The folder terminalsAndIcons: flanges as in the Modelica Standard Library, and the icons.

FMI 3.0 defines the folder; FMI 2.0 takes it over unchanged since 2.0.4. Flow variables are signed as
the standard asks: an outflow is a force or torque that the element applies to what is connected, an
inflow one that is applied to the element.
"""

from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.joints.model import Model

from .description import serialized
from .icon import flange_icon, icon

_ROTATIONAL = "Modelica.Mechanics.Rotational.Interfaces.Flange_"
_TRANSLATIONAL = "Modelica.Mechanics.Translational.Interfaces.Flange_"
_COLORS = {_ROTATIONAL: "0 0 0", _TRANSLATIONAL: "0 127 0"}
_HALF_SIZE = 10.0


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


def _axis(axis: str, y: float) -> Terminal:
    members = {
        "s": (f"s_rel_{axis}", "signal"),
        "v": (f"v_rel_{axis}", "signal"),
        "f": (f"f_{axis}", "outflow"),
    }
    return Terminal(f"flange_{axis}", _TRANSLATIONAL, "b", f"side 2 along {axis}, side 1 fixed", members, y)


def _shaft(number: int, side: str, doc: str) -> Terminal:
    members = {
        "phi": (f"phi{number}", "signal"),
        "w": (f"w{number}", "signal"),
        "tau": (f"tau{number}", "outflow"),
    }
    return Terminal(f"flange{number}", _ROTATIONAL, side, doc, members)


def _body(motion: str, rate: str, flow: str, kind: str, body: str) -> tuple[Terminal, Terminal]:
    """Both flanges of a partner that moves; each takes a load of its own."""

    def flange(side: str) -> Terminal:
        load = (f"{flow}_{side}", "inflow")
        members = {motion: (motion, "signal"), rate: (rate, "signal"), flow: load}
        return Terminal(f"flange_{side}", kind, side, f"{body}, load {load[0]}", members)

    return flange("a"), flange("b")


TERMINALS: dict[str, tuple[Terminal, ...]] = {
    "HarmonicDriveSpring": (
        _shaft(1, "a", "wave generator (motor)"),
        _shaft(2, "b", "output"),
    ),
    "HarmonicDriveCompliance": (
        Terminal(
            "flange",
            _ROTATIONAL,
            "b",
            "output, wave generator locked",
            {"phi": ("phi_rel", "signal"), "tau": ("tau", "inflow")},
        ),
    ),
    "BoltedJoint": (_axis("x", 60.0), _axis("y", 0.0), _axis("z", -60.0)),
    "GearContact": (
        Terminal(
            "flange",
            _TRANSLATIONAL,
            "a",
            "one flank pressed on the other, along the normal",
            {"s": ("s_rel", "signal"), "f": ("f", "inflow")},
        ),
    ),
    "RotationalInertia": _body("phi", "w", "tau", _ROTATIONAL, "the inertia"),
    "TranslationalMass": _body("s", "v", "f", _TRANSLATIONAL, "the mass"),
}
"""Of the joints, and of their partners that move; a load over time has no motion and so no flange."""


def terminals_and_icons(model: Model) -> dict[str, bytes]:
    """{file name: content} of the folder terminalsAndIcons."""
    png, svg = icon(model.name)
    files = {"terminalsAndIcons.xml": terminals_xml(model), "icon.png": png, "icon.svg": svg.encode()}
    for terminal in TERMINALS.get(model.name, ()):
        files[f"{_icon_name(terminal)}.png"] = flange_icon(terminal.kind == _ROTATIONAL, terminal.side == "a")
    return files


def terminals_xml(model: Model) -> bytes:
    """terminalsAndIcons.xml."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    graphics = SubElement(root, "GraphicalRepresentation")
    SubElement(graphics, "CoordinateSystem", corners | {"suggestedScalingFactorTo_mm": "0.1"})
    SubElement(graphics, "Icon", corners)
    if model.name not in TERMINALS:
        return serialized(root)
    terminals = SubElement(root, "Terminals")
    for terminal in TERMINALS[model.name]:
        node = SubElement(
            terminals,
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
    domain = "rotational" if terminal.kind == _ROTATIONAL else "translational"
    return f"{domain}_{terminal.side}"
