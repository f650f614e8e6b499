"""Comparison of measured natural frequencies with frequencies from finite elements."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from jointfmu.joints import KINDS
from jointfmu.parameters import default

from ..fields.clamped import clamping
from ..joint_parts import part
from ..published.reference import guesses, points
from ..published.validation import ValidatedPoint, compare


@dataclass(frozen=True, slots=True)
class MeasuredFrequencies:
    """Measured natural frequencies of a bolted assembly: constant `FREQUENCIES` of a kind of joint.

    reference_file : file of published numbers in models/reference/; `where` of each number gives `preload`
                     [N] per bolt, `moment` [N.m] about x and `mode`, counted from 1
    assembly_file  : file of the assembly in models/assemblies/
    """

    points: str
    assembly: str

    @property
    def path(self) -> Path:
        """Path of the assembly file."""
        return Path(str(files("jointfmu_models") / "assemblies" / f"{self.assembly}.toml"))


def natural_frequencies() -> list[ValidatedPoint]:
    """Compare measured frequencies of all assemblies with finite elements: half a minute for each assembly.

    Raises ImportError without the extra `fem`.
    """
    modules = {name: part(kind, "frequencies") for name, kind in KINDS.items()}
    return [
        row for name, module in modules.items() if module for row in _frequencies(name, module.FREQUENCIES)
    ]


def _frequencies(joint: str, measured: MeasuredFrequencies) -> list[ValidatedPoint]:
    """Compare the measured frequencies of one assembly with finite elements."""
    from . import assembly, modes

    published, values = points(measured.points), default(joint).values
    states = list(dict.fromkeys((p.where["preload"], p.where["moment"]) for p in published))
    shear = float(clamping(joint).shear_ratio(values))
    computed = modes.frequencies(assembly.load(measured.path), values, shear, states)
    by_state = dict(zip(states, computed.tolist(), strict=True))
    matching = [by_state[p.where["preload"], p.where["moment"]][p.where["mode"] - 1] for p in published]
    guessed = guesses(published)
    return [compare(p, value, guessed.get(p.id)) for p, value in zip(published, matching, strict=True)]
