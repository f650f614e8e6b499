"""The gear contact in the laboratory: its flanks only press."""

from ...laboratory.part import Bench

LABORATORY = {"GearContact": Bench(spans={"f": (0.0, 3e3)})}
"""{FMU: what the page shows beside its variables}."""
