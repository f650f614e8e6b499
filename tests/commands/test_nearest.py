"""A wrong word is answered with the nearest right one."""

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
def test_what_is_nearly_right_is_named(capsys, words, said):
    assert said in refused_line(capsys, *words)


def test_what_is_like_nothing_gets_no_guess(capsys):
    assert "did you mean" not in refused_line(capsys, "qqqq")
    assert "did you mean" not in refused_line(capsys, "validate", "--zzz")


@pytest.mark.parametrize("words", [("csg25-100",), ("CSG-25-100",), ("csg", "25", "100"), ("csg 25 100",)])
def test_the_catalogue_is_searched_whatever_the_signs(capsys, words):
    assert cli.main(["catalogue", *words, "--json"]) == 0
    assert [item["name"] for item in json.loads(capsys.readouterr().out)] == ["CSG-25-100"]


def test_a_name_that_no_catalogue_has(capsys):
    assert "has 'csg 99 100' in its name" in refused_line(capsys, "catalogue", "csg", "99", "100")
