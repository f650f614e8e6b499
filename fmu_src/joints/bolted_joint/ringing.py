"""A mass on the joint: it rings along the joint's normal about the tightened state."""

from pathlib import Path

from ...master import Slave
from ...ringing import Axis, Body, Rest

PRELOADS = (3e3, 9e3, 15e3, 30e3)
"""Per bolt [N]."""
_FMU = "BoltedJoint"


def _rest(folder: Path, preload: float) -> Rest:
    with Slave(folder / f"{_FMU}.fmu", {"preload": preload}, (), ("K_zz", "C_zz")) as law:
        stiffness, damping = law.get()
    if stiffness <= 0.0:
        raise ValueError(f"load = {preload:g} N: the joint has no stiffness there; allowed are preloads > 0")
    return Rest(0.0, 0.0, stiffness, damping)


RINGING = Body(
    fmu=_FMU,
    motion=("s_rel_z", "v_rel_z"),
    force="f_z",
    partner="TranslationalMass",
    loads=lambda folder: PRELOADS,
    start=lambda preload: {"preload": preload},
    rest=_rest,
    release=1.0,
    load=Axis("preload", "kN", 1e-3),
    deflection=Axis("motion", "nm", 1e9),
    doc="along the joint's normal",
    stiffness="K_zz",
)
