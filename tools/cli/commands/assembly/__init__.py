"""Functions shared by `jointfmu footprint` and `jointfmu modes`: finite elements of a bolted assembly."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu.joints import KINDS
from jointfmu.joints.bolted_joint import KIND
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file

from ....common.judgement import Plausibility, assess_law_stiffness, find_rms_height
from ....common.pressure import warn_overload
from ....inputs.drawing.vdi2230 import proof_load
from ...command import declare_argument

if TYPE_CHECKING:
    from ....fem.geometry import Assembly


def declare_assembly_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the assembly file, `--preload` and `--params`."""
    declare_argument(
        parser,
        "assembly",
        Path,
        "assembly file with bodies and bolts (TOML), as in models/assemblies",
        "ASSEMBLY",
    )
    declare_argument(
        parser,
        "--preload",
        float,
        "force of each bolt [N]: the preload that remains after embedding",
        "F",
        default=9e3,
    )
    declare_argument(
        parser,
        "--params",
        Path,
        "parameter file of a bolted joint, whose interface is used (default: box specimen of Zhao 2018)",
    )


def load_joint_file(parameter_path: Path | None) -> ParameterFile:
    """Load the parameter file of a bolted joint; None: the default file.

    Raises ValueError for a file of another joint.
    """
    if parameter_path is None:
        return load_default(KIND.name)
    file = load_parameter_file(parameter_path)
    if file.joint != KIND.name:
        raise ValueError(
            f"{parameter_path}: joint = {file.joint!r}, expected a parameter file of a {KIND.name!r}"
        )
    return file


def check_bolt_stiffness(option_name: str, parameter_file: ParameterFile) -> None:
    """Raise ValueError if an option for the complete joint is set and the file has no bolt stiffness."""
    if not parameter_file.values_by_name.get("bolt_stiffness", 0.0) > 0.0:
        raise ValueError(
            f"{option_name} needs the stiffness of a bolt; state bolt_stiffness above 0 N/m in the file of "
            "--params"
        )


def judge_stiffness_and_preload(
    parameter_file: ParameterFile,
    assembly: "Assembly",
    preload: float,
    mean_pressure: float,
    peak_pressure: float,
) -> Plausibility:
    """Assess whether the contact stiffness of an assembly is plausible; warn of a preload above proof load.

    preload       : preload of each bolt [N]
    mean_pressure : mean contact pressure [Pa]
    peak_pressure : greatest contact pressure [Pa]
    """
    judgement = assess_law_stiffness(
        KINDS[parameter_file.joint].extract_law(parameter_file.values),
        [mean_pressure],
        find_rms_height(parameter_file),
        peak_pressure,
    )
    return judgement.prepend_warnings(
        warn_overload("preload", preload, proof_load(assembly.bolts.hole_diameter))
    )


def replace_assembly_parameters(
    parameter_file: ParameterFile, assembly: "Assembly", include_bolts: bool
) -> ParameterFile:
    """Set contact area and materials in the parameters of a joint to the values of an assembly.

    include_bolts : also set number and rows of the bolts

    If the bolts do not form two rows, the row distance is the head diameter: the pressure under the heads
    carries the moment.
    """
    changes = {"A_0": assembly.contact_area}
    for name in ("side1", "side2"):
        body = getattr(assembly, name)
        changes |= {f"{name}.E": body.E, f"{name}.nu": body.nu}
    if include_bolts:
        rows = assembly.find_outer_rows()
        changes |= {"n_bolts": float(len(assembly.bolts.bolt_positions))}
        if rows is None:
            changes |= {"row_bolts": 1.0, "row_distance": assembly.bolts.head_diameter}
        else:
            changes |= {"row_bolts": float(rows[0].sum()), "row_distance": assembly.row_distance}
    old = parameter_file.values_by_name
    new = {name: v for name, v in changes.items() if not math.isclose(old[name], v, rel_tol=1e-12)}
    return parameter_file.with_values(new, "derived", f"from the assembly {assembly.name}")
