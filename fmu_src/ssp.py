"""`jointfmu build --systems`: the partners' FMUs, and `models/ssp/*.ssd` packed with all that they need."""

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, fromstring

from jointfmu.joints import MODELS
from jointfmu.parameters import ParameterFile, default
from jointfmu.progress import track
from jointfmu.systems import System, system, systems
from jointfmu.units import UNITS

from .archive import pack, workshop
from .native.build import build
from .partners import PARTNERS
from .partners import parameters as partner_parameters
from .xml_parts import VARIABILITIES, serialized

_SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
_NAMESPACES = {
    "xmlns:ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "xmlns:ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}
_LOADS = ("torque", "pulse")
"""Groups of a system's file that describe its load."""


def build_systems(
    out: Path, parameters: ParameterFile | None, joints: bool = True, variability: str = VARIABILITIES[0]
) -> list[Path]:
    """Write `out/ssp/SYSTEM.ssp`, and its partners as `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu`.

    parameters : of a joint, instead of its defaults: then only its systems are packed
    joints     : build the systems' joints beside the partners; else they are in `out/fmi2`
    variability : of the parameters, one of VARIABILITIES

    The archives hold FMUs of FMI 2.0. Raises what `native.build.build` raises, and ValueError if no
    system has the joint.
    """
    joint_of = {name: system.joint for name, system in systems().items()}
    names = [name for name, kind in joint_of.items() if parameters is None or kind == parameters.joint]
    if parameters and not names:
        allowed = ", ".join(sorted(set(joint_of.values())))
        raise ValueError(f"no system has a joint {parameters.joint!r}, allowed are {allowed}")
    used: dict[str, ParameterFile] = {}
    for name in names:
        for fmu in components(structure(name)).values():
            if fmu in PARTNERS:
                used[fmu] = partner_parameters(fmu)
            elif joints:
                used[fmu] = parameters or default(joint_of[name])
    jobs = [(fmu, version) for version in "23" for fmu in used]
    built = []
    for fmu, version in track(jobs, "build FMUs of systems", len(jobs)):
        built.append(build(fmu, used[fmu], out / f"fmi{version}", version, variability))
    return built + [pack_system(name, out, parameters or default(joint_of[name])) for name in names]


def pack_system(name: str, out: Path, joint: ParameterFile) -> Path:
    """Write `out/ssp/name.ssp` of FMUs in `out/fmi2`, with the parameters of its joint."""
    ssd = structure(name)
    example = system(name)
    members = {"SystemStructure.ssd": ssd}
    every: dict[str, tuple[Any, str]] = {}
    for component, fmu in components(ssd).items():
        own = values(example, component, fmu, joint)
        every |= {f"{component}.{variable}": value for variable, value in own.items()}
        members[f"resources/{fmu}.fmu"] = (out / "fmi2" / f"{fmu}.fmu").read_bytes()
        members[f"parameters/{component}.ssv"] = parameter_set(name, own)
    members[f"parameters/{name}.ssv"] = parameter_set(name, every)
    target = out / "ssp" / f"{name}.ssp"
    with workshop(target) as work:
        pack(members, work / target.name)
    return target


def structure(name: str) -> bytes:
    """The system structure description of a system."""
    return (files("jointfmu_models") / "ssp" / f"{name}.ssd").read_bytes()


def components(ssd: bytes) -> dict[str, str]:
    """{component: FMU} of a system structure description."""
    nodes = fromstring(ssd).iter(f"{_SSD}Component")
    return {node.get("name", ""): Path(node.get("source", "")).stem for node in nodes}


def values(example: System, component: str, fmu: str, joint: ParameterFile) -> dict[str, tuple[Any, str]]:
    """{variable: (value, unit)} of a component: of the joint's file, and of the system's.

    In a system the loads of joints come late, as in every master that steps its FMUs side by side. Booleans
    of the joint's file are the start values of its FMU: fmpy takes every Boolean of a parameter set for true.
    """
    if fmu in MODELS:
        model = MODELS[fmu].of(joint.joint, joint.values)
        fields = model.parameter_fields()
        file = {n: v for n, v in joint.flat.items() if not isinstance(v, bool)}
        given = {n: v for n, v in {**file, **example.joint_parameters}.items() if n in fields}
        own = {n: (v, fields[n].metadata.get("unit", "")) for n, v in given.items()}
        inputs = {v.name: v.unit for v in model.inputs}
        return own | {n: (v, inputs[n]) for n, v in example.joint_state.items()}
    fields = PARTNERS[fmu].parameter_fields()
    named: dict[str, float] = {}
    for name, value in example.values.items():
        group, _, variable = name.partition(".")
        if group == component:
            named[variable] = value
        elif component == "load" and group in _LOADS:
            named[variable if variable in fields else f"pulse_{variable}"] = value
    if "lag_b" in fields:
        named["lag_b"] = 1.0
    return {n: (v, fields[n].metadata["unit"]) for n, v in named.items()}


def parameter_set(name: str, entries: Mapping[str, tuple[Any, str]]) -> bytes:
    """An SSV file of {variable: (value, unit)}."""
    root = Element("ssv:ParameterSet", {**_NAMESPACES, "version": "1.0", "name": name})
    parameters = SubElement(root, "ssv:Parameters")
    for variable, (value, unit) in entries.items():
        node = SubElement(parameters, "ssv:Parameter", name=variable)
        if isinstance(value, bool):
            SubElement(node, "ssv:Boolean", value=str(value).lower())
        else:
            SubElement(node, "ssv:Real", value=repr(float(value)), unit=unit)
    units = SubElement(root, "ssv:Units")
    for unit in sorted({unit for _, unit in entries.values() if unit}):
        node = SubElement(units, "ssc:Unit", name=unit)
        SubElement(node, "ssc:BaseUnit", {base: str(n) for base, n in UNITS[unit].base.items()})
    return serialized(root)
