"""Synthetic records of systems with known parameters: motor, harmonic drive and link.

A drive without friction and hysteresis is a linear system, whose motion scipy computes exactly
(`scipy.signal.lsim`, torques linear between samples). With friction and hysteresis the compiled system is
simulated at a tolerance a thousand times tighter than in a fit. Encoders have noise and a resolution.
"""

from pathlib import Path

import numpy as np
from jointfmu_tools.common.columns import format_table
from jointfmu_tools.inputs.fitting.outcome import FitResult
from jointfmu_tools.systems.fit import compiled_system
from jointfmu_tools.systems.fit.estimate import fit_system
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.system import read_system
from scipy.signal import StateSpace, chirp, lfilter, lsim

RATIO = 100.0
LINEAR = {"motor.J": 1e-4, "link.J": 0.8, "drive.K1": 1e4, "drive.d": 5.0}
"""Parameters of the linear system [SI]."""
FRICTION = {
    "motor.J": 1e-4,
    "link.J": 0.8,
    "drive.hysteresis_loss": 3e-4,
    "drive.friction_coulomb": 0.02,
    "drive.friction_viscous": 2e-4,
}
"""Parameters of the system with friction [SI]."""
RESOLUTIONS = {"motor.phi": 2.0 * np.pi / 2**12, "link.phi": 2.0 * np.pi / 2**17}
"""Resolution of the encoders [rad]; the standard deviation of their noise is half of it."""
RELEASED_ANGLE = 1e-3
"""Angle from which the link is released [rad]."""

TIME = 2e-3 * np.arange(600)
"""Times of the records [s]."""
START_RATIO = 1.3
"""Start value over true value [1]."""
WARM_UP = 100
"""Samples of correlated noise before the record."""
_SYSTEM = """\
schema = 1
name = "arm"
connect = [{motor_side}, ["drive.flange2", "link.flange_b"]]

[drive]
model = "HarmonicDriveSpring"
parameters = "arm_drive.toml"
{drive}
{motor}
[link]
model = "RotationalInertia"
{link}
[experiment]
stop_time = {{ value = 1.0, unit = "s", kind = "estimate", source = "test" }}
interval = {{ value = 1e-4, unit = "s", kind = "estimate", source = "test" }}
"""
_DRIVE = """\
schema = 1
joint = "harmonic_drive"
law = "catalogue"
name = "linear drive"
"""
_UNITS = {
    "ratio": "1", "d": "N.m.s/rad", "rated_torque": "N.m", "K1": "N.m/rad", "K2": "N.m/rad", "K3": "N.m/rad",
    "T1": "N.m", "T2": "N.m", "max_torque": "N.m", "hysteresis_loss": "rad", "friction_coulomb": "N.m",
    "friction_viscous": "N.m.s/rad", "J": "kg.m2",
}  # fmt: skip
_DRIVE_VALUES = {
    "ratio": RATIO,
    "d": 5.0,
    "rated_torque": 40.0,
    "K1": 1e4,
    "K2": 1e4,
    "K3": 1e4,
    "T1": 20.0,
    "T2": 40.0,
    "max_torque": 160.0,
}


def _format_entry(name: str, value: float) -> str:
    return f'{name} = {{ value = {value!r}, unit = "{_UNITS[name]}", kind = "estimate", source = "test" }}\n'


def write_system(folder: Path, values: dict[str, float], start_ratio: float = 1.0) -> Path:
    """Write a system file, and the drive that it names; returns its path.

    values      : {COMPONENT.PARAMETER: value [SI]}; without motor.J the drive is on the ground
    start_ratio : factor of all these values in the file
    """
    entries = {"motor": "", "drive": "", "link": ""}
    for name, value in values.items():
        component, _, parameter = name.partition(".")
        entries[component] += _format_entry(parameter, start_ratio * value)
    drive = "".join(_format_entry(name, value) for name, value in _DRIVE_VALUES.items())
    (folder / "arm_drive.toml").write_text(_DRIVE + drive)
    if entries["motor"]:
        motor_side = '["motor.flange_b", "drive.flange1"]'
        entries["motor"] = f'[motor]\nmodel = "RotationalInertia"\n{entries["motor"]}'
    else:
        motor_side = '["drive.flange1", "ground"]'
    path = folder / "arm.toml"
    path.write_text(_SYSTEM.format(motor_side=motor_side, **entries))
    return path


def make_torque(time: np.ndarray, height: float) -> np.ndarray:
    """Chirp of the motor torque [N.m] from 1 to 40 Hz over the times (n) [s]."""
    return height * chirp(time, 1.0, time[-1], 40.0, phi=-90.0)


