"""One file of each kind: the numbers of a joint, its comment, its text."""

from dataclasses import dataclass
from typing import Any

from ..joints.bolted_joint.spring import BoltedJointSpring, shear_ratio
from ..joints.gear_contact.spring import GearContactSpring
from ..joints.harmonic_drive.spring import HarmonicDriveSpring
from ..parameters import ParameterFile
from . import ansys, columns, keywords, tables
from .mesh import Mesh
from .placing import Placing
from .springs import Springs, of_joint, on_mesh, under_pressure
from .units import Units


@dataclass(frozen=True, slots=True)
class Written:
    """The text of a file and what is worth saying about it."""

    text: str
    facts: dict[str, Any]


@dataclass(frozen=True, slots=True)
class State:
    """Working point of a bolted joint: preload [N] per bolt, moment [N.m]."""

    preload: float
    moment: float

    def __str__(self) -> str:
        return f"preload {self.preload:g} N per bolt, moment {self.moment:g} N.m"


def springs(
    form: str, file: ParameterFile, state: State | None, mesh: Mesh | None, placing: Placing
) -> Written:
    """Springs (and dashpots) of a bolted joint between node pairs.

    state : working point, or None where the mesh states the pressures
    mesh  : the user's node pairs, or None for the joint's own nodes
    """
    spring = BoltedJointSpring.of(file.values)
    found, where = _springs(spring, state, mesh, placing)
    units = placing.units
    sums = ", ".join(f"{n} {v:.9g} {'N/m' if n[0] == 'K' else 'N.s/m'}" for n, v in found.sums.items())
    about = [
        "springs of a bolted joint between node pairs, linear about a working point",
        f"parameters: {file.name} ({file.joint})",
        f"working point: {where}",
        f"units: {units.name}",
        f"pairs: {len(found.nodes)}, left out because they are open: {found.opened}",
        f"sums over the pairs, SI: {sums}",
        f"stiffness multiplied by {found.correction:.9g} to add up to the joint's",
        f"the joint's normal is the model's {placing.normal}",
    ]
    if form == "ansys":
        text = ansys.springs_text(found, placing, [*about, "MATRIX27, KEYOPT(3) = 4 stiffness, 5 damping"])
    elif form == "csv":
        text = columns.springs_csv(found, placing, about)
    else:
        if form == "calculix":
            about.append("no dashpots: CalculiX has none along an axis between coincident nodes")
        text = keywords.springs_text(found, placing, about, dashpots=form == "abaqus")
    facts = {"pairs": len(found.nodes), "open": found.opened, "correction": found.correction, **found.sums}
    return Written(text, facts)


def _springs(
    spring: BoltedJointSpring, state: State | None, mesh: Mesh | None, placing: Placing
) -> tuple[Springs, str]:
    if state is None:
        if mesh is None:
            raise ValueError("springs need a preload, or node pairs with their pressure")
        return under_pressure(spring, mesh), f"pressures of {mesh.path.name}"
    if mesh is None:
        return of_joint(spring, state.preload, state.moment, placing.first), str(state)
    return on_mesh(spring, mesh, state.preload, state.moment), f"{state}, on the nodes of {mesh.path.name}"


def contact(form: str, file: ParameterFile, units: Units, error: float) -> Written:
    """The interface's pressure over its approach, for a contact of two surfaces."""
    if file.joint == "harmonic_drive":
        raise ValueError(
            "the contact of a harmonic_drive cannot be exported: only with pair_scale and drive_scale does "
            "it give the drive's stiffness; export its curve"
        )
    kind = BoltedJointSpring if file.joint == "bolted_joint" else GearContactSpring
    curve = kind.of(file.values).curve
    table = tables.law_table(curve, error)
    about = [
        "normal contact of the rough interface: pressure over overclosure from first touch",
        f"parameters: {file.name} ({file.joint})",
        f"units: {units.name}",
        f"straight lines keep to the law's pressure within {table.straight[0]:.2g}, to its stiffness within "
        f"{table.straight[1]:.2g},",
        f"from {curve.closed:.4g} Pa (below, one line leads to first touch) to {curve.end[1]:.4g} Pa",
    ]
    if file.joint == "bolted_joint":
        ratio = float(shear_ratio(file.values))
        about.append(f"tangential stiffness of the law: {ratio:.9g} times the slope of the table")
    if form == "csv":
        heads = (("overclosure", "m"), ("pressure", "Pa"), ("stiffness", "N/m3"))
        text = columns.table_csv(table.rows, heads, units, about)
    else:
        about.append(f"the last row is {keywords.FAR:g} m further on the last tangent")
        most = None
        if form == "calculix":
            most = keywords.CALCULIX_ROWS
            about.append(
                "for TYPE=NODE TO SURFACE: face to face CalculiX 2.20 takes no pressure from a table"
            )
        text = keywords.contact_text(table, units, about, most)
    return Written(text, _facts(table))


def curve(form: str, file: ParameterFile, state: State | None, units: Units, error: float) -> Written:
    """Load over displacement of the whole joint, with its stiffness."""
    about = [f"parameters: {file.name} ({file.joint})"]
    table, heads, name = _curve(file, state, error)
    if state is not None:
        about.append(f"working point: {state}")
    about += [
        "columns: " + ", ".join(f"{n} [{units.symbol(u)}]" for n, u in heads),
        f"straight lines keep to the load within {table.straight[0]:.2g}, to the stiffness within "
        f"{table.straight[1]:.2g};",
        f"the monotone cubic of Fritsch and Butland within {table.monotone[0]:.2g} and "
        f"{table.monotone[1]:.2g}",
    ]
    about.insert(0, _MEANING[file.joint])
    if form == "modelica":
        return Written(columns.modelica_text(table.rows, name, about), {"table": name, **_facts(table)})
    return Written(columns.table_csv(table.rows, heads, units, about), _facts(table))


_MEANING = {
    "harmonic_drive": "torque over wind-up at the output, wave generator locked",
    "gear_contact": "normal load over approach of the flanks from first touch; without load while apart",
    "bolted_joint": "force that holds the joint together over its separation from the tightened state; "
    "without damping",
}


def _curve(file: ParameterFile, state: State | None, error: float) -> tuple[tables.Table, columns.Heads, str]:
    if file.joint == "harmonic_drive":
        drive = HarmonicDriveSpring.of(file.values)
        heads = (("phi_rel", "rad"), ("tau", "N.m"), ("K_WTS", "N.m/rad"))
        return tables.odd_table(drive.curve, error), heads, "torque"
    if file.joint == "gear_contact":
        gear = GearContactSpring.of(file.values)
        heads = (("s_rel", "m"), ("f", "N"), ("K_N", "N/m"))
        return tables.load_table(gear.curve, file.values.A_0, error), heads, "force"
    if state is None:
        raise ValueError("the curve of a bolted_joint needs a preload")
    heads = (("s_rel_z", "m"), ("pull", "N"), ("K_zz", "N/m"))
    spring = BoltedJointSpring.of(file.values)
    return tables.pull_table(spring, state.preload, state.moment, error), heads, "force"


def _facts(table: tables.Table) -> dict[str, Any]:
    return {
        "rows": len(table.rows),
        "error": table.straight[0],
        "stiffness_error": table.straight[1],
        "error_monotone": table.monotone[0],
        "stiffness_error_monotone": table.monotone[1],
    }
