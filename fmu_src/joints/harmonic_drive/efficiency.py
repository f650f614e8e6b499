"""What friction costs a drive, found by running its FMU: efficiency, starting and back-driving torque."""

import math
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from scipy.optimize import brentq

from ...master import Slave

_MOTION = ("phi1", "w1", "phi2", "w2")
_FAR = 20.0
"""Way of the wave generator over `presliding` [1] after which its friction has built up."""
_STEADY: Mapping[str, float] = {"hysteresis_loss": 0.0, "error_1": 0.0, "error_2": 0.0, "error_4": 0.0}
"""Without what changes along a turn or remembers the load."""


@dataclass(frozen=True, slots=True)
class CatalogueDrive:
    """What a catalogue says of a drive's friction; the running torque is an estimate.

    ratio [1]; torques [N.m], speed [rad/s]; the first and the last two at the wave generator
    """

    name: str
    ratio: float
    rated_torque: float
    starting_torque: float
    back_driving_torque: float
    running_torque: float
    running_speed: float

    @property
    def parameters(self) -> dict[str, float]:
        """Friction of the FMU: from starting, running and back-driving torque, where the latter says more."""
        start, slope = self.starting_torque, (self.running_torque - self.starting_torque) / self.running_speed
        loss = max(1.0 - self.ratio * start / self.back_driving_torque, 0.0)
        own = {"friction_coulomb": start, "friction_viscous": slope, "load_loss": loss}
        return {"ratio": self.ratio, **own}


def catalogue() -> list[CatalogueDrive]:
    """The drives of models/reference/harmonic_drive_friction.toml."""
    path = files("jointfmu_models") / "reference" / "harmonic_drive_friction.toml"
    rows = tomllib.loads(path.read_text(encoding="utf-8"))["drive"]
    return [CatalogueDrive(**{k: v for k, v in row.items() if k not in ("source", "read")}) for row in rows]


@dataclass(slots=True)
class Bench:
    """An instance of HarmonicDriveSpring that is turned and loaded; see `bench`."""

    drive: Slave
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
        """Wind-up [rad] under a torque [N.m]; the stiffness is least without one."""

        def missing(angle: float) -> float:
            self.drive.set(self.angle, 0.0, self.angle / self.ratio + angle, 0.0)
            return self.drive.get()[0] - torque

        return float(brentq(missing, 0.0, torque / self.stiffness, xtol=1e-16)) if torque else 0.0


@contextmanager
def bench(path: Path, parameters: Mapping[str, float]) -> Iterator[Bench]:
    """The FMU HarmonicDriveSpring (FMI 2.0) at a path, with parameters beside the default ones."""
    wires = ("tau", "tau1", "K_WTS", "ratio", "presliding")
    with Slave(path, {**parameters, **_STEADY}, _MOTION, wires) as drive:
        _, _, stiffness, ratio, presliding = drive.get()
        yield Bench(drive, ratio, presliding, stiffness)
