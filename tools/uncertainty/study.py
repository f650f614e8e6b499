"""Study of uncertain parameters: distributions for parameters of a parameter file.

A study file is TOML, with one entry for each parameter. The texts are the same as on the command line:

    schema = 1
    [parameters]
    surface.D = "2.45..2.6"
    surface.G = "lognormal(20%)"
    eccentricity = "0..1e-5"

Text of an entry, and its distribution:

    1.42                          a value, true, false or a named choice: no distribution
    1.38..1.46                    uniform between two values
    loguniform(1e-12, 1e-10)      uniform in the logarithm
    1.42+-2%                      uniform, 2 % about a value; `+-2%`: about the value of the file
    normal(1.42, 0.02)            mean, standard deviation (number or %); `normal(2%)`: about the file's value
    lognormal(2.4e-7, 20%)        median, factor of one standard deviation (1.2 or 20%); `lognormal(20%)`
    triangular(1.3, 1.4, 1.5)     smallest, most likely, largest value
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats
from scipy.stats import qmc

from jointfmu.parameters import leaves, read_document
from jointfmu.quantity import Array

FORMS = (
    "VALUE, LOW..HIGH, VALUE+-PERCENT%, loguniform(LOW, HIGH), normal(MEAN, SD), "
    "lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH)"
)
_CALL = re.compile(r"(\w+)\((.*)\)")


@dataclass(frozen=True, slots=True)
class Uncertain:
    """Uncertain parameter: name and distribution.

    text : text of the distribution, as the user wrote it
    distribution : frozen distribution of scipy.stats
    """

    name: str
    text: str
    law: Any

    @property
    def support(self) -> tuple[float, float]:
        """Ends of the support of the distribution."""
        low, high = self.law.support()
        return float(low), float(high)


def parse(name: str, text: str, base: float | None) -> Uncertain | None:
    """Parse the text of a distribution; None if the text is a plain value or word.

    base : value of the parameter file, to which a percentage without a value refers; None if there is none

    Raises ValueError that names the parameter, the text and the allowed forms.
    """
    try:
        law = _law(text.strip(), base)
    except ValueError as error:
        raise ValueError(f"{name} = {text}: {error or 'is no distribution'}; allowed are {FORMS}") from None
    return law and Uncertain(name, text, law)


def _law(text: str, base: float | None) -> Any:
    """Parse a distribution of scipy.stats; None if the text is a plain value or word. See `parse`."""
    if ".." in text:
        return _uniform(*_numbers(text.split(".."), 2))
    if "+-" in text:
        middle, _, spread = text.partition("+-")
        m = _number(middle) if middle.strip() else _base(base)
        half_width = abs(m) * _percent(spread) if _is_percent(spread) else _number(spread)
        return _uniform(m - half_width, m + half_width)
    if call := _CALL.fullmatch(text):
        if call[1] not in _CALLS:
            raise ValueError(f"there is no distribution {call[1]!r}")
        return _CALLS[call[1]]([argument.strip() for argument in call[2].split(",")], base)
    return None


def _uniform(low: float, high: float) -> object:
    _ascending(low, high)
    return stats.uniform(low, high - low)


def _loguniform(parts: list[str], base: float | None) -> object:
    low, high = _numbers(parts, 2)
    if low <= 0.0:
        raise ValueError(f"low = {low:g} is outside (0, inf)")
    _ascending(low, high)
    return stats.loguniform(low, high)


def _normal(parts: list[str], base: float | None) -> object:
    mean, spread = _about(parts, base)
    sd = abs(mean) * _percent(spread) if _is_percent(spread) else _number(spread)
    if sd <= 0.0:
        raise ValueError(f"standard deviation = {sd:g} is outside (0, inf)")
    return stats.norm(mean, sd)


def _lognormal(parts: list[str], base: float | None) -> object:
    median, spread = _about(parts, base)
    factor = 1.0 + _percent(spread) if _is_percent(spread) else _number(spread)
    if median <= 0.0:
        raise ValueError(f"median = {median:g} is outside (0, inf)")
    if factor <= 1.0:
        raise ValueError(f"factor = {factor:g} is outside (1, inf)")
    return stats.lognorm(math.log(factor), scale=median)


def _triangular(parts: list[str], base: float | None) -> object:
    low, mode, high = _numbers(parts, 3)
    _ascending(low, high)
    if not low <= mode <= high:
        raise ValueError(f"mode = {mode:g} is outside [{low:g}, {high:g}]")
    return stats.triang((mode - low) / (high - low), low, high - low)


_CALLS = {
    "uniform": lambda parts, base: _uniform(*_numbers(parts, 2)),
    "loguniform": _loguniform,
    "normal": _normal,
    "lognormal": _lognormal,
    "triangular": _triangular,
}


def _about(parts: list[str], base: float | None) -> tuple[float, str]:
    """Centre, and text of the spread, from one or two arguments; one percentage: about the file's value."""
    if len(parts) == 1 and _is_percent(parts[0]):
        return _base(base), parts[0]
    if len(parts) != 2:
        raise ValueError(f"has {len(parts)} numbers, expected 2")
    return _number(parts[0]), parts[1]


