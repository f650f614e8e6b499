"""Load cycles: run an FMU along cycles of one input in fmpy; energy loss and stiffness of the loops."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array, units

from ...common import columns
from ..host import unpack_fmu
from . import ramp

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

WAVEFORMS = ("triangle", "sine")
"""Waveforms of load cycles."""
DEFAULT_POINTS_PER_CYCLE, DEFAULT_CYCLE_COUNT = 200, 2
MIN_POINTS_PER_CYCLE, MAX_POINTS_PER_CYCLE = 8, 1_000_000
MAX_CYCLE_COUNT = 1000
"""Largest number of load cycles [1]."""
MAX_AMPLITUDE_OVER_NOMINAL = 1e4
"""Largest amplitude over the nominal value of the input [1]: 10 mm of a relative displacement."""
MAX_ROUND_OFF_WORK_OVER_BOUNDING_BOX_AREA = 1e-12
"""Work over the area of the loop's bounding box [1] below which the work is round-off."""
JOULE_EXPONENTS = units.base_exponents("J")
"""Exponents of the SI base units of the joule."""
FORCE_AND_TORQUE_UNITS = (units.base_exponents("N"), units.base_exponents("N.m"))
"""Units of a force and of a torque; the other of two conjugate variables is the displacement or rotation."""
LOOP_COLUMN_NAMES = {"m": ("displacement", "force"), "rad": ("angle", "torque")}
"""{unit of the displacement: column names of displacement and force}, as `jointfmu fit loop` reads them."""


@dataclass(frozen=True, slots=True)
class CyclicInputPath:
    """Path of an FMU's input in load cycles: first loading to an amplitude, then cycles about a centre.

    centre_value     : value of the input at the start and in the middle of the cycles
    waveform         : waveform, one of WAVEFORMS
    points_per_cycle : number of points of a cycle, a multiple of four
    cycle_count      : number of cycles after the first loading; the last cycle is evaluated
    """

    centre_value: float = 0.0
    waveform: str = WAVEFORMS[0]
    points_per_cycle: int = DEFAULT_POINTS_PER_CYCLE
    cycle_count: int = DEFAULT_CYCLE_COUNT

    def __post_init__(self) -> None:
        if not np.isfinite(self.centre_value):
            raise ValueError(f"about = {self.centre_value:g} is outside (-inf, inf): must be finite")
        if (
            self.points_per_cycle % 4
            or not MIN_POINTS_PER_CYCLE <= self.points_per_cycle <= MAX_POINTS_PER_CYCLE
        ):
            raise ValueError(
                f"points = {self.points_per_cycle}, allowed are multiples of 4 from {MIN_POINTS_PER_CYCLE} "
                f"to {MAX_POINTS_PER_CYCLE}"
            )
        if not 1 <= self.cycle_count <= MAX_CYCLE_COUNT:
            raise ValueError(f"cycles = {self.cycle_count} is outside [1, {MAX_CYCLE_COUNT}]")

    def compute_input_values(self, amplitude: float) -> Array:
        """Values of the input: first loading to an amplitude, then full cycles from there."""
        if not 0.0 < amplitude < np.inf:
            raise ValueError(f"loop = {amplitude:g} is outside (0, inf): the amplitude of the input")
        phase = (
            np.arange(self.points_per_cycle // 4 + self.cycle_count * self.points_per_cycle + 1)
            / self.points_per_cycle
        )
        turned = np.abs((phase + 0.25) % 1.0 - 0.5)  # 1/4 at the centre, 0 at the upper end
        value = 1.0 - 4.0 * turned if self.waveform == "triangle" else np.sin(2.0 * np.pi * phase)
        return np.asarray(self.centre_value + amplitude * value)


@dataclass(frozen=True, slots=True)
class HysteresisLoop:
    """Hysteresis loop of one amplitude of an FMU's input: first loading and cycles.

    displacements, forces  : (n) displacement or rotation, and force or torque on the joint in its direction
    last_cycle_start_index : index of the first point of the last cycle, which ends at the last point
    path_result            : all inputs and outputs of the FMU along the path
    """

    displacements: Array
    forces: Array
    last_cycle_start_index: int
    path_result: ramp.RampResult

    @property
    def _last_cycle(self) -> tuple[Array, Array]:
        """Displacements and forces at the points of the last load cycle."""
        return self.displacements[self.last_cycle_start_index :], self.forces[self.last_cycle_start_index :]

    @property
    def displacement_and_force_amplitude(self) -> tuple[float, float]:
        """Amplitudes of displacement and force: half of their ranges in the last cycle."""
        motion, force = self._last_cycle
        return 0.5 * float(np.ptp(motion)), 0.5 * float(np.ptp(force))

    @property
    def energy_loss(self) -> float:
        """Energy loss [J] of the last cycle, by the trapezoidal rule; 0 if it is round-off."""
        motion, force = self._last_cycle
        work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(motion)))
        return (
            work
            if abs(work) > MAX_ROUND_OFF_WORK_OVER_BOUNDING_BOX_AREA * float(np.ptp(motion) * np.ptp(force))
            else 0.0
        )

    def compute_loop_quantities(self) -> dict[str, float]:
        """Compute amplitudes, secant stiffness, energy loss and loss factor of the loop: {name: value}.

        The secant stiffness K is that between the ends of the loop. The loss factor is loss/(pi K a^2) with
        the amplitude a of the displacement.
        """
        motion, force = self.displacement_and_force_amplitude
        stiffness = force / motion
        found = {
            "motion": motion,
            "force": force,
            "secant_stiffness": stiffness,
            "loss": self.energy_loss,
            "loss_factor": self.energy_loss / (np.pi * force * motion) if force else 0.0,
        }
        if "E_loss" in self.path_result.variable_columns:
            found["E_loss"] = float(
                np.diff(self.path_result.variable_columns["E_loss"][[self.last_cycle_start_index, -1]])[0]
            )
        return found


