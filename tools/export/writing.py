"""Contents of exported files: numbers of a joint with a comment at the head, for each format."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile

from . import ansys, keywords, tables
from .exports import LoadCurve, required
from .mesh import Mesh
from .placing import Placing, Springs, Units


@dataclass(frozen=True, slots=True)
class Written:
    """Content of an exported file, facts about it for the user, and warnings."""

    text: str
    facts: dict[str, object]
    warnings: tuple[str, ...] = ()


_SPRINGS: dict[str, tuple[Callable[[Springs, Placing, list[str]], str], tuple[str, ...]]] = {
    "ansys": (ansys.springs_text, ("MATRIX27, KEYOPT(3) = 4 stiffness, 5 damping",)),
    "calculix": (
        partial(keywords.springs_text, dashpots=False),
        ("no dashpots: CalculiX has none along an axis between coincident nodes",),
    ),
    "abaqus": (partial(keywords.springs_text, dashpots=True), ()),
    "csv": (tables.springs_csv, ()),
}
"""{format: (function that formats springs, comment lines)}."""
_FAR = f"the last row extrapolates the last tangent by {keywords.FAR:g} m"
_CONTACTS: dict[str, tuple[Callable[[tables.LoadTable, Units, list[str]], str], tuple[str, ...]]] = {
    "calculix": (
        partial(keywords.contact_text, most=keywords.CALCULIX_ROWS),
        (_FAR, "for TYPE=NODE TO SURFACE: face to face CalculiX 2.20 takes no pressure from a table"),
    ),
    "abaqus": (keywords.contact_text, (_FAR,)),
    "csv": (tables.contact_csv, ()),
}
"""{format: (function that formats a contact, comment lines)}."""


def springs(form: str, file: ParameterFile, state: object, mesh: Mesh | None, placing: Placing) -> Written:
    """Export springs and dashpots of a joint between node pairs.

    working_point : None if the mesh states the pressures
    mesh          : node pairs of the user; None: nodes of the joint

    Raises ValueError if the joint offers no springs, or they do not fit the node pairs.
    """
    field, where = required(file.joint, "springs")(file.values, state, mesh, placing)
    units = placing.units
    sums = ", ".join(f"{n} {v:.9g} {'N/m' if n[0] == 'K' else 'N.s/m'}" for n, v in field.sums.items())
    about = [
        f"springs of a {KINDS[file.joint].title} between node pairs, linear about a working point",
        f"parameters: {file.name} ({file.joint})",
        f"working point: {where}",
        f"units: {units.name}",
        f"pairs: {len(field.nodes)}, left out because they are open: {field.opened}",
        f"sums over the pairs, SI: {sums}",
        f"stiffness multiplied by {field.correction:.9g} to add up to the joint's",
        f"the joint's normal is the model's {placing.normal}",
    ]
    write, notes = _SPRINGS[form]
    facts = {"pairs": len(field.nodes), "open": field.opened, "correction": field.correction, **field.sums}
    return Written(write(field, placing, [*about, *notes]), facts)


def contact(form: str, file: ParameterFile, units: Units, error: float) -> Written:
    """Export the interface's pressure over its approach, for a contact of two surfaces.

    Raises ValueError if the joint does not offer it.
    """
    curve, more = required(file.joint, "contact")(file.values)
    table = tables.law_table(curve, error)
    about = [
        "normal contact of the rough interface: pressure over overclosure from first touch",
        f"parameters: {file.name} ({file.joint})",
        f"units: {units.name}",
        f"straight lines keep to the law's pressure within {table.straight[0]:.2g}, to its stiffness within "
        f"{table.straight[1]:.2g},",
        f"from {curve.closed:.4g} Pa (below, one line leads to first touch) to {curve.end[1]:.4g} Pa",
        *more,
    ]
    write, notes = _CONTACTS[form]
    return Written(write(table, units, [*about, *notes]), _facts(table))


def curve(form: str, file: ParameterFile, state: object, units: Units, error: float) -> Written:
    """Export the load over the displacement of the whole joint, with its stiffness.

    Raises ValueError if the joint does not offer the curve, or if the working point is missing.
    """
    load: LoadCurve = required(file.joint, "curve")
    table = load.table(file.values, state, error)
    heads = [(v.name, v.unit) for v in load.columns]
    about = [load.meaning, f"parameters: {file.name} ({file.joint})"]
    if state is not None:
        about.append(f"working point: {state}")
    about += [
        "columns: " + ", ".join(f"{n} [{units.symbol(u)}]" for n, u in heads),
        f"straight lines keep to the load within {table.straight[0]:.2g}, to the stiffness within "
        f"{table.straight[1]:.2g};",
        f"the monotone cubic of Fritsch and Butland within {table.monotone[0]:.2g} and "
        f"{table.monotone[1]:.2g}",
    ]
    if form == "modelica":
        facts = {"table": load.name, **_facts(table)}
        return Written(tables.modelica_text(table.rows, load.name, about), facts, _warnings(table))
    return Written(tables.columns_csv([*table.rows.T], heads, units, about), _facts(table), _warnings(table))


def _warnings(table: tables.LoadTable) -> tuple[str, ...]:
    """Warn if the slope of the table differs from the stiffness by more than MAX_STIFFNESS_ERROR."""
    straight, cubic = table.straight[1], table.monotone[1]
    if straight <= tables.STIFFNESS:
        return ()
    return (
        f"the table's slope is up to {100.0 * straight:.2g} % off the stiffness by straight lines and "
        f"{100.0 * cubic:.2g} % by a monotone cubic; a smaller --error has more rows",
    )


def _facts(table: tables.LoadTable) -> dict[str, object]:
    return {
        "rows": len(table.rows),
        "error": table.straight[0],
        "stiffness_error": table.straight[1],
        "error_monotone": table.monotone[0],
        "stiffness_error_monotone": table.monotone[1],
    }
