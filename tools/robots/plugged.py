"""A robot with elastic axes whose drives are the plugin: all that the FMU has, beside the plain MJCF."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

from jointfmu_fmu_src.building import build

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile

from ..mujoco import INPUTS, plugin
from .elastic import MOTOR, ElasticAxis, with_drives
from .names import identifier


def spring_of(file: ParameterFile) -> str:
    """The FMU of a drive's file that stands between two flanges."""
    models = KINDS[file.joint].models
    return next(one.name for one in models if [v.name for v in one.inputs[: len(INPUTS)]] == INPUTS)


def plugins(files: Mapping[str, ParameterFile], out: Path) -> dict[str, Path]:
    """{name of a drive: the plugin `jointfmu.NAME` of its FMU}, written to a folder.

    Raises ImportError, RuntimeError and ValueError as `jointfmu_tools.mujoco.plugin`.
    """
    found = {}
    with TemporaryDirectory() as folder:
        for file in files.values():
            name = identifier(file.name)
            if name not in found:
                (fmu,) = build([spring_of(file)], ["fmi3"], file, Path(folder), alias=name)
                found[name] = plugin(fmu, out)
    return found


def text(spec: Any, chosen: Sequence[ElasticAxis], files: Mapping[str, ParameterFile]) -> str:
    """The MJCF; files : {joint: its drive}."""
    made = with_drives(spec, list(chosen), springs=False)
    made.compile()
    root = ElementTree.fromstring(made.to_xml())
    extension = ElementTree.Element("extension")
    root.insert(0, extension)
    for axis in chosen:
        name = f"jointfmu.{identifier(files[axis.joint].name)}"
        found = extension.find(f"plugin[@plugin='{name}']")
        own = ElementTree.SubElement(extension, "plugin", plugin=name) if found is None else found
        drive = ElementTree.SubElement(own, "instance", name=f"{axis.joint}_drive")
        ElementTree.SubElement(drive, "config", key="phi1", value=axis.joint + MOTOR)
        ElementTree.SubElement(drive, "config", key="phi2", value=axis.joint)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"