def move_linear_system(time: np.ndarray, torque: np.ndarray) -> dict[str, np.ndarray]:
    """Angles (n) [rad] of motor and link of the linear system under a motor torque (n) [N.m], from rest."""
    motor, link, stiffness, damping = LINEAR.values()
    wind_up = np.array([[-1.0 / RATIO, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0 / RATIO, 1.0]])
    load = stiffness * wind_up[0] + damping * wind_up[1]  # torque of the drive at the output
    a = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], load / (RATIO * motor), -load / link])
    b = np.array([[0.0], [0.0], [1.0 / motor], [0.0]])
    _, angles, _ = lsim(StateSpace(a, b, np.eye(2, 4), np.zeros((2, 1))), torque, time)
    return {"motor.phi": angles[:, 0], "link.phi": angles[:, 1]}


def release_link(time: np.ndarray, angle: float) -> dict[str, np.ndarray]:
    """Angle (n) [rad] of the link on the held drive after its release from an angle [rad], in closed form."""
    _, link, stiffness, damping = LINEAR.values()
    rate = damping / (2.0 * link)
    frequency = np.sqrt(stiffness / link - rate**2)
    phase = frequency * time
    return {"link.phi": angle * np.exp(-rate * time) * (np.cos(phase) + rate / frequency * np.sin(phase))}


def move_drive_with_friction(path: Path, time: np.ndarray, torque: np.ndarray) -> dict[str, np.ndarray]:
    """Angles (n) [rad] of motor and link of the system with friction in the file `path`."""
    compiled = compiled_system.CompiledSystem(assemble_system(read_system(path)))
    simulated = compiled.simulate({}, time, {"motor.tau_a": torque}, [*RESOLUTIONS], 1e-10)
    return dict(zip(RESOLUTIONS, simulated.T, strict=True))


def write_record(path: Path, columns: dict[str, np.ndarray], seed: int, correlation: float = 0.0) -> Path:
    """Write a record with the angles that encoders of RESOLUTIONS show.

    columns     : {time, input or angle: values (n) [SI]}
    correlation : of the noise of neighbouring samples [1]
    """
    random, units = np.random.default_rng(seed), {"time": "s", "motor.tau_a": "N.m"}
    table = []
    for name, column in columns.items():
        if name in RESOLUTIONS:
            step = RESOLUTIONS[name]
            white = random.normal(0.0, 0.5 * step, column.size + WARM_UP)
            noise = lfilter([np.sqrt(1.0 - correlation**2)], [1.0, -correlation], white)[WARM_UP:]
            table.append(step * np.round((column + noise) / step))
        else:
            table.append(column)
    path.write_text(format_table([(name, units.get(name, "rad")) for name in columns], table))
    return path


def make_chirp_record(folder: Path, seed: int, correlation: float = 0.0) -> tuple[Path, Path]:
    """System file with start values and record of the linear system under a chirp of the motor torque."""
    torque = make_torque(TIME, 0.05)
    columns = {"time": TIME, "motor.tau_a": torque} | move_linear_system(TIME, torque)
    return write_system(folder, LINEAR, START_RATIO), write_record(
        folder / "record.csv", columns, seed, correlation
    )


def make_correlated_record(folder: Path, seed: int) -> tuple[Path, Path]:
    """System file with start values and record of the linear system under a chirp, with correlated noise."""
    return make_chirp_record(folder, seed, 0.8)


def make_ring_down(folder: Path, seed: int, angle: float = RELEASED_ANGLE) -> tuple[Path, Path]:
    """System file with start values and record of the released link on the held drive."""
    record = write_record(folder / "record.csv", {"time": TIME} | release_link(TIME, angle), seed)
    return write_system(folder, RING_DOWN, START_RATIO), record


def make_friction_record(folder: Path, seed: int) -> tuple[Path, Path]:
    """System file with start values and record of the drive with friction and hysteresis, under a chirp."""
    torque = make_torque(TIME, 0.06)
    columns = {"time": TIME, "motor.tau_a": torque}
    columns |= move_drive_with_friction(write_system(folder, FRICTION), TIME, torque)
    return write_system(folder, FRICTION, START_RATIO), write_record(folder / "record.csv", columns, seed)


RING_DOWN = {name: LINEAR[name] for name in ("link.J", "drive.d")}
"""Fitted parameters of the ring-down [SI], beside the angle of release."""
CASES = {
    "motor, drive and link, chirp of the torque": (make_chirp_record, LINEAR),
    "the same, noise correlated (0.8)": (make_correlated_record, LINEAR),
    "ring-down of the link": (make_ring_down, RING_DOWN | {"link.phi": RELEASED_ANGLE}),
    "with friction and hysteresis, chirp of the torque": (make_friction_record, FRICTION),
}
"""{record: (its maker, parameters to fit with their true values [SI])}."""


def fit_case(name: str, seed: int, folder: Path, hold_out: float = 0.0) -> FitResult:
    """Fit the record of a case."""
    make, truth = CASES[name]
    path, record = make(folder, seed)
    return fit_system(read_system(path), record, [*truth], hold_out)


def count_held(fit: FitResult, truth: dict[str, float]) -> dict[str, bool]:
    """{parameter: whether its interval contains the true value}."""
    return {name: low <= truth[name] <= high for name, (low, high) in fit.confidence_intervals.items()}
