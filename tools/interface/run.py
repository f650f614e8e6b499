"""Running an FMU along arrays of inputs."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..ramps import ramp
from .frame import Frame


def run(
    fmu: str | Path,
    inputs: Mapping[str, ArrayLike],
    *,
    time: ArrayLike | None = None,
    settings: Mapping[str, object] | None = None,
) -> Frame:
    """Run an FMU in co-simulation along points of its inputs; every output at every point.

    inputs   : {input: values (n) or one value} [SI]
    time     : (n) [s] from the start on, rising; one second each by default
    settings : {parameter or other input: value}

    Raises ValueError, one line, for what is no FMU, an unknown name, inputs of different lengths, or what the
    FMU itself refuses; RuntimeError if it does not instantiate.

    >>> import jointfmu
    >>> fmu = jointfmu.load("GearContact").build("dist", "fmi2")[0]
    >>> frame = jointfmu.run(fmu, {"f": [0.0, 500.0, 1000.0]})
    >>> bool(frame["K_N"][2] > frame["K_N"][1] > 0.0)
    True
    """
    points = {name: np.atleast_1d(np.asarray(x, dtype=np.float64)) for name, x in inputs.items()}
    clock = None if time is None else np.asarray(time, dtype=np.float64)
    found = ramp.drive(fmu, points, clock, settings)
    return Frame(found.columns, found.units, found.messages)
