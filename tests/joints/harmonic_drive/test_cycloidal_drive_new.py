"""A cycloidal or RV reducer from the numbers that its maker prints."""

import math

import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.harmonic_drive.efficiency import compute_hysteresis_loss, compute_lost_motion

import jointfmu
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_parameter_file

NUMBERS = {"ratio": 121, "rated_torque": 412, "rigidity": 108, "lost_motion": 1, "hysteresis": 0.8}
ARCMIN = math.radians(1.0 / 60.0)


def words(**numbers: object) -> list[str]:
    """Options of the command for NUMBERS, with some replaced."""
    options = (NUMBERS | numbers).items()
    return [word for name, n in options for word in (f"--{name.replace('_', '-')}", *str(n).split())]


def test_the_computed_loop_has_the_printed_numbers(tmp_path):
    """Lost motion and backlash of the loop up to rated torque; rigidity of its loading branch."""
    path = tmp_path / "rv.toml"
    assert cli.main(["new", "cycloidal-drive", *words(), "--out", str(path)]) == 0
    file = load_parameter_file(path)
    spring = HarmonicDriveSpring.tabulate(file.values)
    assert (file.law, file.values.ratio, file.values.max_torque) == ("catalogue", 121.0, 1648.0)
    assert compute_lost_motion(spring, 0.03) == pytest.approx(ARCMIN, rel=1e-6)
    assert compute_hysteresis_loss(spring) == pytest.approx(0.8 * ARCMIN, rel=1e-6)
    history, angle = spring.initial_history(), {}
    for torque in (412.0, -412.0, 206.0, 412.0):
        outputs, history = spring.advance_torque(torque, history)
        angle[torque] = float(outputs["phi_rel"])
    rigidity = 206.0 / (angle[412.0] - angle[206.0])
    assert rigidity == pytest.approx(
        108.0 / ARCMIN, rel=2e-3
    )  # 1.1e-3 here: friction is not yet all mobilised


def test_two_rigidities_and_friction_in_python():
    drive = jointfmu.cycloidal_drive(
        **(NUMBERS | {"rigidity": [80, 108], "starting_torque": 0.5, "back_driving_torque": 75})
    )
    values = drive.values
    assert (values["K1"], values["K2"]) == pytest.approx((80.0 / ARCMIN, 108.0 / ARCMIN))
    assert (values["T1"], values["friction_coulomb"]) == (206.0, 0.5)
    assert values["load_loss_back"] == pytest.approx(1.0 - 121.0 * 0.5 / 75.0)


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ({"lost_motion": 0.2}, "--lost-motion = '0.2' is outside [0.2"),
        ({"rigidity": "108 80"}, "--rigidity = '80' above 50 % of rated torque is below '108'"),
        ({"rigidity": "80 90 100"}, "--rigidity has 3 numbers"),
        ({"rigidity": "371000"}, "plausible are 0.1 to 10000 N.m/arcmin"),
        ({"peak_torque": 100}, "--peak-torque = 100 N.m is outside [412, inf)"),
        ({"ratio": 0}, "--ratio = 0"),
    ],
)
def test_impossible_numbers_are_refused(capsys, numbers, text):
    assert text in refused_line(capsys, "new", "cycloidal-drive", *words(**numbers))