@dataclass(frozen=True, slots=True)
class HysteresisLoops:
    """Hysteresis loops of one FMU, for several amplitudes of one input.

    displacement_name, force_name : names of the variables
    displacement_and_force_units  : units of displacement (or rotation) and force (or torque)
    force_sign                    : sign of the variable `force_name` as a force on the joint in the direction
        of the displacement: +1 or -1
    loops                         : one loop for each amplitude, in the requested order
    """

    displacement_name: str
    force_name: str
    displacement_and_force_units: tuple[str, str]
    force_sign: float
    loops: Sequence[HysteresisLoop]

    @property
    def loop_column_names(self) -> tuple[str, str]:
        """Column names of displacement and force in CSV files, which `jointfmu fit loop` reads."""
        return LOOP_COLUMN_NAMES[self.displacement_and_force_units[0]]

    @property
    def log_messages(self) -> tuple[str, ...]:
        """Log messages of the FMU from all loops."""
        return tuple(dict.fromkeys(text for loop in self.loops for text in loop.path_result.log_messages))

    @property
    def loop_quantity_units(self) -> dict[str, str]:
        """Units {name: unit} of a loop's amplitudes, secant stiffness and energy loss."""
        stiffness = "N/m" if self.displacement_and_force_units[0] == "m" else "N.m/rad"
        return {
            "motion": self.displacement_and_force_units[0],
            "force": self.displacement_and_force_units[1],
            "secant_stiffness": stiffness,
            "loss": "J",
        }

    def describe_loop_columns(self) -> str:
        """Variables of the FMU that the columns of displacement and force contain, as text."""
        displacement, force = self.loop_column_names
        sign = "-" if self.force_sign < 0.0 else ""
        return f"{displacement} = {self.displacement_name}, {force} = {sign}{self.force_name}"

    def compute_quantities_of_loops(self) -> list[dict[str, float]]:
        """Compute amplitudes, stiffness and energy loss of each loop: {name: value}."""
        return [loop.compute_loop_quantities() for loop in self.loops]

    def format_quantity_table(self) -> str:
        """Format stiffness and energy loss of each loop as a row of CSV text, with six digits."""
        rows = self.compute_quantities_of_loops()
        own = dict(zip(("motion", "force"), self.loop_column_names, strict=True))
        given = {"E_loss": "J", "loss_factor": "1"} | self.loop_quantity_units
        return columns.format_table(
            [(own.get(name, name), given[name]) for name in rows[0]],
            [np.array([row[name] for row in rows]) for name in rows[0]],
            significant_digits=6,
        )

    def format_point_table(self) -> str:
        """Format all points of all loops as CSV text that `jointfmu fit loop` reads.

        Columns: number of the loop, displacement, force, outputs.
        """
        first = self.loops[0].path_result
        others = [
            name for name in first.variable_columns if name not in (self.displacement_name, self.force_name)
        ]
        names = [*self.loop_column_names, *others]
        heads = [
            ("run", "1"),
            *zip(
                names,
                (*self.displacement_and_force_units, *(first.variable_units[name] for name in others)),
                strict=True,
            ),
        ]
        parts = [
            [
                np.full(loop.displacements.size, float(number)),
                loop.displacements,
                loop.forces,
                *(loop.path_result.variable_columns[name] for name in others),
            ]
            for number, loop in enumerate(self.loops, 1)
        ]
        return columns.format_table(heads, [np.concatenate(part) for part in zip(*parts, strict=True)])


def run_loops(
    fmu_path: str | Path,
    input_name: str,
    amplitudes: Sequence[float],
    cyclic_path: CyclicInputPath,
    output_name: str | None = None,
    start_values: Mapping[str, object] | None = None,
) -> HysteresisLoops:
    """Run an FMU along load cycles of one input, one instance for each amplitude, from rest.

    All other inputs are constant.

    output_name : output that is energy-conjugate to the input; None: the conjugate output with the same
        suffix, `f_x` for `s_rel_x`, `tau2` for `phi2`

    Raises ValueError as `ramp.run_ramp`, for an amplitude that is not positive, or if no output is conjugate
    to the input.
    """
    points = [cyclic_path.compute_input_values(amplitude) for amplitude in amplitudes]
    with unpack_fmu(fmu_path) as (_, model_description):
        _check_amplitudes(model_description, input_name, amplitudes)
        output_name = find_conjugate_output(
            *input_and_output_units(model_description), input_name, output_name, str(fmu_path)
        )
    return loops_from_results(
        [ramp.run_path(fmu_path, input_name, each, start_values) for each in points],
        input_name,
        output_name,
        cyclic_path,
    )


