"""Box specimen of Zhao 2018: lengths identified from its six frequencies at 9 kN.

The only published length is the distance of the bolt rows. Five describe an open box whose walls are flush
with the inside of the flange: length, height, wall, flange thickness and the flange's overhang, in whose
middle the bolts sit.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jointfmu_tools.fem import modes
from jointfmu_tools.fem.assembly import read_assembly
from jointfmu_tools.fem.elasticity import Array
from jointfmu_tools.fem.geometry import Assembly, BoltGrid, BoxSection
from jointfmu_tools.fem.modes import DEFAULT_MESH_REFINEMENT
from jointfmu_tools.joints.bolted_joint.frequencies import BOX_SPECIMEN_ASSEMBLY_FILE
from scipy.optimize import least_squares

from jointfmu.joints.bolted_joint.law import BoltedJointParameters

LENGTHS = ("length", "height", "wall", "flange_thickness", "overhang")
STEP = 0.01
"""Relative step of the difference quotients, well above the random change of a new mesh."""
RANGE = 0.1
"""Largest relative change of the lengths in the first step."""


@dataclass(frozen=True, slots=True)
class Identification:
    """Identified lengths and their errors.

    lengths   : {name: m}
    error     : (6) [1] computed over measured frequency, less 1
    slope     : (6, 5) [1] change of the logarithm of a frequency with the logarithm of a length
    """

    lengths: dict[str, float]
    error: Array
    slope: Array

    @property
    def deviation(self) -> dict[str, float]:
        """Standard deviation [1] of each length, relative, if the errors of the fit are random."""
        variance = float(self.error @ self.error) / (self.error.size - len(self.lengths))
        covariance = variance * np.linalg.inv(self.slope.T @ self.slope)
        return dict(zip(self.lengths, np.sqrt(np.diag(covariance)).tolist(), strict=True))


def specimen(start: Assembly, lengths: Sequence[float]) -> Assembly:
    """The assembly with other lengths (5) [m], in the order of LENGTHS."""
    length, height, wall, flange_thickness, overhang = lengths
    if not (isinstance(start.side2, BoxSection) and isinstance(start.bolts, BoltGrid)):
        raise ValueError(f"{start.name}: is no box on a grid of bolts; expected the box specimen")
    box = replace(
        start.side2,
        length=length,
        width=start.bolts.row_spacing + overhang,
        height=height,
        wall=wall,
        flange_width=overhang + wall,
        flange_thickness=flange_thickness,
        wall_inset=overhang,
    )
    return replace(start, side1=box, side2=box, bolts=replace(start.bolts, column_spacing=length - overhang))


def shipped() -> Assembly:
    """The assembly with the identified lengths."""
    return read_assembly(BOX_SPECIMEN_ASSEMBLY_FILE)


def lengths_of(assembly: Assembly) -> Array:
    """Lengths (5) [m] of a box specimen, in the order of LENGTHS."""
    box = assembly.side2
    assert isinstance(box, BoxSection)
    return np.array([box.length, box.height, box.wall, box.flange_thickness, box.wall_inset])


def frequencies(
    assembly: Assembly, joint: BoltedJointParameters, states: Sequence[tuple[float, float]], **options: Any
) -> Array:
    """Frequencies (states, modes) [Hz] with the shear stiffness of the joint."""
    return modes.compute_frequencies(assembly, joint, float(joint.shear_stiffness_ratio()), states, **options)


def identify(
    start: Assembly,
    joint: BoltedJointParameters,
    preload: float,
    measured: Array,
    refinement: float = DEFAULT_MESH_REFINEMENT,
    trials: int = 8,
    solve: Callable[..., Array] = frequencies,
) -> Identification:
    """Identify the lengths by least squares.

    preload  : [N] per bolt, without a moment
    measured : (6) [Hz] frequencies by mode
    trials   : largest number of trial lengths, without those for the difference quotients
    solve    : function that computes the frequencies
    """
    first = lengths_of(start)

    def error(ratio: Array) -> Array:
        box = specimen(start, (ratio * first).tolist())
        found = solve(box, joint, [(preload, 0.0)], refinement=refinement, mode_count=measured.size)
        return np.asarray(found[0] / measured - 1.0)

    fit = least_squares(error, np.ones(first.size), diff_step=STEP, x_scale=RANGE, ftol=1e-3, max_nfev=trials)
    lengths = dict(zip(LENGTHS, (fit.x * first).tolist(), strict=True))
    return Identification(lengths, np.asarray(fit.fun), np.asarray(fit.jac) * fit.x)
