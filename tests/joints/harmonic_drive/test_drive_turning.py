"""The laboratory turns the drive under load as the bench of the report does, another program."""

import math
from collections.abc import Iterator

import pytest
from browser import PROGRAM, Browser, browser
from conftest import made_once
from jointfmu_tools.joints.harmonic_drive.efficiency import spring_bench
from jointfmu_tools.joints.harmonic_drive.laboratory import LABORATORY
from jointfmu_tools.laboratory.assemble import write_laboratory

from jointfmu.joints import MODELS
from jointfmu.parameters import default

pytestmark = [pytest.mark.slow, pytest.mark.skipif(PROGRAM is None, reason="no Chromium is installed")]

NAME = "HarmonicDriveSpring"
SPEED = 150.0
"""Of the wave generator [rad/s]."""


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = made_once(tmp_path_factory, "page", lambda out: write_laboratory(out / "laboratory.html"))
    with browser() as one:
        one.open(folder / "laboratory.html")
        yield one


SCRIPT = """(async () => {
  const lab = await laboratory;
  await lab.choose("HarmonicDriveSpring", 0);
  for (const [name, value] of Object.entries(lab.about.example.values)) lab.values.set(name, value);
  for (const [name, value] of Object.entries(GIVEN)) lab.values.set(name, value);
  lab.turn.speed_now = SPEED;
  lab.draw();
  const [gain] = lab.turn.gain.series, [torque] = lab.turn.over.series, [error] = lab.turn.wave.series;
  return { loads: gain.x, efficiency: gain.y, torque: torque.y, error: error.y };
})()"""


@pytest.mark.parametrize("ratio", [100.0, -80.0])
def test_efficiency_is_that_of_the_bench(shown: Browser, ratio: float) -> None:
    given = {"ratio": ratio, "hysteresis_loss": 0.0, "error_2": 0.0, "temperature_factor": 1.3}
    found = shown.run(SCRIPT.replace("GIVEN", str(given)).replace("SPEED", str(SPEED)))
    example = LABORATORY[NAME].example
    assert example
    file = default("harmonic_drive").with_values({**example.values, **given}, "user", "a test")
    bench = spring_bench(MODELS[NAME], file)
    assert len(found["loads"]) > 10
    for load, value in zip(found["loads"], found["efficiency"], strict=True):
        # friction has built up to 1 - exp(-50) in the page, to 1 - exp(-20) on the bench
        assert value == pytest.approx(100.0 * bench.efficiency(SPEED, load), rel=1e-6), load


def test_the_error_comes_twice_a_turn_and_takes_no_work(shown: Browser) -> None:
    amplitude = 1.5e-4
    losses = ("friction_coulomb", "friction_viscous", "load_loss", "load_loss_back", "hysteresis_loss")
    without = dict.fromkeys(losses, 0.0)
    given = without | {"error_2": amplitude}
    found = shown.run(SCRIPT.replace("GIVEN", str(given)).replace("SPEED", str(SPEED)))
    arcmin = math.degrees(1.0) * 60.0
    assert max(found["error"]) == pytest.approx(amplitude * arcmin, rel=2e-3)  # the nearest of 2 deg
    signs = [a * b < 0.0 for a, b in zip(found["error"], found["error"][1:], strict=False)]
    assert sum(signs) == 4
    assert found["efficiency"] == pytest.approx([100.0] * len(found["efficiency"]), rel=1e-6)
    assert max(found["torque"]) - min(found["torque"]) > 0.0
