"""What a joint's file `catalogue.py` gives: bought joints whose published numbers ship with the package."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple


class Printed(NamedTuple):
    """A number [SI], where it comes from (one of parameters.ORIGINS), and the source.

    bound    : it is printed as an upper limit, not as a value
    interval : of an estimate [SI], where it is known
    """

    value: float
    kind: str
    source: str
    bound: bool = False
    interval: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Column:
    """A number of the joints of a catalogue: name, SI unit, meaning, and the unit that it is shown in."""

    name: str
    unit: str
    text: str
    shown: str


@dataclass(frozen=True, slots=True)
class Item:
    """A joint of a catalogue: its name, and its numbers by column, where they are known."""

    name: str
    numbers: dict[str, Printed]


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """CATALOGUE of the file catalogue.py in a joint's folder.

    columns : of every joint, in the order in which they are shown
    items   : the joints, in the order of the catalogue
    """

    columns: Sequence[Column]
    items: Callable[[], Sequence[Item]]
