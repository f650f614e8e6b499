"""A mass on the joint: it rings about the tightened state, in shear along the rows of bolts."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...systems.master import Slave
from ...systems.ringing import Axis, Body, Pull, Rest

PRELOADS = (3e3, 9e3, 15e3, 30e3)
"""Per bolt [N]."""
_FMU = "BoltedJoint"


def _rest(folder: Path, preload: float, parameters: Mapping[str, Any]) -> Rest:
    start = {**parameters, "preload": preload, "v_rel_x": 1.0}
    with Slave(folder / f"{_FMU}.fmu", start, (), ("K_xx", "f_x")) as law:
        K, dashpot = law.get()
    if K <= 0.0:
        raise ValueError(f"load = {preload:g} N: the joint has no stiffness there; allowed are preloads > 0")
    return Rest(0.0, 0.0, K, 0.0 - dashpot)


RINGING = Body(
    fmu=_FMU,
    motion=("s_rel_x", "v_rel_x"),
    force="f_x",
    partner="TranslationalMass",
    over="preload",
    loads=lambda folder, parameters: PRELOADS,
    start=lambda preload: {"preload": preload},
    rest=_rest,
    release=1.0,
    load=Axis("preload", "kN", 1e-3),
    deflection=Axis("motion", "um", 1e6),
    doc="in shear",
    stiffness="K_xx",
    pull=Pull(15e3, 8e-7, "half of the friction limit"),
)
