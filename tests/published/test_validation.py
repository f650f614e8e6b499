"""Published numbers: all are met, fits use calibration points only, and a miss is reported."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jointfmu_tools.studies.published import calibration
from jointfmu_tools.studies.published.calibration import fit_calibrated_parameters
from jointfmu_tools.studies.published.computed import load_published_numbers
from jointfmu_tools.studies.published.reference import (
    CALIBRATION_TOLERANCE,
    POINT_ROLES,
    ROLES_WITH_TRIVIAL_GUESS,
    UNTESTED_ROLES,
    PublishedPoint,
    TrivialGuess,
    compute_trivial_guesses,
    read_points,
)
from jointfmu_tools.studies.published.validation import (
    compare_point,
    count_points,
    format_validation_summary,
    format_validation_table,
    select_missed_points,
    validate_published_numbers,
)

from jointfmu.joints import KINDS
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_fields, flatten_parameters

REPRODUCED = 1e-6
"""Relative tolerance of a repeated fit [1]: it stops at residuals of 1e-8, and its least determined parameter
changes about ten times as much."""

PAPERS = [paper for kind in KINDS.values() for paper in load_published_numbers(kind).paper_names]
OBSERVABLES = {
    q: f for kind in KINDS.values() for q, f in load_published_numbers(kind).observable_functions.items()
}
FITS = {
    name: (load_published_numbers(kind).paper_names[0], load_published_numbers(kind).calibration_fits)
    for name, kind in KINDS.items()
    if load_published_numbers(kind).calibration_fits
}
ALL = [point for paper in PAPERS for point in read_points(paper)]


@pytest.fixture(scope="module")
def rows():
    return validate_published_numbers()


# The comparison


@pytest.mark.parametrize("point", ALL, ids=[f"{p.paper}-{p.id}" for p in ALL])
def test_published_point_is_met(rows, point):
    row = next(r for r in rows if r.published_point == point)
    assert row.has_passed, (row.published_point.id, row.computed_value, row.published_point.value, row.error)


def test_every_point_is_compared_once(rows):
    assert [row.published_point for row in rows] == ALL
    assert len({(p.paper, p.id) for p in ALL}) == len(ALL)
    assert select_missed_points(rows) == []
    assert {p.paper for p in ALL} == set(PAPERS)


def test_points_say_where_they_stand():
    for p in ALL:
        assert p.role in POINT_ROLES
        assert p.quantity in OBSERVABLES
        assert any(word in p.place for word in ("section", "Eq", "Table", "conclusion", "yield")), p.id
        assert p.absolute or p.unit != "%", p.id  # a change in per cent is off by percentage points
        assert (p.guess is not None) == (p.role in ROLES_WITH_TRIVIAL_GUESS), p.id
        if p.role == "calibration":
            assert p.tolerance == CALIBRATION_TOLERANCE
        elif p.role != "claim":
            assert p.basis != "fitted", p.id  # a tolerance of its own, with its origin


PRINTED = {  # as the papers print them
    ("hu2023", "K_TS.nominal.5"): 1820.44,
    ("hu2023", "K_TS.max.1"): 1009.11,
    ("hu2023", "K_TS.max.3"): 1552.69,
    ("hu2023", "K_TS.max.5"): 1940.49,
    ("hu2023", "K_TS.eccentricity.1"): -9.40,
    ("hu2023", "K_TS.eccentricity.3"): -6.61,
    ("hu2023", "K_TS.eccentricity.5"): -5.02,
    ("hu2023", "K_WTS.theory.0.5"): 2524.92,
    ("hu2023", "K_WTS.measured.0.5"): 2723.75,
    ("hu2023", "K_WTS.measured.5"): 5294.0,
    ("hu2023", "p_max.5"): 96.35e6,
    ("zhao2018", "p_max.9kN"): 7.98e6,
    ("zhao2018", "p_between.9kN"): 0.62e6,
    ("zhao2018", "bolt_force.high"): 20e3,
    ("zhao2018", "bolt_force.low"): 10e3,
    ("hu2023", "kogut_etsion.load.1"): 1.1282,
    ("hu2023", "kogut_etsion.load.2"): 1.4988,
    ("hu2023", "kogut_etsion.stiffness.1"): 1.5082,
    ("hu2023", "kogut_etsion.stiffness.2"): 1.7935,
    ("hu2023", "kogut_etsion.area.1"): 7.1197,
    ("hu2023", "kogut_etsion.area.2"): 205.3827,
}
DERIVED = {  # the printed maximum over 1 plus the printed rise (Hu 2023, section 3.4)
    ("hu2023", "K_TS.min.1"): 1009.11 / 1.1265,
    ("hu2023", "K_TS.min.3"): 1552.69 / 1.0876,
    ("hu2023", "K_TS.min.5"): 1940.49 / 1.0712,
}


def test_values_are_those_of_the_papers():
    printed = {(p.paper, p.id): p.value for p in ALL if p.printed and p.role != "claim"}
    assert printed == PRINTED
    derived = {(p.paper, p.id): p for p in ALL if not p.printed}
    for key, value in DERIVED.items():
        assert derived[key].value == pytest.approx(value, abs=0.005)  # half a unit of the last digit
    others = {p.role for key, p in derived.items() if key not in DERIVED}
    assert others == {"self-check", "circular", "contradiction"}


def test_table_3_is_divided_by_the_experiment(rows):
    """Errors of frequencies are those of Zhao 2018, Table 3: 100 (predicted/measured - 1)."""
    for row in rows:
        if row.published_point.quantity == "frequency_error":
            given = row.published_point.where
            assert row.computed_value == pytest.approx(
                100 * (given["predicted"] / given["measured"] - 1), rel=1e-12
            )


def point(**changes):
    base = PublishedPoint(
        paper="p",
        joint="gear_contact",
        id="x",
        quantity="claim",
        where={},
        value=-200.0,
        unit="N",
        place="Eq. 1",
        printed=True,
        role="prediction",
        tolerance=0.01,
        basis="one per cent",
    )
    return replace(base, **changes)


@pytest.mark.parametrize(
    ("changes", "computed", "error", "passed"),
    [
        ({}, -200.0, 0.0, True),
        ({}, -198.5, 0.0075, True),
        ({}, -202.5, -0.0125, False),
        ({}, 200.0, 2.0, False),
        ({}, float("nan"), float("nan"), False),
        ({}, float("inf"), float("inf"), False),
        ({"tolerance": 1.5, "absolute": True}, -201.4, -1.4, True),
        ({"tolerance": 1.5, "absolute": True}, -198.4, 1.6, False),
        ({"value": True, "role": "claim"}, True, 0.0, True),
        ({"value": True, "role": "claim"}, False, 1.0, False),
        ({"value": False, "role": "claim"}, True, 1.0, False),
        ({"value": False, "role": "claim"}, False, 0.0, True),
    ],
)
def test_compare(changes, computed, error, passed):
    row = compare_point(point(**changes), computed)
    assert row.error == pytest.approx(error, rel=1e-9, nan_ok=True)  # differences of three digits
    assert row.has_passed is passed
    assert row.to_json()["verdict"] == ("pass" if passed else "miss")
    assert select_missed_points([row]) == ([] if passed else [row])


@pytest.mark.parametrize("role", [role for role in POINT_ROLES if role != "claim"])
def test_what_a_miss_means(role):
    """A miss counts, unless the point was met by calibration or by construction."""
    row = compare_point(point(role=role), -300.0)
    assert not row.has_passed
    assert select_missed_points([row]) == ([] if role in UNTESTED_ROLES else [row])
    assert row.verdict == ("no test, moved" if role in UNTESTED_ROLES else "miss")
    met = compare_point(point(role=role), -200.0)
    assert met.verdict == ("no test" if role in UNTESTED_ROLES else "pass")
    assert count_points([row]).missed == [r.published_point.id for r in select_missed_points([row])]


def test_who_is_nearer():
    assert compare_point(point(), -199.0).nearer_estimate == ""
    assert compare_point(point(), -199.0, -201.5).nearer_estimate == "law"
    assert compare_point(point(), -198.0, -201.5).nearer_estimate == "guess"
    assert compare_point(point(), -199.0, -201.0).nearer_estimate == "guess"  # no better than the guess
    row = compare_point(point(absolute=True), -199.0, -201.5)
    assert (row.trivial_guess, row.guess_error) == (-201.5, -1.5)
    assert row.to_json()["guess"] == -201.5


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"role": "validation"}, "role = 'validation', allowed are calibration, circular, contradiction"),
        ({"role": "claim"}, "value = -200.0; expected true or false for role"),
        ({"value": True}, "value = True; expected true or false for role"),
        (
            {"role": "constant", "guess": TrivialGuess(rule="constant", points=["a"])},
            "interpolation, prediction",
        ),
    ],
)
def test_a_point_that_contradicts_itself_is_refused(changes, said):
    with pytest.raises(ValueError, match=said) as error:
        point(**changes)
    assert str(error.value).startswith("p: x: ")


# Trivial guesses


A, B, C = (
    point(id=name, value=value, where={"torque": torque}, role="calibration")
    for name, value, torque in (("a", 3.0, 1.0), ("b", 12.0, 4.0), ("c", 24.0, 2.0))
)


@pytest.mark.parametrize(
    ("how", "guess", "text"),
    [
        ({"rule": "constant", "points": ["b"]}, 12.0, "as b"),
        ({"rule": "power law", "points": ["a", "b"], "over": "torque"}, 27.0, "through a, b"),
        ({"rule": "offset", "points": ["a", "b", "c"]}, -9.0, "a + b - c"),
        ({"rule": "proportion", "points": ["a", "b", "c"]}, 1.5, "a * b / c"),
        (
            {"rule": "growth", "points": ["c", "a", "b"], "over": "torque"},
            108.0,
            "power of torque from a to b",
        ),
        ({"rule": "offset", "points": ["a", "b", "y"]}, 3.0, "a + b - y"),  # y by its own guess
    ],
)
def test_guess(how, guess, text):
    asked = point(value=1.0, where={"torque": 9.0}, guess=TrivialGuess(**how))
    other = point(id="y", value=99.0, guess=TrivialGuess(rule="constant", points=["b"]))
    assert compute_trivial_guesses([A, B, C, other, asked])["x"] == pytest.approx(guess, rel=1e-12)
    assert text in str(asked.guess)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"rule": "mean", "points": ["a"]}, "rule = 'mean', allowed are constant, power law"),
        ({"rule": "constant", "points": ["a", "b"]}, "2 points, expected 1 for the rule constant"),
        ({"rule": "power law", "points": ["a", "b"]}, "over = '', expected a name for the rule power law"),
        (
            {"rule": "constant", "points": ["a"], "over": "torque"},
            "over = 'torque', expected none for the rule constant",
        ),
    ],
)
def test_a_guess_that_is_none_is_refused(how, said):
    with pytest.raises(ValueError, match=said):
        TrivialGuess(**how)


@pytest.mark.parametrize("name", ["x", "z", "missing"])
def test_a_guess_from_what_was_not_calibrated_is_refused(name):
    """A guess from the point itself, from a prediction without guess, or from no point is refused."""
    asked = point(guess=TrivialGuess(rule="constant", points=[name]))
    with pytest.raises(ValueError, match=f"x: guess from '{name}', allowed are calibration points"):
        compute_trivial_guesses([point(id="z"), asked])


def test_guesses_are_those_by_hand(rows):
    found = {row.published_point.id: row.trivial_guess for row in rows if row.trivial_guess is not None}
    power = np.log(5294.0 / 2524.92) / np.log(10.0)
    top = {T: 1940.49 * (T / 5.0) ** power for T in (1, 3)}
    expected = {f"K_TS.max.{T}": value for T, value in top.items()}
    expected |= {f"K_TS.min.{T}": value - (1940.49 - 1811.51) for T, value in top.items()}
    expected |= {f"K_TS.eccentricity.{T}": -5.02 * 1940.49 / value for T, value in top.items()}
    assert found == pytest.approx(expected, rel=1e-12)


def test_modes_are_guessed_from_the_lower_preload():
    published = read_points("zhao2018_modes")
    measured = {p.id: p.value for p in published}
    found = compute_trivial_guesses(published)
    assert len(found) == 12
    assert all(value == measured[name.split(".")[0] + ".9kN"] for name, value in found.items())


# The comparison as a whole


def test_a_wrong_computed_value_is_a_miss():
    """Every quantity in turn is wrong by twice its tolerance, in both directions; claims are inverted."""
    for name in OBSERVABLES:
        first = next(p for p in ALL if p.quantity == name)
        for sign in (-1.0, 1.0):
            wrong = not first.value
            if not isinstance(first.value, bool):
                off = first.tolerance * (1.0 if first.absolute else abs(first.value))
                wrong = first.value + sign * 2.0 * off
            assert not compare_point(first, wrong).has_passed


def test_missed_points_are_listed(rows):
    wrong = [p.id for p in ALL if p.quantity == "psi"]
    assert "psi.1.5" in wrong
    found = [compare_point(r.published_point, 2.0) if r.published_point.id in wrong else r for r in rows]
    assert [row.published_point.id for row in select_missed_points(found)] == wrong
    assert format_validation_summary(found).endswith("missed: " + ", ".join(wrong))
    lines = format_validation_table(found).splitlines()
    assert len(lines) == len(ALL) + 1
    assert [line.split()[1] for line in lines if line.endswith("MISS")] == wrong


def test_counts(rows):
    found = count_points(rows)
    assert sum(found.roles.values()) == len(ALL)
    assert found.roles == {role: sum(p.role == role for p in ALL) for role in POINT_ROLES} == found.met
    assert found.numbers == found.printed + found.derived == len(ALL) - found.roles["claim"]
    assert found.printed == len(PRINTED)
    assert found.guessed == {
        role: n if role in ROLES_WITH_TRIVIAL_GUESS else 0 for role, n in found.roles.items()
    }
    assert found.nearer == {
        role: sum(r.nearer_estimate == "law" and r.published_point.role == role for r in rows)
        for role in POINT_ROLES
    }
    assert len(found.contradictions) == 3
    assert found.missed == []


def test_the_guide_explains_every_role():
    guide = Path(__file__).parents[2] / "docs" / "models.md"
    section = (
        guide.read_text(encoding="utf-8").partition("## What a published number shows")[2].partition("##")[0]
    )
    assert set(re.findall(r"^\| `([a-z-]+)` \|", section, flags=re.MULTILINE)) == set(POINT_ROLES)


def test_summary(rows):
    found = count_points(rows)
    roles = ", ".join(f"{n} {role}" for role, n in found.roles.items() if role != "claim")
    assert format_validation_summary(rows) == (
        f"{found.numbers} numbers, {found.printed} printed in the papers and "
        f"{found.derived} computed from printed ones: {roles}; {found.roles['claim']} claims; "
        f"nearer than the trivial guess: {found.nearer['interpolation']} of 6 (interpolation); "
        f"text against its own equations: {', '.join(found.contradictions)}; missed: none"
    )
    off = [replace(row, has_passed=False) if row.published_point.id == "p_max.9kN" else row for row in rows]
    assert (
        f"{found.roles['calibration']} calibration ({found.roles['calibration'] - 1} met)"
        in format_validation_summary(off)
    )


def test_another_parameter_set_is_compared():
    """The given parameter sets are used, and defaults for the others."""
    soft = load_default("harmonic_drive").with_values({"K_FTS0": 1e4}, "user", "test")
    found = validate_published_numbers({"harmonic_drive": soft})
    names = {row.published_point.id for row in found if not row.has_passed}
    assert "K_WTS.measured.5" in names
    assert all(name.startswith("K_WTS") for name in names)


# The fits


def fitted_points():
    return [(paper, name) for paper, fits in FITS.values() for fit in fits for name in fit.point_ids]


def test_fits_name_calibration_points_only():
    roles = {(p.paper, p.id): p.role for p in ALL}
    assert {roles[key] for key in fitted_points()} == {"calibration"}
    # and every calibration point is used, once
    assert sorted(fitted_points()) == sorted(key for key, role in roles.items() if role == "calibration")


def test_as_many_points_as_unknowns():
    for _, fits in FITS.values():
        for fit in fits:
            assert len(fit.start_value_by_parameter) == len(fit.point_ids)


@pytest.mark.parametrize(
    ("curve", "most"), [("K_TS.max", 2), ("K_TS.min", 2), ("K_TS.eccentricity", 1), ("K_WTS.measured", 1)]
)
def test_part_of_every_curve_is_not_fitted(curve, most):
    """At most two of three torques of a stiffness curve are fitted, and one of the eccentricity's curve."""
    of_curve = [p for p in ALL if p.id.startswith(f"{curve}.")]
    assert len(of_curve) == (2 if curve == "K_WTS.measured" else 3)
    assert 1 <= sum(p.role == "calibration" for p in of_curve) <= most


