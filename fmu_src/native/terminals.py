"""Folder terminalsAndIcons of an FMU: flanges as in the Modelica Standard Library, and icons.

FMI 3.0 defines the folder; FMI 2.0 allows it since 2.0.4. Signs of flow variables follow FMI 3.0:
an outflow is a force or torque that the FMU applies to the connected part, an inflow is applied to the FMU.
"""

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from jointfmu.joints.model import Model

from ..folders import find_fmu_build_data, find_page_or_icon
from ..joint_parts.terminals import ROTATIONAL_FLANGE_CLASS, TRANSLATIONAL_FLANGE_CLASS, Terminal
from ..xml_parts import serialize_xml

_FLANGE_COLORS = {ROTATIONAL_FLANGE_CLASS: "0 0 0", TRANSLATIONAL_FLANGE_CLASS: "0 127 0"}
"""{class of a flange: RGB colour of its icon}."""
_FLANGE_ICON_HALF_SIZE = 10.0
"""Half the side of the icon of a flange, in units of the FMU's icon (200 wide) [1]."""
_FLANGE_ICON_FOLDER = Path(__file__).with_name("flanges")
"""Folder of the flange icons, 32 x 32 pixels: circle or square, filled for side a, open for side b."""


def find_terminals(fmu_model: Model) -> tuple[Terminal, ...]:
    """Flanges (FMI terminals) of an FMU; may be empty."""
    return find_fmu_build_data(fmu_model).terminals.get(fmu_model.name, ())


def make_terminal_files(fmu_model: Model) -> dict[str, bytes]:
    """Make the folder terminalsAndIcons of an FMU: {file name: content}."""
    files = {"terminalsAndIcons.xml": format_terminals(fmu_model)}
    files |= {
        f"icon.{kind}": find_page_or_icon(fmu_model, f"{fmu_model.name}.{kind}").read_bytes()
        for kind in ("png", "svg")
    }
    flanges = {f"{_make_flange_icon_stem(terminal)}.png" for terminal in find_terminals(fmu_model)}
    return files | {name: (_FLANGE_ICON_FOLDER / name).read_bytes() for name in sorted(flanges)}


def format_terminals(fmu_model: Model) -> bytes:
    """Format terminalsAndIcons.xml: flanges of an FMU, and positions of their icons."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    graphics = SubElement(root, "GraphicalRepresentation")
    SubElement(graphics, "CoordinateSystem", corners | {"suggestedScalingFactorTo_mm": "0.1"})
    SubElement(graphics, "Icon", corners)
    flanges = find_terminals(fmu_model)
    group = SubElement(root, "Terminals") if flanges else root
    for terminal in flanges:
        node = SubElement(
            group,
            "Terminal",
            name=terminal.terminal_name,
            matchingRule="plug",
            terminalKind=terminal.connector_class + terminal.flange_side,
            description=terminal.flange_description,
        )
        for member, (variable, kind) in terminal.member_variables.items():
            SubElement(
                node, "TerminalMemberVariable", variableName=variable, memberName=member, variableKind=kind
            )
        x = -100.0 if terminal.flange_side == "a" else 100.0
        SubElement(
            node,
            "TerminalGraphicalRepresentation",
            defaultConnectionColor=_FLANGE_COLORS[terminal.connector_class],
            x1=f"{x - _FLANGE_ICON_HALF_SIZE:g}",
            y1=f"{terminal.icon_y_position - _FLANGE_ICON_HALF_SIZE:g}",
            x2=f"{x + _FLANGE_ICON_HALF_SIZE:g}",
            y2=f"{terminal.icon_y_position + _FLANGE_ICON_HALF_SIZE:g}",
            iconBaseName=_make_flange_icon_stem(terminal),
        )
    return serialize_xml(root)


def _make_flange_icon_stem(flange_terminal: Terminal) -> str:
    """File name of the icon of a flange, without extension."""
    domain = "rotational" if flange_terminal.connector_class == ROTATIONAL_FLANGE_CLASS else "translational"
    return f"{domain}_{flange_terminal.flange_side}"
