"""Builder data of the harmonic drive; the nodes of a measured midline are data of the FMU."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.given import MAX_POINTS, MeasuredDrive, SplineNode, TableDrive
from jointfmu.quantity import Number, flatten_parameters, quantity_field

from ...joint_parts import Parts, RampPanel, native_of
from ...joint_parts.data import NO_TABLES, DataPart, DataTable
from ...joint_parts.terminals import ROTATIONAL, Terminal, shaft


@dataclass(frozen=True, kw_only=True)
class MidlineDrive(MeasuredDrive):
    """Harmonic drive with a measured midline (torque against wind-up) whose nodes are data."""

    end: float = quantity_field("N.m", "torque at the last point", gt=0.0)
    stiffest: float = quantity_field("N.m/rad", "twice the largest stiffness of the midline", gt=0.0)

    @property
    def max_table_torque(self) -> Number:
        """Torque [N.m] at the last node of the midline."""
        return self.end

    @property
    def K_FTS(self) -> Number:
        """Twice the largest stiffness of the midline [N.m/rad]."""
        return self.stiffest

    def make_nodes(self) -> list[SplineNode]:
        """Empty list: the nodes are read from the data block at run time."""
        return []


def _of(drive: Drive) -> type[Drive]:
    """Class of the parameter set with which the C code of a drive is generated."""
    return MidlineDrive if isinstance(drive, TableDrive) else type(drive)


def _parameter_values(drive: Drive) -> Mapping[str, Any]:
    """{name: value} of the parameter set with which the C code of a drive is generated."""
    values = flatten_parameters(drive)
    if not isinstance(drive, TableDrive):
        return values
    midline = {"end": drive.max_table_torque, "stiffest": drive.K_FTS}
    return {name: value for name, value in values.items() if not name.startswith("table.")} | midline


def _tables(drive: Drive) -> Mapping[str, DataTable]:
    """{"midline": nodes of a measured midline}; empty for other drives."""
    if not isinstance(drive, TableDrive):
        return NO_TABLES
    return {"midline": DataTable(np.array(drive.make_nodes(), dtype=np.float64), MAX_POINTS + 1)}


_STIFFNESS = RampPanel("tau", ("K_WTS", "K_TS"))
_LOCKED = {"phi": ("phi_rel", "signal"), "tau": ("tau", "inflow")}

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    data=DataPart(_parameter_values, _of, _tables),
    panels={
        "HarmonicDriveSpring": (RampPanel("phi_rel", ("tau",)), _STIFFNESS),
        "HarmonicDriveCompliance": (RampPanel("tau", ("phi_rel",)), _STIFFNESS),
    },
    terminals={
        "HarmonicDriveSpring": (shaft(1, "a", "wave generator (motor)"), shaft(2, "b", "output")),
        "HarmonicDriveCompliance": (
            Terminal("flange", ROTATIONAL, "b", "output, wave generator locked", _LOCKED),
        ),
    },
)
