"""Commands on a bolted assembly by finite elements, `footprint` and `modes`; what they share."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, default, load

from ...command_line.common import argument
from ...drawing.vdi2230 import proof_load
from ...fields.clamped import clamped
from ...judgement import Judgement, judge, known_height
from ...pressure import overload

if TYPE_CHECKING:
    from ...fem.geometry import Assembly


def assembly_arguments(sub: argparse.ArgumentParser) -> None:
    """Declare the assembly, `--preload` and `--params`."""
    argument(sub, "assembly", Path, "bodies and bolts (TOML)", "ASSEMBLY")
    argument(sub, "--preload", float, "per bolt [N]", "F", default=9e3)
    argument(sub, "--params", Path, "parameters of the interface (default: box specimen)")


def joint_file(path: Path | None) -> ParameterFile:
    """Parameters of a joint with bolts: of a file, or the default of the first such joint."""
    joints = list(clamped())
    if path is None:
        return default(joints[0])
    file = load(path)
    if file.joint not in joints:
        allowed = " or ".join(repr(name) for name in joints)
        raise ValueError(f"{path}: joint = {file.joint!r}, expected a parameter file of a {allowed}")
    return file


def check_bolts(option: str, file: ParameterFile) -> None:
    """Refuse an option for the whole joint where the file has no bolts that bear."""
    if not file.flat.get("bolt_stiffness", 0.0) > 0.0:
        raise ValueError(
            f"{option} without the stiffness of a bolt: expected bolt_stiffness above 0 N/m in the file of "
            "--params"
        )


def judge_assembly(
    file: ParameterFile, assembly: "Assembly", preload: float, mean: float, peak: float
) -> Judgement:
    """The judgement of an assembly's contact at a preload [N] per bolt, mean and greatest pressure [Pa]."""
    found = judge(KINDS[file.joint].law_of(file.values), [mean], known_height(file), peak)
    return found.with_warnings(overload("preload", preload, proof_load(assembly.bolts.hole_diameter)))


def with_assembly(file: ParameterFile, assembly: "Assembly", whole: bool) -> ParameterFile:
    """The joint's parameters with the area and the materials of an assembly; all of its bolts if `whole`.

    Where the bolts are no two rows, the pressure under their heads carries a moment.
    """
    changes = {"A_0": assembly.contact_area}
    for name in ("side1", "side2"):
        body = getattr(assembly, name)
        changes |= {f"{name}.E": body.E, f"{name}.nu": body.nu}
    if whole:
        rows = assembly.outer_rows()
        changes |= {"n_bolts": float(len(assembly.bolts.positions))}
        if rows is None:
            changes |= {"row_bolts": 1.0, "row_distance": assembly.bolts.head_diameter}
        else:
            changes |= {"row_bolts": float(rows[0].sum()), "row_distance": assembly.row_distance}
    old = file.flat
    new = {name: v for name, v in changes.items() if not math.isclose(old[name], v, rel_tol=1e-12)}
    return file.with_values(new, "derived", f"from the assembly {assembly.name}")
