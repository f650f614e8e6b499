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

from ...joint_parts import FmuBuildData, RampPanel, make_native_definition_loader
from ...joint_parts.data import NO_DATA_TABLES, DataConversion, DataTable
from ...joint_parts.terminals import ROTATIONAL_FLANGE_CLASS, Terminal, make_shaft_flange


@dataclass(frozen=True, kw_only=True)
class MidlineDriveParameters(MeasuredDriveParameters):
    """Parameters for the C code of a drive with measured midline (mean torque as a function of wind-up).

    The C code reads the nodes of the midline from the file data.c.
    """

    end_torque: float = quantity_field("N.m", "torque at the last point", gt=0.0)
    max_stiffness: float = quantity_field("N.m/rad", "twice the largest stiffness of the midline", gt=0.0)

    @property
    def max_table_torque(self) -> Number:
        """Torque [N.m] at the last node of the midline."""
        return self.end_torque

    @property
    def K_FTS(self) -> Number:
        """Stiffness K_FTS [N.m/rad] of circular spline and flexspline, set to `max_stiffness`."""
        return self.max_stiffness

    def make_midline_nodes(self) -> list[SplineNode]:
        """Return an empty list: the C code reads the nodes of the midline from data.c."""
        return []


def _find_code_parameter_class(harmonic_drive: DriveParameters) -> type[DriveParameters]:
    """Class of the parameter set with which the C code of a drive is generated."""
    return (
        MidlineDriveParameters if isinstance(harmonic_drive, TableDriveParameters) else type(harmonic_drive)
    )


def _convert_parameters(harmonic_drive: DriveParameters) -> Mapping[str, Any]:
    """Parameters {structured name: value} with which the C code of a drive is generated."""
    values = flatten_parameters(harmonic_drive)
    if not isinstance(harmonic_drive, TableDriveParameters):
        return values
    midline = {"end_torque": harmonic_drive.max_table_torque, "max_stiffness": harmonic_drive.K_FTS}
    return {name: value for name, value in values.items() if not name.startswith("table.")} | midline


def _make_data_tables(harmonic_drive: DriveParameters) -> Mapping[str, DataTable]:
    """Data table with the nodes of a measured midline (torque over wind-up); none for other drives."""
    if not isinstance(harmonic_drive, TableDriveParameters):
        return NO_DATA_TABLES
    return {
        "midline": DataTable(
            np.array(harmonic_drive.make_midline_nodes(), dtype=np.float64), MAX_TABLE_POINTS + 1
        )
    }


_STIFFNESS_RAMP_PANEL = RampPanel("tau", ("K_WTS", "K_TS"))
"""Chart of the stiffnesses over the torque on the documentation page."""
_LOCKED_FLANGE_MEMBER_VARIABLES = {"phi": ("phi_rel", "signal"), "tau": ("tau", "inflow")}
"""{Modelica variable of the output flange: (FMU variable, variableKind)}, wave generator locked."""

FMU_BUILD_DATA = FmuBuildData(
    joint_folder=Path(__file__).parent,
    load_native_definition=make_native_definition_loader(__name__),
    data_conversion=DataConversion(_convert_parameters, _find_code_parameter_class, _make_data_tables),
    load_ramp_panels={
        "HarmonicDriveSpring": (RampPanel("phi_rel", ("tau",)), _STIFFNESS_RAMP_PANEL),
        "HarmonicDriveCompliance": (RampPanel("tau", ("phi_rel",)), _STIFFNESS_RAMP_PANEL),
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
                _LOCKED_FLANGE_MEMBER_VARIABLES,
            ),
        ),
    },
)
"""Builder data of the harmonic drive."""
