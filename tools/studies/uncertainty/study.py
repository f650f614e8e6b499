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

from jointfmu.parameters import list_entries, read_document
from jointfmu.quantity import Array
from jointfmu.quantity.units import unit_size

from ...inputs.drawing.reading import NUMBER_WITH_UNIT_PATTERN

DISTRIBUTION_FORMS = (
    "VALUE, LOW..HIGH, VALUE+-PERCENT%, loguniform(LOW, HIGH), normal(MEAN, SD), "
    "lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH), all in SI units; relative to the file's value: "
    "+-PERCENT%, normal(PERCENT%), lognormal(PERCENT%)"
)
"""Allowed forms of the text of a distribution, for error messages."""
_DISTRIBUTION_CALL_PATTERN = re.compile(r"(\w+)\((.*)\)")
"""Pattern of a distribution with arguments: NAME(ARGUMENTS)."""


@dataclass(frozen=True, slots=True)
class UncertainParameter:
    """Uncertain parameter: name and distribution.

    distribution_text : text of the distribution, as the user wrote it
    distribution      : frozen distribution of scipy.stats
    """

    name: str
    distribution_text: str
    distribution: Any

    @property
    def support_interval(self) -> tuple[float, float]:
        """Lower and upper end of the values that the distribution allows."""
        low, high = self.distribution.support()
        return float(low), float(high)


def parse_distribution(
    parameter_name: str, distribution_text: str, parameter_file_value: float | None
) -> UncertainParameter | None:
    """Parse the text of a distribution; None if the text is a plain value or word.

    parameter_file_value : value of the parameter in its file, to which a percentage without a value refers;
        None if the file has no value

    Raises ValueError that names the parameter, the text and the allowed forms.
    """
    try:
        law = _parse_scipy_distribution(distribution_text.strip(), parameter_file_value)
    except ValueError as error:
        raise ValueError(
            f"{parameter_name} = {distribution_text}: {error or 'is not a distribution'}; "
            f"allowed are {DISTRIBUTION_FORMS}"
        ) from None
    return law and UncertainParameter(parameter_name, distribution_text, law)


def _parse_scipy_distribution(distribution_text: str, parameter_file_value: float | None) -> Any:
    """Parse a distribution of scipy.stats; None if the text is a plain value or word."""
    if ".." in distribution_text:
        return _make_uniform_distribution(*_parse_numbers(distribution_text.split(".."), 2))
    if "+-" in distribution_text:
        middle, _, spread = distribution_text.partition("+-")
        if not middle.strip() and not _is_percent(spread):
            raise ValueError(f"a half width without a value before it is relative: write +-{spread.strip()}%")
        m = _parse_number(middle) if middle.strip() else _require_file_value(parameter_file_value)
        half_width = abs(m) * _parse_percent(spread) if _is_percent(spread) else _parse_number(spread)
        return _make_uniform_distribution(m - half_width, m + half_width)
    if call := _DISTRIBUTION_CALL_PATTERN.fullmatch(distribution_text):
        if call[1] not in _DISTRIBUTION_PARSERS:
            raise ValueError(f"there is no distribution {call[1]!r}")
        return _DISTRIBUTION_PARSERS[call[1]](
            [argument.strip() for argument in call[2].split(",")], parameter_file_value
        )
    return None


def _make_uniform_distribution(lower_end: float, upper_end: float) -> object:
    """Uniform distribution of scipy.stats between two values."""
    _check_ascending(lower_end, upper_end)
    return stats.uniform(lower_end, upper_end - lower_end)


def _parse_loguniform(argument_texts: list[str], parameter_file_value: float | None) -> object:
    """Log-uniform distribution of scipy.stats, from the texts of its two ends."""
    low, high = _parse_numbers(argument_texts, 2)
    if low <= 0.0:
        raise ValueError(f"low = {low:g} is outside (0, inf)")
    _check_ascending(low, high)
    return stats.loguniform(low, high)


def _parse_normal(argument_texts: list[str], parameter_file_value: float | None) -> object:
    """Normal distribution of scipy.stats, from the texts of mean and standard deviation."""
    mean, spread = _parse_centre_and_spread(argument_texts, parameter_file_value)
    sd = abs(mean) * _parse_percent(spread) if _is_percent(spread) else _parse_number(spread)
    if sd <= 0.0:
        raise ValueError(f"standard deviation = {sd:g} is outside (0, inf)")
    return stats.norm(mean, sd)


