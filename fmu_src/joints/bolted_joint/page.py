"""What the page shows: the load ramp, and the friction of the joint."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint.contact import loop_sums

from ...joint_parts import RampPanel, chart

PANELS = {"BoltedJoint": (RampPanel("preload", ("K_zz", "K_xx")), RampPanel("preload", ("C_zz", "C_xx")))}

PART = 0.3
"""Preload of the loops over the end of the load ramp [1]."""
AMPLITUDES = (0.06, 0.12, 0.22, 0.4)
"""Of the loops that are drawn, over the shift at which the mean spot slips [1]."""
_POINTS = 13


def loops(spring: Any, end: float) -> list[chart.Panel]:
    """Loops of several amplitudes, and their loss factor over the amplitude; `end` of the ramp [N]."""
    preload = PART * end
    approach = spring.tightened(preload, 0.0)
    foundation, share = spring.foundation(), spring.shape.share
    mean = share @ np.maximum(approach - spring.curve.displacement[0], 0.0)
    slips = foundation.friction / foundation.ratio * float(mean)

    def force(shift: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of first shear [N]."""
        return np.asarray(spring.joint.A_0 * (foundation.backbone(approach, shift[:, None]) @ share))

    lines = []
    for part in reversed(AMPLITUDES):
        u = part * slips * np.linspace(-1.0, 1.0, 2 * _POINTS + 1)
        top = force(u[-1:])
        back = top - 2.0 * force(0.5 * (u[-1] - u))
        shift, loop = np.concatenate([u, u[::-1]]), np.concatenate([back, -back])
        lines.append(chart.Series(f"amplitude {u[-1] * 1e6:.3g} µm", shift * 1e6, loop / 1e3))
    u = AMPLITUDES[-1] * slips * np.linspace(0.0, 1.0, _POINTS)
    lines.append(chart.Series("first shear", u * 1e6, force(u) / 1e3, dashed=True))
    size = slips * np.geomspace(0.01, 2.0, _POINTS)
    sums = [loop_sums(foundation, share, approach, np.full(approach.size, a)) for a in size]
    loss = [s["loop_work"] / (2.0 * np.pi * s["loop_energy"]) for s in sums]
    over = chart.Series("eta_loop", size * 1e6, loss)
    return [
        chart.Panel(f"Loops at preload = {preload / 1e3:g} kN", "s_rel_x [um]", "-f_x [kN]", lines),
        chart.Panel(
            "Loss factor over the amplitude", "amplitude of s_rel_x [um]", "eta_loop [1]", [over], True
        ),
    ]


DRAWINGS = {"BoltedJoint": {"loops": loops}}
