"""The gear contact in the laboratory: its flanks only press."""

from ...laboratory.part import LaboratoryModel

LABORATORY = {"GearContact": LaboratoryModel(spans={"f": (0.0, 3e3)})}
"""{FMU: what the page shows beside its variables}."""
