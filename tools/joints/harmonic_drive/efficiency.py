"""What catalogues quote of a drive, found by running it: efficiency, torques without load, its loop."""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scipy.optimize import brentq

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ...catalogue import Item
from ...systems.master import Slave
from .catalogue import items
from .friction import friction

_MOTION = ("phi1", "w1", "phi2", "w2")
_TORQUES = ("tau", "tau1")
_FAR = 20.0
"""Way of the wave generator over `presliding` [1] after which its friction has built up."""
_STEADY: Mapping[str, float] = {"hysteresis_loss": 0.0, "error_1": 0.0, "error_2": 0.0, "error_4": 0.0}
"""Without what changes along a turn or remembers the load."""


def printed_drives() -> list[Item]:
    """The catalogue's drives whose starting torque is printed."""
    return [item for item in items() if (n := item.numbers.get("starting_torque")) and n.kind == "catalogue"]


def parameters(item: Item) -> dict[str, float]:
    """Ratio and friction of a drive of the catalogue, for the FMU."""
    numbers = {"ratio": item.numbers["ratio"], **friction(item.numbers)}
    return {name: number.value for name, number in numbers.items()}


class PythonDrive:
    """The Python drive in the place of an FMU; it begins at rest with all angles zero."""

    def __init__(self, model: Model, file: ParameterFile) -> None:
        assert model.rest
        self._model, self._spring = model, model.spring(file.values)
        self._memory = model.rest(self._spring)
        self._rest = {v.name: file.start(v.name) for v in model.inputs}
        self.set(0.0, 0.0, 0.0, 0.0)
        self.step(0.0, 0.0)

    def set(self, *values: float) -> None:
        self._inputs = {**self._rest, **dict(zip(_MOTION, values, strict=True))}

    def get(self) -> list[float]:
        """The torques at the present inputs, and the stiffness."""
        outputs = self._evolved()[0]
        return [float(outputs[name]) for name in (*_TORQUES, "K_WTS")]

    def step(self, time: float, size: float) -> None:
        """Accept the present inputs."""
        self._memory = self._evolved()[1]

    def _evolved(self) -> Any:
        assert self._model.evolve
        return self._model.evolve(self._spring, self._inputs, self._memory)


def wound_up(carried: Callable[[float], float], torque: float, stiffness: float) -> float:
    """Wind-up [rad] at which a drive of about this stiffness [N.m/rad] carries a torque [N.m]."""

    def missing(angle: float) -> float:
        return carried(angle) - torque

    if not torque:
        return 0.0
    far = torque / stiffness
    while missing(far) * torque < 0.0:
        far *= 2.0
    return float(brentq(missing, 0.0, far, xtol=1e-16))


@dataclass(slots=True)
class Bench:
    """A drive between two flanges that is turned and loaded; see `bench` and `spring_bench`.

    drive : takes phi1, w1, phi2, w2, gives tau and tau1 and maybe more, and is accepted by a step
    """

    drive: Slave | PythonDrive
    ratio: float
    presliding: float
    stiffness: float
    angle: float = 0.0
    steps: int = 0

    def motor_torque(self, speed: float, torque: float) -> float:
        """Torque [N.m] that the motor gives at a steady speed [rad/s], 0 as the limit from above.

        torque : [N.m] from outside on the output, positive as its angle
        """
        wound, ratio = self._wind_up(torque), self.ratio
        self.drive.set(self.angle, 0.0, self.angle / ratio + wound, 0.0)
        self.drive.step(float(self.steps), 1.0)
        self.steps += 1
        self.angle += math.copysign(_FAR * self.presliding, speed)
        self.drive.set(self.angle, speed, self.angle / ratio + wound, speed / ratio)
        return -self.drive.get()[1]

    def efficiency(self, speed: float, load: float) -> float:
        """Output power over motor power [1] at the motor's speed [rad/s] > 0 against a load [N.m] > 0."""
        return load / (abs(self.ratio) * self.motor_torque(speed, -math.copysign(load, self.ratio)))

    def starting_torque(self) -> float:
        """Torque [N.m] of the motor that sets a drive without load in motion."""
        return self.motor_torque(0.0, 0.0)

    def back_driving_torque(self, most: float) -> float:
        """Torque [N.m] at the output that moves a drive without motor; inf if none up to `most` does."""

        def holds(load: float) -> float:
            return self.motor_torque(0.0, math.copysign(load, self.ratio))

        if holds(0.0) == 0.0:
            return 0.0
        return math.inf if holds(most) > 0.0 else float(brentq(holds, 0.0, most, rtol=1e-9))

    def _wind_up(self, torque: float) -> float:
        """Wind-up [rad] under a torque [N.m]."""

        def carried(angle: float) -> float:
            self.drive.set(self.angle, 0.0, self.angle / self.ratio + angle, 0.0)
            return self.drive.get()[0]

        return wound_up(carried, torque, self.stiffness)


@contextmanager
def bench(path: Path, parameters: Mapping[str, float]) -> Iterator[Bench]:
    """The FMU HarmonicDriveSpring (FMI 2.0) at a path, with parameters beside the default ones."""
    wires = (*_TORQUES, "K_WTS", "ratio", "presliding")
    with Slave(path, {**parameters, **_STEADY}, _MOTION, wires) as drive:
        _, _, stiffness, ratio, presliding = drive.get()
        yield Bench(drive, ratio, presliding, stiffness)


def spring_bench(model: Model, file: ParameterFile) -> Bench:
    """The same of the Python drive with the parameters of a file: no FMU is needed."""
    steady = file.with_values(_STEADY, "user", "steady")
    drive = PythonDrive(model, steady)
    return Bench(drive, steady.values.ratio, steady.values.presliding, drive.get()[2])


LOST_MOTION = 0.04
"""Torque over rated torque [1] between which catalogues state lost motion."""


def hysteresis_loss(spring: HarmonicDriveSpring) -> float:
    """Angle [rad] between the branches at zero torque, of the loop through rated torque."""
    rated = float(spring.joint.rated_torque)
    there, back = (_wind_up(spring, (rated, sign * rated, 0.0)) for sign in (1.0, -1.0))
    return there - back


def lost_motion(spring: HarmonicDriveSpring) -> float:
    """Angle [rad] between LOST_MOTION times rated torque and its negative, midway between the branches of
    the loop through rated torque.
    """
    rated = float(spring.joint.rated_torque)
    ends = (
        0.5 * sum(_wind_up(spring, (rated, side * rated, sign * LOST_MOTION * rated)) for side in (1.0, -1.0))
        for sign in (1.0, -1.0)
    )
    there, back = ends
    return there - back


def _wind_up(spring: HarmonicDriveSpring, torques: tuple[float, ...]) -> float:
    """Wind-up [rad] at the last of the torques [N.m] that follow one another from rest."""
    memory = spring.rest()
    for torque in torques:
        out, memory = spring.loaded(torque, memory)
    return float(out["phi_rel"])
