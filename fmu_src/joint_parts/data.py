"""What a joint says of its parameters: which numbers are data beside its C, and which tables."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from jointfmu.quantity import Array, flatten


class DataTable(NamedTuple):
    """Rows (n, k) of numbers that parameters decide, of which there is room for `most`.

    digits : whether they are whole and have two bytes; a row of them is a multiple of 8 bytes
    """

    rows: Array
    most: int
    digits: bool = False


Tables = Mapping[str, DataTable]
NO_TABLES: Tables = {}


@dataclass(frozen=True, slots=True)
class DataPart:
    """How those parameters that no tool may change become data: `Parts.data`.

    Without it every real number is data as it is, and all else (choices, series, whole numbers) is code.

    stands : (parameter set) -> {structured name: value} of one that stands for it in the generated code
    of     : (parameter set) -> the class of that one
    tables : (parameter set) -> {name: table} that its C reads, `data.NAME` with `data.n_NAME` rows
    """

    stands: Callable[..., Mapping[str, Any]] = flatten
    of: Callable[..., type[object]] = type
    tables: Callable[..., Tables] = lambda values: NO_TABLES


class Split(NamedTuple):
    """Parameters of an FMU by what they are in C.

    exposed : variables, which a tool sets
    fixed   : {name: value} numbers of the block
    code    : {name: value} what the generated code depends on
    of      : class of the parameter set that the code is generated with
    tables  : {name: table} of the block
    """

    exposed: Sequence[str]
    fixed: Mapping[str, float]
    code: Mapping[str, object]
    of: type[object]
    tables: Tables

    @property
    def structure(self) -> str:
        """What parameter files with the same code have in common, as text."""
        rooms = {name: (table.most, table.rows.shape[1]) for name, table in self.tables.items()}
        return repr((sorted(self.code.items()), list(self.fixed), sorted(rooms.items())))
