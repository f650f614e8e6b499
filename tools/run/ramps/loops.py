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
WORK_ROUND_OFF_OVER_BOX_AREA = 1e-12
"""Work over the area of the loop's bounding box [1] below which the work is round-off."""
ENERGY_UNIT = units.base_exponents("J")
"""Exponents of the SI base units of the joule."""
FORCE_UNITS = (units.base_exponents("N"), units.base_exponents("N.m"))
"""Units of a force and of a torque; the other of two conjugate variables is the motion."""
LOOP_COLUMN_NAMES = {"m": ("displacement", "force"), "rad": ("angle", "torque")}
"""{unit of the motion: names of the columns of motion and force}, as `jointfmu fit loop` reads them."""


@dataclass(frozen=True, slots=True)
class CyclicPath:
    """Path of an FMU's input in load cycles: first loading to an amplitude, then cycles about a centre.

    centre : value of the input at the start and in the middle of the cycles
    shape  : waveform, one of WAVEFORMS
    points : number of points of a cycle, a multiple of four
    cycles : number of cycles after the first loading; the last cycle is evaluated
    """

    centre: float = 0.0
    shape: str = WAVEFORMS[0]
    points: int = DEFAULT_POINTS_PER_CYCLE
    cycles: int = DEFAULT_CYCLE_COUNT

    def __post_init__(self) -> None:
        if not np.isfinite(self.centre):
            raise ValueError(f"about = {self.centre:g} is outside (-inf, inf): must be finite")
        if self.points % 4 or not MIN_POINTS_PER_CYCLE <= self.points <= MAX_POINTS_PER_CYCLE:
            raise ValueError(
                f"points = {self.points}, allowed are multiples of 4 from {MIN_POINTS_PER_CYCLE} to "
                f"{MAX_POINTS_PER_CYCLE}"
            )
        if not 1 <= self.cycles <= MAX_CYCLE_COUNT:
            raise ValueError(f"cycles = {self.cycles} is outside [1, {MAX_CYCLE_COUNT}]")

    def input_values(self, amplitude: float) -> Array:
        """Values of the input: first loading to an amplitude, then full cycles from there."""
        if not 0.0 < amplitude < np.inf:
            raise ValueError(f"loop = {amplitude:g} is outside (0, inf): the amplitude of the input")
        phase = np.arange(self.points // 4 + self.cycles * self.points + 1) / self.points
        turned = np.abs((phase + 0.25) % 1.0 - 0.5)  # 1/4 at the centre, 0 at the upper end
        value = 1.0 - 4.0 * turned if self.shape == "triangle" else np.sin(2.0 * np.pi * phase)
        return np.asarray(self.centre + amplitude * value)


@dataclass(frozen=True, slots=True)
class HysteresisLoop:
    """Hysteresis loop of one amplitude: first loading and cycles.

    motion, force : (n) motion, and force on the joint, positive in the direction of the motion
    cycle_start   : index of the first point of the last cycle, which ends at the last point
    result        : all outputs along the path
    """

    motion: Array
    force: Array
    cycle_start: int
    result: ramp.RampResult

    @property
    def _last_cycle(self) -> tuple[Array, Array]:
        """Motion and force of the last cycle."""
        return self.motion[self.cycle_start :], self.force[self.cycle_start :]

    @property
    def amplitudes(self) -> tuple[float, float]:
        """Amplitudes of motion and force: half of their ranges in the last cycle."""
        motion, force = self._last_cycle
        return 0.5 * float(np.ptp(motion)), 0.5 * float(np.ptp(force))

    @property
    def energy_loss(self) -> float:
        """Energy loss [J] of the last cycle, by the trapezoidal rule; 0 if it is round-off."""
        motion, force = self._last_cycle
        work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(motion)))
        return (
            work if abs(work) > WORK_ROUND_OFF_OVER_BOX_AREA * float(np.ptp(motion) * np.ptp(force)) else 0.0
        )

    def compute_results(self) -> dict[str, float]:
        """Results of the loop: {name: value}.

        The secant stiffness K is that between the ends of the loop. The loss factor is loss/(pi K a^2) with
        the amplitude a of the motion.
        """
        motion, force = self.amplitudes
        stiffness = force / motion
        found = {
            "motion": motion,
            "force": force,
            "secant_stiffness": stiffness,
            "loss": self.energy_loss,
            "loss_factor": self.energy_loss / (np.pi * force * motion) if force else 0.0,
        }
        if "E_loss" in self.result.columns:
            found["E_loss"] = float(np.diff(self.result.columns["E_loss"][[self.cycle_start, -1]])[0])
        return found


