"""Catalogue of bought joints with their manufacturers' numbers: `catalogue.py` in the folder of a joint."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple


class SourcedNumber(NamedTuple):
    """A number with its source.

    value    : [SI]
    kind     : origin, one of parameters.ORIGINS
    source   : document, table or estimate that the number is taken from
    bound    : whether the number is printed as an upper limit, not as a value
    interval : lower and upper end of an estimate [SI]; None if unknown
    """

    value: float
    kind: str
    source: str
    bound: bool = False
    interval: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class CatalogueColumn:
    """A column of a catalogue: name, SI unit, meaning, and display unit."""

    name: str
    unit: str
    meaning: str
    display_unit: str


@dataclass(frozen=True, slots=True)
class CatalogueEntry:
    """An entry of a catalogue: name of the joint, and {column: number} of the known numbers."""

    name: str
    numbers: dict[str, SourcedNumber]


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """Catalogue of one kind of joint: the constant CATALOGUE in `catalogue.py` of the joint's folder.

    columns : columns in display order
    entries : function that returns the joints in the order of the printed catalogue
    """

    columns: Sequence[CatalogueColumn]
    entries: Callable[[], Sequence[CatalogueEntry]]
