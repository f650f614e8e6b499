"""Reference values of the laws: a law that moves by 1 % is missed."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from jointfmu_tools.cli import main
from jointfmu_tools.studies.published.law_quadrature import format_reference_table
from jointfmu_tools.studies.published.law_reference import (
    LawComparison,
    compare_laws,
    format_law_summary,
    missed_quantities,
    read_reference_cases,
)

from jointfmu.contact.laws import LAWS, zhao2018
from jointfmu.contact.laws.zhao2018 import Zhao2018
from jointfmu.contact.powerlaw import SmoothTerm
from jointfmu.joints import KINDS
from jointfmu.joints.harmonic_drive import prescribed_midline
from jointfmu.quantity import flatten_fields


def test_all_laws_agree():
    compared = compare_laws()
    assert {c.law for c in compared} == {law for kind in KINDS.values() for law in kind.laws}
    assert missed_quantities(compared) == []
    assert format_law_summary(compared).endswith("missed: none")


def test_every_choice_of_a_law_has_a_case():
    for law, cls in LAWS.items():
        cases = [case["parameters"] for case in read_reference_cases() if case["law"] == law]
        for name, item in flatten_fields(cls):
            if "allowed" in item.metadata:
                assert {case[name] for case in cases} == set(item.metadata["allowed"]), (law, name)


def scale_term(term, factor):
    """The term of a spot with its value times a factor."""
    if isinstance(term, SmoothTerm):
        return replace(term, spot_function=lambda t: factor * term.spot_function(t))
    return replace(term, coefficient=factor * term.coefficient)


def scaled(spots, quantity, factor):
    terms = tuple(scale_term(term, factor) for term in spots.regime_terms[quantity])
    return replace(spots, regime_terms=dict(spots.regime_terms) | {quantity: terms})


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("quantity", ["load", "normal", "tangential", "area"])
def test_a_quantity_of_a_law_that_moves_by_a_percent_is_missed(law, quantity, monkeypatch):
    cls = LAWS[law]
    own = cls.spot_distribution
    case = next(case for case in read_reference_cases() if case["law"] == law)
    if law == "roughness" and quantity == "area":
        monkeypatch.setattr(cls, "real_area", moved_area(cls.real_area))
    elif (law, quantity) in (("yu2022", "tangential"), ("table", "area")):
        assert {"tangential": "K_T", "area": "A_r"}[quantity] not in case["values"]  # the law has none
        return
    else:
        monkeypatch.setattr(cls, "spot_distribution", lambda self: scaled(own(self), quantity, 1.01))
    missed = missed_quantities(compare_laws())
    assert missed
    assert {name.partition(".")[0] for name in missed} == {law}


def moved_area(real_area):
    return lambda self, p: (1.01 * real_area(self, p)[0], real_area(self, p)[1])


@pytest.mark.parametrize("law", ["catalogue", "table"])
def test_a_midline_that_moves_by_a_percent_is_missed(law, monkeypatch):
    cls = {
        "catalogue": prescribed_midline.CatalogueDriveParameters,
        "table": prescribed_midline.TableDriveParameters,
    }[law]
    own = cls.make_midline_nodes
    monkeypatch.setattr(
        cls,
        "make_midline_nodes",
        lambda self: [n._replace(torque=1.01 * n.torque, stiffness=1.01 * n.stiffness) for n in own(self)],
    )
    assert missed_quantities(compare_laws()) == [f"{law}.tau", f"{law}.K_WTS"]


def test_validate_misses_the_plastic_load_of_zhao_times_one_and_a_half(monkeypatch, capsys):
    own = Zhao2018.spot_distribution

    def spots(self):
        found = own(self)
        plastic, elastic = found.regime_terms["load"]
        return replace(
            found, regime_terms=dict(found.regime_terms) | {"load": (scale_term(plastic, 1.5), elastic)}
        )

    monkeypatch.setattr(Zhao2018, "spot_distribution", spots)
    assert main(["validate"]) == 1
    assert "zhao2018.K_N" in capsys.readouterr().out


def test_validate_misses_twice_the_normal_stiffness(monkeypatch, capsys):
    own = zhao2018.normal_stiffness
    monkeypatch.setattr(zhao2018, "normal_stiffness", lambda law, a: 2.0 * own(law, a))
    assert main(["validate"]) == 1
    assert "missed: zhao2018.K_N" in capsys.readouterr().out


def test_not_a_number_is_a_miss():
    assert not LawComparison("zhao2018", "K_N", 1, np.nan, ("pressure", 1e6), 1.0, np.nan).has_passed


@pytest.mark.slow
def test_the_table_is_that_of_the_script():
    frozen = (files("jointfmu_models") / "reference" / "laws.toml").read_text(encoding="utf-8")
    again = "\n".join(format_reference_table())
    numbers = [float(x) for x in words(frozen) if is_number(x)]
    assert [float(x) for x in words(again) if is_number(x)] == pytest.approx(numbers, rel=1e-10)
    assert [x for x in words(again) if not is_number(x)] == [x for x in words(frozen) if not is_number(x)]


def words(text):
    return text.replace(",", " ").replace("[", " ").replace("]", " ").split()


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True
