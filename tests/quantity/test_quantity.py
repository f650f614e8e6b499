"""Refusals are one line: the name, the value with its unit, and the allowed values."""

import re
from dataclasses import dataclass, fields

import numpy as np
import pytest
from laws import HU, LAWS, YU, ZHAO

from jointfmu.contact.laws.yu2022 import Yu2022
from jointfmu.contact.laws.zhao2018 import Zhao2018
from jointfmu.contact.surface import ElasticConstants, ElasticPlasticConstants, FlankSurface, ProfileSurface
from jointfmu.quantity import (
    build_parameter_set,
    check_fields,
    choice_field,
    find_problem,
    flatten_fields,
    flatten_parameters,
    group_field,
    quantity_field,
    replace_values,
)


@dataclass(frozen=True, kw_only=True)
class Inner:
    stress: float = quantity_field("Pa", "some stress", gt=0.0, le=1e9)
    share: float = quantity_field("1", "some share", ge=0.0, lt=1.0)

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True, kw_only=True)
class Outer:
    inner: Inner = group_field("the inner thing")
    lambda_: float = quantity_field("m", "some length")
    mode: str = choice_field("slow", "fast", doc="how fast")
    rigid: bool = choice_field(True, False, doc="whether it gives")

    def __post_init__(self) -> None:
        check_fields(self)


VALUES = {"inner.stress": 2e8, "inner.share": 0.25, "lambda": -3.0}


def refusal(values):
    with pytest.raises(ValueError, match=r".") as error:
        build_parameter_set(Outer, values)
    text = str(error.value)
    assert "\n" not in text
    return text


def test_build_and_flatten_are_inverse():
    outer = build_parameter_set(Outer, VALUES)
    assert outer == Outer(inner=Inner(stress=2e8, share=0.25), lambda_=-3.0, mode="slow", rigid=True)
    assert flatten_parameters(outer) == {**VALUES, "mode": "slow", "rigid": True}
    other = {**VALUES, "mode": "fast", "rigid": False}
    assert flatten_parameters(build_parameter_set(Outer, other)) == other


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_laws_survive_flattening(law):
    assert build_parameter_set(type(law), flatten_parameters(law)) == law
    names = [name for name, _ in flatten_fields(type(law))]
    assert names == list(flatten_parameters(law))
    assert len(names) == len(set(names))
    assert not any(name.endswith("_") for name in names)


def test_lambda_has_its_published_name():
    assert "lambda" in flatten_parameters(YU)
    assert dict(flatten_fields(Yu2022))["lambda"].name == "lambda_"
    assert replace_values(YU, {"lambda": 0.125}).lambda_ == 0.125


def test_integers_become_floats():
    outer = build_parameter_set(Outer, VALUES | {"lambda": 7})
    assert outer.lambda_ == 7.0
    assert type(outer.lambda_) is float


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("inner.stress", 0.0, "inner.stress = 0 Pa is outside (0, 1e+09]: some stress"),
        ("inner.stress", -5.0, "inner.stress = -5 Pa is outside (0, 1e+09]: some stress"),
        ("inner.stress", 1.5e9, "inner.stress = 1500000000 Pa is outside (0, 1e+09]: some stress"),
        ("inner.stress", np.nan, "inner.stress = nan Pa is outside (0, 1e+09]: some stress"),
        ("inner.share", 1.0, "inner.share = 1 is outside [0, 1): some share"),
        ("inner.share", -1e-9, "inner.share = -1e-09 is outside [0, 1): some share"),
        ("inner.share", np.inf, "inner.share = inf is outside [0, 1): some share"),
        ("lambda", np.inf, "lambda = inf m is outside (-inf, inf): some length"),
        ("lambda", -np.inf, "lambda = -inf m is outside (-inf, inf): some length"),
        ("lambda", np.nan, "lambda = nan m is outside (-inf, inf): some length"),
        ("lambda", True, "lambda = True is not a number in m: some length"),
        ("lambda", "3", "lambda = '3' is not a number in m: some length"),
        ("lambda", None, "lambda = None is not a number in m: some length"),
        ("lambda", [1.0], "lambda = [1.0] is not a number in m: some length"),
        ("lambda", 1j, "lambda = 1j is not a number in m: some length"),
        (
            "lambda",
            np.complex128(1j),
            "lambda = np.complex128(1j) is not a real number in m: some length",
        ),
        ("inner.share", "half", "inner.share = 'half' is not a number: some share"),
        ("inner.share", False, "inner.share = False is not a number: some share"),
        ("mode", "quick", "mode = 'quick' is not one of slow, fast"),
        ("mode", "Slow", "mode = 'Slow' is not one of slow, fast"),
        ("mode", 1.0, "mode = 1.0 is not one of slow, fast"),
        ("rigid", "true", "rigid = 'true' is not one of true, false"),
        ("rigid", 1, "rigid = 1 is not one of true, false"),
    ],
)
def test_refusals(name, value, text):
    assert refusal(VALUES | {name: value}) == text