def _parse_lognormal(argument_texts: list[str], parameter_file_value: float | None) -> object:
    """Lognormal distribution of scipy.stats, from the texts of median and factor."""
    median, spread = _parse_centre_and_spread(argument_texts, parameter_file_value)
    factor = 1.0 + _parse_percent(spread) if _is_percent(spread) else _parse_number(spread)
    if median <= 0.0:
        raise ValueError(f"median = {median:g} is outside (0, inf)")
    if factor <= 1.0:
        raise ValueError(f"factor = {factor:g} is outside (1, inf)")
    return stats.lognorm(math.log(factor), scale=median)


def _parse_triangular(argument_texts: list[str], parameter_file_value: float | None) -> object:
    """Triangular distribution of scipy.stats, from the texts of its three values."""
    low, mode, high = _parse_numbers(argument_texts, 3)
    _check_ascending(low, high)
    if not low <= mode <= high:
        raise ValueError(f"mode = {mode:g} is outside [{low:g}, {high:g}]")
    return stats.triang((mode - low) / (high - low), low, high - low)


_DISTRIBUTION_PARSERS = {
    "uniform": lambda parts, base: _make_uniform_distribution(*_parse_numbers(parts, 2)),
    "loguniform": _parse_loguniform,
    "normal": _parse_normal,
    "lognormal": _parse_lognormal,
    "triangular": _parse_triangular,
}
"""{name of a distribution: function that parses its arguments}."""


def _parse_centre_and_spread(
    argument_texts: list[str], parameter_file_value: float | None
) -> tuple[float, str]:
    """Centre and spread of a distribution, from one or two argument texts.

    A single text is a percentage; the centre is then the file's value. The spread is returned as text.
    """
    if len(argument_texts) == 1 and _is_percent(argument_texts[0]):
        return _require_file_value(parameter_file_value), argument_texts[0]
    if len(argument_texts) != 2:
        hint = f", or a percentage, as in {argument_texts[0]}%" if len(argument_texts) == 1 else ""
        raise ValueError(f"expected 2 numbers{hint}")
    return _parse_number(argument_texts[0]), argument_texts[1]


def _check_ascending(lower_end: float, upper_end: float) -> None:
    """Raise ValueError unless the lower end of a distribution is below the upper one."""
    if not lower_end < upper_end:
        raise ValueError(f"low = {lower_end:g} is not below high = {upper_end:g}")


def _parse_numbers(number_texts: list[str], expected_count: int) -> list[float]:
    """Parse `expected_count` finite numbers from the texts of a distribution.

    Raises ValueError for another count or another text.
    """
    if len(number_texts) != expected_count:
        raise ValueError(f"has {len(number_texts)} numbers, expected {expected_count}")
    return [_parse_number(text) for text in number_texts]


def _parse_number(number_text: str) -> float:
    """Parse a finite number. Raises ValueError if the text is not a finite number."""
    try:
        value = float(number_text)
    except ValueError:
        raise ValueError(
            f"{number_text.strip()!r} is not a number{_suggest_si_number(number_text)}"
        ) from None
    if not math.isfinite(value):
        raise ValueError(f"{value:g} is not finite")
    return value


def _suggest_si_number(number_text: str) -> str:
    """Suggestion to write a number with a unit as a number in SI units; empty for other texts."""
    number = NUMBER_WITH_UNIT_PATTERN.fullmatch(number_text.strip())
    try:
        return f": write {float(number[1]) * unit_size(number[2]):.12g}" if number else ""
    except ValueError:
        return ""


def _is_percent(number_text: str) -> bool:
    """Whether a text ends with %."""
    return number_text.strip().endswith("%")


def _parse_percent(percentage_text: str) -> float:
    """Parse a positive percentage, as a fraction [1]."""
    value = _parse_number(percentage_text.strip()[:-1])
    if value <= 0.0:
        raise ValueError(f"{value:g} % is outside (0, inf)")
    return value / 100.0


def _require_file_value(parameter_file_value: float | None) -> float:
    """Value of the parameter file to which a percentage refers; ValueError if there is none."""
    if parameter_file_value is None:
        raise ValueError("a percentage needs a value before it: VALUE+-PERCENT%")
    return parameter_file_value


