"""Gear mesh in the Modelica library: tables of force and energy of a tooth pair over its deflection."""

from collections.abc import Sequence

from jointfmu.joints.gear_mesh.spring import GearMeshSpring, Mesh
from jointfmu.parameters import ParameterFile

from ....modelica.records import (
    COMPUTED,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    computed,
    curve_of,
    given,
    identifier,
    number,
    thinned,
)


def _records(file: ParameterFile, points: Sequence[WorkingPoint]) -> list[ModelicaRecord]:
    spring = GearMeshSpring.of(file.values)
    table = thinned(spring.curve)
    energy = curve_of(table).energy(table.rows[:, 0])
    values = given(_wheels(spring.joint)) | computed({"closing": spring.closing})
    nodes = "{\n      " + ",\n      ".join(number(x, COMPUTED) for x in energy.tolist()) + "}"
    return [
        ModelicaRecord(
            name=identifier(file.name), title=file.name, table=table, values={**values, "energy": nodes}
        )
    ]


def _wheels(mesh: Mesh) -> dict[str, float]:
    names = ("r_b1", "r_b2", "teeth1", "backlash", "contact_ratio", "engagement", "d", "overlap_ratio")
    return {name: getattr(mesh, name) for name in names}


COMPONENT = ModelicaComponent(
    name="GearMesh", base="GearMesh", records=_records, texts=lambda mesh: {"end": f"{mesh.end / 1e3:g} kN"}
)
