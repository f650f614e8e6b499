"""The records of the package Data: one table per joint."""

from collections.abc import Mapping, Sequence
from typing import Any

from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile

from .tables import TOLERANCE, Table, Tightened, thinned, tightened
from .text import identifier, matrix, number, text

BASES = {"harmonic_drive": "HarmonicDrive", "bolted_joint": "BoltedJoint", "gear_contact": "GearContact"}


def records(
    joints: Mapping[str, ParameterFile], states: Sequence[tuple[float, float]]
) -> dict[str, dict[str, Any]]:
    """{name: content} of all records."""
    drive, gear, bolted = joints["harmonic_drive"], joints["gear_contact"], joints["bolted_joint"]
    found = {}
    table = thinned(HarmonicDriveSpring.of(drive.values).curve)
    values = {name: number(getattr(drive.values, name)) for name in ("ratio", "d", "K_FTS0")}
    found[identifier(drive.name)] = _record(drive, drive.name, table, values)
    spring = BoltedJointSpring.of(bolted.values)
    for state in states:
        tight = tightened(spring, *state)
        title = f"{bolted.name}, {_state(state)}"
        found[record_name(bolted.name, state)] = _record(
            bolted, title, tight.table, _tight_values(spring, tight)
        )
    contact = GearContactSpring.of(gear.values)
    table = thinned(contact.curve)
    table.rows[:, 0] -= contact.curve.displacement[0]
    table.rows[:, 1:] *= contact.joint.A_0
    found[identifier(gear.name)] = _record(gear, gear.name, table, {})
    return found


def _tight_values(spring: BoltedJointSpring, tight: Tightened) -> dict[str, str]:
    at_rest = spring.motion(tight.preload, tight.moment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    numbers = {
        "preload": tight.preload,
        "moment": tight.moment,
        "mass": spring.joint.mass,
        "shear": tight.shear,
        "eta_t": float(at_rest["eta_t"]),
    }
    return {k: number(x) for k, x in numbers.items()} | {"damping": matrix(tight.damping)}


def _record(file: ParameterFile, title: str, table: Table, values: Mapping[str, str]) -> dict[str, Any]:
    more = "; where the force is below the one at tightening, relative to that" if "preload" in values else ""
    return {
        "title": text(title),
        "base": BASES[file.joint],
        "values": {**values, "table": matrix(table.rows)},
        "about": text(f"From the parameters {title}."),
        "error": f"{max(table.error, TOLERANCE):.0e}",
        "more": more,
        "end": table.rows[-1, :2],
    }


def _state(state: tuple[float, float]) -> str:
    preload, moment = state
    return f"{preload / 1e3:g} kN per bolt" + (f" and {moment:g} N m" if moment else "")


def record_name(name: str, state: tuple[float, float]) -> str:
    """Name of the record of a bolted joint at a preload [N] and a moment [N.m]."""
    preload, moment = state
    return identifier(f"{name} {preload / 1e3:g} kN" + (f" {moment:g} Nm" if moment else ""))
