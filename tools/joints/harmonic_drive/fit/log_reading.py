"""Logs of a robot: read and check the columns, filter them, select samples.

A log with the column time is dynamic. Motion and torque pass the same filter, a local polynomial over
FILTER_WINDOW_TIME (Savitzky and Golay 1964), which also gives the derivatives. One sample per window is kept,
so that the noise of the samples is independent. Samples are marked if the drive has rotated far enough since
its last reversal. A log without the column time is a table of steady speeds, and is not filtered.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.quantity import Array
from jointfmu.quantity.units import CELSIUS_ZERO_IN_KELVIN, UnitSizes, unit_sizes

from ....common import columns

SampleIndices: TypeAlias = NDArray[np.int_]
"""Indices of samples."""
FILTER_WINDOW_TIME, FILTER_POLYNOMIAL_DEGREE = 0.04, 4
"""Window of the filter [s], and degree of its polynomial [1]."""
FILTER_NODE_COUNT = 9
"""Number of speeds in a window at which friction is evaluated and filtered; smallest number of samples of a
window."""
DEVELOPED_FRICTION_ROTATION_OVER_PRESLIDING = 5.0
"""Rotation of the motor since a reversal over `presliding` [1] after which friction is developed to 99 %."""
MIN_LARGEST_OVER_SMALLEST_SPEED = 1.2
"""Largest speed over smallest speed [1] that a log must exceed."""


@dataclass(frozen=True, slots=True)
class LogSamples:
    """Samples of logs; arrays (n) in SI units, NaN for columns that a log does not have.

    time                  : [s]
    q, dq, ddq            : angle [rad], speed [rad/s] and acceleration [rad/s2] of the joint
    window_speeds         : (n, FILTER_NODE_COUNT) [rad/s] of the joint, within the window of the filter
    window_weights        : (n, FILTER_NODE_COUNT) [1] of the filter at these speeds
    window_angles         : (n, FILTER_NODE_COUNT) [rad] of the motor at these speeds; NaN if unknown
    ripple_terms          : (n, 2 k) [1] filtered sense of rotation times sine and cosine of k harmonics of
                            the motor angle; k = 0 until friction ripple is found
    motor_torque          : [N.m] of the motor
    gravity_torque        : [N.m] torque at the joint that balances gravity
    temperature           : [K]
    motor_angle           : [rad]
    sensor_torque         : [N.m] of a sensor at the joint
    is_held_out           : sample for validation
    is_of_dynamic_log     : sample of a log with the column time
    is_friction_developed : friction is fully developed
    """

    time: Array
    q: Array
    dq: Array
    ddq: Array
    window_speeds: Array
    window_weights: Array
    window_angles: Array
    ripple_terms: Array
    motor_torque: Array
    gravity_torque: Array
    temperature: Array
    motor_angle: Array
    sensor_torque: Array
    is_held_out: NDArray[np.bool_]
    is_of_dynamic_log: NDArray[np.bool_]
    is_friction_developed: NDArray[np.bool_]

    @property
    def has_joint_torque_sensor(self) -> bool:
        """Whether the torque at the joint is measured for all samples."""
        return bool(np.all(np.isfinite(self.sensor_torque)))

    def select_samples(self, sample_selection: NDArray[np.bool_] | SampleIndices) -> "LogSamples":
        """Select samples of the logs by a mask or indices."""
        return LogSamples(*(getattr(self, field.name)[sample_selection] for field in fields(self)))


def join_samples(samples_of_logs: Sequence[LogSamples]) -> LogSamples:
    """Join the samples of several logs into one object."""
    return LogSamples(
        *(np.concatenate([getattr(p, f.name) for p in samples_of_logs]) for f in fields(LogSamples))
    )


def make_steady_speed_samples(columns_by_name: Mapping[str, Array], steady_motor_torque: Array) -> LogSamples:
    """Make the samples of a table of steady speeds; every third row is held out."""
    none = np.full(steady_motor_torque.size, np.nan)
    return LogSamples(
        time=none,
        q=columns_by_name.get("q", none),
        dq=columns_by_name["dq"],
        ddq=np.zeros(steady_motor_torque.size),
        window_speeds=np.repeat(columns_by_name["dq"][:, None], FILTER_NODE_COUNT, axis=1),
        window_weights=np.repeat(np.eye(1, FILTER_NODE_COUNT), steady_motor_torque.size, axis=0),
        window_angles=np.repeat(columns_by_name.get("q_motor", none)[:, None], FILTER_NODE_COUNT, axis=1),
        ripple_terms=np.zeros((steady_motor_torque.size, 0)),
        motor_torque=steady_motor_torque,
        gravity_torque=columns_by_name.get("gravity", none),
        temperature=columns_by_name.get("temperature", none),
        motor_angle=none,
        sensor_torque=columns_by_name.get("link_torque", none),
        is_held_out=np.arange(steady_motor_torque.size) % 3 == 1,
        is_of_dynamic_log=np.zeros(steady_motor_torque.size, dtype=bool),
        is_friction_developed=columns_by_name["dq"] != 0.0,
    )


def filter_window_size(time_step: float) -> int:
    """Number of samples in the window of the filter of a log, at a time step [s]; odd."""
    return max(2 * round(0.5 * FILTER_WINDOW_TIME / time_step) + 1, FILTER_NODE_COUNT)


def filter_column_values(column_values: Array, time_step: float, derivative_order: int = 0) -> Array:
    """Filtered column (n) of a log with a constant time step [s], or its filtered derivative."""
    return np.asarray(
        savgol_filter(
            column_values,
            filter_window_size(time_step),
            FILTER_POLYNOMIAL_DEGREE,
            derivative_order,
            time_step,
        )
    )


def make_dynamic_samples(
    sample_times: Array,
    time_step: float,
    columns_by_name: Mapping[str, Array],
    drive_parameters: DriveParameters,
) -> LogSamples:
    """Make the filtered samples of a log with a column `time`, at n times [s] with a constant step [s]."""
    none = np.full(sample_times.size, np.nan)

    def filter_column(column_name: str) -> Array:
        """Filter a column of the log, or its derivative; NaN if the log does not have it."""
        return (
            filter_column_values(columns_by_name[column_name], time_step)
            if column_name in columns_by_name
            else none
        )

    without_dq = "dq" not in columns_by_name
    dq = filter_column_values(columns_by_name["q"], time_step, 1) if without_dq else filter_column("dq")
    nodes, weights = _filter_window_nodes(filter_window_size(time_step))
    window = np.clip(np.arange(sample_times.size)[:, None] + nodes, 0, sample_times.size - 1)
    joint_angle, motor_angle = filter_column("q"), filter_column("q_motor")
    rotation = motor_angle if "q_motor" in columns_by_name else drive_parameters.ratio * joint_angle
    return LogSamples(
        time=sample_times,
        q=joint_angle,
        dq=dq,
        ddq=filter_column_values(columns_by_name["q"], time_step, 2)
        if without_dq
        else filter_column_values(columns_by_name["dq"], time_step, 1),
        window_speeds=dq[window],
        window_weights=np.repeat(weights[None, :], sample_times.size, axis=0),
        window_angles=rotation[window],
        ripple_terms=np.zeros((sample_times.size, 0)),
        motor_torque=filter_column("tau"),
        gravity_torque=filter_column("gravity"),
        temperature=columns_by_name.get("temperature", none),
        motor_angle=motor_angle,
        sensor_torque=filter_column("link_torque"),
        is_held_out=sample_times > sample_times[0] + 0.7 * (sample_times[-1] - sample_times[0]),
        is_of_dynamic_log=np.ones(sample_times.size, dtype=bool),
        is_friction_developed=_is_friction_developed(
            dq, time_step, filter_window_size(time_step), drive_parameters
        ),
    )


def _filter_window_nodes(window_sample_count: int) -> tuple[SampleIndices, Array]:
    """Sample offsets (FILTER_NODE_COUNT) of the nodes of the filter window, and the weights at the nodes.

    The weights are those for values that are linear between the nodes.
    """
    half = window_sample_count // 2
    nodes = np.round(np.linspace(-half, half, FILTER_NODE_COUNT)).astype(int)
    hats = [np.interp(np.arange(-half, half + 1), nodes, row) for row in np.eye(FILTER_NODE_COUNT)]
    return nodes, np.array(hats) @ savgol_coeffs(window_sample_count, FILTER_POLYNOMIAL_DEGREE, use="dot")


def _is_friction_developed(
    joint_speed: Array, time_step: float, window_sample_count: int, drive_parameters: DriveParameters
) -> NDArray[np.bool_]:
    """Mask (n) of samples with fully developed friction.

    The motor has rotated by DEVELOPED_FRICTION_ROTATION_OVER_PRESLIDING times the presliding rotation since
    its last reversal, and no reversal lies within the window of the filter (`window_sample_count` samples).
    """
    sign = np.sign(joint_speed)
    run = np.concatenate([[0], np.cumsum(np.diff(sign) != 0.0)])
    first = np.concatenate([[0], np.flatnonzero(np.diff(run)) + 1])
    last = np.concatenate([first[1:], [joint_speed.size]])
    index = np.arange(joint_speed.size)
    rotation = (
        np.concatenate([[0.0], np.cumsum(np.abs(joint_speed[1:]))]) * time_step * abs(drive_parameters.ratio)
    )
    before, after = index - first[run], last[run] - 1 - index
    developed = (
        rotation - rotation[first[run]]
        > DEVELOPED_FRICTION_ROTATION_OVER_PRESLIDING * drive_parameters.presliding
    )
    return np.asarray(
        developed & (before > window_sample_count // 2) & (after > window_sample_count // 2) & (sign != 0.0)
    )


COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "time": unit_sizes("s", "ms"),
    "q": unit_sizes("rad", "deg"),
    "dq": unit_sizes("rad/s", "deg/s", "rev/min"),
    "i": {"A": 1.0, "mA": 1e-3},
    "tau": unit_sizes("N.m", "mN.m"),
    "gravity": unit_sizes("N.m", "mN.m"),
    "q_motor": unit_sizes("rad", "deg", "rev"),
    "link_torque": unit_sizes("N.m", "mN.m"),
    "temperature": {"K": 1.0, "degC": 1.0, "°C": 1.0, "C": 1.0},
}
"""{column: {unit: size in SI}}: q, dq angle and speed of the joint; i, tau current and torque of the motor;
gravity torque at the joint that balances gravity; q_motor motor angle; link_torque torque sensor at the
joint."""
COLUMN_SYNONYMS: Mapping[str, Sequence[str]] = {
    "time": ("t", "timestamp", "zeit"),
    "q": ("position", "angle", "actual_q", "joint_position", "winkel", "gelenkwinkel"),
    "dq": (
        "qd",
        "speed",
        "velocity",
        "actual_qd",
        "joint_speed",
        "joint_velocity",
        "geschwindigkeit",
        "drehzahl",
        "winkelgeschwindigkeit",
    ),
    "i": ("current", "actual_current", "motor_current", "strom", "motorstrom", "iststrom"),
    "tau": ("torque", "motor_torque", "moment", "drehmoment", "motormoment"),
    "gravity": ("tau_g", "gravity_torque"),
    "q_motor": ("motor_angle", "motor_position", "theta", "motorwinkel"),
    "link_torque": ("joint_torque", "torque_sensor", "gelenkmoment", "abtriebsmoment"),
    "temperature": ("temp", "motor_temperature", "joint_temperature", "temperatur"),
}
"""{column: other headings that are accepted}."""
MIN_LOG_ROW_COUNT = 6
"""Required number of rows of a log."""
MAX_MOTOR_SPEED = 2000.0
"""Largest plausible speed of a wave generator [rad/s]: catalogues allow up to 14 000 rev/min."""
MAX_MOTOR_CURRENT = 1e3
"""Largest plausible motor current [A]."""
MAX_MOTOR_OVER_DRIVE_TORQUE = 3.0
"""Largest plausible motor torque over max_torque/ratio [1]."""
MIN_MOTOR_SPEED = 1e-3
"""Motor speed [rad/s] below which a log has no motion."""
MAX_RELATIVE_TIME_STEP_DEVIATION, MIN_TIME_GAP_OVER_TIME_STEP = 0.2, 10.0
"""Deviation of a time step from the median, over the median [1], up to which the sampling counts as even; and
time step over the median [1] that counts as a gap."""
SPEED_COLUMN_OVER_ANGLE_DERIVATIVE_RANGE = (0.5, 2.0)
"""Smallest and largest ratio of the column dq and the derivative of q [1]; outside, a unit is wrong."""


@dataclass(frozen=True, slots=True)
class MeasuredLog:
    """Log that is read from a file.

    has_motor_torque : whether torque or current of the motor is measured; if not, `motor_torque` of the
                       samples is the torque at the joint over the ratio
    """

    log_path: Path
    log_samples: LogSamples
    has_motor_torque: bool


def read_log_columns(
    log_path: Path, renamed_columns: Mapping[str, tuple[str, str | None]]
) -> columns.TableColumns:
    """Read the columns of a robot's log from a file.

    renamed_columns : {column: (heading, unit or None)} for other headings

    Raises ValueError with a one-line message that begins with the path.
    """
    return columns.read_columns(log_path, COLUMN_UNITS, MIN_LOG_ROW_COUNT, COLUMN_SYNONYMS, renamed_columns)


def make_measured_log(
    log_columns: columns.TableColumns,
    torque_constant: float | None,
    drive_parameters: DriveParameters,
    torque_location: str = "motor",
) -> MeasuredLog:
    """Make the samples of a robot's log from its columns.

    torque_constant  : motor torque over motor current [N.m/A]
    drive_parameters : drive, for plausibility checks of speed and torque
    torque_location  : side of the drive to which the torque in the column tau refers, "motor" or "joint"

    Raises ValueError with a one-line message that begins with the path.
    """
    path, have = log_columns.table_path, dict(log_columns.values_by_name)
    if torque_location == "joint" and "tau" in have:
        if "link_torque" in have:
            raise ValueError(
                f"{path}: has tau and link_torque, with --torque-at joint both at the joint; expected one "
                "of them"
            )
        have["link_torque"] = have.pop("tau")
    torque = _find_motor_torque(log_columns, have, torque_constant)
    has_motor_torque = torque is not None
    if torque is None:
        torque = _find_joint_torque(log_columns, have, torque_location) / abs(drive_parameters.ratio)
    if "temperature" in have and log_columns.heading_units["temperature"] != "K":
        have["temperature"] = have["temperature"] + CELSIUS_ZERO_IN_KELVIN
    if "time" in have:
        samples = _read_dynamic_log(log_columns, have, torque, drive_parameters)
    else:
        log_columns.require_column("dq", COLUMN_UNITS)
        samples = make_steady_speed_samples(have, torque)
        _check_speeds(path, samples, drive_parameters)
    _check_motor_torque(path, samples, drive_parameters, torque_constant)
    return MeasuredLog(path, samples, has_motor_torque)


def _find_motor_torque(
    log_columns: columns.TableColumns, columns_by_name: Mapping[str, Array], torque_constant: float | None
) -> Array | None:
    """Motor torque (n) [N.m], from the column of the torque or of the current; None if there is neither."""
    if "tau" in columns_by_name:
        return columns_by_name["tau"]
    if "i" not in columns_by_name:
        return None
    current = columns_by_name["i"]
    if np.max(np.abs(current)) > MAX_MOTOR_CURRENT:
        raise ValueError(
            f"{log_columns.table_path}: a current of {np.max(np.abs(current)):.4g} A is outside "
            f"[-{MAX_MOTOR_CURRENT:g}, {MAX_MOTOR_CURRENT:g}] A; likely i is in mA"
        )
    if torque_constant is None:
        raise ValueError(
            f"{log_columns.table_path}: has the motor current, but no torque; expected --torque-constant "
            "[N.m/A]"
        )
    return torque_constant * current


def _find_joint_torque(
    log_columns: columns.TableColumns, columns_by_name: Mapping[str, Array], torque_location: str
) -> Array:
    """Torque (n) [N.m] at the joint of a log without a torque of the motor.

    Raises ValueError if there is no torque, or if the user has not stated that it is measured at the joint.
    """
    wanted = columns.format_expected_heading({name: COLUMN_UNITS[name] for name in ("tau", "i")})
    if "link_torque" in columns_by_name:
        if torque_location == "joint":
            return columns_by_name["link_torque"]
        raise ValueError(
            f"{log_columns.table_path}: has the torque at the joint, link_torque, and no torque and no "
            f"current of the motor; expected {wanted}, or --torque-at joint"
        )
    names = ", ".join(columns.read_column_names(log_columns.table_path))
    raise ValueError(
        f"{log_columns.table_path}: has no torque and no current of the motor; expected {wanted}; the file "
        f"has {names}; a heading needs a unit, --columns 'i=HEADING [A]' states another heading"
    )


def _read_dynamic_log(
    log_columns: columns.TableColumns,
    columns_by_name: Mapping[str, Array],
    motor_torque: Array,
    drive_parameters: DriveParameters,
) -> LogSamples:
    """Read the filtered samples of a log with a column `time`, one per window of the filter."""
    if "q" not in columns_by_name and "dq" not in columns_by_name:
        raise ValueError(
            f"{log_columns.table_path}: has neither q nor dq; expected "
            f"{columns.format_expected_heading(COLUMN_UNITS)}"
        )
    time, step = _find_time_step(log_columns)
    even = np.arange(time[0], time[-1] + 0.5 * step, step)
    columns_by_name = {
        name: np.interp(even, time, x) for name, x in (*columns_by_name.items(), ("tau", motor_torque))
    }
    width = filter_window_size(step)
    if even.size < 2 * width:
        raise ValueError(
            f"{log_columns.table_path}: the record lasts {time[-1] - time[0]:.4g} s, expected at least "
            f"{2 * width * step:.3g} s"
        )
    samples = make_dynamic_samples(even, step, columns_by_name, drive_parameters)
    if "dq" in columns_by_name and "q" in columns_by_name:
        _check_speed_column(log_columns, filter_column_values(columns_by_name["q"], step, 1), samples.dq)
    _check_speeds(log_columns.table_path, samples, drive_parameters)
    return samples.select_samples(np.arange(width // 2, even.size - width // 2, width))


def _find_time_step(log_columns: columns.TableColumns) -> tuple[Array, float]:
    """Times (n) [s] of a log, and the time step [s] for resampling.

    Raises ValueError for times that do not increase, and for gaps.
    """
    time = log_columns.values_by_name["time"]
    steps = np.diff(time)
    if np.any(wrong := steps <= 0.0):
        first = int(np.argmax(wrong))
        raise ValueError(
            f"{log_columns.table_path}: line {log_columns.line_numbers[first + 1]}: time = "
            f"{time[first + 1]:.9g} s after {time[first]:.9g} s runs back; expected rising times"
        )
    step = float(np.median(steps))
    if np.any(wrong := steps > MIN_TIME_GAP_OVER_TIME_STEP * step):
        first = int(np.argmax(wrong))
        raise ValueError(
            f"{log_columns.table_path}: line {log_columns.line_numbers[first + 1]}: a gap of "
            f"{steps[first]:.4g} s, allowed is {MIN_TIME_GAP_OVER_TIME_STEP * step:.4g} s; cut the log "
            "there, several files are read at once"
        )
    if np.max(np.abs(steps - step)) < MAX_RELATIVE_TIME_STEP_DEVIATION * step:
        step = float(time[-1] - time[0]) / (time.size - 1)
    return time, step


def _check_speed_column(
    log_columns: columns.TableColumns, derivative_of_q: Array, joint_speed: Array
) -> None:
    """Check that dq is the derivative of q. Raises ValueError if not."""
    most = float(np.max(np.abs(derivative_of_q)))
    scale = float(joint_speed @ derivative_of_q / (derivative_of_q @ derivative_of_q)) if most else 0.0
    if (
        np.max(np.abs(joint_speed))
        and not SPEED_COLUMN_OVER_ANGLE_DERIVATIVE_RANGE[0]
        <= scale
        <= SPEED_COLUMN_OVER_ANGLE_DERIVATIVE_RANGE[1]
    ):
        hint = (
            "; likely one of them is in degrees"
            if 40.0 < max(abs(scale), 1.0 / abs(scale or 1.0)) < 80.0
            else ""
        )
        raise ValueError(
            f"{log_columns.table_path}: dq is {scale:.3g} times the derivative of q over time, expected "
            f"1{hint}"
        )


def _check_speeds(log_path: Path, log_samples: LogSamples, drive_parameters: DriveParameters) -> None:
    """Check the speeds of a log. Raises ValueError if nothing moves or a speed is implausible."""
    ratio = abs(drive_parameters.ratio)
    fastest = ratio * float(np.max(np.abs(log_samples.dq)))
    if fastest > MAX_MOTOR_SPEED:
        raise ValueError(
            f"{log_path}: the joint's speed of {fastest / ratio:.4g} rad/s turns the motor with "
            f"{fastest:.4g} rad/s, outside [0, {MAX_MOTOR_SPEED:g}]; likely angles are in degrees"
        )
    if fastest < MIN_MOTOR_SPEED:
        raise ValueError(
            f"{log_path}: has no motion; expected speeds of the joint above {MIN_MOTOR_SPEED / ratio:.2g} "
            "rad/s"
        )


def _check_motor_torque(
    log_path: Path, log_samples: LogSamples, drive_parameters: DriveParameters, torque_constant: float | None
) -> None:
    """Check the motor torque of a log. Raises ValueError if it is implausible for the drive."""
    limit = (
        MAX_MOTOR_OVER_DRIVE_TORQUE * float(drive_parameters.max_table_torque) / abs(drive_parameters.ratio)
    )
    largest = float(np.max(np.abs(log_samples.motor_torque)))
    if largest > limit:
        advice = "expected that of the motor, not of the joint (--torque-at joint), of a drive as stated"
        if torque_constant is not None:
            advice = f"check --torque-constant = {torque_constant:g} N.m/A, and the size of the drive"
        raise ValueError(
            f"{log_path}: a motor torque of {largest:.4g} N.m is outside [-{limit:.4g}, {limit:.4g}] N.m; "
            f"{advice}"
        )
