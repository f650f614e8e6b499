"""Robot model (MJCF) whose drives are MuJoCo plugins compiled from FMUs, with all effects of the FMU."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

from jointfmu_fmu_src.building import build_fmus

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile

from ..mujoco import FLANGE_INPUTS, plugin
from .elastic import MOTOR_NAME_SUFFIX, ElasticAxis, add_drives
from .names import make_identifier


def find_two_flange_fmu(drive_file: ParameterFile) -> str:
    """Name of the FMU of a drive that connects two flanges."""
    models = KINDS[drive_file.joint].models
    return next(
        model.name
        for model in models
        if [v.name for v in model.inputs[: len(FLANGE_INPUTS)]] == FLANGE_INPUTS
    )


def compile_plugins(drive_files: Mapping[str, ParameterFile], output_folder: Path) -> dict[str, Path]:
    """Compile the plugin `jointfmu.NAME` of each drive into a folder; returns {name of the drive: file}.

    drive_files : {joint: parameter file of its drive}

    Raises ImportError, RuntimeError and ValueError as `jointfmu_tools.exchange.mujoco.plugin`.
    """
    paths = {}
    with TemporaryDirectory() as folder:
        for file in drive_files.values():
            name = make_identifier(file.name)
            if name not in paths:
                (fmu,) = build_fmus([find_two_flange_fmu(file)], ["fmi3"], file, Path(folder), fmu_alias=name)
                paths[name] = plugin(fmu, output_folder)
    return paths


def format_robot_with_plugins(
    robot_spec: Any, robot_axes: Sequence[ElasticAxis], drive_files: Mapping[str, ParameterFile]
) -> str:
    """Format the MJCF of a robot with plugins as drives; the folders of meshes are those of the robot.

    robot_axes  : axes with a drive
    drive_files : {joint: parameter file of its drive}
    """
    model_spec = add_drives(robot_spec, list(robot_axes), has_springs=False)
    model_spec.compile()
    root = ElementTree.fromstring(model_spec.to_xml())
    extension = ElementTree.Element("extension")
    root.insert(0, extension)
    for axis in robot_axes:
        name = f"jointfmu.{make_identifier(drive_files[axis.joint_name].name)}"
        node = extension.find(f"plugin[@plugin='{name}']")
        if node is None:
            node = ElementTree.SubElement(extension, "plugin", plugin=name)
        drive = ElementTree.SubElement(node, "instance", name=f"{axis.joint_name}_drive")
        ElementTree.SubElement(drive, "config", key="phi1", value=axis.joint_name + MOTOR_NAME_SUFFIX)
        ElementTree.SubElement(drive, "config", key="phi2", value=axis.joint_name)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"
