"""How the steps decide the heat that a drive counts while its motor swings through the Stribeck speed.

`python benchmarks/drive_heat.py` prints, over the steps and the amplitude of the speed, the error of E_loss
over the work that goes through the drive, against 20 000 steps. There is no load, so that all of the work
is friction's.
"""

from dataclasses import replace

import numpy as np
from validity_tables import heading, row

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

FRICTION = {
    "friction_coulomb": 0.03,
    "friction_stribeck": 0.02,
    "stribeck_speed": 10.0,
    "friction_viscous": 2e-4,
}
ALONE = FRICTION | {"friction_coulomb": 0.0, "friction_viscous": 0.0}
"""The worst: all of the heat falls with the speed."""
TIME = 0.2
"""[s] of two periods."""
FINE = 20_000


def heat(steps, speed, friction):
    """E_loss [J] of a motor that swings twice without load, with an amplitude [rad/s], and its work [J]."""
    law = HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **friction))
    angle = 4.0 * np.pi * np.linspace(0.0, 1.0, steps + 1)
    w1, phi1 = speed * np.sin(angle), speed * TIME / (4.0 * np.pi) * (1.0 - np.cos(angle))
    ratio = law.joint.ratio
    memory, begun, through, before = law.initial_history(), 0.0, 0.0, None
    for k in range(steps + 1):
        out, memory = law.advance_motion((phi1[k], w1[k], phi1[k] / ratio, w1[k] / ratio), memory)
        if before is None:
            begun = float(out["E_loss"])
        else:
            through += abs(0.5 * (float(out["tau1"]) + before) * (phi1[k] - phi1[k - 1]))
        before = float(out["tau1"])
    return float(out["E_loss"]) - begun, through


def main():
    """Print the tables."""
    speeds = (10.0, 50.0, 200.0, 1000.0)
    for title, friction in (("all friction", FRICTION), ("Stribeck friction alone", ALONE)):
        exact = {speed: heat(FINE, speed, friction) for speed in speeds}
        heading(
            f"E_loss of a swinging motor, error over the work through the drive: {title}",
            "steps of two periods",
            *(f"amplitude {speed:g} rad/s" for speed in speeds),
        )
        for steps in (50, 100, 200, 400, 1000):
            found = (heat(steps, speed, friction)[0] - exact[speed][0] for speed in speeds)
            row(steps, *(f"{e / exact[s][1]:+.2%}" for e, s in zip(found, speeds, strict=True)))


if __name__ == "__main__":
    main()