@pytest.mark.parametrize("joint", FITS)
def test_fitted_values_are_marked_in_the_code_and_in_the_file(joint):
    unknowns = {name for fit in FITS[joint][1] for name in fit.start_value_by_parameter}
    file = load_default(joint)
    assert unknowns == {name for name, kind in file.origins.items() if kind == "calibration"}
    declared = {name for name, item in flatten_fields(type(file.values)) if item.metadata.get("calibration")}
    assert declared <= unknowns
    for fit in FITS[joint][1]:
        for name in fit.start_value_by_parameter:
            assert all(used in file.sources[name] for used in fit.point_ids)


@pytest.mark.slow
@pytest.mark.parametrize("joint", FITS)
def test_calibration_reproduces_the_committed_values(joint):
    """Calibration gives the committed values from other values in the file and other start values."""
    committed = load_default(joint)
    paper, fits = FITS[joint]
    unknowns = [name for fit in fits for name in fit.start_value_by_parameter]
    values = flatten_parameters(committed.values)
    factors = {"rated_pressure": 1.02, "radial_deformation": 1.005}
    start = committed.with_values(
        {name: values[name] * factors.get(name, 0.9) for name in unknowns}, "user", "perturbed"
    )
    points, again = {p.id: p for p in read_points(paper)}, start
    for fit in fits:
        first = {
            name: value * factors.get(name, 1.05) for name, value in fit.start_value_by_parameter.items()
        }
        wanted = [points[name] for name in fit.point_ids]
        assert {p.role for p in wanted} == {"calibration"}
        again = calibration.fit_unknowns(again, replace(fit, start_value_by_parameter=first), wanted)
    for name in unknowns:
        assert flatten_parameters(again.values)[name] == pytest.approx(values[name], rel=REPRODUCED), name
        assert again.origins[name] == "calibration"
        assert again.sources[name] == committed.sources[name]
    untouched = {name: value for name, value in values.items() if name not in unknowns}
    assert {name: flatten_parameters(again.values)[name] for name in untouched} == untouched


