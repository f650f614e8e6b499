"""FMU of the gear mesh: its law on both flanks, in every phase, for any tooth stiffness."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from conftest import Fmu
from natives import VERSIONS, close, jacobian

from jointfmu.joints.gear_mesh.spring import GearMeshSpring, base_pitch
from jointfmu.mechanics.stable_steps import MAX_STABLE_STEP
from jointfmu.parameters import load_default
from jointfmu.quantity import replace_values

Host = Callable[..., Fmu]
Inputs = dict[str, float]

MESH = load_default("gear_mesh").values
SETS: dict[str, dict[str, Any]] = {
    "default": {},
    "soft teeth": {"K_tooth": 1e4, "backlash": 0.0, "contact_ratio": 2.3},
    "stiff teeth": {"K_tooth": 1e11, "engagement": 1.0, "contact_ratio": 1.1},
    "helical": {"overlap_ratio": 0.4, "contact_ratio": 1.55},
    "whole ratio": {"contact_ratio": 2.0, "teeth1": 17.0, "d": 0.0},
    "two bodies": {"surface1.D": 1.6, "rigid_flat": False, "r_b2": 0.05, "A_0": 2e-5, "e": 0.5},
}
"""Parameter sets whose tables have different nodes; soft teeth need a denser table."""


@cache
def spring(name: str) -> GearMeshSpring:
    return GearMeshSpring.tabulate(replace_values(MESH, SETS[name]))


def angles(of: GearMeshSpring, s: float, phase: float) -> Inputs:
    """Angles of both wheels at a deflection (0: middle of the backlash) and a phase of the mesh cycle, at
    rest."""
    mesh = of.joint
    along = s + 0.5 * mesh.backlash * np.sign(s)
    way = phase * float(base_pitch(mesh))
    return {
        "phi1": float((0.5 * along + way) / mesh.r_b1),
        "w1": 0.0,
        "phi2": float((0.5 * along - way) / mesh.r_b2),
        "w2": 0.0,
    }


def states(of: GearMeshSpring, count: int) -> list[Inputs]:
    """Motions from nanometres to beyond the table on both flanks, and a tenth of them in the backlash."""
    rng, found = np.random.default_rng(1), []
    for _ in range(count):
        size = 10.0 ** rng.uniform(-9.0, np.log10(1.2 * of.curve.end_point[0]))
        s = 0.0 if rng.random() < 0.1 else size * float(rng.choice([-1.0, 1.0]))
        moving = {"w1": float(rng.normal()), "w2": float(rng.normal())}
        found.append(angles(of, s, float(rng.uniform(-3.0, 3.0))) | moving)
    return found


def outputs(of: GearMeshSpring, v: Inputs) -> dict[str, float]:
    found = of.evaluate(v["phi1"], v["w1"], v["phi2"], v["w2"])
    return {name: float(value) for name, value in found.items()}


@pytest.mark.parametrize("name", SETS)
def test_native_tables_are_those_of_the_package(host: Host, version: str, name: str) -> None:
    """Tolerance 1e-10. Measured: 2e-12 where damping and spring force cancel, 1e-12 elsewhere."""
    of, instance = spring(name), host("GearMesh", version).start(SETS[name])
    for state in states(of, 150):
        assert instance.at(state) == close(outputs(of, state), 1e-10)


def test_the_python_flavour_is_the_package(fmu: Host) -> None:
    of, instance = spring("default"), fmu("GearMesh").start()
    for state in states(of, 30):
        assert instance.at(state) == outputs(of, state)


@pytest.mark.parametrize("name", ["default", "stiff teeth"])
def test_torques_are_the_gradient_of_the_energy(host: Host, version: str, name: str) -> None:
    """Derivatives of the FMU: dE = -tau dphi, mixed derivatives are equal, to round-off of their terms."""
    of, instance = spring(name), host("GearMesh", version).start(SETS[name])
    for state in states(of, 60):
        values = instance.at(state | {"w1": 0.0, "w2": 0.0})
        J = jacobian(instance)
        assert (J["E", "phi1"], J["E", "phi2"]) == close((-values["tau1"], -values["tau2"]), 1e-11)
        stiffness = of.joint.r_b1 * of.joint.r_b2 * max(values["K"], 1.0)
        assert abs(J["tau1", "phi2"] - J["tau2", "phi1"]) <= 1e-12 * stiffness
        assert (J["E", "w1"], J["K", "w1"], J["pairs", "w1"]) == (0.0, 0.0, 0.0)


def test_derivatives_are_those_of_the_package(host: Host) -> None:
    """Along deflection and phase, against central differences of fourth order. Errors: truncation, round-off,
    jumps of the third derivative at nodes and of the second one at regime ends. Measured: 5e-8 of a
    thousandth of the output, the step size."""
    of, two, three = spring("default"), *(host("GearMesh", v).start() for v in VERSIONS)
    rng, curve = np.random.default_rng(3), of.curve
    kinks = curve.displacement[1:-1][curve.stiffness_slope_end[:-1] != curve.stiffness_slope_start[1:]]
    for _ in range(40):
        s = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-7.0, -4.0))
        if np.any(np.abs(kinks - abs(s)) < 3e-3 * abs(s)):
            continue
        phase = float(rng.uniform(-2.0, 2.0))
        state = angles(of, s, phase) | {"w1": 0.3, "w2": 0.1}
        values = three.at(state)
        two.set_values(state)
        J = jacobian(three)
        assert jacobian(two) == J
        for ds, dphase in ((1e-3 * s, 0.0), (0.0, 1e-4)):
            points = [
                angles(of, s + k * ds, phase + k * dphase) | {"w1": 0.3, "w2": 0.1} for k in (-2, -1, 1, 2)
            ]
            way = {i: points[2][i] - state[i] for i in ("phi1", "phi2")}
            far, low, high, further = (outputs(of, p) for p in points)
            for o, value in values.items():
                expected = (8.0 * (high[o] - low[o]) - (further[o] - far[o])) / 12.0
                found = sum(J[o, i] * way[i] for i in way)
                assert abs(found - expected) <= 1e-6 * 1e-3 * abs(value), (o, state)


def test_nothing_acts_inside_the_backlash(host: Host, version: str) -> None:
    of, instance = spring("default"), host("GearMesh", version).start()
    for phase in (0.0, 0.25, 0.33, 0.5, -0.5, 0.7):
        for along in (0.0, 0.4, -0.49):
            state = angles(of, 0.0, phase) | {"w1": 2.0, "w2": -1.0}
            state["phi1"] += along * MESH.backlash / MESH.r_b1
            values, J = instance.at(state), jacobian(instance)
            assert values["step_at_once"] == MAX_STABLE_STEP  # nothing limits it
            assert {values[o] for o in instance.outputs if o not in ("pairs", "step_at_once")} == {0.0}
            assert 1.0 <= values["pairs"] <= 2.0
            assert {value for (o, _), value in J.items() if o != "pairs"} == {0.0}
    assert not instance.warnings


@pytest.mark.parametrize("phase", [0.5, -0.5, 1.5, 0.0, 1.0])
def test_derivatives_are_continuous_where_the_phase_wraps(host: Host, phase: float) -> None:
    """At half cycles the distance from the middle of the next pair jumps, at whole cycles it changes
    direction."""
    of, instance = spring("stiff teeth"), host("GearMesh").start(SETS["stiff teeth"])
    found = []
    for side in (-1e-9, 0.0, 1e-9):
        values = instance.at(angles(of, 1e-5, phase + side))
        found.append((values, jacobian(instance)))
    (before, J0), (at, J), (after, J1) = found
    assert before == close(at, 1e-6)
    assert after == close(at, 1e-6)
    size = {key: abs(at[key[0]]) / 1e-3 for key in J}
    assert all(abs(J0[k] - J[k]) <= 1e-6 * max(abs(J[k]), size[k]) for k in J)
    assert all(abs(J1[k] - J[k]) <= 1e-6 * max(abs(J[k]), size[k]) for k in J)


def test_turned_round_it_is_odd(host: Host, version: str) -> None:
    of, instance = spring("default"), host("GearMesh", version).start()
    even = {"K", "pairs", "E", "step_at_once", "step_side_by_side"}
    for state in states(of, 40):
        there = instance.at(state)
        back = instance.at({name: -value for name, value in state.items()})
        assert back == {o: value if o in even else 0.0 - value for o, value in there.items()}


def test_a_closed_path_returns_its_energy(host: Host, version: str) -> None:
    """Three mesh cycles with both flanks and separations. Measured: 5e-8 of the exchanged energy by the
    trapezoidal rule, with four times as many steps 7e-10. Without the derivative of the energy with respect
    to the phase the error would exceed 1e-4."""
    instance = host("GearMesh", version).start({"d": 0.0})
    work, forces, through, steps = 0.0, 0.0, 0.0, 8000
    for t in np.arange(steps) * (2.0 * np.pi / steps):
        phi1, rate1 = 0.3 * np.sin(t), 0.3 * np.cos(t)
        along, rate = 1.5e-4 * np.sin(5.0 * t + 0.4), 7.5e-4 * np.cos(5.0 * t + 0.4)
        phi2, rate2 = (along - MESH.r_b1 * phi1) / MESH.r_b2, (rate - MESH.r_b1 * rate1) / MESH.r_b2
        found = instance.at({"phi1": float(phi1), "phi2": float(phi2)})
        power = found["tau1"] * rate1 + found["tau2"] * rate2
        work, forces, through = work + power, forces - found["f"] * rate, through + abs(power)
    assert abs(work) <= 1e-7 * through
    assert abs(forces) > 1e-4 * through
    assert through * (2.0 * np.pi / steps) > 1.0  # joules


@pytest.mark.parametrize(
    ("parameter", "value", "said"),
    [
        ("contact_ratio", 3.0, "contact_ratio = 3 is outside [1, 3): mean number of tooth pairs in contact"),
        ("backlash", -1.0, "backlash = -1 m is outside [0, inf): backlash along the line of action"),
        ("teeth1", 28.5, "teeth1 = 28.5 is not a whole number, allowed are 1, 2, 3, ..."),
    ],
)
def test_a_parameter_that_is_refused_can_be_set_right(
    host: Host, version: str, parameter: str, value: float, said: str
) -> None:
    instance = host("GearMesh", version).start({"phi1": 1.5e-3})
    before = instance.get()
    right = instance.get(parameter)
    instance.set_values({parameter: value})
    assert said in instance.refused(instance.get)
    assert instance.at(right) == before


def test_teeth_too_soft_for_a_table_are_refused_as_by_the_package(host: Host, version: str) -> None:
    instance = host("GearMesh", version)
    with pytest.raises(RuntimeError) as refusal:
        GearMeshSpring.tabulate(replace_values(MESH, {"K_tooth": 1e2}))
    assert instance.refused(instance.start, {"K_tooth": 1e2}) == str(refusal.value)


def test_beyond_the_table_each_side_warns_once_and_a_state_remembers(host: Host, version: str) -> None:
    of, instance = spring("default"), host("GearMesh", version).start()
    end = of.curve.end_point[0]
    inside = instance.at(angles(of, 0.9 * end, 0.2))
    state = instance.fmu.getFMUState()
    far = instance.at(angles(of, 1.1 * end, 0.2))
    (warning,) = instance.warnings
    assert warning.startswith(
        f"s_rel = {1.1 * end:.6g} m is outside [-{end:.6g}, {end:.6g}] m: outside the tabulated law"
    )
    assert instance.at(angles(of, -1.1 * end, -0.2))["f"] == -far["f"]
    assert len(instance.warnings) == 1
    instance.fmu.setFMUState(state)
    assert instance.get() == inside
    instance.at(angles(of, -1.1 * end, 0.2))
    assert len(instance.warnings) == 2  # before the state was saved there was none
    instance.reset()
    assert instance.start(angles(of, 0.9 * end, 0.2)).get() == inside