@dataclass(frozen=True, slots=True)
class HysteresisLoops:
    """Hysteresis loops of one FMU.

    motion_name, force_name : names of the variables
    units                   : units of motion and force
    force_sign              : force on the joint over the variable `force_name`: +1 or -1
    loops                   : one loop for each amplitude, in the requested order
    """

    motion_name: str
    force_name: str
    units: tuple[str, str]
    force_sign: float
    loops: Sequence[HysteresisLoop]

    @property
    def column_names(self) -> tuple[str, str]:
        """Names of the columns of motion and force in files, as `jointfmu fit loop` reads them."""
        return LOOP_COLUMN_NAMES[self.units[0]]

    @property
    def messages(self) -> tuple[str, ...]:
        """Log messages of the FMU in all loops."""
        return tuple(dict.fromkeys(text for loop in self.loops for text in loop.result.messages))

    @property
    def result_units(self) -> dict[str, str]:
        """Units of the results of a loop: {name: unit}, without dimensionless results."""
        stiffness = "N/m" if self.units[0] == "m" else "N.m/rad"
        return {"motion": self.units[0], "force": self.units[1], "secant_stiffness": stiffness, "loss": "J"}

    def compute_loop_results(self) -> list[dict[str, float]]:
        """Results of each loop: {name: value}."""
        return [loop.compute_results() for loop in self.loops]

    def format_table(self) -> str:
        """Format the results of the loops as CSV text with six digits, one row for each loop."""
        rows = self.compute_loop_results()
        own = dict(zip(("motion", "force"), self.column_names, strict=True))
        given = {"E_loss": "J", "loss_factor": "1"} | self.result_units
        return columns.format_table(
            [(own.get(name, name), given[name]) for name in rows[0]],
            [np.array([row[name] for row in rows]) for name in rows[0]],
            digits=6,
        )

    def format_csv(self) -> str:
        """Format all points of all loops as CSV text that `jointfmu fit loop` reads.

        Columns: number of the loop, motion, force, outputs.
        """
        first = self.loops[0].result
        others = [name for name in first.columns if name not in (self.motion_name, self.force_name)]
        names = [*self.column_names, *others]
        heads = [
            ("run", "1"),
            *zip(names, (*self.units, *(first.units[name] for name in others)), strict=True),
        ]
        parts = [
            [
                np.full(loop.motion.size, float(number)),
                loop.motion,
                loop.force,
                *(loop.result.columns[name] for name in others),
            ]
            for number, loop in enumerate(self.loops, 1)
        ]
        sign = "-" if self.force_sign < 0.0 else ""
        told = (
            f"# {self.column_names[0]} = {self.motion_name}, {self.column_names[1]} = {sign}{self.force_name}"
        )
        return columns.format_table(
            heads, [np.concatenate(part) for part in zip(*parts, strict=True)], header_lines=[told]
        )


def run_loops(
    fmu: str | Path,
    input_name: str,
    amplitudes: Sequence[float],
    cyclic_path: CyclicPath,
    output: str | None = None,
    settings: Mapping[str, object] | None = None,
) -> HysteresisLoops:
    """Run an FMU along load cycles of one input, one instance for each amplitude, from rest.

    All other inputs are constant.

    output : output that is energy-conjugate to the input; None: the conjugate output with the same suffix,
        `f_x` for `s_rel_x`, `tau2` for `phi2`

    Raises ValueError as `ramp.run_ramp`, for an amplitude that is not positive, or if no output is conjugate
    to the input.
    """
    points = [cyclic_path.input_values(amplitude) for amplitude in amplitudes]
    with unpack_fmu(fmu) as (_, description):
        _check_amplitudes(description, input_name, amplitudes)
        output = find_conjugate_output(*input_and_output_units(description), input_name, output, str(fmu))
    return loops_from_results(
        [ramp.run_path(fmu, input_name, each, settings) for each in points], input_name, output, cyclic_path
    )


