"""Catalogue quantities of a drive by simulation: efficiency, no-load torques, hysteresis, lost motion."""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ...inputs.catalogue import CatalogueEntry
from ...run.engine import open_joint
from ...systems.master import Slave
from .catalogue import list_drives
from .friction import compute_friction_parameters

_FLANGE_INPUT_NAMES = ("phi1", "w1", "phi2", "w2")
"""Names of the inputs with angles and speeds of the flanges."""
_TORQUE_OUTPUT_NAMES = ("tau", "tau1")
"""Names of the outputs with the torque of the drive and of the motor."""
_DEVELOPED_FRICTION_ROTATION_OVER_PRESLIDING = 20.0
"""Rotation of the wave generator over `presliding` [1] after which friction is fully developed."""
_PARAMETERS_WITHOUT_ERRORS_AND_HYSTERESIS: Mapping[str, float] = {
    "hysteresis_loss": 0.0,
    "error_1": 0.0,
    "error_2": 0.0,
    "error_4": 0.0,
}
"""Parameter values that switch off hysteresis and kinematic error, which depend on history and angle."""


def drives_with_friction() -> list[CatalogueEntry]:
    """Drives of the catalogue with a published starting torque."""
    return [
        item
        for item in list_drives()
        if (n := item.known_numbers.get("starting_torque")) and n.value_origin == "catalogue"
    ]


def ratio_and_friction_parameters(catalogue_entry: CatalogueEntry) -> dict[str, float]:
    """Speed ratio and friction parameters of a catalogue drive: {parameter of the FMU: value}."""
    numbers = {
        "ratio": catalogue_entry.known_numbers["ratio"],
        **compute_friction_parameters(catalogue_entry.known_numbers),
    }
    return {name: number.si_value for name, number in numbers.items()}


class SimulatedDrive:
    """Harmonic drive evaluated in Python, with the methods of a running FMU. It starts at rest at angle 0."""

    def __init__(self, fmu_model: Model, parameter_file: ParameterFile) -> None:
        self._joint = open_joint(fmu_model, parameter_file)
        self._path = [(0.0,) * len(_FLANGE_INPUT_NAMES)]
        self._inputs = self._path[0]

    def set_inputs(self, *values: float) -> None:
        """Set the angles and speeds of both flanges."""
        self._inputs = values

    def get_outputs(self) -> list[float]:
        """Transmitted torque, motor torque [N.m] and stiffness [N.m/rad] at the present inputs."""
        path = zip(*self._path, self._inputs, strict=True)
        columns = self._joint.evaluate_path(
            dict(zip(_FLANGE_INPUT_NAMES, path, strict=True))
        ).variable_columns
        return [float(columns[name][-1]) for name in (*_TORQUE_OUTPUT_NAMES, "K_WTS")]

    def do_step(self, step_start_time: float, step_size: float) -> None:
        """Accept the present inputs: they become part of the load history."""
        self._path.append(self._inputs)


def solve_wind_up(
    transmitted_torque: Callable[[float], float], required_torque: float, approximate_stiffness: float
) -> float:
    """Solve for the wind-up [rad] at which a drive transmits a torque [N.m].

    transmitted_torque    : wind-up [rad] -> torque [N.m]
    approximate_stiffness : approximate stiffness [N.m/rad], for the initial bracket
    """
    from scipy.optimize import brentq  # slow to import, and most commands import this module

    def residual(trial_wind_up: float) -> float:
        """Torque [N.m] transmitted at a wind-up [rad], minus the torque to be transmitted."""
        return transmitted_torque(trial_wind_up) - required_torque

    if not required_torque:
        return 0.0
    end = required_torque / approximate_stiffness
    while residual(end) * required_torque < 0.0:
        end *= 2.0
    return float(brentq(residual, 0.0, end, xtol=1e-16))


