"""Harmonic drive in the Modelica library: table of the torque over the wind-up, an odd function."""

from collections.abc import Sequence

import numpy as np

from jointfmu.joints.harmonic_drive.drive import WIDTH, Drive
from jointfmu.joints.harmonic_drive.friction import LIMITS, REFERENCE, SPRINGS, TURNED
from jointfmu.joints.harmonic_drive.hysteresis import exponent, shares
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import flat_fields

from ....modelica.records import (
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    computed,
    given,
    identifier,
    matrix,
    number,
    thinned,
)

_SPRING = ("hysteresis_loss", "hysteresis_stiffness", "lost_motion", "inertia1", "inertia2")
"""Parameters of the drive without a parameter of their own in the component: they are in the table and in the
sliders of the record, or only the FMU uses them."""
_OWN = tuple(name for name, _ in flat_fields(Drive) if name not in _SPRING)
"""Parameters of the drive that are parameters of the component, too."""


def _records(file: ParameterFile, points: Sequence[WorkingPoint]) -> list[ModelicaRecord]:
    drive = file.values
    spring = HarmonicDriveSpring.of(drive)
    stated = given({name: getattr(drive, name) for name in _OWN})
    stated |= given({"T": file.start("temperature")})
    derived = computed({"K_FTS0": drive.K_FTS} | _hysteresis(spring))
    sliders = np.array(shares(exponent(drive)), dtype=np.float64).T
    return [
        ModelicaRecord(
            name=identifier(file.name),
            title=file.name,
            table=thinned(spring.curve),
            values=stated | derived | {"sliders": matrix(sliders)},
        )
    ]


def _hysteresis(spring: HarmonicDriveSpring) -> dict[str, float]:
    """Total friction limit [N.m] of the hysteresis sliders, and their stiffness [N.m/rad] while all stick."""
    sliders = spring.hysteresis
    return {
        "hysteresis_friction": float(np.sum(sliders.limit)),
        "hysteresis_stiffness": float(np.sum(sliders.stiffness)),
    }


COMPONENT = ModelicaComponent(
    name="HarmonicDriveSpring",
    base="HarmonicDrive",
    records=_records,
    of_system=lambda file: (
        computed(_hysteresis(HarmonicDriveSpring.of(file.values))) | {"stateSelect": "StateSelect.default"}
    ),
    held={"temperature": "T"},
    special=("hysteresis_loss", "hysteresis_stiffness"),
    texts=lambda drive: {
        "end": f"{drive.end:g} N m",
        "brakes": matrix(np.column_stack([SPRINGS, LIMITS])),
        "turned": number(TURNED),
        "reference": number(REFERENCE),
        "width": number(WIDTH),
    },
    note="For the drive with a locked wave generator (the FMU <code>HarmonicDriveCompliance</code>) fix "
    '<code>flange_a</code> of <a href="modelica://JointStiffness.Components.HarmonicDriveSpring">'
    "HarmonicDriveSpring</a>: an acausal component is its own inverse. With <code>d</code> = 0 and no "
    "inertia set <code>use_damping=false</code>.",
)
