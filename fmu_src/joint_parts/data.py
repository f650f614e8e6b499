"""Split of a joint's parameters into FMU variables, data, and values that the C code depends on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from jointfmu.quantity import Array

from .interface_table import find_code_parameter_class, replace_table_points


class DataTable(NamedTuple):
    """Table of numbers in data.c of an FMU, n rows and k columns, computed from the joint's parameters.

    table_rows    : (n, k) numbers
    max_row_count : largest number n of rows; data.c reserves space for it
    is_integer    : whether the numbers are 2-byte integers; the size of a row is then a multiple of 8 bytes
    """

    table_rows: Array
    max_row_count: int
    is_integer: bool = False


DataTables = Mapping[str, DataTable]
"""{name: table} that the C code of a joint reads."""
NO_DATA_TABLES: DataTables = {}
"""Tables of a joint whose C code reads none."""


@dataclass(frozen=True, slots=True)
class DataConversion:
    """Conversion of those parameters of a joint that are no FMU variables into numbers in the file data.c.

    By default real numbers and the points of the law `table` are written to data.c. The other C files are
    generated for given values of choices, series and integers.

    convert_parameters   : (parameter set) -> {structured name: value} of the parameter set with which the
        C code is generated
    find_parameter_class : (parameter set) -> class of this parameter set
    make_data_tables     : (parameter set) -> {name: table} that the C code reads as `data.NAME` with
        `data.n_NAME` rows
    """

    convert_parameters: Callable[..., Mapping[str, Any]] = replace_table_points
    find_parameter_class: Callable[..., type[object]] = find_code_parameter_class
    make_data_tables: Callable[..., DataTables] = lambda values: NO_DATA_TABLES


class ParameterSplit(NamedTuple):
    """Parameters of an FMU in three groups: FMU variables, numbers in data.c, values in the other C files.

    variable_names         : names of FMU variables, which a simulation tool can set
    data_struct_values     : {name: value} of real numbers in data.c
    code_generation_values : {name: value} on which the other generated C files depend
    parameter_class        : class of the parameter set with which the code is generated
    data_tables            : {name: table of numbers} in data.c
    """

    variable_names: Sequence[str]
    data_struct_values: Mapping[str, float]
    code_generation_values: Mapping[str, object]
    parameter_class: type[object]
    data_tables: DataTables

    @property
    def code_structure_key(self) -> str:
        """Text that is equal for all parameter files with the same generated C code, except data.c."""
        shapes = {
            name: (table.max_row_count, table.table_rows.shape[1]) for name, table in self.data_tables.items()
        }
        return repr(
            (
                sorted(self.code_generation_values.items()),
                list(self.data_struct_values),
                sorted(shapes.items()),
            )
        )