@dataclass(slots=True)
class DriveTestRig:
    """Simulated test rig: a drive whose input rotates at a steady speed, with a torque at its output.

    running_drive         : running drive; inputs: angle and speed of wave generator (phi1, w1) and output
                            (phi2, w2); first outputs: transmitted torque tau, motor torque tau1
    speed_ratio           : speed ratio [1]
    presliding_rotation   : rotation [rad] of the wave generator before its friction slips
    zero_torque_stiffness : [N.m/rad] without torque
    motor_angle           : phi1 [rad]
    step_count            : number of steps so far

    `open_fmu_test_rig` and `make_test_rig` create a rig.
    """

    running_drive: Slave | SimulatedDrive
    speed_ratio: float
    presliding_rotation: float
    zero_torque_stiffness: float
    motor_angle: float = 0.0
    step_count: int = 0

    def motor_torque(self, motor_speed: float, output_torque: float) -> float:
        """Torque [N.m] of the motor at a steady speed.

        motor_speed   : [rad/s] of the motor; 0.0 is the limit for positive speeds
        output_torque : [N.m] external torque on the output, positive in the direction of its angle
        """
        wind_up, ratio = self._wind_up(output_torque), self.speed_ratio
        self.running_drive.set_inputs(self.motor_angle, 0.0, self.motor_angle / ratio + wind_up, 0.0)
        self.running_drive.do_step(float(self.step_count), 1.0)
        self.step_count += 1
        self.motor_angle += math.copysign(
            _DEVELOPED_FRICTION_ROTATION_OVER_PRESLIDING * self.presliding_rotation, motor_speed
        )
        self.running_drive.set_inputs(
            self.motor_angle, motor_speed, self.motor_angle / ratio + wind_up, motor_speed / ratio
        )
        return -self.running_drive.get_outputs()[1]

    def efficiency(self, motor_speed: float, load_torque: float) -> float:
        """Efficiency [1]: output power over motor power.

        motor_speed : [rad/s] of the motor, > 0
        load_torque : [N.m] at the output against the motion, > 0
        """
        return load_torque / (
            abs(self.speed_ratio)
            * self.motor_torque(motor_speed, -math.copysign(load_torque, self.speed_ratio))
        )

    def starting_torque(self) -> float:
        """Motor torque [N.m] that starts the rotation of the drive without load."""
        return self.motor_torque(0.0, 0.0)

    def back_driving_torque(self, max_searched_torque: float) -> float:
        """Torque [N.m] at the output that rotates the drive without a motor.

        max_searched_torque : end of the search; inf is returned if a larger torque is needed
        """
        from scipy.optimize import brentq  # slow to import, and most commands import this module

        def required_torque(output_torque: float) -> float:
            """Motor torque [N.m] for slow rotation in the direction of a load torque on the output."""
            return self.motor_torque(0.0, math.copysign(output_torque, self.speed_ratio))

        if required_torque(0.0) == 0.0:
            return 0.0
        if required_torque(max_searched_torque) > 0.0:
            return math.inf
        return float(brentq(required_torque, 0.0, max_searched_torque, rtol=1e-9))

    def _wind_up(self, output_torque: float) -> float:
        """Wind-up [rad] of the output under a torque [N.m]."""

        def transmitted_torque(angle: float) -> float:
            """Torque [N.m] that the running drive transmits at an output angle."""
            self.running_drive.set_inputs(
                self.motor_angle, 0.0, self.motor_angle / self.speed_ratio + angle, 0.0
            )
            return self.running_drive.get_outputs()[0]

        return solve_wind_up(transmitted_torque, output_torque, self.zero_torque_stiffness)


@contextmanager
def open_fmu_test_rig(fmu_path: Path, start_values: Mapping[str, float]) -> Iterator[DriveTestRig]:
    """Open the FMU HarmonicDriveSpring (FMI 2.0) as a test rig; the parameters replace default values."""
    wires = (*_TORQUE_OUTPUT_NAMES, "K_WTS", "ratio", "presliding")
    with Slave(
        fmu_path, {**start_values, **_PARAMETERS_WITHOUT_ERRORS_AND_HYSTERESIS}, _FLANGE_INPUT_NAMES, wires
    ) as drive:
        _, _, stiffness, ratio, presliding = drive.get_outputs()
        yield DriveTestRig(drive, ratio, presliding, stiffness)


def make_test_rig(fmu_model: Model, parameter_file: ParameterFile) -> DriveTestRig:
    """Make a test rig of the drive with the parameters of a file. No FMU is needed."""
    steady = parameter_file.with_values(_PARAMETERS_WITHOUT_ERRORS_AND_HYSTERESIS, "user", "steady")
    drive = SimulatedDrive(fmu_model, steady)
    return DriveTestRig(drive, steady.values.ratio, steady.values.presliding, drive.get_outputs()[2])


LOST_MOTION_TORQUE_OVER_RATED = 0.04
"""Torque over rated torque [1], positive and negative, at which catalogues state lost motion."""


def compute_hysteresis_loss(drive_spring: HarmonicDriveSpring) -> float:
    """Hysteresis loss [rad]: angle between the branches at zero torque, in the loop up to rated torque."""
    rated = float(drive_spring.joint.rated_torque)
    unloading, loading = (_final_wind_up(drive_spring, (rated, sign * rated, 0.0)) for sign in (1.0, -1.0))
    return unloading - loading


def compute_lost_motion(
    drive_spring: HarmonicDriveSpring, torque_over_rated: float = LOST_MOTION_TORQUE_OVER_RATED
) -> float:
    """Lost motion [rad]: change of the mean angle of both branches between two small torques -T and +T.

    The branches are those of the hysteresis loop between plus and minus the rated torque.

    torque_over_rated : T over the rated torque [1]
    """
    rated = float(drive_spring.joint.rated_torque)
    ends = (
        0.5
        * sum(
            _final_wind_up(drive_spring, (rated, side * rated, sign * torque_over_rated * rated))
            for side in (1.0, -1.0)
        )
        for sign in (1.0, -1.0)
    )
    positive, negative = ends
    return positive - negative


def _final_wind_up(drive_spring: HarmonicDriveSpring, torque_sequence: tuple[float, ...]) -> float:
    """Wind-up [rad] of a drive after a sequence of torques [N.m], starting at rest."""
    history = drive_spring.initial_history()
    for torque in torque_sequence:
        outputs, history = drive_spring.advance_torque(torque, history)
    return float(outputs["phi_rel"])
