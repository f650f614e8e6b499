"""Entries of a catalogue of bought joints: published numbers of makers with their sources."""

from dataclasses import dataclass
from typing import NamedTuple


class SourcedNumber(NamedTuple):
    """Number with its origin (catalogue, estimate, ...) and its source.

    value          : [SI]
    origin         : one of parameters.ORIGINS
    source         : document, table or estimate that the number is taken from
    is_upper_limit : whether the number is printed as an upper limit of the quantity, not as its value
    interval       : lower and upper end of an estimate [SI]; None if unknown
    """

    value: float
    origin: str
    source: str
    is_upper_limit: bool = False
    interval: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class CatalogueColumn:
    """Column of a catalogue of bought joints: name, SI unit, meaning, and display unit."""

    name: str
    unit: str
    meaning: str
    display_unit: str


@dataclass(frozen=True, slots=True)
class CatalogueEntry:
    """Entry of a catalogue of bought joints: name of the joint, and {column: number} of the known numbers."""

    name: str
    numbers: dict[str, SourcedNumber]
