"""What other solvers are given of a harmonic drive."""

from typing import TYPE_CHECKING

from jointfmu.joints.harmonic_drive import KIND
from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

from ...export.exports import Exports, LoadCurve

if TYPE_CHECKING:
    from ...export.tables import LoadTable


def _torque(drive: Drive, _: None, error: float) -> "LoadTable":
    from ...export.tables import odd_table

    return odd_table(HarmonicDriveSpring.of(drive).curve, error)


EXPORTS = Exports(
    curve=LoadCurve(
        meaning="torque over wind-up at the output, wave generator locked",
        columns=tuple(KIND.variables[name] for name in ("phi_rel", "tau", "K_WTS")),
        name="torque",
        table=_torque,
    ),
    lacks={"contact": "its stiffness is a sum over the nodes of a mesh, not over an area; export its curve"},
)
