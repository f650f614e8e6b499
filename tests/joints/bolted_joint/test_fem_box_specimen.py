"""Natural frequencies of Zhao's box specimen: what was fitted, what is predicted, what is missed."""

import json
from dataclasses import replace

import box_specimen_lengths as box
import numpy as np
import pytest
from jointfmu_tools.cli import main
from jointfmu_tools.fem.geometry import Plate

from jointfmu.parameters import default
from jointfmu.quantity import flatten

pytestmark = pytest.mark.slow

COARSE = 0.2
"""Refinement at which a frequency is still within some percent: enough for how it varies."""


def ringing(lengths, **options):
    assembly = box.specimen(box.shipped(), lengths)
    joint = default("bolted_joint").values
    return box.frequencies(assembly, joint, [(9e3, 0.0)], refinement=COARSE, **options)[0]


def test_table_3(capsys):
    # status 1: two predictions miss the 5.1 % of the paper's own model, as docs/finite_elements.md says
    assert main(["validate", "--frequencies", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    rows = {row["id"]: row for row in found["rows"] if row["quantity"] == "natural_frequency"}
    assert len(rows) == 18
    predicted = {name: row["error"] for name, row in rows.items() if row["role"] == "prediction"}
    assert len(predicted) == 12
    missed = {name for name, row in rows.items() if row["role"] == "prediction" and row["verdict"] == "miss"}
    assert missed == {"f5.15kN", "f3.15kN_4500Nm"}
    assert found["missed"] == len(missed)
    # the frequencies of 9 kN are nearer in most rows; f1 is within a mesh's 0.3 % of a draw
    nearer = [name for name in predicted if rows[name]["nearer"] == "law"]
    assert 1 <= len(nearer) <= 3
    assert max(map(abs, predicted.values())) == pytest.approx(0.057, abs=0.003)  # a mesh changes 0.3 %
    fitted = np.array([row["error"] for row in rows.values() if row["role"] == "calibration"])
    assert np.sqrt(np.mean(fitted**2)) == pytest.approx(0.032, abs=0.003)


def test_lengths_are_those_of_the_file():
    shipped = box.shipped()
    again = box.specimen(shipped, box.lengths_of(shipped).tolist())
    for one, other in ((again.side2, shipped.side2), (again.bolts, shipped.bolts)):
        assert flatten(one) == pytest.approx(flatten(other), rel=1e-12)  # sums of decimals


def test_what_is_no_box_is_refused():
    plate = Plate(length=0.4, width=0.4, thickness=0.02, E=2e11, nu=0.3, density=7800.0)
    shipped = box.shipped()
    plates = replace(shipped, side1=plate, side2=plate)
    with pytest.raises(ValueError, match="is no box on a grid of bolts"):
        box.specimen(plates, box.lengths_of(shipped).tolist())


def test_identification_finds_the_lengths_of_a_known_box():
    """Frequencies of a box that differs in what they determine best, length and overhang, are met again.

    One step of the least squares must do it: the slopes of all five lengths decide its direction.
    """
    lengths = box.lengths_of(box.shipped())
    known = lengths * np.array([1.03, 1.0, 1.0, 1.0, 0.97])
    target = ringing(known.tolist())
    start = ringing(lengths.tolist()) / target - 1.0
    joint = default("bolted_joint").values
    found = box.identify(box.shipped(), joint, 9e3, target, COARSE, trials=2)
    assert np.max(np.abs(start)) > 0.03
    # from 6 %: the square of that by curvature, and what a new mesh changes at random, 0.2 % together
    assert np.max(np.abs(found.error)) < 0.005
    assert found.slope.shape == (6, 5)
    assert set(found.deviation) == set(box.LENGTHS)
