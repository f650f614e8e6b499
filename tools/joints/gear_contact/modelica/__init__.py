"""Gear contact in the Modelica library: table of the normal force over the approach from first contact."""

from collections.abc import Sequence

import numpy as np

from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.parameters import ParameterFile

from ....exchange.modelica.records import (
    InterpolationTable,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    decimate_curve,
    make_identifier,
)


def _make_records(
    parameter_file: ParameterFile, working_points: Sequence[WorkingPoint]
) -> list[ModelicaRecord]:
    """Make the Modelica records of a parameter file; the gear contact has one."""
    contact = GearContactSpring.tabulate(parameter_file.values)
    pressure = decimate_curve(contact.curve)
    approach = pressure.table_rows[:, :1] - contact.curve.displacement[0]
    table = InterpolationTable(
        np.hstack([approach, contact.joint.A_0 * pressure.table_rows[:, 1:]]), pressure.max_relative_error
    )
    return [
        ModelicaRecord(
            record_name=make_identifier(parameter_file.name),
            record_title=parameter_file.name,
            interpolation_table=table,
        )
    ]


MODELICA_COMPONENT = ModelicaComponent(
    component_name="GearContact",
    base_record="GearContact",
    make_records=_make_records,
    make_template_texts=lambda contact: {"end": f"{contact.max_load / 1e3:g} kN"},
)
"""Modelica component of the gear contact."""