def _ascending(low: float, high: float) -> None:
    """Raise ValueError unless low < high."""
    if not low < high:
        raise ValueError(f"low = {low:g} is not below high = {high:g}")


def _numbers(parts: list[str], count: int) -> list[float]:
    """Parse exactly `count` finite numbers; ValueError if the texts are none, or more or less."""
    if len(parts) != count:
        raise ValueError(f"has {len(parts)} numbers, expected {count}")
    return [_number(text) for text in parts]


def _number(text: str) -> float:
    """Parse a finite number; ValueError if the text is none."""
    try:
        value = float(text)
    except ValueError:
        raise ValueError(f"{text.strip()!r} is no number") from None
    if not math.isfinite(value):
        raise ValueError(f"{value:g} is not finite")
    return value


def _is_percent(text: str) -> bool:
    return text.strip().endswith("%")


def _percent(text: str) -> float:
    """Parse a positive percentage, as a fraction [1]."""
    value = _number(text.strip()[:-1])
    if value <= 0.0:
        raise ValueError(f"{value:g} % is outside (0, inf)")
    return value / 100.0


def _base(base: float | None) -> float:
    """Return the value of the parameter file; ValueError if there is none."""
    if base is None:
        raise ValueError("a percentage needs a value before it here")
    return base


def is_relative(text: str) -> bool:
    """Whether the text of a distribution is a percentage without a value, relative to another value."""
    text = text.strip()
    call = _CALL.fullmatch(text)
    return text.startswith("+-") or bool(call and "," not in call[2] and _is_percent(call[2]))


MOST_SAMPLES = 2**24
"""Maximum number of samples of a study."""


def read(path: str | Path) -> dict[str, object]:
    """Read a study file: {name: number, true, false or text}.

    Raises ValueError with one line that names the file, the entry and the allowed values.
    """
    path = Path(path)
    document = read_document(path, "a study file")
    if unknown := set(document) - {"schema", "parameters"}:
        raise ValueError(f"{path}: unknown entry {sorted(unknown)[0]!r}, allowed are schema, parameters")
    table = document.get("parameters")
    if not isinstance(table, dict) or not table:
        raise ValueError(f"{path}: parameters = {table!r}, expected a table of NAME = VALUE or DISTRIBUTION")
    entries = dict(leaves(table))
    for name, value in entries.items():
        if not isinstance(value, str | bool | int | float):
            raise ValueError(f"{path}: {name} = {value!r}, expected a number or a text")
    return {name: float(value) if type(value) is int else value for name, value in entries.items()}


def settings(path: Path | None, given: Sequence[tuple[str, object]]) -> dict[str, object]:
    """Settings of a study file, if there is one, overridden by the stated settings (name, value)."""
    return (read(path) if path else {}) | dict(given)


def split(
    given: Mapping[str, object], base: Mapping[str, object]
) -> tuple[dict[str, object], tuple[Uncertain, ...]]:
    """Split settings into plain values, {name: value}, and uncertain parameters.

    base : {name: value} to which percentages refer

    Raises ValueError for a wrong text of a distribution.
    """
    plain: dict[str, object] = {}
    uncertain = []
    for name, value in given.items():
        centre = base.get(name)
        centre = float(centre) if isinstance(centre, int | float) and not isinstance(centre, bool) else None
        parameter = parse(name, value, centre) if isinstance(value, str) else None
        if parameter is None:
            plain[name] = value
        else:
            uncertain.append(parameter)
    return plain, tuple(uncertain)


def power_of_two(samples: int) -> int:
    """Round a number of samples up to a power of two, for which a Sobol' sequence is balanced.

    Raises ValueError outside [2, MAX_SAMPLES].
    """
    if not 2 <= samples <= MOST_SAMPLES:
        raise ValueError(f"samples = {samples} is outside [2, {MOST_SAMPLES}]")
    return int(2 ** math.ceil(math.log2(samples)))


def check_seed(seed: int) -> None:
    """Raise ValueError for a negative seed."""
    if seed < 0:
        raise ValueError(f"seed = {seed} is outside [0, inf)")


def unit_design(count: int, dimensions: int, seed: int) -> Array:
    """Points (count, dimensions) of a scrambled Sobol' sequence in the open unit cube, count = 2^k."""
    sequence = qmc.Sobol(dimensions, scramble=True, bits=64, seed=seed)
    points = sequence.random_base2(int(math.log2(count)))
    return np.asarray(np.clip(points, 2.0**-40, 1.0 - 2.0**-40))


def samples_of(uncertain: Sequence[Uncertain], points: Array) -> dict[str, Array]:
    """Map points (n, d) of the unit cube to samples, {name: (n)}, by the inverse distribution functions."""
    return {
        parameter.name: np.asarray(parameter.law.ppf(points[:, i])) for i, parameter in enumerate(uncertain)
    }


@dataclass(frozen=True, slots=True)
class Refused:
    """Samples that the law refuses.

    count   : number of refused samples
    example : {name: value} of the first refused sample
    reason  : error message of the law for this sample
    """

    count: int
    example: Mapping[str, float]
    reason: str
