"""How the load presses on the flanks of one tooth pair, which may carry all of it."""

from jointfmu.joints.gear_mesh.spring import GearMesh

from ...pressure import NominalPressure


def _pressure(mesh: GearMesh, load: float) -> float:
    return load / mesh.A_0


PRESSURE = NominalPressure(
    load="f", usual=lambda mesh: min(3e3, 0.1 * mesh.hardness * mesh.A_0), mean=_pressure, peak=_pressure
)
