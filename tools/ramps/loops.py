"""Loops: any of the FMUs driven to and fro through fmpy, what it loses and how stiff it is."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array, units

from .. import columns
from ..host import unpack_fmu
from . import ramp

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

SHAPES = ("triangle", "sine")
DEFAULT_POINTS, DEFAULT_CYCLES = 200, 2
MIN_POINTS, MAX_POINTS = 8, 1_000_000
MAX_CYCLES = 1000
RELATIVE_ROUNDING = 1e-12
"""Work over that of the loop's box [1] that is round-off."""
ENERGY_UNIT = units.base_exponents("J")
FORCE_UNITS = (units.base_exponents("N"), units.base_exponents("N.m"))
"""What counts as a force or torque; the other of two conjugate variables is the motion."""
COLUMN_NAMES = {"m": ("displacement", "force"), "rad": ("angle", "torque")}
"""{unit of the motion: names of motion and force in the file}, those that `fit loop` reads."""


@dataclass(frozen=True, slots=True)
class CyclicPath:
    """How an input is driven.

    about  : where it starts and about which it swings
    shape  : one of SHAPES
    points : of a cycle, a multiple of four
    cycles : after the first loading; the last one counts
    """

    centre: float = 0.0
    shape: str = SHAPES[0]
    points: int = DEFAULT_POINTS
    cycles: int = DEFAULT_CYCLES

    def __post_init__(self) -> None:
        if not np.isfinite(self.centre):
            raise ValueError(f"about = {self.centre:g} is outside (-inf, inf): must be finite")
        if self.points % 4 or not MIN_POINTS <= self.points <= MAX_POINTS:
            raise ValueError(
                f"points = {self.points}, allowed are multiples of 4 from {MIN_POINTS} to {MAX_POINTS}"
            )
        if not 1 <= self.cycles <= MAX_CYCLES:
            raise ValueError(f"cycles = {self.cycles} is outside [1, {MAX_CYCLES}]")

    def path(self, amplitude: float) -> Array:
        """The points: first loading to the amplitude, then whole cycles from there."""
        if not 0.0 < amplitude < np.inf:
            raise ValueError(f"loop = {amplitude:g} is outside (0, inf): the amplitude of the input")
        phase = np.arange(self.points // 4 + self.cycles * self.points + 1) / self.points
        turned = np.abs((phase + 0.25) % 1.0 - 0.5)  # 1/4 at zero, least at the top
        value = 1.0 - 4.0 * turned if self.shape == "triangle" else np.sin(2.0 * np.pi * phase)
        return np.asarray(self.centre + amplitude * value)


@dataclass(frozen=True, slots=True)
class HysteresisLoop:
    """One amplitude.

    motion, force : (n) of first loading and cycles; the force on the joint, positive with the motion
    closed : first point of the last cycle, which ends with the last one
    result : every output
    """

    motion: Array
    force: Array
    cycle_start: int
    result: ramp.RampResult

    @property
    def _cycle(self) -> tuple[Array, Array]:
        return self.motion[self.cycle_start :], self.force[self.cycle_start :]

    @property
    def amplitudes(self) -> tuple[float, float]:
        """Half the range of motion and of force in the last cycle."""
        motion, force = self._cycle
        return 0.5 * float(np.ptp(motion)), 0.5 * float(np.ptp(force))

    @property
    def loss(self) -> float:
        """Work [J] that goes in over the last cycle, by trapezoids; none where it is round-off."""
        motion, force = self._cycle
        work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(motion)))
        return work if abs(work) > RELATIVE_ROUNDING * float(np.ptp(motion) * np.ptp(force)) else 0.0

    def row(self) -> dict[str, float]:
        """What the loop gives; secant stiffness through its ends, loss factor loss/(pi K a^2)."""
        motion, force = self.amplitudes
        stiffness = force / motion
        found = {
            "motion": motion,
            "force": force,
            "secant_stiffness": stiffness,
            "loss": self.loss,
            "loss_factor": self.loss / (np.pi * force * motion) if force else 0.0,
        }
        if "E_loss" in self.result.columns:
            found["E_loss"] = float(np.diff(self.result.columns["E_loss"][[self.cycle_start, -1]])[0])
        return found


