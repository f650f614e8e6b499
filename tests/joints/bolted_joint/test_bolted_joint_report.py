"""The report of a bolted joint: its loops and its picture."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from jointfmu_tools.joints.bolted_joint.field import PlaneLayout
from jointfmu_tools.joints.bolted_joint.picture import plan
from jointfmu_tools.joints.bolted_joint.report import pictured
from jointfmu_tools.report.course import Course

from jointfmu.joints import MODELS
from jointfmu.mechanics.footprint.shape import NodalField, as_lists
from jointfmu.parameters import default

SVG = "{http://www.w3.org/2000/svg}"
YELLOW = "#fde725"
"""The end of the colours."""


@pytest.mark.parametrize("mu", [0.15, 0.0015])
def test_loops_show_partial_slip_whatever_the_friction(mu: float) -> None:
    """The smallest keeps part of its stiffness, the largest stays below the friction and loses."""
    file = default("bolted_joint").with_values({"mu": mu, "memory": True}, "user", "friction")
    model = MODELS["BoltedJoint"]
    course = Course(model, file)
    small, *_, large = course.loops().rows()
    point = {**course.about, "s_rel_x": 0.0}
    stiff = model.evaluate(course.spring, point)["K_xx"]
    assert small["secant_stiffness"] > 0.25 * stiff
    assert large["force"] <= mu * course.about["preload"] * file.flat["n_bolts"] * (1.0 + 1e-9)
    if mu < 0.1:
        assert large["motion"] < 0.5 * model.loop.amplitude
        # slides freely over more than a third of the way back
        assert large["loss_factor"] > 0.7


def test_the_picture_shows_pressure_and_bolts_where_they_are() -> None:
    """Cells make up the frame, the brightest lies at a bolt, numbers run as the bolts do."""
    joint = default("bolted_joint").values
    shape = joint.pattern.shape()
    drawn = ElementTree.fromstring(plan(joint, 9e3, 0.0))
    cells = [rect for rect in drawn.iter(f"{SVG}rect") if rect.get("fill") not in ("#fff", "none", None)]
    area = sum(float(rect.get("width")) * float(rect.get("height")) for rect in cells[: len(shape.share)])
    outer = next(rect for rect in drawn.iter(f"{SVG}rect") if rect.get("fill") == "none")
    scale = float(outer.get("width")) / (joint.pattern.column_spacing + joint.pattern.flange_width)
    assert area / (1.02 * scale) ** 2 == pytest.approx(joint.A_0, rel=0.03)  # drawn to tenths of 5 px
    (x, y), *_ = [
        np.array([float(rect.get("x")), float(rect.get("y"))]) for rect in cells if rect.get("fill") == YELLOW
    ]
    holes = {(float(c.get("cx")), float(c.get("cy"))) for c in drawn.iter(f"{SVG}circle")}
    assert len(holes) == len(joint.pattern.bolts)
    assert min(np.hypot(x - a, y - b) for a, b in holes) < scale * joint.pattern.hole_diameter
    told = [text.text for text in drawn.iter(f"{SVG}text")]
    assert [text for text in told if text and text.isdigit()][:8] == [str(i + 1) for i in range(8)]


def test_the_picture_of_points_without_an_outline() -> None:
    """One disc a point, of its area; no bolts, and the page says so."""
    file = default("bolted_joint")
    shape = file.values.pattern.shape()
    half = np.flatnonzero(shape.position[:, 1] > 0.0)
    some = shape.part(half)
    share = some.share / some.share.sum()
    moved = replace(some, share=share, position=some.position - share @ some.position)
    moved = replace(moved, equal=some.equal / (share @ some.equal), tilt=some.tilt - share @ some.tilt)
    joint = replace(file.values, pattern=NodalField(**as_lists(moved)))
    drawn = ElementTree.fromstring(plan(joint, 9e3, 0.0))
    discs = [circle for circle in drawn.iter(f"{SVG}circle") if circle.get("fill-opacity")]
    assert len(discs) == len(share)
    radius = np.array([float(disc.get("r")) for disc in discs])
    places = np.array([[float(disc.get("cx")), -float(disc.get("cy"))] for disc in discs])
    scale = np.ptp(places, axis=0) / np.ptp(moved.position, axis=0)
    np.testing.assert_allclose(scale[0], scale[1], rtol=1e-2)
    assert np.pi * np.sum(radius**2) / scale[0] ** 2 == pytest.approx(joint.A_0, rel=0.05)
    assert len(PlaneLayout.of(joint).bolts) == 0
    figure = pictured(Course(MODELS["BoltedJoint"], replace(file, values=joint)))
    assert "no places of the bolts" in figure.text
    assert len(figure.pictures) == 1