@pytest.mark.parametrize("name", ["wrong", "lambda_", "inner"])
def test_unknown_names(name):
    allowed = "allowed are inner.stress, inner.share, lambda, mode, rigid"
    assert refusal(VALUES | {name: 1.0}) == f"unknown name {name!r}; {allowed}"


def test_missing_names():
    assert refusal({"inner.share": 0.25}) == "missing inner.stress, lambda"
    assert refusal({}) == "missing inner.share, inner.stress, lambda"


def test_all_problems_are_named_at_once():
    text = refusal({"inner.stress": -1.0, "inner.share": 2.0, "oops": 1.0, "mode": "quick"})
    for part in ("'oops'", "missing lambda", "inner.stress = -1 Pa", "inner.share = 2 ", "mode = 'quick'"):
        assert part in text


@pytest.mark.parametrize("edge", [("inner.stress", 1e9), ("inner.share", 0.0), ("inner.stress", 5e-324)])
def test_closed_ends_are_allowed(edge):
    assert flatten_parameters(build_parameter_set(Outer, VALUES | dict([edge])))[edge[0]] == edge[1]


def test_arrays_are_checked_everywhere():
    good = np.array([0.0, 0.5])
    assert build_parameter_set(Outer, VALUES | {"inner.share": good}).inner.share is good
    for bad in (1.25, np.nan):
        values = VALUES | {"inner.share": np.array([0.0, bad, 0.5])}
        assert refusal(values) == f"inner.share = {bad:g} is outside [0, 1): some share"
    assert build_parameter_set(Outer, VALUES | {"lambda": np.float32(0.5)}).lambda_ == 0.5


@pytest.mark.parametrize("array", [np.array([True, False]), np.array(["a", "b"]), np.array([1j, 2.0])])
def test_arrays_of_other_things_are_refused(array):
    assert refusal(VALUES | {"lambda": array}).endswith(" is not a real number in m: some length")


def test_a_large_array_of_other_things_is_still_one_line():
    assert "lambda" in refusal(VALUES | {"lambda": np.zeros((3, 3), dtype=bool)})


@dataclass(frozen=True, kw_only=True)
class Round:
    radius: float = quantity_field("m", "radius", gt=0.0)


@dataclass(frozen=True, kw_only=True)
class Square:
    side: float = quantity_field("m", "side", gt=0.0)
    corner: float = quantity_field("m", "radius of the corners", ge=0.0)


@dataclass(frozen=True, kw_only=True)
class Hole:
    depth: float = quantity_field("m", "depth", gt=0.0)
    outline: Round | Square = group_field("outline", round=Round, square=Square)


@dataclass(frozen=True, kw_only=True)
class Part:
    hole: Hole = group_field("the hole")


ROUND = {"depth": 1.0, "round.radius": 2.0}
SQUARE = {"depth": 1.0, "square.side": 2.0, "square.corner": 0.0}


def nested(values):
    return {f"hole.{name}": value for name, value in values.items()}


@pytest.mark.parametrize("values", [ROUND, SQUARE])
def test_a_set_has_one_of_the_alternatives(values):
    hole = build_parameter_set(Hole, values)
    assert flatten_parameters(hole) == values
    assert flatten_parameters(build_parameter_set(Part, nested(values))) == nested(values)
    assert list(dict(flatten_fields(Hole))) == ["depth", "round.radius", "square.side", "square.corner"]
    assert list(dict(flatten_fields(Hole, parameter_names=values))) == list(values)


@pytest.mark.parametrize("most", [ROUND, SQUARE])
def test_names_of_two_alternatives_are_refused_whatever_their_number(most):
    values = most | {"round.radius": 2.0, "square.side": 2.0}
    corner = ", square.corner" if most is SQUARE else ""
    text = f"round.radius together with square.side{corner}: state parameters of only one section, "
    text += "[round] or [square]"
    with pytest.raises(ValueError, match=f"^{re.escape(text)}$"):
        build_parameter_set(Hole, values)
    with pytest.raises(
        ValueError,
        match=r"^hole.round.radius together with .* only one section, \[hole.round\] or \[hole.square\]$",
    ):
        build_parameter_set(Part, nested(values))


def test_changes_of_an_alternative_that_is_not_there_are_refused():
    hole, part = build_parameter_set(Hole, SQUARE), build_parameter_set(Part, nested(SQUARE))
    assert replace_values(hole, {"square.side": 3}) == build_parameter_set(
        Hole, SQUARE | {"square.side": 3.0}
    )
    allowed = "allowed are depth, square.side, square.corner"
    text = f"round.radius is not a parameter of a set that has [square]; {allowed}"
    with pytest.raises(ValueError, match=f"^{re.escape(text)}$"):
        replace_values(hole, {"round.radius": 1.0})
    with pytest.raises(
        ValueError, match=r"^hole.round.radius is not a .* that has \[hole.square\]; allowed are hole.d"
    ):
        replace_values(part, {"hole.round.radius": 1.0})
    with pytest.raises(ValueError, match=r"^unknown name 'width'; allowed are depth, square.side"):
        replace_values(hole, {"width": 1.0})