def _check_amplitudes(
    model_description: "ModelDescription", input_name: str, amplitudes: Sequence[float]
) -> None:
    """Raise ValueError if an amplitude is so far above the input's nominal value that its unit is wrong."""
    for variable in model_description.modelVariables:
        if variable.name == input_name and variable.nominal and variable.unit:
            nominal = float(variable.nominal)
            largest = MAX_AMPLITUDE_OVER_NOMINAL * nominal
            for amplitude in amplitudes:
                if amplitude > largest:
                    raise ValueError(
                        f"loop = {amplitude:g} {variable.unit} of {input_name} is outside (0, {largest:g}] "
                        f"{variable.unit}: values are in SI units, usual is about {nominal:g} "
                        f"{variable.unit}"
                    )


def loops_from_results(
    ramp_results: Sequence[ramp.RampResult], input_name: str, output_name: str, cyclic_path: CyclicInputPath
) -> HysteresisLoops:
    """Make hysteresis loops from results along load cycles of an input, one for each amplitude.

    output_name : output that is energy-conjugate to the input
    """
    first = max(ramp_results, key=lambda result: float(np.ptp(result.variable_columns[input_name])))
    driven = units.base_exponents(first.variable_units[input_name]) in FORCE_AND_TORQUE_UNITS
    motion, force = (output_name, input_name) if driven else (input_name, output_name)
    x, y = first.variable_columns[motion], first.variable_columns[force]
    sign = -1.0 if np.sum((x - x.mean()) * (y - y.mean())) < 0.0 else 1.0
    closed = cyclic_path.points_per_cycle // 4 + (cyclic_path.cycle_count - 1) * cyclic_path.points_per_cycle
    loops = [
        HysteresisLoop(r.variable_columns[motion], sign * r.variable_columns[force], closed, r)
        for r in ramp_results
    ]
    return HysteresisLoops(
        motion, force, (first.variable_units[motion], first.variable_units[force]), sign, loops
    )


def input_and_output_units(model_description: "ModelDescription") -> tuple[dict[str, str], dict[str, str]]:
    """Units of an FMU's inputs, {name: unit}, and of its outputs, from the model description of fmpy."""
    inputs, outputs = (
        {v.name: v.unit or "1" for v in model_description.modelVariables if v.causality == causality}
        for causality in ("input", "output")
    )
    return inputs, outputs


def find_conjugate_output(
    input_units: Mapping[str, str],
    output_units: Mapping[str, str],
    input_name: str,
    stated_output: str | None,
    fmu_label: str,
) -> str:
    """Find the output that is energy-conjugate to an input: the product of their units is an energy.

    If several outputs are conjugate, the one with the suffix of the input is chosen.

    input_units, output_units : {name: unit}
    stated_output             : output that the user states; None: find it
    fmu_label                 : name of the FMU, for messages

    Raises ValueError if no output is conjugate, or if the stated output is not.
    """
    if input_name not in input_units:
        raise ValueError(f"{fmu_label}: unknown input {input_name!r}, allowed are {', '.join(input_units)}")
    own = input_units[input_name]
    fitting = [
        name for name, unit in output_units.items() if unit != "J" and _is_energy_unit_product(own, unit)
    ]
    if stated_output is not None:
        if stated_output not in fitting:
            raise ValueError(
                f"{fmu_label}: {stated_output!r} is not an output whose product with {input_name} is an "
                f"energy, allowed are {', '.join(fitting) or 'none'}"
            )
        return stated_output
    if not fitting:
        raise ValueError(
            f"{fmu_label}: no output multiplied by {input_name} [{own}] is an energy; expected a "
            "displacement, an angle, a force or a torque as input"
        )
    same = [name for name in fitting if variable_suffix(name) == variable_suffix(input_name)]
    return (same or fitting)[0]


def variable_suffix(variable_name: str) -> str:
    """Suffix of a variable name that states axis or flange: `_x` of `f_x`, `2` of `tau2`; else empty."""
    match = re.search(r"(_[xyz]|\d+)$", variable_name)
    return match[0] if match else ""


def _is_energy_unit_product(first_unit: str, second_unit: str) -> bool:
    """Whether the product of two units is a unit of energy; the radian is ignored."""
    try:
        parts = units.base_exponents(first_unit), units.base_exponents(second_unit)
    except ValueError:
        return False
    whole = {name: sum(part.get(name, 0) for part in parts) for name in {**parts[0], **parts[1]}}
    return {
        name: n for name, n in whole.items() if n and name != "rad"
    } == JOULE_EXPONENTS and first_unit != "1" != second_unit
