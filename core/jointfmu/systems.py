"""The example systems: `models/systems/*.toml`, the same numbers for every tool."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files

from .joints import KINDS
from .parameters import ORIGINS
from .units import UNITS

SCHEMA = 1
_PARAMETERS, _STATE = "joint_parameters.", "joint_state."


@dataclass(frozen=True, slots=True)
class System:
    """One system.

    joint  : kind of its joint, whose default parameter file it uses
    name   : title
    body   : structured name of the inertia that rings on the joint
    load   : variable of the joint over which it rings
    values : {structured name: SI value}
    units, sources : {structured name: text}
    """

    joint: str
    name: str
    body: str
    load: str
    values: Mapping[str, float]
    units: Mapping[str, str]
    sources: Mapping[str, str]

    @property
    def inertia(self) -> float:
        """Of the body [kg or kg.m2]."""
        return self.values[self.body]

    @property
    def inertia_unit(self) -> str:
        """Unit of the body's inertia."""
        return self.units[self.body]

    @property
    def load_unit(self) -> str:
        """Unit of the load."""
        return KINDS[self.joint].variables[self.load].unit

    @property
    def joint_parameters(self) -> dict[str, float]:
        """{parameter of the joint: value} that differ from its parameter file, SI."""
        return {
            name.removeprefix(_PARAMETERS): value
            for name, value in self.values.items()
            if name.startswith(_PARAMETERS)
        }

    @property
    def joint_state(self) -> dict[str, float]:
        """{input of the joint: value} at which the system holds its joint, SI."""
        return {
            name.removeprefix(_STATE): value for name, value in self.values.items() if name.startswith(_STATE)
        }


def names() -> tuple[str, ...]:
    """The systems that there are, by name: one file each."""
    paths = (files("jointfmu_models") / "systems").iterdir()
    return tuple(sorted(path.name.removesuffix(".toml") for path in paths if path.name.endswith(".toml")))


def systems() -> dict[str, System]:
    """{name: system} of all, in the order of their joints.

    Raises what `system` raises.
    """
    order = list(KINDS)
    every = [(name, system(name)) for name in names()]
    return dict(sorted(every, key=lambda entry: order.index(entry[1].joint)))


def system(name: str) -> System:
    """Read and check one of `names()`.

    Raises ValueError with one line that names the entry and what is allowed.
    """
    if name not in names():
        raise ValueError(f"system = {name!r}, allowed are {', '.join(names())}")
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
            value = entry["value"]
            values[label] = value if isinstance(value, bool) else float(value)
            units[label] = entry["unit"]
            sources[label] = entry["source"]
    for key, allowed in (("body", values), ("load", KINDS[document["joint"]].variables)):
        if document.get(key) not in allowed:
            raise ValueError(f"{path}: {key} = {document.get(key)!r}, allowed are {', '.join(allowed)}")
    return System(
        joint=document["joint"],
        name=document["name"],
        body=document["body"],
        load=document["load"],
        values=values,
        units=units,
        sources=sources,
    )
