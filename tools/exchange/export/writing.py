"""Contents of exported files: numbers of a joint with a comment at the head, for each format."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from . import ansys, aster, keywords, nastran, tables
from .exports import DEFAULT_MAX_LOAD_ERROR, LoadCurveExport, require_export
from .joint_stiffness import JointStiffness, describe_joint_stiffness
from .mesh import NodePairs
from .target_model import Springs, TargetModel, UnitSet


@dataclass(frozen=True, slots=True)
class ExportedFile:
    """Text of an exported file, numbers of it to print {name: value}, and warnings."""

    file_text: str
    printed_quantities: dict[str, object]
    warnings: tuple[str, ...] = ()


_SPRING_WRITERS: dict[str, tuple[Callable[[Springs, TargetModel, list[str]], str], tuple[str, ...]]] = {
    "ansys": (ansys.format_springs, ("MATRIX27, KEYOPT(3) = 4 stiffness, 5 damping",)),
    "calculix": (
        partial(keywords.format_springs, writes_dashpots=False),
        ("no dashpots: CalculiX has none along an axis between coincident nodes",),
    ),
    "abaqus": (partial(keywords.format_springs, writes_dashpots=True), ()),
    "csv": (tables.format_springs_csv, ()),
}
"""{format: (function that formats springs, comment lines)}."""
_EXTRAPOLATION_NOTE = (
    f"the last row extrapolates the last tangent by {keywords.TABLE_EXTENSION_OVERCLOSURE:g} m"
)
"""Comment line of a table that ends with an extrapolated row."""
_CONTACT_WRITERS: dict[str, tuple[Callable[[tables.LoadTable, UnitSet, list[str]], str], tuple[str, ...]]] = {
    "calculix": (
        partial(keywords.format_contact, max_table_rows=keywords.MAX_CALCULIX_TABLE_ROWS),
        (
            _EXTRAPOLATION_NOTE,
            "for TYPE=NODE TO SURFACE: face to face CalculiX 2.20 takes no pressure from a table",
        ),
    ),
    "abaqus": (keywords.format_contact, (_EXTRAPOLATION_NOTE,)),
    "csv": (tables.format_contact_csv, ()),
}
"""{format: (function that formats a contact, comment lines)}."""


_MAX_CONTACT_ROWS = {"calculix": keywords.MAX_CALCULIX_TABLE_ROWS}
"""{format: largest number of rows of a contact table, with the extrapolated row}."""


def export_springs(
    file_format: str,
    parameter_file: ParameterFile,
    working_point: object,
    node_pairs: NodePairs | None,
    target_model: TargetModel,
) -> ExportedFile:
    """Export springs and dashpots of a joint between node pairs.

    working_point : None if the mesh states the pressures
    node_pairs    : node pairs of the user; None: nodes of the joint

    Raises ValueError if the joint offers no springs, or they do not fit the node pairs.
    """
    field, where = require_export(parameter_file.joint, "springs")(
        parameter_file.values, working_point, node_pairs, target_model
    )
    units = target_model.unit_set
    sums = ", ".join(
        f"{n} {v:.9g} {'N/m' if n[0] == 'K' else 'N.s/m'}"
        for n, v in field.total_stiffness_and_damping.items()
    )
    about = [
        f"springs of a {KINDS[parameter_file.joint].title} between node pairs, linear about a working point",
        f"parameters: {parameter_file.name} ({parameter_file.joint})",
        f"working point: {where}",
        f"units: {units.unit_set_name}",
        f"pairs: {len(field.node_labels)}, left out because they are open: {field.open_pair_count}",
        f"sums over the pairs, SI: {sums}",
        f"stiffness multiplied by {field.stiffness_correction_factor:.9g} to add up to the joint's",
        f"the joint's normal is the model's {target_model.joint_normal_axis}",
    ]
    write, notes = _SPRING_WRITERS[file_format]
    facts = {
        "pairs": len(field.node_labels),
        "open": field.open_pair_count,
        "correction": field.stiffness_correction_factor,
    }
    facts |= field.total_stiffness_and_damping
    return ExportedFile(write(field, target_model, [*about, *notes]), facts)


_STIFFNESS_WRITERS: dict[str, Callable[[JointStiffness, TargetModel, list[str]], str]] = {
    "ansys": ansys.format_joint_stiffness,
    "calculix": keywords.format_coupled_springs,
    "abaqus": keywords.format_user_element,
    "nastran": nastran.format_joint_stiffness,
    "aster": aster.format_joint_stiffness,
}
"""{format in STIFFNESS_FORMATS: function that formats the stiffness matrix of a complete joint}."""


def export_stiffness(
    file_format: str,
    parameter_file: ParameterFile,
    working_point: object,
    node_positions: Array,
    target_model: TargetModel,
) -> ExportedFile:
    """Export the stiffness matrix of a complete joint between two nodes.

    node_positions : (2, 3) of the nodes of side 1 and side 2 from the centroid of the contact, along the
                     model's axes and in its units

    Raises ValueError if the joint has no stiffness matrix to export, or if the working point is outside the
    law.
    """
    tangent = require_export(parameter_file.joint, "stiffness")(parameter_file.values, working_point)
    positions = node_positions / target_model.unit_set.convert_from_si(1.0, "m")
    stiffness = JointStiffness.from_tangent_stiffness(tangent, positions)
    about = [
        f"complete {KINDS[parameter_file.joint].title} between two nodes, linear about a working point",
        f"parameters: {parameter_file.name} ({parameter_file.joint})",
        f"working point: {working_point}",
        f"units: {target_model.unit_set.unit_set_name}",
        *describe_joint_stiffness(stiffness, target_model),
    ]
    facts: dict[str, object] = {**stiffness.diagonal_stiffness(), "coupling": stiffness.max_relative_coupling}
    return ExportedFile(_STIFFNESS_WRITERS[file_format](stiffness, target_model, about), facts)


def export_contact(
    file_format: str, parameter_file: ParameterFile, unit_set: UnitSet, max_load_error: float | None = None
) -> ExportedFile:
    """Export the interface's pressure as a function of approach, for a contact of two surfaces.

    max_load_error : largest relative error [1] of the pressure; None: DEFAULT_MAX_LOAD_ERROR, or the smallest
                     larger error whose table the solver can read

    Raises ValueError if the joint has no contact law to export, or if the table has more rows than the solver
    can read.
    """
    curve, more = require_export(parameter_file.joint, "contact")(parameter_file.values)
    table = tables.tabulate_law(curve, DEFAULT_MAX_LOAD_ERROR if max_load_error is None else max_load_error)
    warnings: tuple[str, ...] = ()
    limit = _MAX_CONTACT_ROWS.get(file_format)
    if max_load_error is None and limit is not None and len(table.table_rows) > limit - 1:
        rows = len(table.table_rows) + 1
        max_load_error, table = tables.tabulate_within_row_limit(
            lambda error: tables.tabulate_law(curve, error), DEFAULT_MAX_LOAD_ERROR, limit - 1
        )
        warnings = (
            f"error = {max_load_error:g}: smallest error whose table fits the {limit} rows of {file_format} "
            f"({DEFAULT_MAX_LOAD_ERROR:g} needs {rows} rows)",
        )
    about = [
        "normal contact of the rough interface: pressure over overclosure from first touch",
        f"parameters: {parameter_file.name} ({parameter_file.joint})",
        f"units: {unit_set.unit_set_name}",
        f"straight lines keep to the law's pressure within {table.linear_interpolation_errors[0]:.2g}, to "
        f"its stiffness within {table.linear_interpolation_errors[1]:.2g},",
        f"from {curve.closing_end_pressure:.4g} Pa (below, one line leads to first touch) to "
        f"{curve.end_point[1]:.4g} Pa",
        *more,
    ]
    write, notes = _CONTACT_WRITERS[file_format]
    return ExportedFile(
        write(table, unit_set, [*about, *warnings, *notes]), _list_table_errors(table), warnings
    )


def export_curve(
    file_format: str,
    parameter_file: ParameterFile,
    working_point: object,
    unit_set: UnitSet,
    max_load_error: float,
) -> ExportedFile:
    """Export load and stiffness of the complete joint as functions of displacement.

    Raises ValueError if the joint has no load curve to export, or if the working point is missing.
    """
    load: LoadCurveExport = require_export(parameter_file.joint, "curve")
    table = load.compute_table(parameter_file.values, working_point, max_load_error)
    heads = [(v.name, v.unit) for v in load.curve_variables]
    about = [load.curve_meaning, f"parameters: {parameter_file.name} ({parameter_file.joint})"]
    if working_point is not None:
        about.append(f"working point: {working_point}")
    about += [
        "columns: " + ", ".join(f"{n} [{unit_set.unit_symbol(u)}]" for n, u in heads),
        f"straight lines keep to the load within {table.linear_interpolation_errors[0]:.2g}, to the "
        f"stiffness within {table.linear_interpolation_errors[1]:.2g};",
        f"the monotone cubic of Fritsch and Butland within {table.monotone_cubic_errors[0]:.2g} and "
        f"{table.monotone_cubic_errors[1]:.2g}",
    ]
    if file_format == "modelica":
        facts = {"table": load.table_name, **_list_table_errors(table)}
        return ExportedFile(
            tables.format_modelica_table(table.table_rows, load.table_name, about),
            facts,
            _list_stiffness_warnings(table),
        )
    return ExportedFile(
        tables.format_columns_csv([*table.table_rows.T], heads, unit_set, about),
        _list_table_errors(table),
        _list_stiffness_warnings(table),
    )


def _list_stiffness_warnings(load_table: tables.LoadTable) -> tuple[str, ...]:
    """Warn if the slope of the table differs from the stiffness by more than MAX_STIFFNESS_ERROR."""
    straight, cubic = load_table.linear_interpolation_errors[1], load_table.monotone_cubic_errors[1]
    if straight <= tables.MAX_STIFFNESS_ERROR:
        return ()
    return (
        f"the slope of the table differs from the stiffness by up to {100.0 * straight:.2g} % with straight "
        f"lines and {100.0 * cubic:.2g} % with a monotone cubic; a smaller --error gives more rows",
    )


def _list_table_errors(load_table: tables.LoadTable) -> dict[str, object]:
    """List the row count of an exported table, and its interpolation errors of load and stiffness [1]."""
    return {
        "rows": len(load_table.table_rows),
        "error": load_table.linear_interpolation_errors[0],
        "stiffness_error": load_table.linear_interpolation_errors[1],
        "error_monotone": load_table.monotone_cubic_errors[0],
        "stiffness_error_monotone": load_table.monotone_cubic_errors[1],
    }
