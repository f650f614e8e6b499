"""Harmonic drive in the Modelica library: table of the torque over the wind-up, an odd function."""

from collections.abc import Sequence

import numpy as np

from jointfmu.joints.harmonic_drive.drive import PLAY_TORQUE_OVER_RATED_TORQUE, DriveParameters
from jointfmu.joints.harmonic_drive.friction import (
    PRIOR_ROTATION_TIME,
    REFERENCE_TEMPERATURE,
    SLIDER_LIMIT_SHARES,
    SLIDER_STIFFNESS_SHARES,
)
from jointfmu.joints.harmonic_drive.hysteresis import slider_shares, stiffness_exponent
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import flatten_fields

from ....exchange.modelica.records import (
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    decimate_curve,
    format_computed_values,
    format_double_literal,
    format_matrix,
    format_parameter_values,
    make_identifier,
)

_RECORD_ONLY_PARAMETERS = ("hysteresis_loss", "hysteresis_stiffness", "lost_motion", "inertia1", "inertia2")
"""Parameters of the drive without a parameter of their own in the component: they are in the table and in the
sliders of the record, or only the FMU uses them."""
_MODELICA_COMPONENT_PARAMETERS = tuple(
    name for name, _ in flatten_fields(DriveParameters) if name not in _RECORD_ONLY_PARAMETERS
)
"""Parameters of the drive that are parameters of the component, too."""


def _make_records(
    parameter_file: ParameterFile, working_points: Sequence[WorkingPoint]
) -> list[ModelicaRecord]:
    """Make the Modelica records of a parameter file; a drive has one."""
    drive = parameter_file.values
    spring = HarmonicDriveSpring.tabulate(drive)
    stated = format_parameter_values({name: getattr(drive, name) for name in _MODELICA_COMPONENT_PARAMETERS})
    stated |= format_parameter_values({"T": parameter_file.start_value("temperature")})
    derived = format_computed_values({"K_FTS0": drive.K_FTS} | _hysteresis_totals(spring))
    sliders = np.array(slider_shares(stiffness_exponent(drive)), dtype=np.float64).T
    return [
        ModelicaRecord(
            record_name=make_identifier(parameter_file.name),
            record_title=parameter_file.name,
            interpolation_table=decimate_curve(spring.curve),
            value_expressions=stated | derived | {"sliders": format_matrix(sliders)},
        )
    ]


def _hysteresis_totals(drive_spring: HarmonicDriveSpring) -> dict[str, float]:
    """Total friction limit [N.m] of the hysteresis sliders, and their total stiffness [N.m/rad] in stick."""
    sliders = drive_spring.hysteresis
    return {
        "hysteresis_friction": float(np.sum(sliders.friction_limit)),
        "hysteresis_stiffness": float(np.sum(sliders.stiffness)),
    }


MODELICA_COMPONENT = ModelicaComponent(
    component_name="HarmonicDriveSpring",
    base_record="HarmonicDrive",
    make_records=_make_records,
    system_parameters=lambda file: format_computed_values(
        _hysteresis_totals(HarmonicDriveSpring.tabulate(file.values))
    ),
    system_parameter_units={"hysteresis_friction": "N.m", "hysteresis_stiffness": "N.m/rad"},
    fixed_input_parameters={"temperature": "T"},
    component_only_parameters=("hysteresis_loss", "hysteresis_stiffness"),
    make_template_texts=lambda drive: {
        "end": f"{drive.max_load:g} N m",
        "brakes": format_matrix(np.column_stack([SLIDER_STIFFNESS_SHARES, SLIDER_LIMIT_SHARES])),
        "turned": format_double_literal(PRIOR_ROTATION_TIME),
        "reference": format_double_literal(REFERENCE_TEMPERATURE),
        "width": format_double_literal(PLAY_TORQUE_OVER_RATED_TORQUE),
    },
    package_note="For the drive with a locked wave generator (the FMU "
    "<code>HarmonicDriveCompliance</code>) fix "
    '<code>flange_a</code> of <a href="modelica://JointStiffness.Components.HarmonicDriveSpring">'
    "HarmonicDriveSpring</a>: an acausal component is its own inverse. With <code>d</code> = 0 and no "
    "inertia set <code>use_damping=false</code>.",
)
"""Modelica component of the harmonic drive."""
