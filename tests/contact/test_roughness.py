"""Surface heights in parameter files, and the stiffness estimate that follows from them."""

import math
import re
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from jointfmu_tools.inputs.fields.joint_parameters import insert_pressure_field
from jointfmu_tools.inputs.fields.nodal_result import ContactPressureField

from jointfmu.contact import roughness
from jointfmu.joints import KINDS
from jointfmu.joints.bolted_joint.law import preload_pressure
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

SECTION, JUDGING = "\n[roughness]\n", "\n[comparison]\n"


def entry(name, value, unit="m"):
    return f'{name} = {{ value = {value}, unit = "{unit}", kind = "user", source = "drawing" }}\n'


@pytest.fixture
def loaded(tmp_path):
    """Function that reads the default gear contact, which states no roughness, with added lines."""

    def read(lines):
        path = tmp_path / "joint.toml"
        path.write_text(format_parameter_file(load_default("gear_contact")) + JUDGING + lines)
        return load_parameter_file(path)

    return read


def test_height_of_both_surfaces():
    """R_q is 1.25 R_a (Gaussian); a side that is not stated counts as smooth; h stands for both sides."""
    assert roughness.rms_height(1.0) == pytest.approx(1.2533, abs=1e-4)
    assert roughness.combined_height({"Ra1": 1.6e-6, "Ra2": 1.6e-6}) == pytest.approx(2.83e-6, rel=0.003)
    assert roughness.combined_height({"Rq1": 3e-6, "Rq2": 4e-6}) == pytest.approx(5e-6)
    assert roughness.combined_height({"Rq1": 3e-6, "Ra2": 4e-6 / roughness.RQ_OVER_RA}) == pytest.approx(5e-6)
    assert roughness.combined_height({"Rq2": 4e-6}) == pytest.approx(4e-6)
    assert roughness.combined_height({"h": 1e-6}) == 1e-6
    assert roughness.combined_height({}) is None


def test_mean_height_of_a_gaussian_surface():
    """RQ_OVER_RA agrees with the integral of |z| over the normal density."""
    step = 1e-3
    mean = sum(2.0 * z * math.exp(-0.5 * z * z) * step for z in (step * (i + 0.5) for i in range(10_000)))
    assert math.sqrt(2.0 * math.pi) / mean == pytest.approx(roughness.RQ_OVER_RA, rel=1e-6)


def test_level():
    """The predicted stiffness of the box specimen at 9 kN is F/(0.45 h) = 5.65e10 N/m."""
    h = roughness.combined_height(load_default("bolted_joint").roughness)
    assert roughness.predicted_stiffness(8 * 9e3, h) == pytest.approx(5.65e10, rel=0.005)


# The section


def load_text(text):
    with TemporaryDirectory() as folder:
        path = Path(folder) / "again.toml"
        path.write_text(text)
        return load_parameter_file(path)


def test_nothing_is_lost(loaded):
    file = loaded(entry("Ra1", 0.8e-6) + entry("Rq2", 1e-6))
    assert file.roughness == {"Ra1": 0.8e-6, "Rq2": 1e-6}
    assert file.sources["comparison.Ra1"] == "drawing"
    again = file.with_values({"lambda": 0.5}, "user", "measured")
    assert again.roughness == file.roughness
    text = format_parameter_file(again)
    assert JUDGING in text
    assert "comparison" not in again.values_by_name
    assert "[comparison]" not in format_parameter_file(load_default("gear_contact"))
    assert load_text(text) == again


@pytest.mark.parametrize("joint", KINDS)
def test_every_joint_may_state_it(joint):
    file = load_default(joint).with_roughness({"h": 2e-6}, "user", "scan")
    again = load_text(format_parameter_file(file))
    assert (again.roughness, again.sources[file.heights_prefix + "h"]) == ({"h": 2e-6}, "scan")


def test_a_new_roughness_replaces_the_old_one_of_the_same_side():
    file = load_default("gear_contact").with_roughness({"Ra1": 1e-6, "Ra2": 2e-6}, "user", "drawing")
    one = file.with_roughness({"Rq1": 3e-6}, "derived", "scan")
    assert one.roughness == {"Ra2": 2e-6, "Rq1": 3e-6}
    assert (one.origins["comparison.Rq1"], one.sources["comparison.Ra2"]) == ("derived", "drawing")
    assert "comparison.Ra1" not in one.sources
    both = one.with_roughness({"h": 1e-6}, "user", "scan of both")
    assert both.roughness == {"h": 1e-6}
    assert [name for name in both.origins if name.startswith("comparison.")] == ["comparison.h"]
    assert both.with_roughness({"Ra2": 1e-6}, "user", "drawing").roughness == {"Ra2": 1e-6}
    with pytest.raises(ValueError, match=r"comparison\.Ra3"):
        file.with_roughness({"Ra3": 1e-6}, "user", "wrong")


WITHOUT_H = re.compile(r"^h = .*\n", re.MULTILINE)


