"""Errors for a wrong word suggest the nearest right one; errors for a number suggest the likely unit."""

import json

import pytest
from conftest import refused_line
from jointfmu_tools import cli


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("bild",), "invalid choice: 'bild'"),
        (("bild",), "; did you mean build?"),
        (("law", "roughnes", "--pressure", "1e6"), "; did you mean roughness?"),
        (
            ("law", "roughness", "--presure", "1e6", "--pressure", "1e6"),
            "--presure 1e6; did you mean --pressure?",
        ),
        (("fit", "catalog"), "; did you mean catalogue?"),
        (("new", "harmonic-drive", "--catalog-name=x"), "did you mean --catalogue?"),
    ],
)
def test_a_misspelt_name_gets_the_nearest_names(capsys, words, said):
    assert said in refused_line(capsys, *words)


def test_a_name_without_similar_names_gets_no_suggestion(capsys):
    assert "did you mean" not in refused_line(capsys, "qqqq")
    assert "did you mean" not in refused_line(capsys, "validate", "--zzz")


@pytest.mark.parametrize("words", [("csg25-100",), ("CSG-25-100",), ("csg", "25", "100"), ("csg 25 100",)])
def test_the_catalogue_is_searched_whatever_the_signs(capsys, words):
    assert cli.main(["catalogue", *words, "--json"]) == 0
    assert [item["name"] for item in json.loads(capsys.readouterr().out)] == ["CSG-25-100"]


def test_a_name_that_no_catalogue_has(capsys):
    assert "has 'csg 99 100' in its name" in refused_line(capsys, "catalogue", "csg", "99", "100")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("law roughness --pressure 1e6 --set Ra1=0.8 Ra2=0.8e-6", "Ra1 = 0.8 m is outside (0, 0.0001]"),
        ("new bolted-joint {} --grip 40 --Ra 800", "plausible are 0.005 to 100 um; if it is in nm"),
        (
            "new bolted-joint {} --grip 4000 --Ra 0.8",
            "--grip = 4000 mm is outside (0, 600] mm: 50 times the diameter of M12",
        ),
    ],
)
def test_what_is_in_another_unit_is_refused_by_what_is_possible(capsys, words, said):
    plate = "--plate 200x100 --bolts 4xM12 --at 160x60 --material steel"
    assert said in refused_line(capsys, *words.format(plate).split())
