"""The drive in the Modelica library: torque over wind-up, odd."""

from collections.abc import Sequence

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile

from ....modelica.records import Component, Record, WorkingPoint, numbers
from ....modelica.tables import thinned
from ....modelica.text import identifier


def _records(file: ParameterFile, points: Sequence[WorkingPoint]) -> list[Record]:
    drive = file.values
    return [
        Record(
            name=identifier(file.name),
            title=file.name,
            table=thinned(HarmonicDriveSpring.of(drive).curve),
            values=numbers({"ratio": drive.ratio, "d": drive.d, "K_FTS0": drive.K_FTS0}),
        )
    ]


COMPONENT = Component(
    name="HarmonicDriveSpring",
    base="HarmonicDrive",
    records=_records,
    texts=lambda drive: {"end": f"{drive.end:g} N m"},
    note="For the drive with a locked wave generator (the FMU <code>HarmonicDriveCompliance</code>) fix "
    '<code>flange_a</code> of <a href="modelica://JointStiffness.Components.HarmonicDriveSpring">'
    "HarmonicDriveSpring</a>: an acausal component is its own inverse.",
)
