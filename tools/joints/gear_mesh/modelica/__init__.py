"""Gear mesh in the Modelica library: tables of force and energy of a tooth pair over its deflection."""

from collections.abc import Sequence

from jointfmu.joints.gear_mesh.spring import GearMeshSpring, MeshParameters
from jointfmu.parameters import ParameterFile

from ....exchange.modelica.records import (
    COMPUTED_DIGITS,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    decimate_curve,
    format_computed_values,
    format_double_literal,
    format_parameter_values,
    make_curve_of_table,
    make_identifier,
)


def _make_records(
    parameter_file: ParameterFile, working_points: Sequence[WorkingPoint]
) -> list[ModelicaRecord]:
    """Make the Modelica records of a parameter file; the gear mesh has one."""
    spring = GearMeshSpring.tabulate(parameter_file.values)
    table = decimate_curve(spring.curve)
    energy = make_curve_of_table(table).energy(table.table_rows[:, 0])
    values = format_parameter_values(_wheel_parameters(spring.joint)) | format_computed_values(
        {"closing": spring.closing_end_deflection}
    )
    nodes = (
        "{\n      "
        + ",\n      ".join(format_double_literal(x, COMPUTED_DIGITS) for x in energy.tolist())
        + "}"
    )
    return [
        ModelicaRecord(
            record_name=make_identifier(parameter_file.name),
            record_title=parameter_file.name,
            interpolation_table=table,
            value_expressions={**values, "energy": nodes},
        )
    ]


def _wheel_parameters(mesh_parameters: MeshParameters) -> dict[str, float]:
    """Parameters of the Modelica component that describe the wheels."""
    names = ("r_b1", "r_b2", "teeth1", "backlash", "contact_ratio", "engagement", "d", "overlap_ratio")
    return {name: getattr(mesh_parameters, name) for name in names}


MODELICA_COMPONENT = ModelicaComponent(
    component_name="GearMesh",
    base_record="GearMesh",
    make_records=_make_records,
    make_template_texts=lambda mesh: {"end": f"{mesh.max_load / 1e3:g} kN"},
)
"""Modelica component of the gear mesh."""
