"""Reference values of the laws: a law with a change of 1 % fails."""

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
    list_missed_quantities,
    read_reference_cases,
)

from jointfmu.contact.laws import LAWS
from jointfmu.contact.powerlaw import SmoothFunctionTerm
from jointfmu.joints import KINDS
from jointfmu.joints.harmonic_drive import prescribed_midline
from jointfmu.quantity import flatten_fields


def test_all_laws_agree():
    compared = compare_laws()
    assert {c.law for c in compared} == {law for kind in KINDS.values() for law in kind.laws}
    assert list_missed_quantities(compared) == []
    assert format_law_summary(compared).endswith("missed: none")


def test_every_choice_of_a_law_has_a_case():
    for law, cls in LAWS.items():
        cases = [case["parameters"] for case in read_reference_cases() if case["law"] == law]
        for name, item in flatten_fields(cls):
            if "allowed" in item.metadata:
                assert {case[name] for case in cases} == set(item.metadata["allowed"]), (law, name)


def scale_term(term, factor):
    """Term of a contact spot with its value multiplied by a factor."""
    if isinstance(term, SmoothFunctionTerm):
        return replace(term, spot_function=lambda t: factor * term.spot_function(t))
    return replace(term, coefficient=factor * term.coefficient)


def scaled(spots, quantity, factor):
    terms = tuple(scale_term(term, factor) for term in spots.regime_terms[quantity])
    return replace(spots, regime_terms=dict(spots.regime_terms) | {quantity: terms})


MIDLINES = {
    "catalogue": prescribed_midline.CatalogueDriveParameters,
    "table": prescribed_midline.TableDriveParameters,
}
NONE = (("yu2022", "tangential"), ("table", "area"))
"""(law, quantity) that a law does not have."""


def moved(law, quantity):
    """Class of a law, name of its method, and the method with a quantity 1 % larger."""
    cls = MIDLINES[law] if quantity == "midline" else LAWS[law]
    name = {"midline": "make_midline_nodes"}.get(quantity, "spot_distribution")
    name = "real_area" if (law, quantity) == ("roughness", "area") else name
    own = getattr(cls, name)
    return (
        cls,
        name,
        {
            "make_midline_nodes": lambda self: [
                n._replace(torque=1.01 * n.torque, stiffness=1.01 * n.stiffness) for n in own(self)
            ],
            "real_area": lambda self, p: (1.01 * own(self, p)[0], own(self, p)[1]),
            "spot_distribution": lambda self: scaled(own(self), quantity, 1.01),
        }[name],
    )


@pytest.mark.parametrize(
    ("law", "quantity"),
    [
        *((law, q) for law in LAWS for q in ("load", "normal", "tangential", "area") if (law, q) not in NONE),
        *((law, "midline") for law in MIDLINES),
    ],
)
def test_a_law_that_moves_by_a_percent_is_missed(law, quantity, monkeypatch, capsys):
    monkeypatch.setattr(*moved(law, quantity))
    missed = list_missed_quantities(compare_laws())
    assert {name.partition(".")[0] for name in missed} == {law}
    if quantity == "midline":
        assert missed == [f"{law}.tau", f"{law}.K_WTS"]
    if (law, quantity) == ("zhao2018", "normal"):
        assert main(["validate"]) == 1
        assert "missed: zhao2018.K_N" in capsys.readouterr().out


def test_what_a_law_does_not_have_is_not_compared():
    for law, quantity in NONE:
        case = next(case for case in read_reference_cases() if case["law"] == law)
        assert {"tangential": "K_T", "area": "A_r"}[quantity] not in case["values"]


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
