"""Template variables of the packages Interfaces and Wrappers of the Modelica library.

The template variables have the variables and flanges of an FMU, and the diagram of its wrapper.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jointfmu_fmu_src.joint_parts.terminals import Terminal
from jointfmu_fmu_src.native.terminals import find_terminals

from jointfmu.joints import KINDS
from jointfmu.joints.model import Model, Variable
from jointfmu.quantity.units import UNITS

from .records import escape_string, format_double_literal

_ROTATIONAL_PACKAGE, _TRANSLATIONAL_PACKAGE = (
    "Modelica.Mechanics.Rotational",
    "Modelica.Mechanics.Translational",
)
_ADAPTOR_MODELS = {  # (rotational, the FMU takes motion) -> adaptor
    (True, True): f"{_ROTATIONAL_PACKAGE}.Components.GeneralTorqueToAngleAdaptor",
    (True, False): f"{_ROTATIONAL_PACKAGE}.Components.GeneralAngleToTorqueAdaptor",
    (False, True): f"{_TRANSLATIONAL_PACKAGE}.Components.GeneralForceToPositionAdaptor",
    (False, False): f"{_TRANSLATIONAL_PACKAGE}.Components.GeneralPositionToForceAdaptor",
}
_FORCE_INPUT_NOTE = (
    "The flange follows the FMU's displacement, so give it a force that does not depend on an inertia "
    "right at the flange: an inertia there would need the inverse of the FMU. "
    'Between inertias take a component of <a href=\\"modelica://JointStiffness.Components\\">Components</a>'
    "{between_inertias}."
)
"""Documentation of a wrapper whose FMU has forces as inputs."""
_MOTION_INPUT_NOTE = "It takes motion and gives force, so it belongs between inertias."
"""Documentation of a wrapper whose FMU has motions as inputs."""


def interface_template_variables(fmu_model: Model) -> dict[str, object]:
    """Template variables of the partial block with an FMU's inputs and outputs."""

    def list_connectors(fmu_variables: Sequence[Variable]) -> list[dict[str, object]]:
        """Name, unit, meaning and vertical position of each connector on one side of the block."""
        return [
            {
                "name": v.name,
                "unit": v.unit,
                "doc": escape_string(v.doc),
                "low": f", min={format_double_literal(v.minimum)}" if v.minimum > -np.inf else "",
                "y": y,
            }
            for v, y in zip(fmu_variables, _connector_heights(fmu_variables), strict=True)
        ]

    inputs, outputs = list_connectors(fmu_model.inputs), list_connectors(fmu_model.outputs)
    return {"name": fmu_model.name, "doc": escape_string(fmu_model.doc), "inputs": inputs, "outputs": outputs}


def wrapper_template_variables(fmu_model: Model) -> dict[str, object]:
    """Template variables of a Modelica model (wrapper) that connects an imported FMU to flanges."""
    flanges = find_terminals(fmu_model)
    members = {variable for t in flanges for variable, _ in t.member_variables.values()}
    note = _MOTION_INPUT_NOTE
    if not _has_motion_inputs(fmu_model):  # name another FMU of the joint, which can be used between inertias
        others = [other.name for other in KINDS[fmu_model.joint].models if _has_motion_inputs(other)]
        note = _FORCE_INPUT_NOTE.format(between_inertias=f" or the FMU {others[0]}" if others else "")
    parameters = [
        {
            "name": v.name,
            "type": f"Modelica.Units.SI.{UNITS[v.unit].quantity}",
            "modifier": f"(min={format_double_literal(v.minimum)}, start=0)"
            if v.minimum > -np.inf and not v.start
            else f"={v.start:g}",
            "doc": escape_string(v.doc),
        }
        for v in fmu_model.inputs
        if v.name not in members
    ]
    return {
        "name": fmu_model.name,
        "doc": escape_string(f"{fmu_model.name} as an imported FMU, between flanges"),
        "note": note,
        "parameters": parameters,
        "terminals": [_flange_template_variables(t, _port_positions(fmu_model)) for t in flanges],
    }


def _has_motion_inputs(fmu_model: Model) -> bool:
    """Whether the inputs of an FMU are motions and its outputs forces."""
    return all(flow != "inflow" for t in find_terminals(fmu_model) for _, flow in t.member_variables.values())