def is_relative_distribution(distribution_text: str) -> bool:
    """Whether the text of a distribution is a percentage without a value, relative to another value."""
    distribution_text = distribution_text.strip()
    call = _DISTRIBUTION_CALL_PATTERN.fullmatch(distribution_text)
    return distribution_text.startswith("+-") or bool(call and "," not in call[2] and _is_percent(call[2]))


MAX_SAMPLES = 2**24
"""Largest number of samples of a study [1]."""


def read_study(study_path: str | Path) -> dict[str, object]:
    """Read a study file: {name: number, true, false or text}.

    Raises ValueError with one line that names the file, the entry and the allowed values.
    """
    study_path = Path(study_path)
    document = read_document(study_path, "a study file")
    if unknown := set(document) - {"schema", "parameters"}:
        raise ValueError(
            f"{study_path}: unknown entry {sorted(unknown)[0]!r}, allowed are schema, parameters"
        )
    table = document.get("parameters")
    if not isinstance(table, dict) or not table:
        raise ValueError(
            f"{study_path}: parameters = {table!r}, expected a table of NAME = VALUE or DISTRIBUTION"
        )
    entries = dict(list_entries(table))
    for name, value in entries.items():
        if not isinstance(value, str | bool | int | float):
            raise ValueError(f"{study_path}: {name} = {value!r}, expected a number or a text")
    return {name: float(value) if type(value) is int else value for name, value in entries.items()}


def merge_settings(
    study_path: Path | None, stated_settings: Sequence[tuple[str, object]]
) -> dict[str, object]:
    """Merge the settings {name: value} of a study file with stated settings, which take precedence."""
    return (read_study(study_path) if study_path else {}) | dict(stated_settings)


def split_settings(
    study_settings: Mapping[str, object], parameter_file_values: Mapping[str, object]
) -> tuple[dict[str, object], tuple[UncertainParameter, ...]]:
    """Split the settings of a study into plain values, {name: value}, and uncertain parameters.

    parameter_file_values : {name: value} to which percentages refer

    Raises ValueError for a wrong text of a distribution.
    """
    plain: dict[str, object] = {}
    uncertain = []
    for name, value in study_settings.items():
        centre = parameter_file_values.get(name)
        centre = float(centre) if isinstance(centre, int | float) and not isinstance(centre, bool) else None
        parameter = parse_distribution(name, value, centre) if isinstance(value, str) else None
        if parameter is None:
            plain[name] = value
        else:
            uncertain.append(parameter)
    return plain, tuple(uncertain)


def round_up_to_power_of_two(sample_count: int) -> int:
    """Round a number of samples up to a power of two, for which a Sobol' sequence is balanced.

    Raises ValueError outside [2, MAX_SAMPLES].
    """
    if not 2 <= sample_count <= MAX_SAMPLES:
        raise ValueError(f"samples = {sample_count} is outside [2, {MAX_SAMPLES}]")
    return int(2 ** math.ceil(math.log2(sample_count)))


def check_seed(seed: int) -> None:
    """Raise ValueError for a negative seed."""
    if seed < 0:
        raise ValueError(f"seed = {seed} is outside [0, inf)")


def draw_unit_cube_points(point_count: int, dimension_count: int, seed: int) -> Array:
    """Points (count, dimensions) of a scrambled Sobol' sequence in the open unit cube, count = 2^k."""
    sequence = qmc.Sobol(dimension_count, scramble=True, bits=64, seed=seed)
    points = sequence.random_base2(int(math.log2(point_count)))
    return np.asarray(np.clip(points, 2.0**-40, 1.0 - 2.0**-40))


def draw_samples(
    uncertain_parameters: Sequence[UncertainParameter], unit_cube_points: Array
) -> dict[str, Array]:
    """Map points (n, d) of the unit cube to samples, {name: (n)}, by the inverse distribution functions."""
    return {
        parameter.name: np.asarray(parameter.distribution.ppf(unit_cube_points[:, i]))
        for i, parameter in enumerate(uncertain_parameters)
    }


@dataclass(frozen=True, slots=True)
class RefusedSamples:
    """Samples that the law refuses.

    refused_count        : number of refused samples
    first_refused_sample : {name: value} of the first refused sample
    refusal_message      : error message of the law for this sample
    """

    refused_count: int
    first_refused_sample: Mapping[str, float]
    refusal_message: str
