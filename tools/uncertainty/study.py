"""A study: which parameters are uncertain and how, beside the values of a parameter file.

A study file is TOML, one entry per parameter with the same words as on the command line:

    schema = 1
    [parameters]
    surface.D = "2.45..2.6"
    surface.G = "lognormal(20%)"
    eccentricity = "0..1e-5"
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from jointfmu.parameters import read_document
from jointfmu.quantity import Array

from . import distributions
from .distributions import Uncertain

MOST_SAMPLES = 2**24


def read(path: str | Path) -> dict[str, object]:
    """{name: number, true, false or text} of a study file.

    Raises ValueError with one line that names the file, the entry and what is allowed.
    """
    path = Path(path)
    document = read_document(path, "a study file")
    if unknown := set(document) - {"schema", "parameters"}:
        raise ValueError(f"{path}: unknown entry {sorted(unknown)[0]!r}, allowed are schema, parameters")
    table = document.get("parameters")
    if not isinstance(table, dict) or not table:
        raise ValueError(f"{path}: parameters = {table!r}, expected a table of NAME = VALUE or DISTRIBUTION")
    entries = dict(_leaves(table, ""))
    for name, value in entries.items():
        if not isinstance(value, str | bool | int | float):
            raise ValueError(f"{path}: {name} = {value!r}, expected a number or a text")
    return {name: float(value) if type(value) is int else value for name, value in entries.items()}


def _leaves(table: Mapping[str, object], prefix: str) -> list[tuple[str, object]]:
    leaves: list[tuple[str, object]] = []
    for key, value in table.items():
        leaves += _leaves(value, f"{prefix}{key}.") if isinstance(value, Mapping) else [(prefix + key, value)]
    return leaves


def settings(path: Path | None, given: Sequence[tuple[str, object]]) -> dict[str, object]:
    """Settings of a study file, if any, and those given, which win."""
    return (read(path) if path else {}) | dict(given)


def split(
    given: Mapping[str, object], base: Mapping[str, object]
) -> tuple[dict[str, object], tuple[Uncertain, ...]]:
    """Plain values and distributions among settings; `base` has the values that percentages refer to.

    Raises ValueError for a text that is meant as a distribution and is none.
    """
    plain: dict[str, object] = {}
    uncertain = []
    for name, value in given.items():
        about = base.get(name)
        about = float(about) if isinstance(about, int | float) and not isinstance(about, bool) else None
        law = distributions.parse(name, value, about) if isinstance(value, str) else None
        if law is None:
            plain[name] = value
        else:
            uncertain.append(law)
    return plain, tuple(uncertain)


def power_of_two(samples: int) -> int:
    """The number of samples a Sobol sequence is balanced for: the next power of two.

    Raises ValueError outside [2, MOST_SAMPLES].
    """
    if not 2 <= samples <= MOST_SAMPLES:
        raise ValueError(f"samples = {samples} is outside [2, {MOST_SAMPLES}]")
    return int(2 ** math.ceil(math.log2(samples)))


def check_seed(seed: int) -> None:
    """Raise ValueError for a negative seed."""
    if seed < 0:
        raise ValueError(f"seed = {seed} is outside [0, inf)")


def unit_design(count: int, dimensions: int, seed: int) -> Array:
    """(count, dimensions) of a scrambled Sobol sequence in the open unit cube; `count` a power of two."""
    sequence = qmc.Sobol(dimensions, scramble=True, bits=64, seed=seed)
    points = sequence.random_base2(int(math.log2(count)))
    return np.asarray(np.clip(points, 2.0**-40, 1.0 - 2.0**-40))


def samples_of(uncertain: Sequence[Uncertain], points: Array) -> dict[str, Array]:
    """{name: samples (n)} from points (n, d) of the unit cube, by the inverse distribution functions."""
    return {
        parameter.name: np.asarray(parameter.law.ppf(points[:, i])) for i, parameter in enumerate(uncertain)
    }


@dataclass(frozen=True, slots=True)
class Refused:
    """Samples that the law refuses: how many, and the first with the law's own words."""

    count: int
    example: Mapping[str, float]
    reason: str
