"""The report's loops of a bolted joint."""

import pytest
from jointfmu_tools.report.course import Course

from jointfmu.joints import MODELS
from jointfmu.parameters import default


@pytest.mark.parametrize("mu", [0.15, 0.015, 0.0015])
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
