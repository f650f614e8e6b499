"""Folder terminalsAndIcons of an FMU: flanges as in the Modelica Standard Library, and icons.

FMI 3.0 defines the folder; FMI 2.0 allows it since 2.0.4. Signs of flow variables follow FMI 3.0:
an outflow is a force or torque that the FMU applies to the connected part, an inflow is applied to the FMU.
"""

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from jointfmu.joints.model import Model

from ..folders import asset, parts_of
from ..joint_parts.terminals import ROTATIONAL, TRANSLATIONAL, Terminal
from ..xml_parts import serialized

_COLORS = {ROTATIONAL: "0 0 0", TRANSLATIONAL: "0 127 0"}
_HALF_SIZE = 10.0
_FLANGES = Path(__file__).with_name("flanges")
"""Folder of the flange icons, 32 x 32 pixels: circle or square, filled for side a, open for side b."""


def terminals(model: Model) -> tuple[Terminal, ...]:
    """Flanges of an FMU; may be empty."""
    return parts_of(model).terminals.get(model.name, ())


def terminals_and_icons(model: Model) -> dict[str, bytes]:
    """{file name: content} of the folder terminalsAndIcons."""
    files = {"terminalsAndIcons.xml": terminals_xml(model)}
    files |= {f"icon.{kind}": asset(model, f"{model.name}.{kind}").read_bytes() for kind in ("png", "svg")}
    flanges = {f"{_icon_name(terminal)}.png" for terminal in terminals(model)}
    return files | {name: (_FLANGES / name).read_bytes() for name in sorted(flanges)}


def terminals_xml(model: Model) -> bytes:
    """Content of terminalsAndIcons.xml."""
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
    """File name of the icon of a flange, without extension."""
    domain = "rotational" if terminal.kind == ROTATIONAL else "translational"
    return f"{domain}_{terminal.side}"
