"""Measured natural frequencies beside those of finite elements."""

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
    """Frequencies of a bolted assembly: `FREQUENCIES` of a clamped joint's folder.

    points   : file of published numbers in models/reference/; `where` of each has `preload` [N] per bolt,
               `moment` [N.m] and `mode`, from 1
    assembly : file in models/assemblies/
    """

    points: str
    assembly: str

    @property
    def path(self) -> Path:
        """Of the assembly's file."""
        return Path(str(files("jointfmu_models") / "assemblies" / f"{self.assembly}.toml"))


def natural_frequencies() -> list[ValidatedPoint]:
    """Measured frequencies of assemblies beside those of finite elements: half a minute each.

    Raises ImportError without the extra `fem`.
    """
    parts = {name: part(kind, "frequencies") for name, kind in KINDS.items()}
    return [row for name, own in parts.items() if own for row in _frequencies(name, own.FREQUENCIES)]


def _frequencies(joint: str, measured: MeasuredFrequencies) -> list[ValidatedPoint]:
    from . import assembly, modes

    published, values = points(measured.points), default(joint).values
    states = list(dict.fromkeys((p.where["preload"], p.where["moment"]) for p in published))
    shear = float(clamping(joint).shear_ratio(values))
    computed = modes.frequencies(assembly.load(measured.path), values, shear, states)
    at = dict(zip(states, computed.tolist(), strict=True))
    found = [at[p.where["preload"], p.where["moment"]][p.where["mode"] - 1] for p in published]
    guessed = guesses(published)
    return [compare(p, value, guessed.get(p.id)) for p, value in zip(published, found, strict=True)]
