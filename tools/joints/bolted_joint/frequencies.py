"""Measured natural frequencies of the box specimen, compared with finite elements."""

from importlib.resources import files
from pathlib import Path

from jointfmu.joints.bolted_joint import KIND
from jointfmu.parameters import load_default

from ...studies.published.reference import compute_trivial_guesses, read_points
from ...studies.published.validation import ValidatedPoint, compare_point

PUBLISHED_FREQUENCIES_FILE = "zhao2018_modes"
"""File of published numbers in models/reference/. `where` of each number gives `preload` [N] per bolt,
`moment` [N.m] about x and `mode`, counted from 1."""
BOX_SPECIMEN_ASSEMBLY_FILE = Path(
    str(files("jointfmu_models") / "assemblies" / "box_specimen_by_frequency.toml")
)
"""Assembly file of the box specimen."""


def compare_natural_frequencies() -> list[ValidatedPoint]:
    """Compare the measured natural frequencies of the box specimen with finite elements; takes half a minute.

    Raises ImportError without the extra `fem`.
    """
    from ...fem import assembly, modes

    published, values = read_points(PUBLISHED_FREQUENCIES_FILE), load_default(KIND.name).values
    states = list(dict.fromkeys((p.where["preload"], p.where["moment"]) for p in published))
    shear = float(values.shear_stiffness_ratio())
    computed = modes.compute_frequencies(
        assembly.read_assembly(BOX_SPECIMEN_ASSEMBLY_FILE), values, shear, states
    )
    by_state = dict(zip(states, computed.tolist(), strict=True))
    matching = [by_state[p.where["preload"], p.where["moment"]][p.where["mode"] - 1] for p in published]
    guessed = compute_trivial_guesses(published)
    return [compare_point(p, value, guessed.get(p.id)) for p, value in zip(published, matching, strict=True)]
