"""Friction, kinematic error and heat port of the drive in the Modelica library, run by rumoca."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jointfmu_fmu_src.partners.laws import GRAVITY
from jointfmu_tools.exchange.modelica import library
from jointfmu_tools.exchange.modelica.records import make_identifier
from jointfmu_tools.systems.master import Slave
from numpy.typing import NDArray
from read_modelica import Read, read, solution
from test_modelica import COMMITTED, EXACT, STAND_IN, move, simulate, top

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.friction import (
    FRICTION_SLIDER_COUNT,
    REFERENCE_TEMPERATURE,
    SLIDER_LIMIT_SHARES,
    friction_limits,
    viscous_torque,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default
from jointfmu.quantity import replace_values

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]

DRY = {
    "friction_coulomb": 0.004,
    "friction_stribeck": 0.003,
    "stribeck_speed": 2.0,
    "load_loss": 0.15,
    "load_loss_back": 0.1,
}
LAYER = 1e-3
"""Width of the layer in which the sliders of the component change from stick to slip, over their friction."""
PRESLIDING = 0.01
"""Presliding angle [rad], the default."""
INERTIA = "Modelica.Mechanics.Rotational.Components.Inertia"
AT_REST = "phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start={w}, nominal=0.1)"


@pytest.fixture(scope="module")
def rumoca() -> Any:
    import rumoca

    return rumoca


def spring(**changes: float) -> HarmonicDriveSpring:
    return HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **changes))


def parameters(law: HarmonicDriveSpring, names: Mapping[str, float]) -> dict[str, float]:
    """Parameters of the Modelica component for parameters of the package's drive."""
    given = {name: getattr(law.joint, name) for name in names if not name.startswith("hysteresis")}
    found = law.hysteresis
    sums = {"friction": float(np.sum(found.friction_limit)), "stiffness": float(np.sum(found.stiffness))}
    return given | {f"hysteresis_{name}": value for name, value in sums.items()}


def component(law: HarmonicDriveSpring, names: Mapping[str, float]) -> str:
    """Declaration of the component with parameters of the package's drive."""
    values = ", ".join(f"{name}={value!r}" for name, value in parameters(law, names).items())
    return f"JointStiffness.Components.HarmonicDriveSpring drive({values});"


def once(found: Any, *names: str) -> tuple[Array, ...]:
    """Times and variables without the second row of each event."""
    times, first = np.unique(found.time, return_index=True)
    return times, *(found[name][first] for name in names)


def follow(law: HarmonicDriveSpring, motion: Callable[[float], tuple[float, ...]], times: Array) -> Array:
    """tau1, tau2, tau_friction and E_loss (4, n) of the package along a motion, in small steps."""
    memory, rows = law.initial_history(), []
    for time in times:
        out, memory = law.advance_motion(motion(time), memory)
        rows.append([float(out[name]) for name in ("tau1", "tau2", "tau_friction", "E_loss")])
    return np.array(rows).T


# ---- the text ----


def test_a_record_has_the_packages_defaults():
    base = (COMMITTED / library.LIBRARY_NAME / "Data/HarmonicDrive.mo").read_text(encoding="utf-8")
    own = {f.name: f.default for f in fields(DriveParameters) if f.default is not MISSING}
    found = {
        name: float(value)
        for name, value in re.findall(r"parameter \S+ (\w+)(?:\([^)]*\))?=(\S+) ", base)
        if name in own
    }
    assert found == {name: own[name] for name in found}
    decided = {"hysteresis_loss", "hysteresis_stiffness", "lost_motion"}
    assert set(own) - set(found) == decided | {"inertia1", "inertia2"}  # of the FMU's stable steps


# ---- along a path ----

_WAY = """
model Way
  parameter Real ratio;
  Modelica.Mechanics.Rotational.Interfaces.Flange_b one, two;
equation
  one.phi = 0.3*sin(3*time);
  two.phi = 0.3/ratio*sin(3*time) + 1.2e-3*sin(7.3*time);
end Way;
"""


def way(ratio: float, t: float) -> tuple[float, ...]:
    one, rate = 0.3 * math.sin(3.0 * t), 0.9 * math.cos(3.0 * t)
    wound = 1.2e-3 * math.sin(7.3 * t)
    return one, rate, one / ratio + wound, rate / ratio + 7.3 * 1.2e-3 * math.cos(7.3 * t)


