"""The drive of the Modelica library with its heat port: temperature in, all losses out."""

import math
from collections.abc import Mapping

import numpy as np
import pytest
from test_drive_modelica import DRY, component, follow, once, rumoca, simulate, spring, top, way

from jointfmu.joints.harmonic_drive.friction import REFERENCE, viscous

__all__ = ["rumoca"]
pytestmark = pytest.mark.slow

WARM: Mapping[str, float] = {
    **DRY,
    "friction_viscous": 1e-3,
    "viscous_temperature_coefficient": 0.03,
    "dry_temperature_coefficient": 0.01,
}
CAPACITY = 2.0
"""[J/K] of the lubricant's surroundings, so little that they warm up on the way."""
_WAY = f"""
model Way
  parameter Real ratio = 100;
  Modelica.Mechanics.Rotational.Interfaces.Flange_b one, two;
equation
  one.phi = 0.3*sin(3*time);
  two.phi = 0.3/ratio*sin(3*time) + 1.2e-3*sin(7.3*time);
end Way;
model Body
  Modelica.Thermal.HeatTransfer.Interfaces.HeatPort_a port;
  Real T(start={REFERENCE!r}, fixed=true, nominal=300);
equation
  port.T = T;
  {CAPACITY!r}*der(T) = port.Q_flow;
end Body;
"""


def test_at_a_temperature_the_component_is_the_package(rumoca):
    law = spring(**WARM)
    text = top(
        component(law, WARM).replace("drive(", "drive(T=263.15, ") + "\n  Way way;",
        "connect(way.one, drive.flange_a);\n  connect(way.two, drive.flange_b);",
        _WAY,
    )
    times, friction = once(simulate(rumoca, text, 1.0, 2e-3, rtol=1e-8), "drive.tau_friction")
    fine, memory, exact = np.linspace(0.0, 1.0, 10001), law.rest(), []
    for time in fine:
        out, memory = law.driven(way(100.0, time), memory, 263.15)
        exact.append(float(out["tau_friction"]))
    expected = np.interp(times, fine, exact)
    # of the solver, and of the package's steps, as without a temperature
    assert np.abs(friction - expected).max() < 1e-5 * np.abs(expected).max()
    cold = follow(law, lambda t: way(100.0, t), fine[::10])[2]
    assert np.abs(np.interp(times, fine[::10], cold) - expected).max() > 0.2 * np.abs(expected).max()


def test_all_losses_go_out_at_the_heat_port(rumoca):
    """A body that takes them gets warmer by all that hysteresis, dry and viscous friction and damper lose.

    It is what the work put in has more than springs and sliders store.
    """
    ratio = -80.0
    values, stop = {**WARM, "hysteresis_loss": 2e-4, "load_loss_back": 0.3, "ratio": ratio}, 2.2
    law = spring(**values)
    text = top(
        component(law, values).replace("drive(", "drive(useHeatPort=true, ")
        + f"\n  Way way(ratio={ratio!r});\n  Body body;"
        "\n  Real loss(start=0, fixed=true), work(start=0, fixed=true);",
        "connect(way.one, drive.flange_a);\n  connect(way.two, drive.flange_b);\n"
        "  connect(drive.heatPort, body.port);\n  der(loss) = drive.lossPower;\n"
        "  der(work) = drive.flange_a.tau*der(way.one.phi) + drive.flange_b.tau*der(way.two.phi);",
        _WAY,
    )
    found = simulate(rumoca, text, stop, 2e-3, rtol=1e-8)
    times, warmth, lost, work, wound = once(found, "body.T", "loss", "work", "drive.phi_rel")
    stored = law.curve.energy(np.abs(wound))
    for name, sliders in (("held_h", law.hysteresis), ("q_w", law.friction)):
        for i, K in enumerate(sliders.stiffness, 1):
            (q,) = once(found, f"drive.{name}[{i}]")[1:]
            stored = stored + q**2 / (2.0 * K)
    assert np.all(np.diff(lost) >= 0.0)
    assert work == pytest.approx(stored - stored[0] + lost, abs=1e-5 * np.sum(np.abs(np.diff(work))))
    assert CAPACITY * (warmth - REFERENCE) == pytest.approx(lost, abs=1e-6 * lost[-1])
    memory, wet = law.rest(), 0.0
    fine = np.linspace(0.0, stop, 5501)
    for time, kelvin in zip(fine, np.interp(fine, times, warmth), strict=True):
        motion = way(ratio, time)
        out, memory = law.driven(motion, memory, kelvin)
        rise = motion[3] - motion[1] / ratio
        damped = law.joint.d * rise**2 + float(viscous(law.joint, motion[1], kelvin)) * motion[1]
        wet += damped * (fine[1] - fine[0])
    assert not math.isclose(warmth[-1], REFERENCE)
    # the layer of the component's sliders, as in test_drive_modelica
    assert lost[-1] == pytest.approx(wet + float(out["E_loss"]), rel=1e-3)
