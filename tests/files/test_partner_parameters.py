"""Parameter files of the partners: one each, with sources; a fault is named in one line."""

from pathlib import Path

import pytest
from jointfmu_fmu_src.partners import PARTNERS, load_partner_parameters, models

from jointfmu.parameters import VALUE_ORIGINS
from jointfmu.quantity import flatten_parameters

SHIPPED = Path(__file__).resolve().parents[2] / "models" / "partners"


def test_every_partner_has_one_file() -> None:
    assert {path.stem for path in SHIPPED.iterdir()} == set(PARTNERS)


@pytest.mark.parametrize("name", PARTNERS)
def test_a_file_gives_every_parameter_with_its_source(name: str) -> None:
    file = load_partner_parameters(name)
    assert isinstance(file.values, PARTNERS[name].parameter_class)
    assert set(flatten_parameters(file.values)) == set(file.origins) == set(file.sources)
    assert set(file.origins.values()) <= set(VALUE_ORIGINS)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            'partner = "TranslationalMass"',
            'partner = "Mass"',
            "partner = 'Mass', expected 'TranslationalMass'",
        ),
        ('partner = "TranslationalMass"\n', "", "partner = None, expected 'TranslationalMass'"),
        ("schema = 1", "schema = 2", "schema = 2, expected the line schema = 1"),
        ('unit = "kg"', 'unit = "g"', "m: unit 'g', expected 'kg'"),
        ("value = 100.0", "value = -1.0", "m = -1 kg is outside (0, inf): mass"),
        ("lag_b", "lag_c", "unknown name 'lag_c'"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = (SHIPPED / "TranslationalMass.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "TranslationalMass.toml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ValueError, match=r"TranslationalMass\.toml: ") as error:
        models.read_partner_parameters(path, "TranslationalMass")
    assert str(error.value).startswith(f"{path}: ")
    assert words in str(error.value)
    assert "\n" not in str(error.value)