def test_friction_along_a_path_is_the_packages(rumoca: Any):
    """The torque agrees with the package with all other effects; friction alone agrees better, see the test
    of the heat port."""
    more = {"ratio": -80.0, "hysteresis_loss": 2e-4, "error_2": 2e-4, "error_4": 5e-5, "error_4_phase": 1.0}
    more |= {"friction_1": 0.002, "friction_1_phase": 0.5, "friction_2": 0.0015, "friction_2_phase": -1.0}
    left = 1e-4  # of the layer, for the 44 sliders of the hysteresis
    values = {**DRY, "stribeck_speed": 0.5, "friction_viscous": 1e-3, "temperature_factor": 1.3, **more}
    law = spring(**values)
    text = top(
        f"{component(law, values)}\n  Way way(ratio={law.joint.ratio!r});\n  Real loss(start=0, fixed=true);",
        "connect(way.one, drive.flange_a);\n  connect(way.two, drive.flange_b);\n"
        "  der(loss) = drive.lossPower - drive.d*drive.w_rel^2 - 1.3*1e-3*drive.w1^2;",
        _WAY,
    )
    names = "drive.flange_a.tau", "drive.flange_b.tau", "drive.tau_friction", "loss"
    times, *found = once(simulate(rumoca, text, 2.2, 2e-3, rtol=1e-8), *names)
    fine = np.linspace(0.0, 2.2, 5501)
    exact = follow(law, lambda t: way(law.joint.ratio, t), fine)
    for sign, mine, its in zip((-1.0, -1.0, 1.0), found[:3], exact[:3], strict=True):
        expected = np.interp(times, fine, its)
        assert np.abs(sign * mine - expected).max() < left * np.abs(expected).max()
    assert np.all(np.diff(found[3]) > -1e-12)
    assert found[3][-1] == pytest.approx(exact[3, -1], rel=1e-4)


@pytest.mark.parametrize("speed", [-3.0, 0.0, 0.05])
def test_a_drive_begins_where_it_is(rumoca: Any, speed: float):
    """At rest far from zero, the drive begins without friction; in rotation, as if it had rotated
    for 0.1 s."""
    law = spring(**DRY)
    text = top(
        f"{component(law, DRY)}\n  Move motor(at=500, rate={speed!r});"
        f"\n  Move link(at=5.0005, rate={speed / 100.0!r});",
        "connect(motor.flange, drive.flange_a);\n  connect(drive.flange_b, link.flange);",
        move("Rotational", "phi"),
    )
    found = simulate(rumoca, text, 1e-3, 1e-4)
    exact = law.evaluate_motion(500.0, speed, 5.0005, speed / 100.0)["tau_friction"]
    assert found["drive.tau_friction"][0] == pytest.approx(exact, rel=EXACT, abs=1e-12)


def test_the_text_read_by_another_parser_holds_along_the_solution(rumoca: Any):
    """All equations as pymoca reads them, at the solution of rumoca; states by the trapezoidal rule over the
    corners."""
    values = {**DRY, "ratio": -80.0, "friction_viscous": 1e-3, "error_2": 2e-4, "hysteresis_loss": 2e-4}
    law = spring(**values)
    body = f"{component(law, values)}\n  Way way(ratio=-80);"
    wires = "connect(way.one, drive.flange_a);\n  connect(way.two, drive.flange_b);"
    found = simulate(rumoca, top(body, wires, _WAY), 0.6, 1e-4, rtol=1e-8)
    times, first = np.unique(found.time, return_index=True)
    root, record = read(STAND_IN, COMMITTED), make_identifier(load_default("harmonic_drive").name)
    seen = solution(found, "drive", first)

    def errors(more: float) -> dict[str, float]:
        given = parameters(law, values) | {"friction_coulomb": more * values["friction_coulomb"]}
        return Read(root, "HarmonicDriveSpring", record, times, seen, given).errors()

    states = {"der(q_w)", "der(phi_rel)", "der(flange_a.phi)"}
    same, other = errors(1.0), errors(1.001)
    assert states < set(same)
    assert max(error for name, error in same.items() if name not in states) < 1e-12  # round-off
    assert max(same[name] for name in states) < 0.01
    assert other["unloaded"] > 1e-4  # it would be seen


# ---- in motion ----


