"""The page: figures, the table of published against computed, the checks."""

import platform
from pathlib import Path
from typing import Any

from jointfmu import __version__
from jointfmu.parameters import write_text
from jointfmu.stamp import build_time

from ..templates import template
from . import figures, systems


def write_report(path: Path, outcome: Any) -> None:
    """Write the self-contained page of an outcome of the main job."""
    ramps = outcome.ramps
    page = template(Path(__file__).with_name("page.html")).render(
        version=__version__,
        python=platform.python_version(),
        when=build_time().strftime("%Y-%m-%d %H:%M UTC"),
        outcome=outcome,
        fmu_values={(r.point.paper, r.point.id): r for r in outcome.fmu_rows},
        figures=[
            (
                "Harmonic drive: stiffness over torque",
                "Left: K_WTS and its parts on the drive's scale, as the FMU gives them. Right: the contact "
                "pair on the scale of the paper's figures. Open circles were used to calibrate.",
                figures.harmonic_stiffness(ramps["HarmonicDriveCompliance"], outcome.rows),
                "HarmonicDriveCompliance.csv",
            ),
            (
                "Harmonic drive: torque over wind-up",
                "The integral of dT/K_WTS, odd in the torque.",
                figures.torque_angle(ramps["HarmonicDriveCompliance"]),
                "HarmonicDriveCompliance.csv",
            ),
            (
                "Bolted joint: stiffness and damping over preload",
                "Normal (zz) and tangential (xx) direction; the damping is the viscous equivalent.",
                figures.bolted_stiffness(ramps["BoltedJoint"]),
                "BoltedJoint.csv",
            ),
            (
                "Bolted joint: contact pressure",
                "White: bolts. Left the preload of the published pressures, right the moment that shifts "
                "the bolt forces of the two rows by 5 kN.",
                figures.pressure_map(9e3),
                None,
            ),
            (
                "Gear contact: stiffness and approach over load",
                "Up to about a tenth of the nominal area in real contact.",
                figures.gear_stiffness(ramps["GearContact"]),
                "GearContact.csv",
            ),
            (
                "In a system: resonance of the robot joint over its torque",
                "The link rings about a working point, motor held. Circles: peak of the simulated signal's "
                "spectrum; line: square root of K_WTS over the link's inertia. Right: the decay at the first "
                "torque, between the envelopes of the stated damping.",
                systems.ringing(outcome.ringing["robot_joint"], "robot_joint"),
                None,
            ),
            (
                "In a system: resonance of the bolted column over its preload",
                "The same for the mass on the bolted joint, along the joint's normal.",
                systems.ringing(outcome.ringing["bolted_column"], "bolted_column"),
                None,
            ),
        ],
    )
    write_text(path, page)