def _port_positions(fmu_model: Model) -> dict[str, tuple[float, float]]:
    """Positions (x, y) of the FMU's inputs and outputs in the diagram of a wrapper."""
    sides = zip((-24.0, 22.0), (fmu_model.inputs, fmu_model.outputs), strict=True)
    return {
        v.name: (x, round(0.2 * y, 1))
        for x, side in sides
        for v, y in zip(side, _connector_heights(side), strict=True)
    }


def _connector_heights(fmu_variables: Sequence[Variable]) -> list[int]:
    """Vertical positions of the connectors on one side of a block, from 90 down to -90."""
    return [round(90 - (i + 0.5) * 180 / len(fmu_variables)) for i in range(len(fmu_variables))]


def _flange_template_variables(
    terminal: Terminal, port_positions: Mapping[str, tuple[float, float]]
) -> dict[str, object]:
    """Variables of the wrapper's Modelica template: one flange, and its adaptor to the signals of the FMU.

    Motion, its rate and force of the FMU's terminal are connected to p, pder and f of the adaptor.
    """
    rotational = ".Rotational." in terminal.connector_class
    potential, rate, force = (
        next((terminal.member_variables[m][0] for m in names if m in terminal.member_variables), None)
        for names in (("phi", "s"), ("w", "v"), ("tau", "f"))
    )
    flow = next(v for _, v in terminal.member_variables.values() if v.endswith("flow"))
    takes_motion = flow == "outflow"
    left = terminal.flange_side == "a"
    flip, y = (1 if left else -1), round(terminal.icon_y_position)
    adaptor, gain = f"adaptor_{terminal.terminal_name}", f"reaction_{terminal.terminal_name}"
    places = {
        f"{adaptor}.flange": (flip * -82.0, y),
        f"{adaptor}.p": (flip * -77.0, y + 8.0),
        f"{adaptor}.pder": (flip * -77.0, y + 5.0),
        f"{adaptor}.f": (flip * -77.0, y - 8.0),
        f"{gain}.u": (flip * (-39.0 if takes_motion else -51.0), y - 25.0),
        f"{gain}.y": (flip * (-50.5 if takes_motion else -39.5), y - 25.0),
        terminal.terminal_name: (flip * -100.0, y),
        **{f"fmu.{name}": place for name, place in port_positions.items()},
    }
    wires = [(f"{adaptor}.p", f"fmu.{potential}")]
    wires += [(f"{adaptor}.pder", f"fmu.{rate}")] if rate else []
    wires += [(f"fmu.{force}", f"{gain}.u"), (f"{gain}.y", f"{adaptor}.f")]
    if not takes_motion:
        wires = [(b, a) for a, b in reversed(wires)]
    shaft = "{0,0,0}" if rotational else "{0,127,0}"
    return {
        "name": terminal.terminal_name,
        "doc": escape_string(terminal.flange_description),
        "connector": terminal.connector_class + terminal.flange_side,
        "adaptor": _ADAPTOR_MODELS[rotational, takes_motion],
        "use_rate": str(rate is not None).lower(),
        "connections": [
            (
                start,
                end,
                _format_connection_line(
                    places[start], places[end], shaft if start == terminal.terminal_name else "{0,0,127}"
                ),
            )
            for start, end in [(terminal.terminal_name, f"{adaptor}.flange"), *wires]
        ],
        "x": flip * -100,
        "y": y,
        "flip": flip,
        "from": -40 if takes_motion else -50,
        "to": -50 if takes_motion else -40,
    }


def _format_connection_line(
    start_point: tuple[float, float], end_point: tuple[float, float], line_color: str
) -> str:
    """Format the line of a connection: horizontal, vertical at half width, horizontal."""
    middle = 0.5 * (start_point[0] + end_point[0])
    corners = (
        [start_point, (middle, start_point[1]), (middle, end_point[1]), end_point]
        if start_point[1] != end_point[1]
        else [start_point, end_point]
    )
    points = ",".join(f"{{{x:g},{y:g}}}" for x, y in corners)
    return f"Line(points={{{points}}}, color={line_color})"