def swung(
    fmu: Path, given: dict[str, float], drive: Callable[[float], float], step: float, stop: float
) -> Array:
    """Rows time, phi1, w1, phi2, tau_friction of a motor and a hanging link on the FMU, by Heun's method."""
    J, weight = np.array([1e-5, 0.05]), GRAVITY * 0.2
    x, w = np.zeros(2), np.zeros(2)
    with Slave(fmu, given, ("phi1", "w1", "phi2", "w2"), ("tau1", "tau2", "tau_friction")) as joint:

        def rates(t: float, x: Array, w: Array) -> tuple[Array, float]:
            joint.set_inputs(x[0], w[0], x[1], w[1])
            tau1, tau2, friction = joint.get_outputs()
            return np.array([drive(t) + tau1, tau2 - weight * math.sin(x[1])]) / J, friction

        a, friction = rates(0.0, x, w)
        rows = [(0.0, x[0], w[0], x[1], friction)]
        for k in range(1, round(stop / step) + 1):
            trial, _ = rates(k * step, x + step * w + 0.5 * step**2 * a, w + step * a)
            faster = w + 0.5 * step * (a + trial)
            x, w = x + 0.5 * step * (w + faster), faster
            a, friction = rates(k * step, x, w)
            joint.do_step((k - 1) * step, step)
            rows.append((k * step, x[0], w[0], x[1], friction))
    return np.array(rows).T


def test_a_drive_starts_turns_round_and_stops_as_on_the_fmu(rumoca: Any, native: Path):
    """Motor with a hanging link, driven in one direction, then in the other, then free.

    The reference is Heun's method on the FMU, extrapolated to a step of zero. The remaining difference comes
    from the regularisation layer of the component's sliders and from corners of the force.
    """
    values = {**DRY, "friction_viscous": 1e-5, "error_2": 2e-4, "hysteresis_loss": 2.9e-4}
    law = spring(**values)
    body = "\n  ".join(
        [
            component(law, values),
            "Modelica.Mechanics.Rotational.Sources.Torque push;",
            f"{INERTIA} motor(J=1e-5, {AT_REST.format(w=0)});",
            f"{INERTIA} link(J=0.05, {AT_REST.format(w=0)});",
            "JointStiffness.Components.LinkWeight weight(m=1, l=0.2);",
        ]
    )
    wires = "\n  ".join(
        f"connect({a}, {b});"
        for a, b in (
            ("push.flange", "motor.flange_a"),
            ("motor.flange_b", "drive.flange_a"),
            ("drive.flange_b", "link.flange_a"),
            ("link.flange_b", "weight.flange"),
        )
    )
    wires += "\n  push.tau = if time < 0.24 then 0.03*sin(26.179938779914945*time)^3 else 0;"
    stop, step = 0.6, 2e-5

    def push(t: float) -> float:
        return 0.03 * math.sin(26.179938779914945 * t) ** 3 if t < 0.24 else 0.0

    names = "motor.phi", "motor.w", "link.phi", "drive.tau_friction"
    times, *found = once(simulate(rumoca, top(body, wires), stop, 2e-3, rtol=1e-7), *names)
    runs = []
    for h in (2.0 * step, step):
        rows = swung(native / "fmi2" / "HarmonicDriveSpring.fmu", values, push, h, stop)
        runs.append(np.array([np.interp(times, rows[0], row) for row in rows[1:]]))
    exact = (4.0 * runs[1] - runs[0]) / 3.0
    speed = exact[1]
    assert speed.max() > 50.0
    assert speed.min() < -20.0
    for mine, its, allowed in zip(found, exact, (2e-5, 5e-5, 2e-5, LAYER), strict=True):
        assert np.abs(mine - its).max() < allowed * np.abs(its).max()
    late = times > stop - 0.05  # it rings within the presliding, and turns no more
    assert np.ptp(found[0][late]) < 0.5 * PRESLIDING


def test_a_coasting_motor_goes_as_far_as_its_energy_lasts(rumoca: Any):
    """J w^2/2 = M phi with the link attached; afterwards the sliders spring back and hold."""
    J, speed, friction = 3e-5, 30.0, 0.03
    law = spring(friction_coulomb=friction)
    body = "\n  ".join(
        [
            component(law, {"friction_coulomb": friction, "friction_stribeck": 0.0}),
            f"{INERTIA} motor(J={J!r}, {AT_REST.format(w=speed)});",
            f"{INERTIA} link(J=1e-6, {AT_REST.format(w=speed / 100.0)});",
            "Real loss(start=0, fixed=true);",
        ]
    )
    wires = "connect(motor.flange_b, drive.flange_a);\n  connect(drive.flange_b, link.flange_a);"
    found = simulate(rumoca, top(body, f"{wires}\n  der(loss) = drive.lossPower;"), 0.3, 1e-3, rtol=1e-8)
    ends = 0.5 * J * speed**2 / friction
    times, phi, w, loss = once(found, "motor.phi", "motor.w", "loss")
    before = times < 0.9 * J * speed / friction
    assert w[before] == pytest.approx(speed - friction / J * times[before], abs=1e-4 * speed)
    assert phi[-1] == pytest.approx(ends, abs=3.0 * PRESLIDING)
    # the sliders of a drive that turns have stored energy, and keep some of it when it stands
    stored = np.sum((friction * SLIDER_LIMIT_SHARES) ** 2 / (2.0 * law.friction.stiffness))
    assert 0.0 < loss[-1] - 0.5 * J * speed**2 < stored
    assert np.abs(w[times > 0.25]).max() < 0.05 * speed


