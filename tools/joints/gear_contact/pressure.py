"""How the load presses on the flanks."""

from jointfmu.joints.gear_contact.spring import GearContact

from ...pressure import NominalPressure


def _pressure(contact: GearContact, load: float) -> float:
    return load / contact.A_0


PRESSURE = NominalPressure(
    load="f",
    usual=lambda contact: min(3e3, 0.1 * contact.hardness * contact.A_0),
    mean=_pressure,
    peak=_pressure,
)
