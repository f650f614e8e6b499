"""The example systems: `models/systems/*.toml`, the same numbers for every tool."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files

from jointfmu.joints import KINDS
from jointfmu.parameters import ORIGINS
from jointfmu.units import UNITS

SCHEMA = 1
SYSTEMS = ("robot_joint", "bolted_column")


@dataclass(frozen=True, slots=True)
class System:
    """One system.

    joint  : kind of its joint, whose default parameter file it uses
    name   : title
    values : {structured name: SI value}
    units, sources : {structured name: text}
    """

    joint: str
    name: str
    values: Mapping[str, float]
    units: Mapping[str, str]
    sources: Mapping[str, str]


def system(name: str) -> System:
    """Read and check one of SYSTEMS.

    Raises ValueError with one line that names the entry and what is allowed.
    """
    if name not in SYSTEMS:
        raise ValueError(f"system = {name!r}, allowed are {', '.join(SYSTEMS)}")
    path = files("jointfmu_models") / "systems" / f"{name}.toml"
    document = tomllib.loads(path.read_text(encoding="utf-8"))
    if document.get("schema") != SCHEMA or document.get("joint") not in KINDS:
        raise ValueError(f"{path}: schema or joint missing; expected schema = {SCHEMA} and a joint")
    values, units, sources = {}, {}, {}
    for group, entries in document.items():
        if not isinstance(entries, dict):
            continue
        for key, entry in entries.items():
            label = f"{group}.{key}"
            if entry["unit"] not in UNITS or entry["kind"] not in ORIGINS or not entry["source"]:
                raise ValueError(
                    f"{path}: {label}: expected a unit of {', '.join(UNITS)}, a kind and a source"
                )
            values[label], units[label] = float(entry["value"]), entry["unit"]
            sources[label] = entry["source"]
    return System(document["joint"], document["name"], values, units, sources)
