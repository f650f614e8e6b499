"""What the page shows: the load ramp, and the friction of the joint."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint.contact import loop_sums
from jointfmu.plots import BLUE, GREY, RED

from ...joint_parts.page import Panel
from ...joint_parts.plot import Plot

PANELS = {"BoltedJoint": (Panel("preload", ("K_zz", "K_xx")), Panel("preload", ("C_zz", "C_xx")))}

PART = 0.3
"""Preload of the loops over the end of the load ramp [1]."""
AMPLITUDES = (0.06, 0.12, 0.22, 0.4)
"""Of the loops that are drawn, over the shift at which the mean spot slips [1]."""
_POINTS = 13


def loops(spring: Any, end: float) -> list[Plot]:
    """Loops of several amplitudes, and their loss factor over the amplitude; `end` of the ramp [N]."""
    preload = PART * end
    approach = spring.tightened(preload, 0.0)
    foundation, share = spring.foundation(), spring.shape.share
    mean = share @ np.maximum(approach - spring.curve.displacement[0], 0.0)
    slips = foundation.friction / foundation.ratio * float(mean)

    def force(shift: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of first shear [N]."""
        return np.asarray(spring.joint.A_0 * (foundation.backbone(approach, shift[:, None]) @ share))

    left = Plot(f"s_rel_x [um] at preload = {preload / 1e3:g} kN", "-f_x [kN]")
    for part in AMPLITUDES:
        u = part * slips * np.linspace(-1.0, 1.0, 2 * _POINTS + 1)
        top = force(u[-1:])
        back = top - 2.0 * force(0.5 * (u[-1] - u))
        both = np.concatenate([u, u[::-1]]), np.concatenate([back, -back])
        left.add(both[0] * 1e6, both[1] / 1e3, BLUE)
    u = AMPLITUDES[-1] * slips * np.linspace(0.0, 1.0, _POINTS)
    left.add(u * 1e6, force(u) / 1e3, GREY, dashed=True)
    right = Plot("amplitude of s_rel_x [um]", "eta_loop [1]", logarithmic=True)
    size = slips * np.geomspace(0.01, 2.0, _POINTS)
    sums = [loop_sums(foundation, share, approach, np.full(approach.size, a)) for a in size]
    right.add(size * 1e6, [s["loop_work"] / (2.0 * np.pi * s["loop_energy"]) for s in sums], RED)
    return [left, right]


DRAWINGS = {"BoltedJoint": {"loops": loops}}
