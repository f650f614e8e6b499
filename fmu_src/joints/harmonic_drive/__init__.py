"""Builder data of the harmonic drive; the nodes of a measured midline are data of the FMU."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.prescribed_midline import (
    MAX_TABLE_POINTS,
    MeasuredDriveParameters,
    SplineNode,
    TableDriveParameters,
)
from jointfmu.quantity import Number, flatten_parameters, quantity_field

from ...joint_parts import FmuParts, RampPanel, make_native_definition_loader
from ...joint_parts.data import EMPTY_TABLES, DataConversion, DataTable
from ...joint_parts.terminals import ROTATIONAL_FLANGE_CLASS, Terminal, make_shaft_flange


@dataclass(frozen=True, kw_only=True)
class MidlineDriveParameters(MeasuredDriveParameters):
    """Harmonic drive with a measured midline (torque against wind-up) whose nodes are data."""

    end_torque: float = quantity_field("N.m", "torque at the last point", gt=0.0)
    max_stiffness: float = quantity_field("N.m/rad", "twice the largest stiffness of the midline", gt=0.0)

    @property
    def max_table_torque(self) -> Number:
        """Torque [N.m] at the last node of the midline."""
        return self.end_torque

    @property
    def K_FTS(self) -> Number:
        """Twice the largest stiffness of the midline [N.m/rad]."""
        return self.max_stiffness

    def make_midline_nodes(self) -> list[SplineNode]:
        """Empty list: the nodes are read from the data block at run time."""
        return []


def _find_code_parameter_class(drive: DriveParameters) -> type[DriveParameters]:
    """Class of the parameter set with which the C code of a drive is generated."""
    return MidlineDriveParameters if isinstance(drive, TableDriveParameters) else type(drive)


def _convert_parameters(drive: DriveParameters) -> Mapping[str, Any]:
    """{structured name: value} of the parameter set with which the C code of a drive is generated."""
    values = flatten_parameters(drive)
    if not isinstance(drive, TableDriveParameters):
        return values
    midline = {"end_torque": drive.max_table_torque, "max_stiffness": drive.K_FTS}
    return {name: value for name, value in values.items() if not name.startswith("table.")} | midline


def _make_data_tables(drive: DriveParameters) -> Mapping[str, DataTable]:
    """Table "midline" of the nodes of a measured midline, as data of the C code; none for other drives."""
    if not isinstance(drive, TableDriveParameters):
        return EMPTY_TABLES
    return {
        "midline": DataTable(np.array(drive.make_midline_nodes(), dtype=np.float64), MAX_TABLE_POINTS + 1)
    }


_STIFFNESS_PANEL = RampPanel("tau", ("K_WTS", "K_TS"))
"""Chart of the stiffnesses over the torque on the documentation page."""
_LOCKED_FLANGE_MEMBERS = {"phi": ("phi_rel", "signal"), "tau": ("tau", "inflow")}
"""{Modelica variable of the output flange: (FMU variable, variableKind)}, wave generator locked."""

FMU_PARTS = FmuParts(
    folder=Path(__file__).parent,
    native=make_native_definition_loader(__name__),
    data_conversion=DataConversion(_convert_parameters, _find_code_parameter_class, _make_data_tables),
    ramp_panels={
        "HarmonicDriveSpring": (RampPanel("phi_rel", ("tau",)), _STIFFNESS_PANEL),
        "HarmonicDriveCompliance": (RampPanel("tau", ("phi_rel",)), _STIFFNESS_PANEL),
    },
    terminals={
        "HarmonicDriveSpring": (
            make_shaft_flange(1, "a", "wave generator (motor)"),
            make_shaft_flange(2, "b", "output"),
        ),
        "HarmonicDriveCompliance": (
            Terminal(
                "flange",
                ROTATIONAL_FLANGE_CLASS,
                "b",
                "output, wave generator locked",
                _LOCKED_FLANGE_MEMBERS,
            ),
        ),
    },
)
"""Builder data of the harmonic drive."""
