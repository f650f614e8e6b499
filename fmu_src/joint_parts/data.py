"""Split of a joint's parameters into FMU variables, data, and values that the C code depends on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from jointfmu.quantity import Array

from .interface_table import find_code_class, replace_points


class DataTable(NamedTuple):
    """Table (n, k) of numbers in the data block of an FMU, computed from the parameters.

    max_rows   : largest number of rows; the data block reserves space for it
    is_integer : whether the numbers are 2-byte integers; the size of a row is then a multiple of 8 bytes
    """

    rows: Array
    max_rows: int
    is_integer: bool = False


Tables = Mapping[str, DataTable]
"""{name: table} that the C code of a joint reads."""
EMPTY_TABLES: Tables = {}
"""Tables of a joint whose C code reads none."""


@dataclass(frozen=True, slots=True)
class DataConversion:
    """Conversion of parameters that are not FMU variables into data: `FmuParts.data_conversion`.

    By default every real number is data, and so are the points of the law `table`. All other values (choices,
    series, integers) select the C code.

    convert_parameters   : (parameter set) -> {structured name: value} of the parameter set that replaces it
        in the C code
    find_parameter_class : (parameter set) -> class of the replacing parameter set
    make_tables          : (parameter set) -> {name: table} that the C code reads as `data.NAME` with
        `data.n_NAME` rows
    """

    convert_parameters: Callable[..., Mapping[str, Any]] = replace_points
    find_parameter_class: Callable[..., type[object]] = find_code_class
    make_tables: Callable[..., Tables] = lambda values: EMPTY_TABLES


class ParameterSplit(NamedTuple):
    """Parameters of an FMU, divided by their role in C.

    variable_names  : names of FMU variables, which a simulation tool can set
    data_values     : {name: value} of real numbers in the data block
    code_values     : {name: value} on which the generated code depends
    parameter_class : class of the parameter set with which the code is generated
    tables          : {name: table} in the data block
    """

    variable_names: Sequence[str]
    data_values: Mapping[str, float]
    code_values: Mapping[str, object]
    parameter_class: type[object]
    tables: Tables

    @property
    def code_structure_key(self) -> str:
        """Text that is equal for all parameter files with the same generated C code (the same structure)."""
        shapes = {name: (table.max_rows, table.rows.shape[1]) for name, table in self.tables.items()}
        return repr((sorted(self.code_values.items()), list(self.data_values), sorted(shapes.items())))
