"""What is propagated for each joint: the load that is ramped, the outputs, and how they are computed.

Every joint has the reduced evaluation of many samples and the exact one of a single sample, which is
the exported spring itself.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..joints.bolted_joint import BoltedJoint, BoltedJointSpring, node_pressure
from ..joints.gear_contact import GearContact, GearContactSpring
from ..joints.harmonic_drive import HarmonicDrive, HarmonicDriveSpring
from . import bolted, drive, gear

Array = NDArray[np.float64]
Evaluate = Callable[[Mapping[str, Any], Array, Array], dict[str, Array]]


@dataclass(frozen=True, slots=True)
class Model:
    """One joint.

    load, unit : the ramped input of the FMU
    outputs    : {name: unit}
    to         : default end of the ramp, of the parameter set
    most       : where the tabulated law ends, of the parameter set (numbers or samples)
    evaluate   : (values or samples (n), loads (m), factor (n, 1)) -> outputs (n, m) at factor times loads
    exact      : (parameter set, loads (m)) -> outputs (m)
    """

    load: str
    unit: str
    outputs: Mapping[str, str]
    to: Callable[[Any], float]
    most: Callable[[Any], Any]
    evaluate: Evaluate
    exact: Callable[[Any, Array], dict[str, Array]]


def drive_exact(joint: HarmonicDrive, loads: Array) -> dict[str, Array]:
    """K_WTS and phi_rel (m) of the exported spring at torques (m) [N.m]."""
    return _only(HarmonicDriveSpring.of(joint).windup(loads), MODELS["harmonic_drive"])


def gear_exact(joint: GearContact, loads: Array) -> dict[str, Array]:
    """K_N and s_rel (m) of the exported spring at forces (m) [N]; no stiffness without force."""
    found = _only(GearContactSpring.of(joint).approach(loads), MODELS["gear_contact"])
    return {name: np.where(loads > 0.0, value, 0.0) for name, value in found.items()}


def bolted_exact(joint: BoltedJoint, loads: Array) -> dict[str, Array]:
    """Stiffness, damping and approach (m) of the exported spring at preloads (m) [N]."""
    spring, rest = BoltedJointSpring.of(joint), (0.0, 0.0, 0.0)
    states = [spring.motion(float(load), 0.0, rest, rest) for load in loads]
    names = [name for name in MODELS["bolted_joint"].outputs if name != "approach"]
    found = {name: np.array([state[name] for state in states]) for name in names}
    return found | {"approach": bolted_approach(spring, loads)}


def bolted_approach(spring: BoltedJointSpring, loads: Array) -> Array:
    """Integral of dF/K_zz over the force of all bolts from 0 to preloads (m) [N].

    Three Gauss-Legendre nodes per log-spaced panel; nodes of the pressure pattern that its symmetry makes
    equal are taken together.
    """
    joint, shape = spring.joint, spring.shape.merged(moment=False)
    lowest = 1e-9 * spring.curve.closed * joint.A_0 / joint.n_bolts
    ends = np.unique(np.concatenate([np.geomspace(lowest, np.max(loads), 60), loads[loads > lowest]]))
    places, weights = np.polynomial.legendre.leggauss(3)
    half, middle = 0.5 * np.diff(np.log(ends)), 0.5 * np.log(ends[1:] * ends[:-1])
    preload = np.concatenate([ends[:1], np.exp(middle[:, None] + half[:, None] * places).ravel()])
    node = spring.curve.inverse(node_pressure(joint, shape.equal, shape.tilt, preload[:, None], 0.0))
    K = joint.A_0 * spring.curve.derivatives(node, 1)[1] @ shape.share
    rate = joint.n_bolts * preload / K
    panels = half * (rate[1:].reshape(-1, 3) @ weights)
    integral = 3.0 * rate[0] + np.concatenate([[0.0], np.cumsum(panels)])
    return np.where(loads > lowest, integral[np.clip(np.searchsorted(ends, loads), 0, ends.size - 1)], 0.0)


def _only(found: Mapping[str, Array], model: "Model") -> dict[str, Array]:
    return {name: np.asarray(found[name]) for name in model.outputs}


MODELS: dict[str, Model] = {
    "harmonic_drive": Model(
        load="tau",
        unit="N.m",
        outputs={"K_WTS": "N.m/rad", "phi_rel": "rad"},
        to=lambda joint: float(joint.rated_torque),
        most=lambda joint: joint.max_torque,
        evaluate=drive.evaluate,
        exact=drive_exact,
    ),
    "bolted_joint": Model(
        load="preload",
        unit="N",
        outputs={"K_zz": "N/m", "K_xx": "N/m", "C_zz": "N.s/m", "C_xx": "N.s/m", "approach": "m"},
        to=lambda joint: 30e3,
        most=lambda joint: joint.H * joint.A_0 / joint.n_bolts,
        evaluate=bolted.evaluate,
        exact=bolted_exact,
    ),
    "gear_contact": Model(
        load="f",
        unit="N",
        outputs={"K_N": "N/m", "s_rel": "m"},
        to=lambda joint: 3e3,
        most=lambda joint: joint.hardness * joint.A_0,
        evaluate=gear.evaluate,
        exact=gear_exact,
    ),
}
