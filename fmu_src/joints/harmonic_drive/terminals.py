"""Flanges of the harmonic drive."""

from ...joint_parts.terminals import ROTATIONAL, Terminal, shaft

TERMINALS = {
    "HarmonicDriveSpring": (
        shaft(1, "a", "wave generator (motor)"),
        shaft(2, "b", "output"),
    ),
    "HarmonicDriveCompliance": (
        Terminal(
            "flange",
            ROTATIONAL,
            "b",
            "output, wave generator locked",
            {"phi": ("phi_rel", "signal"), "tau": ("tau", "inflow")},
        ),
    ),
}
