"""All files of the Modelica library: templates filled with tables, variables, terminals and numbers."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from jointfmu import __version__
from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, default, write_text
from jointfmu.quantity import flat_fields

from ..folders import asset
from ..systems import System, system
from ..templates import template
from .blocks import interface, wrapper
from .records import BASES, record_name, records
from .tables import DAMPING_TOLERANCE, STRONGEST, TOLERANCE
from .text import number, text

NAME = "JointStiffness"
TIGHTENED = ((9e3, 0.0), (15e3, 0.0), (15e3, 4500.0))
"""Preload [N] per bolt and moment [N.m] of the bolted joints in the library: Zhao 2018, Table 3."""
_MODEL_OF = {
    "harmonic_drive": "HarmonicDriveSpring",
    "bolted_joint": "BoltedJoint",
    "gear_contact": "GearContact",
}
_ORDER = {
    "": ("Examples", "Components", "Wrappers", "Interfaces", "Data", "Functions"),
    "Examples": ("RobotJoint", "BoltedColumn"),
    "Components": ("HarmonicDriveSpring", "BoltedJoint", "GearContact", "LinkWeight", "Load"),
    "Wrappers": tuple(MODELS),
    "Interfaces": tuple(MODELS),
    "Functions": (
        "load",
        "stiffness",
        "bend",
        "linear",
        "segment",
        "smoothStep",
        "loadDerivative",
        "stiffnessDerivative",
    ),
}


def write(
    folder: Path, file: ParameterFile | None = None, tight: Sequence[tuple[float, float]] = ()
) -> list[Path]:
    """Write the library into a folder; returns its files.

    file  : parameters of one joint, in place of its default
    tight : preload [N] and moment [N.m] of the bolted joints in the library, in place of TIGHTENED
    """
    written = []
    for name, content in library(file, tight or TIGHTENED).items():
        write_text(folder / NAME / name, content)
        written.append(folder / NAME / name)
    return written


def library(
    file: ParameterFile | None = None, tight: Sequence[tuple[float, float]] = TIGHTENED
) -> dict[str, str]:
    """{path in the library: text} of every file."""
    joints = {joint: default(joint) for joint in KINDS}
    if file is not None:
        joints[file.joint] = file
    column = system("bolted_column")
    struck = (column.values["joint_state.preload"], column.values["joint_state.moment"])
    tables = records(joints, tight)
    shown = {kind: next(name for name, r in tables.items() if r["base"] == BASES[kind]) for kind in KINDS}
    example = record_name(joints["bolted_joint"].name, struck if struck in tight else tight[0])
    env = _environment()
    common: dict[str, Any] = {"version": __version__, "records": shown}
    out = {"package.mo": env.get_template("package.mo").render(common, tolerance=f"{TOLERANCE:g}")}
    for folder in ("Functions", "Data", "Components", "Interfaces", "Wrappers", "Examples"):
        out[f"{folder}/package.mo"] = env.get_template(f"{folder}/package.mo").render(common)
    for name in _ORDER["Functions"]:
        out[f"Functions/{name}.mo"] = env.get_template(f"Functions/{name}.mo").render(common)
    for kind, base in BASES.items():
        meta = _meanings(kind)
        out[f"Data/{base}.mo"] = env.get_template(f"Data/{base}.mo").render(common, meta=meta)
        name = _MODEL_OF[kind]
        out[f"Components/{name}.mo"] = env.get_template(f"Components/{name}.mo").render(
            common,
            meta=meta,
            docs={v.name: v.doc for v in MODELS[name].outputs},
            html=_documentation(MODELS[name]),
            ends=_ends(tables, shown),
            damping_tolerance=f"{DAMPING_TOLERANCE:g}",
            strongest=f"{STRONGEST:g}",
        )
    for name in ("LinkWeight", "Load"):
        out[f"Components/{name}.mo"] = env.get_template(f"Components/{name}.mo").render(common)
    for name, record in tables.items():
        out[f"Data/{name}.mo"] = env.get_template("Data/record.mo").render(common, name=name, **record)
    for name, model in MODELS.items():
        out[f"Interfaces/{name}.mo"] = env.get_template("Interfaces/block.mo").render(interface(model))
        out[f"Wrappers/{name}.mo"] = env.get_template("Wrappers/wrapper.mo").render(wrapper(model))
    for name, one in (("RobotJoint", system("robot_joint")), ("BoltedColumn", column)):
        out[f"Examples/{name}.mo"] = env.get_template(f"Examples/{name}.mo").render(
            common, v={k: number(x) for k, x in one.values.items()}, sources=_sources(one), record=example
        )
    orders = _ORDER | {"Data": (*BASES.values(), *tables)}
    out |= {(f"{k}/" if k else "") + "package.order": "\n".join(v) + "\n" for k, v in orders.items()}
    return dict(sorted(out.items()))


def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("jointfmu_fmu_src.modelica"),
        undefined=StrictUndefined,
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        comment_start_string="<#",
        comment_end_string="#>",
        keep_trailing_newline=True,
        autoescape=False,
    )


def _ends(tables: Mapping[str, dict[str, Any]], shown: Mapping[str, str]) -> dict[str, str]:
    """Where the shown tables of drive and gear end."""
    drive, gear = (tables[shown[kind]]["end"][1] for kind in ("harmonic_drive", "gear_contact"))
    return {"harmonic_drive": f"{drive:g} N m", "gear_contact": f"{gear / 1e3:g} kN"}


def _meanings(joint: str) -> dict[str, str]:
    return {
        name: text(item.metadata["doc"])
        for name, item in flat_fields(KINDS[joint].parameters)
        if "doc" in item.metadata
    }


def _documentation(model: Model) -> dict[str, str]:
    """Parts of the FMU's documentation page, as text of a Modelica annotation."""
    page = template(asset(model, "page.html"), Path(__file__).parent)
    parts = ("what", "law", "trust", "paper")
    return {part: text(page.render(model=model, fmu=False, part=part).strip()) for part in parts}


def _sources(one: System) -> str:
    rows = "".join(
        f"<tr><td><code>{name}</code></td><td>{number(value)} {one.units[name].replace('.', ' ')}</td>"
        f"<td>{text(one.sources[name])}</td></tr>\n"
        for name, value in one.values.items()
    )
    return f"<table>\n<tr><th>number</th><th>value</th><th>source</th></tr>\n{rows}</table>"