def _check_amplitudes(description: "ModelDescription", input_name: str, amplitudes: Sequence[float]) -> None:
    """Raise ValueError for an amplitude far above the nominal value of the input: it is in another unit."""
    for variable in description.modelVariables:
        if variable.name == input_name and variable.nominal and variable.unit:
            nominal = float(variable.nominal)
            largest = MAX_AMPLITUDE_OVER_NOMINAL * nominal
            for amplitude in amplitudes:
                if amplitude > largest:
                    raise ValueError(
                        f"loop = {amplitude:g} {variable.unit} of {input_name} is outside (0, {largest:g}] "
                        f"{variable.unit}: values are in SI units, usual are {nominal:g} {variable.unit}"
                    )


def loops_from_results(
    results: Sequence[ramp.RampResult], input_name: str, output: str, cyclic_path: CyclicPath
) -> HysteresisLoops:
    """Hysteresis loops from results along load cycles of an input, one for each amplitude.

    output : output that is energy-conjugate to the input
    """
    first = max(results, key=lambda result: float(np.ptp(result.columns[input_name])))
    driven = units.base_exponents(first.units[input_name]) in FORCE_UNITS
    motion, force = (output, input_name) if driven else (input_name, output)
    x, y = first.columns[motion], first.columns[force]
    sign = -1.0 if np.sum((x - x.mean()) * (y - y.mean())) < 0.0 else 1.0
    closed = cyclic_path.points // 4 + (cyclic_path.cycles - 1) * cyclic_path.points
    loops = [HysteresisLoop(r.columns[motion], sign * r.columns[force], closed, r) for r in results]
    return HysteresisLoops(motion, force, (first.units[motion], first.units[force]), sign, loops)


def input_and_output_units(description: "ModelDescription") -> tuple[dict[str, str], dict[str, str]]:
    """Units of an FMU's inputs, {name: unit}, and of its outputs, from the model description of fmpy."""
    inputs, outputs = (
        {v.name: v.unit or "1" for v in description.modelVariables if v.causality == causality}
        for causality in ("input", "output")
    )
    return inputs, outputs


def find_conjugate_output(
    input_units: Mapping[str, str],
    output_units: Mapping[str, str],
    input_name: str,
    output: str | None,
    fmu_label: str,
) -> str:
    """Find the output that is energy-conjugate to an input: the product of their units is an energy.

    If several outputs are conjugate, the one with the suffix of the input is chosen.

    input_units, output_units : {name: unit}
    output                    : output that the user states; None: find it
    fmu_label                 : name of the FMU, for messages

    Raises ValueError if no output is conjugate, or if the stated output is not.
    """
    if input_name not in input_units:
        raise ValueError(f"{fmu_label}: unknown input {input_name!r}, allowed are {', '.join(input_units)}")
    own = input_units[input_name]
    fitting = [name for name, unit in output_units.items() if unit != "J" and _is_energy(own, unit)]
    if output is not None:
        if output not in fitting:
            raise ValueError(
                f"{fmu_label}: {output!r} is not an output whose product with {input_name} is an energy, "
                f"allowed are {', '.join(fitting) or 'none'}"
            )
        return output
    if not fitting:
        raise ValueError(
            f"{fmu_label}: no output makes an energy with {input_name} [{own}]; expected a displacement, an "
            "angle, a force or a torque as input"
        )
    same = [name for name in fitting if variable_suffix(name) == variable_suffix(input_name)]
    return (same or fitting)[0]


def variable_suffix(variable_name: str) -> str:
    """Suffix of a variable name that states axis or flange: `_x` of `f_x`, `2` of `tau2`; else empty."""
    match = re.search(r"(_[xyz]|\d+)$", variable_name)
    return match[0] if match else ""


def _is_energy(first_unit: str, second_unit: str) -> bool:
    """Whether the product of two units is a unit of energy; the radian is ignored."""
    try:
        parts = units.base_exponents(first_unit), units.base_exponents(second_unit)
    except ValueError:
        return False
    whole = {name: sum(part.get(name, 0) for part in parts) for name in {**parts[0], **parts[1]}}
    return {
        name: n for name, n in whole.items() if n and name != "rad"
    } == ENERGY_UNIT and first_unit != "1" != second_unit