@dataclass(frozen=True, slots=True)
class HysteresisLoops:
    """Loops of one FMU.

    motion, force : names of the variables; units : of both
    sign  : of the force, +1 or -1, over the variable
    loops : by amplitude, in the order asked for
    """

    motion: str
    force: str
    units: tuple[str, str]
    sign: float
    loops: Sequence[HysteresisLoop]

    @property
    def column_names(self) -> tuple[str, str]:
        """Names of motion and force in files: those that `fit loop` reads."""
        return COLUMN_NAMES[self.units[0]]

    @property
    def messages(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(text for loop in self.loops for text in loop.result.messages))

    @property
    def row_units(self) -> dict[str, str]:
        """Of what a row gives with a unit."""
        stiffness = "N/m" if self.units[0] == "m" else "N.m/rad"
        return {"motion": self.units[0], "force": self.units[1], "secant_stiffness": stiffness, "loss": "J"}

    def rows(self) -> list[dict[str, float]]:
        return [loop.row() for loop in self.loops]

    def table(self) -> str:
        """The rows as CSV text, six digits."""
        rows = self.rows()
        own = dict(zip(("motion", "force"), self.column_names, strict=True))
        given = {"E_loss": "J", "loss_factor": "1"} | self.row_units
        return columns.format_table(
            [(own.get(name, name), given[name]) for name in rows[0]],
            [np.array([row[name] for row in rows]) for name in rows[0]],
            digits=6,
        )

    def csv(self) -> str:
        """Every point of every loop as CSV text that `fit loop` reads: runs, motion, force, the outputs."""
        first = self.loops[0].result
        others = [name for name in first.columns if name not in (self.motion, self.force)]
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
        sign = "-" if self.sign < 0.0 else ""
        told = f"# {self.column_names[0]} = {self.motion}, {self.column_names[1]} = {sign}{self.force}"
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
    """Drive one input to and fro, each amplitude from rest in an instance of its own; all else stays.

    output : conjugate to the input; None: that of its suffix, `f_x` to `s_rel_x`, `tau2` to `phi2`

    Raises ValueError as `ramp.run`, for a swing that is none, or where no output is conjugate to the input.
    """
    points = [cyclic_path.path(amplitude) for amplitude in amplitudes]
    with unpack_fmu(fmu) as (_, description):
        output = find_conjugate(*input_and_output_units(description), input_name, output, str(fmu))
    return loops_from_results(
        [ramp.run_path(fmu, input_name, each, settings) for each in points], input_name, output, cyclic_path
    )


def loops_from_results(
    results: Sequence[ramp.RampResult], input_name: str, output: str, cyclic_path: CyclicPath
) -> HysteresisLoops:
    """The loops of an input that swung, one for each amplitude, with an output that is conjugate to it."""
    first = max(results, key=lambda result: float(np.ptp(result.columns[input_name])))
    driven = units.base_exponents(first.units[input_name]) in FORCE_UNITS
    motion, force = (output, input_name) if driven else (input_name, output)
    x, y = first.columns[motion], first.columns[force]
    sign = -1.0 if np.sum((x - x.mean()) * (y - y.mean())) < 0.0 else 1.0
    closed = cyclic_path.points // 4 + (cyclic_path.cycles - 1) * cyclic_path.points
    loops = [HysteresisLoop(r.columns[motion], sign * r.columns[force], closed, r) for r in results]
    return HysteresisLoops(motion, force, (first.units[motion], first.units[force]), sign, loops)


def input_and_output_units(description: "ModelDescription") -> tuple[dict[str, str], dict[str, str]]:
    """{name: unit} of the inputs and of the outputs of an fmpy model description."""
    inputs, outputs = (
        {v.name: v.unit or "1" for v in description.modelVariables if v.causality == causality}
        for causality in ("input", "output")
    )
    return inputs, outputs


def find_conjugate(
    inputs: Mapping[str, str], outputs: Mapping[str, str], input_name: str, output: str | None, source: str
) -> str:
    """The output whose product with the input is an energy, of the same suffix where there are several.

    Raises ValueError if there is none, or if `output` is none of them.
    """
    if input_name not in inputs:
        raise ValueError(f"{source}: unknown input {input_name!r}, allowed are {', '.join(inputs)}")
    own = inputs[input_name]
    fitting = [name for name, unit in outputs.items() if unit != "J" and _is_energy(own, unit)]
    if output is not None:
        if output not in fitting:
            raise ValueError(
                f"{source}: {output!r} is not an output whose product with {input_name} is an energy, "
                f"allowed are {', '.join(fitting) or 'none'}"
            )
        return output
    if not fitting:
        raise ValueError(
            f"{source}: no output makes an energy with {input_name} [{own}]; expected a displacement, an "
            "angle, a force or a torque as input"
        )
    same = [name for name in fitting if suffix(name) == suffix(input_name)]
    return (same or fitting)[0]


def suffix(name: str) -> str:
    """The axis or flange of a name: `_x` of `f_x`, `2` of `tau2`."""
    match = re.search(r"(_[xyz]|\d+)$", name)
    return match[0] if match else ""


def _is_energy(first: str, second: str) -> bool:
    """Whether the product of two units is an energy; the radian counts as none."""
    try:
        parts = units.base_exponents(first), units.base_exponents(second)
    except ValueError:
        return False
    whole = {name: sum(part.get(name, 0) for part in parts) for name in {**parts[0], **parts[1]}}
    return {
        name: n for name, n in whole.items() if n and name != "rad"
    } == ENERGY_UNIT and first != "1" != second
