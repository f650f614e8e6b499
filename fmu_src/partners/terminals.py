"""Flanges of the partners that move; a load over time has no motion and so no flange."""

from ..joint_parts.terminals import ROTATIONAL, TRANSLATIONAL, Terminal


def _body(motion: str, rate: str, flow: str, terminal_kind: str, body: str) -> tuple[Terminal, Terminal]:
    """Both flanges of a partner that moves; each takes a load of its own."""

    def flange(side: str) -> Terminal:
        load = (f"{flow}_{side}", "inflow")
        members = {motion: (motion, "signal"), rate: (rate, "signal"), flow: load}
        return Terminal(f"flange_{side}", terminal_kind, side, f"{body}, load {load[0]}", members)

    return flange("a"), flange("b")


TERMINALS = {
    "RotationalInertia": _body("phi", "w", "tau", ROTATIONAL, "the inertia"),
    "TranslationalMass": _body("s", "v", "f", TRANSLATIONAL, "the mass"),
}