def test_a_joint_without_points_is_refused():
    with pytest.raises(ValueError, match="gear_contact") as error:
        fit_calibrated_parameters(load_default("gear_contact"))
    assert "harmonic_drive, bolted_joint" in str(error.value)


@pytest.mark.slow
def test_a_fit_that_cannot_be_met_is_reported():
    """A fit is reported as impossible if a pressure between the bolts would be above the largest pressure."""
    paper, (fit,) = FITS["bolted_joint"]
    points = [p for p in read_points(paper) if p.id in fit.point_ids]
    bad = [replace(p, value=9e6) if p.id == "p_between.9kN" else p for p in points]
    with pytest.raises((RuntimeError, ValueError), match=r"pattern\.decay|decay_"):
        calibration.fit_unknowns(load_default("bolted_joint"), fit, bad)


UNKNOWNS = [
    (joint, name)
    for joint, (_, fits) in FITS.items()
    for fit in fits
    for name in fit.start_value_by_parameter
]


@pytest.mark.parametrize(("joint", "name"), UNKNOWNS)
def test_computed_values_follow_the_calibrated_ones(rows, joint, name):
    """A change of one per mille moves a computed value; for the drive, a value that was not fitted."""
    file = load_default(joint)
    changed = file.with_values({name: flatten_parameters(file.values)[name] * 1.001}, "user", "test")
    paper = FITS[joint][0]
    moved = set()
    for row in rows:
        if row.published_point.paper == paper:
            computed = OBSERVABLES[row.published_point.quantity](changed.values, **row.published_point.where)
            if computed != pytest.approx(row.computed_value, rel=1e-6):  # far above round-off, far below 1e-3
                moved.add(row.published_point.role)
    assert "calibration" in moved
    assert (
        joint == "bolted_joint" or moved & set(ROLES_WITH_TRIVIAL_GUESS) or "circular" in moved
    )  # Zhao's two are both fitted


def test_validation_reads_nothing_but_the_parameter_set(rows):
    """Published values have no influence on computed values."""
    for row in rows:
        values = load_default(row.published_point.joint).values
        computed = OBSERVABLES[row.published_point.quantity](values, **row.published_point.where)
        assert computed == row.computed_value
        if not isinstance(row.published_point.value, bool):
            tenth = replace(row.published_point, value=0.1 * row.published_point.value)
            assert not compare_point(tenth, computed).has_passed
