"""The drive in the Modelica library: torque over wind-up, odd."""

from collections.abc import Sequence

import numpy as np

from jointfmu.joints.harmonic_drive.hysteresis import exponent, shares
from jointfmu.joints.harmonic_drive.kinematic_error import HARMONICS
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile

from ....modelica.records import Component, Record, WorkingPoint, numbers
from ....modelica.tables import thinned
from ....modelica.text import identifier, matrix

_ERROR = [f"error_{n}{what}" for n in HARMONICS for what in ("", "_phase")]


def _records(file: ParameterFile, points: Sequence[WorkingPoint]) -> list[Record]:
    drive = file.values
    spring = HarmonicDriveSpring.of(drive)
    own = {name: getattr(drive, name) for name in ("ratio", "d", *_ERROR)} | {"K_FTS0": drive.K_FTS}
    sliders = np.array(shares(exponent(drive)), dtype=np.float64).T
    return [
        Record(
            name=identifier(file.name),
            title=file.name,
            table=thinned(spring.curve),
            values=numbers({**own, **_hysteresis(spring)}) | {"sliders": matrix(sliders)},
        )
    ]


def _hysteresis(spring: HarmonicDriveSpring) -> dict[str, float]:
    """Friction [N.m] and stiffness while all sliders stick [N.m/rad]."""
    found = spring.hysteresis
    return {"friction": float(np.sum(found.limit)), "stick": float(np.sum(found.stiffness))}


def _of_system(file: ParameterFile) -> dict[str, str]:
    own = numbers(_hysteresis(HarmonicDriveSpring.of(file.values)))
    return own | {"stateSelect": "StateSelect.default"}


COMPONENT = Component(
    name="HarmonicDriveSpring",
    base="HarmonicDrive",
    records=_records,
    of_system=_of_system,
    special=("hysteresis_loss", "hysteresis_stiffness"),
    texts=lambda drive: {"end": f"{drive.end:g} N m"},
    note="For the drive with a locked wave generator (the FMU <code>HarmonicDriveCompliance</code>) fix "
    '<code>flange_a</code> of <a href="modelica://JointStiffness.Components.HarmonicDriveSpring">'
    "HarmonicDriveSpring</a>: an acausal component is its own inverse. With <code>d</code> = 0 and no "
    "inertia set <code>use_damping=false</code>.",
)
