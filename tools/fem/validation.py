"""Comparison of measured natural frequencies with frequencies from finite elements."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from jointfmu.joints import KINDS
from jointfmu.parameters import load_default

from ..fields.bolted_interface import field_adapter
from ..joint_parts import load_tool_module
from ..published.reference import compute_trivial_guesses, read_points
from ..published.validation import ValidatedPoint, compare_point


@dataclass(frozen=True, slots=True)
class MeasuredFrequencies:
    """Measured natural frequencies of a bolted assembly: constant MEASURED_FREQUENCIES of a joint.

    reference_file : file of published numbers in models/reference/; `where` of each number gives `preload`
                     [N] per bolt, `moment` [N.m] about x and `mode`, counted from 1
    assembly_file  : file of the assembly in models/assemblies/
    """

    reference_file: str
    assembly_file: str

    @property
    def path(self) -> Path:
        """Path of the assembly file."""
        return Path(str(files("jointfmu_models") / "assemblies" / f"{self.assembly_file}.toml"))


def compare_natural_frequencies() -> list[ValidatedPoint]:
    """Compare measured frequencies of all assemblies with finite elements: half a minute for each assembly.

    Raises ImportError without the extra `fem`.
    """
    modules = {name: load_tool_module(kind, "frequencies") for name, kind in KINDS.items()}
    return [
        row
        for name, module in modules.items()
        if module
        for row in _compare_frequencies(name, module.FREQUENCIES)
    ]


def _compare_frequencies(joint_kind: str, measurement: MeasuredFrequencies) -> list[ValidatedPoint]:
    """Compare the measured frequencies of one assembly with finite elements."""
    from . import assembly, modes

    published, values = read_points(measurement.reference_file), load_default(joint_kind).values
    states = list(dict.fromkeys((p.where["preload"], p.where["moment"]) for p in published))
    shear = float(field_adapter(joint_kind).tangential_stiffness_ratio(values))
    computed = modes.compute_frequencies(assembly.read_assembly(measurement.path), values, shear, states)
    by_state = dict(zip(states, computed.tolist(), strict=True))
    matching = [by_state[p.where["preload"], p.where["moment"]][p.where["mode"] - 1] for p in published]
    guessed = compute_trivial_guesses(published)
    return [compare_point(p, value, guessed.get(p.id)) for p, value in zip(published, matching, strict=True)]