def test_a_drive_holds_a_shaken_load_without_drift(rumoca: Any):
    """Half of the friction limit at the output, with an oscillation of a fifth of it, over 100 periods, motor
    off."""
    law = spring(friction_coulomb=0.03)
    most = 100.0 * float(friction_limits(law.joint, 0.0, 0.0)[0])
    body = "\n  ".join(
        [
            component(law, {"friction_coulomb": 0.03}),
            "Modelica.Mechanics.Rotational.Sources.Torque load;",
            f"{INERTIA} motor(J=1e-5, {AT_REST.format(w=0)});",
            f"{INERTIA} link(J=0.05, {AT_REST.format(w=0)});",
        ]
    )
    wires = "\n  ".join(
        [
            "connect(motor.flange_b, drive.flange_a);",
            "connect(drive.flange_b, link.flange_a);",
            "connect(link.flange_b, load.flange);",
            f"load.tau = {most!r}*(0.5*JointStiffness.Functions.smoothStep(time/0.5)"
            " + 0.2*JointStiffness.Functions.smoothStep((time - 0.5)/0.5)*sin(62.83185307179586*time));",
        ]
    )
    found = simulate(rumoca, top(body, wires), 10.0, 0.1, rtol=1e-7)
    times, phi = once(found, "motor.phi")
    late = phi[times > 6.0]  # always at the same place of a period
    assert phi[-1] > 0.5 * PRESLIDING
    assert np.ptp(late) < 1e-5 * PRESLIDING  # what the solver's tolerance leaves


@pytest.mark.parametrize("share", [0.7, 1.0, 1.3])
def test_the_kinematic_error_makes_a_ripple_that_resonates_at_half_the_natural_frequency(
    rumoca: Any, share: float
):
    """Link on a drive at constant speed; error_2 has two periods per turn. Linear theory for small
    amplitudes."""
    J, d, error = 0.05, 2.0, 1e-6
    K = float(spring().curve.stiffness[0])
    natural = math.sqrt(K / J)
    w1 = 0.5 * share * natural
    body = "\n  ".join(
        [
            component(spring(d=d), {"d": d}).replace("drive(", f"drive(error_2={error!r}, "),
            f"Move motor(rate={w1!r});",
            f"{INERTIA} link(J={J!r}, {AT_REST.format(w=w1 / 100.0)});",
        ]
    )
    wires = "connect(motor.flange, drive.flange_a);\n  connect(drive.flange_b, link.flange_a);"
    found = simulate(rumoca, top(body, wires, move("Rotational", "phi")), 1.0, 5e-4, rtol=1e-9)
    times, wound = once(found, "drive.phi_rel")
    late = times > 1.0 - 10.0 * 2.0 * math.pi / (
        2.0 * w1
    )  # ten periods: the start has died out by exp(-d/J t/2)
    base = np.stack([f(2.0 * w1 * times[late]) for f in (np.cos, np.sin, np.ones_like)], axis=1)
    cos, sin, _ = np.linalg.lstsq(base, wound[late], rcond=None)[0]
    wave = 2.0 * w1
    expected = error * J * wave**2 / abs(K - J * wave**2 + 1j * d * wave)
    assert math.hypot(cos, sin) == pytest.approx(expected, rel=1e-3)


# ---- the laws of the midline ----


@pytest.mark.parametrize(
    ("law", "more"),
    [("catalogue", {"lost_motion": 2e-4}), ("table", {}), ("roughness", {"lost_motion": 2e-4})],
)
def test_a_drive_of_any_law_gives_the_torque_of_the_package(
    rumoca: Any, tmp_path: Path, law: str, more: dict[str, float]
):
    file = load_default("harmonic_drive", law)
    file = replace(file, values=replace_values(file.values, more)) if more else file
    library.write_library(tmp_path, file)
    drive = HarmonicDriveSpring.tabulate(file.values)
    reach = 1.2 * drive.curve.end_point[0]
    record = make_identifier(file.name)
    text = top(
        f"JointStiffness.Components.HarmonicDriveSpring drive(data=JointStiffness.Data.{record}(), d=0);\n"
        f"  Move motor;\n  Move load(at={-reach!r}, rate={2.0 * reach!r});",
        "connect(motor.flange, drive.flange_a);\n  connect(drive.flange_b, load.flange);",
        move("Rotational", "phi"),
    )
    found = simulate(rumoca, text, 1.0, 4e-3, tmp_path)
    load, stiffness = drive.curve.derivatives(np.abs(reach * (2.0 * found.time - 1.0)), 1)
    assert np.abs(np.abs(found["drive.tau"]) - load).max() <= EXACT * load.max()
    assert np.all(np.abs(found["drive.K_WTS"] - stiffness) <= EXACT * stiffness)