def test_missing_alternatives_are_named():
    with pytest.raises(ValueError, match=r"^missing round.radius$"):
        build_parameter_set(Hole, {"depth": 1.0})


def test_construction_checks_as_well():
    with pytest.raises(ValueError, match=r"^E = -1 Pa is outside \(0, inf\): Young's modulus$"):
        ElasticConstants(E=-1.0, nu=0.3)
    with pytest.raises(ValueError, match=r"^nu = 0.6 is outside \(-1, 0.5\]: Poisson ratio$"):
        ElasticConstants(E=1e11, nu=0.6)
    with pytest.raises(ValueError, match=r"^E = 0 Pa .*; nu = -1 is .*; sigma_y = -2 Pa .*yield strength$"):
        ElasticPlasticConstants(E=0.0, nu=-1.0, sigma_y=-2.0)
    with pytest.raises(ValueError, match=r"^D = 2 is outside \(1, 2\)"):
        ProfileSurface(D=2.0, G=1e-9, gamma=1.5)
    with pytest.raises(ValueError, match=r"^D = 1 is outside \(1, 2\).*; G = 0 m is outside \(0, inf\)"):
        FlankSurface(D=1.0, G=0.0)


@pytest.mark.parametrize(
    ("law", "name", "value", "text"),
    [
        (ZHAO, "surface.D", 1.0, "surface.D = 1 is outside (1, 2)"),
        (ZHAO, "H", 0.0, "H = 0 Pa is outside (0, inf)"),
        (ZHAO, "traction_ratio", 1.0, "traction_ratio = 1 is outside [0, 1)"),
        (
            ZHAO,
            "critical_area",
            "x",
            "critical_area = 'x' is not one of continuity, printed, yield",
        ),
        (ZHAO, "spot_stiffness", "x", "spot_stiffness = 'x' is not one of hertz, family"),
        (ZHAO, "A_0", -1.0, "A_0 = -1 m2 is outside (0, inf)"),
        (ZHAO, "mass", np.nan, "mass = nan kg is outside (0, inf)"),
        (HU, "surface.D", 1.5304, "surface.D = 1.5304 is outside (2, 3)"),
        (HU, "surface.s_min", 0.0, "surface.s_min = 0 m2 is outside (0, inf)"),
        (HU, "mu", 0.0, "mu = 0 is outside (0, inf)"),
        (YU, "e", 1.0, "e = 1 is outside [0, 1)"),
        (YU, "lambda", 1.5, "lambda = 1.5 is outside (0, 1]"),
        (YU, "lambda", 0.0, "lambda = 0 is outside (0, 1]"),
        (YU, "rigid_flat", "yes", "rigid_flat = 'yes' is not one of true, false"),
        (YU, "plastic_area", "x", "plastic_area = 'x' is not one of geometric, kogut_etsion"),
        (YU, "surface2.G", -1e-9, "surface2.G = -1e-09 m is outside (0, inf)"),
    ],
)
def test_laws_refuse_what_is_outside(law, name, value, text):
    with pytest.raises(ValueError, match=r"^[^\n]*$") as error:
        replace_values(law, {name: value})
    assert str(error.value).startswith(text)


def test_construction_of_a_law_uses_the_published_name():
    values = {item.name: getattr(YU, item.name) for item in fields(YU)}
    with pytest.raises(ValueError, match=r"^lambda = 2 is outside \(0, 1\]"):
        Yu2022(**values | {"lambda_": 2.0})


def test_no_physical_value_has_a_default():
    for cls in (Zhao2018, type(HU), Yu2022):
        with pytest.raises(ValueError, match=r"^missing ") as error:
            build_parameter_set(cls, {})
        missing = set(str(error.value).removeprefix("missing ").split(", "))
        assert missing == {name for name, item in flatten_fields(cls) if "unit" in item.metadata}


def test_every_number_has_a_unit_and_a_meaning():
    for cls in (Zhao2018, type(HU), Yu2022):
        for name, item in flatten_fields(cls):
            assert item.metadata["doc"].strip(), name
            if "allowed" not in item.metadata:
                assert item.metadata["unit"] in {"1", "m", "m2", "Pa", "kg"}, name


def test_problem_and_interval():
    share = next(item for item in fields(Inner) if item.name == "share")
    stress = next(item for item in fields(Inner) if item.name == "stress")
    length = next(item for item in fields(Outer) if item.name == "lambda_")
    texts = [str(item.metadata["interval"]) for item in (share, stress, length)]
    assert texts == ["[0, 1)", "(0, 1e+09]", "(-inf, inf)"]
    assert find_problem("x", 0.5, share) is None
    assert find_problem("x", np.float64(0.5), share) is None
    assert find_problem("x", 1.0, share) == "x = 1 is outside [0, 1): some share"
