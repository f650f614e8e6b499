"""Entries of a catalogue of bought joints: published numbers of makers with their sources."""

from dataclasses import dataclass
from typing import NamedTuple


class SourcedNumber(NamedTuple):
    """Number with its origin (catalogue, estimate, ...) and its source.

    si_value          : number in SI units
    value_origin      : one of parameters.VALUE_ORIGINS
    value_source      : document, table or estimate that the number is taken from
    is_upper_limit    : whether the catalogue states the number as an upper limit of the quantity
    estimate_interval : lower and upper end of an estimate [SI]; None if unknown
    """

    si_value: float
    value_origin: str
    value_source: str
    is_upper_limit: bool = False
    estimate_interval: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class CatalogueColumn:
    """Column of a catalogue of bought joints: name, SI unit, meaning, and display unit."""

    column_name: str
    si_unit: str
    column_meaning: str
    display_unit: str


@dataclass(frozen=True, slots=True)
class CatalogueEntry:
    """Entry of a catalogue of bought joints: name of the joint, {column name: number} of known numbers."""

    joint_name: str
    known_numbers: dict[str, SourcedNumber]