def test_the_component_has_the_packages_sliders():
    text = (COMMITTED / library.LIBRARY_NAME / "Components/HarmonicDriveSpring.mo").read_text(
        encoding="utf-8"
    )
    rows = re.search(r"brakes\[:, 2\]=\[(.*?)\]", text, re.DOTALL)
    assert rows
    shares = np.array([[float(x) for x in row.split(",")] for row in rows[1].split(";")])
    assert shares.shape == (FRICTION_SLIDER_COUNT, 2)
    # as Dahl's law at the places between which each slider gives way
    assert np.cumsum(shares[::-1, 0])[::-1] == pytest.approx(
        (np.arange(FRICTION_SLIDER_COUNT, 0, -1) / FRICTION_SLIDER_COUNT) ** 2, rel=1e-9
    )
    assert shares.sum(axis=0) == pytest.approx([1.0, 1.0], rel=1e-9)


# The heat port

WARM: Mapping[str, float] = {
    **DRY,
    "friction_viscous": 1e-3,
    "viscous_temperature_coefficient": 0.03,
    "dry_temperature_coefficient": 0.01,
}
CAPACITY = 2.0
"""Heat capacity [J/K] around the lubricant, so small that the temperature rises during the motion."""
_BODY = f"""
model Body
  Modelica.Thermal.HeatTransfer.Interfaces.HeatPort_a port;
  Real T(start={REFERENCE_TEMPERATURE!r}, fixed=true, nominal=300);
equation
  port.T = T;
  {CAPACITY!r}*der(T) = port.Q_flow;
end Body;
"""


def test_at_a_temperature_the_component_is_the_package(rumoca):
    law = spring(**WARM)
    text = top(
        component(law, WARM).replace("drive(", "drive(T=263.15, ") + "\n  Way way(ratio=100);",
        "connect(way.one, drive.flange_a);\n  connect(way.two, drive.flange_b);",
        _WAY + _BODY,
    )
    times, friction = once(simulate(rumoca, text, 1.0, 2e-3, rtol=1e-8), "drive.tau_friction")
    fine, memory, exact = np.linspace(0.0, 1.0, 2001), law.initial_history(), []
    for time in fine:
        out, memory = law.advance_motion(way(100.0, time), memory, 263.15)
        exact.append(float(out["tau_friction"]))
    expected = np.interp(times, fine, exact)
    # of the solver, and of the package's steps, as without a temperature
    assert np.abs(friction - expected).max() < 1e-5 * np.abs(expected).max()
    cold = follow(law, lambda t: way(100.0, t), fine[::4])[2]
    assert np.abs(np.interp(times, fine[::4], cold) - expected).max() > 0.2 * np.abs(expected).max()


def test_all_losses_go_out_at_the_heat_port(rumoca):
    """A heat capacity at the port receives the losses of hysteresis, dry and viscous friction, and damper.

    The heat is the input work minus the energy stored in springs and sliders.
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
        _WAY + _BODY,
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
    assert CAPACITY * (warmth - REFERENCE_TEMPERATURE) == pytest.approx(lost, abs=1e-6 * lost[-1])
    memory, wet = law.initial_history(), 0.0
    fine = np.linspace(0.0, stop, 2751)
    for time, kelvin in zip(fine, np.interp(fine, times, warmth), strict=True):
        motion = way(ratio, time)
        out, memory = law.advance_motion(motion, memory, kelvin)
        rise = motion[3] - motion[1] / ratio
        damped = law.joint.d * rise**2 + float(viscous_torque(law.joint, motion[1], kelvin)) * motion[1]
        wet += damped * (fine[1] - fine[0])
    assert not math.isclose(warmth[-1], REFERENCE_TEMPERATURE)
    # the layer of the component's sliders, as above
    assert lost[-1] == pytest.approx(wet + float(out["E_loss"]), rel=1e-3)
