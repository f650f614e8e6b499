"""Measured natural frequencies beside those of finite elements."""

from jointfmu.joints import KINDS
from jointfmu.parameters import default
from jointfmu.published.reference import guesses, points
from jointfmu.published.validation import ValidatedPoint, compare

from ..fields.clamped import clamping
from ..joint_parts import part
from .frequencies import MeasuredFrequencies


def natural_frequencies() -> list[ValidatedPoint]:
    """Measured frequencies of assemblies beside those of finite elements: half a minute each.

    Raises ImportError without the extra `fem`.
    """
    parts = {name: part(kind, "frequencies") for name, kind in KINDS.items()}
    return [row for name, own in parts.items() if own for row in _frequencies(name, own.FREQUENCIES)]


def _frequencies(joint: str, measured: MeasuredFrequencies) -> list[ValidatedPoint]:
    from jointfmu_tools.fem import assembly, assembly_modes

    published, values = points(measured.points), default(joint).values
    states = list(dict.fromkeys((p.where["preload"], p.where["moment"]) for p in published))
    shear = float(clamping(joint).shear_ratio(values))
    computed = assembly_modes.frequencies(assembly.load(measured.path), values, shear, states)
    at = dict(zip(states, computed.tolist(), strict=True))
    found = [at[p.where["preload"], p.where["moment"]][p.where["mode"] - 1] for p in published]
    guessed = guesses(published)
    return [compare(p, value, guessed.get(p.id)) for p, value in zip(published, found, strict=True)]