@pytest.mark.parametrize("joint", KINDS)
def test_it_is_the_height_of_the_law_of_that_name(joint):
    """Without h, the height is computed from both sides: sqrt(pi/2) Ra each (Gaussian)."""
    text = format_parameter_file(load_default(joint, "roughness"))
    found = load_text(WITHOUT_H.sub("", text) + SECTION + entry("Ra1", 0.8e-6) + entry("Rq2", 1e-6))
    name = next(name for name in found.values_by_name if name.split(".")[-1] == "h")
    assert found.values_by_name[name] == pytest.approx(np.sqrt(np.pi / 2 * 0.64e-12 + 1e-12), rel=1e-15)
    assert (found.origins[name], found.sources[name]) == (
        "derived",
        "from roughness.Ra1, roughness.Rq2: drawing",
    )


@pytest.mark.parametrize("joint", KINDS)
def test_another_height_of_the_law_beside_it_is_refused(joint):
    """Within 1 % both heights may be stated, and the law's own height is used."""
    file = load_default(joint, "roughness")
    name = next(name for name in file.values_by_name if name.split(".")[-1] == "h")
    near = load_text(format_parameter_file(file) + SECTION + entry("h", 1.009 * file.values_by_name[name]))
    assert near.values_by_name[name] == file.values_by_name[name]
    with pytest.raises(
        ValueError, match=r"h = .* m does not agree with roughness\.Ra1, which give 1\.003e-06 m: "
    ):
        load_text(format_parameter_file(file) + SECTION + entry("Ra1", 0.8e-6))


@pytest.mark.parametrize("joint", KINDS)
def test_a_law_has_the_height_that_was_stated_last(joint):
    """The height is that of the surfaces, or the law's own if it is set later; the written file
    loads again."""
    file = load_default(joint, "roughness").with_roughness({"Ra1": 1e-6, "Rq2": 2e-6}, "user", "drawing")
    name = next(name for name in file.values_by_name if name.split(".")[-1] == "h")
    assert load_text(format_parameter_file(file)).values_by_name[name] == pytest.approx(
        np.sqrt(np.pi / 2 * 1e-12 + 4e-12), rel=1e-15
    )
    assert file.sources[name] == "from roughness.Ra1, roughness.Rq2: drawing"
    fitted = load_text(format_parameter_file(file.with_values({name: 3e-6}, "calibration", "fit")))
    assert (fitted.values_by_name[name], fitted.roughness) == (3e-6, {})


def test_a_roughness_acts_or_is_refused(tmp_path):
    """For a law without height, the heights are in a section whose name says that they do not act."""
    path = tmp_path / "joint.toml"
    path.write_text(format_parameter_file(load_default("gear_contact")) + SECTION + entry("Ra1", 0.8e-6))
    with pytest.raises(
        ValueError, match=r"joint\.toml: \[roughness\] has no effect on law = 'yu2022', .* \[comparison\]"
    ):
        load_parameter_file(path)


@pytest.mark.slow
def test_a_field_keeps_it():
    file = load_default("bolted_joint")
    shape = pressure_distribution(file.values.pattern)
    pressure = preload_pressure(file.values, shape, 9e3, 0.0)
    field = ContactPressureField(shape.area_share * file.values.A_0, shape.position, pressure)
    made, _ = insert_pressure_field(file, field, 9e3, "test")
    assert made.roughness == file.roughness
    assert made.sources["comparison.Ra1"] == file.sources["comparison.Ra1"]


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (entry("Ra1", 0.0), ["comparison.Ra1 = 0 m", "(0, 0.0001]", "arithmetic mean height of the first"]),
        (entry("h", -1e-6), ["comparison.h = -1e-06 m", "(0, 0.0001]"]),
        (entry("h", "nan"), ["comparison.h = nan m", "(0, 0.0001]"]),
        (entry("h", "true"), ["comparison.h = True", "not a number"]),
        (entry("h", '"fine"'), ["comparison.h = 'fine'", "not a number"]),
        (entry("Ra1", 0.8, "um"), ["comparison.Ra1", "unit 'um'", "expected 'm'"]),
        (entry("Rz1", 1e-6), ["'comparison.Rz1'", "comparison.Ra1, comparison.Ra2, comparison.Rq1"]),
        (
            entry("Ra1", 1e-6) + entry("Rq1", 1e-6),
            ["comparison.Ra1 with comparison.Rq1", "one height"],
        ),
        (entry("h", 1e-6) + entry("Ra2", 1e-6), ["comparison.h with comparison.Ra2", "or only h"]),
        ("h = 1e-6\n", ["comparison.h = 1e-06", "{ value, unit, kind, source }"]),
    ],
)
def test_a_wrong_entry_is_refused(loaded, lines, words):
    with pytest.raises(ValueError, match=r"joint\.toml: ") as error:
        loaded(lines)
    message = str(error.value)
    assert len(message.splitlines()) == 1
    for word in words:
        assert word in message
