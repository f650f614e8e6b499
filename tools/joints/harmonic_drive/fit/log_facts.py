"""What a fit to a log prints beside its parameters, and how it predicts a part that is held out."""

from collections.abc import Sequence

import numpy as np

from jointfmu.parameters import ParameterFile

from ....fitting.least_squares import Array
from .log_friction import FittedLog, fitted_to
from .log_model import Linear
from .log_samples import Samples

Facts = dict[str, tuple[float, str, str]]


def facts(
    file: ParameterFile, samples: Samples, whole: FittedLog, wanted: Sequence[str]
) -> dict[str, tuple[float, str, str]]:
    """Residual, what was found beside, and the held-out part beside a constant."""
    ratio = abs(whole.drive.ratio)
    beside = Linear.of(samples, ratio)
    units = {"inertia": "kg.m2", "offset": "N.m", "gravity_cos": "N.m", "gravity_sin": "N.m"}
    texts = {"inertia": "of arm and rotor at the joint", "offset": "of the motor's torque"}
    facts = {
        name: (float(value), units[name], texts.get(name, f"{name[8:]}(q) part of gravity at the joint"))
        for name, value in zip(beside.names, whole.linear, strict=True)
    }
    if whole.rotor_deviation:
        text = f"of the rotor, from the wind-up; standard deviation {whole.rotor_deviation:.2g}"
        facts["motor_inertia"] = whole.rotor, "kg.m2", text
    facts["residual"] = (
        _rms(samples.torque - whole.torque(samples)[1]),
        "N.m",
        "root mean square, at the motor",
    )
    early, late = samples.part(~samples.later), samples.part(samples.later)
    if late.dq.size and early.dq.size > len(wanted) + len(beside.names):
        part = fitted_to(file, early, wanted, whole.rotor)
        miss = _rms(late.torque - part.torque(late)[1])
        facts["held_out"] = (
            miss,
            "N.m",
            f"the same of {late.dq.size} samples that a fit to the rest predicts",
        )
        guess = _rms(late.torque - _constant(early, late, ratio))
        facts["held_out_constant"] = (guess, "N.m", "the same of a constant in the place of friction")
    return facts


def _constant(early: Samples, late: Samples, ratio: float) -> Array:
    """Torque (n) [N.m] at later samples by what is linear and a constant, fitted to earlier ones."""
    matrices = []
    for samples in (early, late):
        beside = Linear.of(samples, ratio)
        matrices.append(
            (np.concatenate([np.ones((samples.dq.size, 1)), beside.matrix], axis=1), beside.known)
        )
    (first, known), (then, more) = matrices
    return np.asarray(then @ np.linalg.lstsq(first, early.torque - known)[0] + more)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
