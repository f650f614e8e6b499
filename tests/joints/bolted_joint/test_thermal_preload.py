"""Preload at other temperatures than at tightening: VDI 2230, all flavours, all tools."""

import json

import fmpy
import numpy as np
import pytest
from clients import needs
from conftest import Fmu, here_alone
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools import cli
from jointfmu_tools.joints.bolted_joint.export import EXPORTS, TightenedState
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import build_system_fmus
from jointfmu_tools.systems.system import load_system
from natives import jacobian

from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, JointInputs
from jointfmu.joints.bolted_joint.law import preload_at_temperature
from jointfmu.parameters import load_default, load_parameter_file

TIGHTENED, WARM, PRELOAD = 293.15, 343.15, 15e3
THERMAL = {
    "bolt_stiffness": 2.98e8, "plate_stiffness": 8.48e8, "side1.clamped_length": 0.015,
    "side2.clamped_length": 0.015, "bolt.alpha": 12e-6, "side1.alpha": 12e-6, "side2.alpha": 23e-6,
}  # fmt: skip
"""M10 through 15 mm of steel and 15 mm of aluminium."""
BY_HAND = 1819.0
"""Gain of preload [N] over 50 K: (23 - 12) 1e-6/K 15 mm 50 K = 8.25 um over 3.356 nm/N + 1.179 nm/N."""
DRAWING = ["--plate", "60x60", "--bolts", "M10", "--Ra", "0.8", "--preload", "20e3"]
STEEL_AND_ALUMINIUM = ("--grip", "15", "15", "--material", "steel", "aluminium")
STILL, SHEARED = np.zeros(6), np.array([1e-6, 0.0, 0.0, 0.0, 0.0, 0.0])


def thermal_file(**changes):
    return load_default("bolted_joint").with_values(THERMAL | changes, "user", "test")


def advance(spring, q, temperature, history=None, preload=PRELOAD, moment=500.0):
    start = spring.initial_history() if history is None else history
    return spring.advance(JointInputs(preload, moment, q, temperature=temperature), start)


def new(path, *options):
    assert cli.main(["new", "bolted-joint", *DRAWING, *options, "--out", str(path), "--force"]) == 0
    return load_parameter_file(path)


# The law


def test_the_gain_of_preload_is_that_of_vdi_2230_by_hand():
    joint = thermal_file().values
    assert preload_at_temperature(joint, PRELOAD, WARM) - PRELOAD == pytest.approx(BY_HAND, rel=5e-4)
    assert preload_at_temperature(joint, PRELOAD, TIGHTENED) == PRELOAD
    cold = preload_at_temperature(joint, PRELOAD, TIGHTENED - 50.0)
    assert cold - PRELOAD == pytest.approx(-BY_HAND, rel=5e-4)


def test_the_gain_of_preload_is_that_of_two_springs_with_a_mismatch():
    """The change of preload is that of two springs, bolt and plates, with different free lengths."""
    joint = thermal_file(**{"side1.alpha": 5e-6, "side1.clamped_length": 0.03}).values
    free_bolt, free_plates = 12e-6 * 0.045 * 50.0, (5e-6 * 0.03 + 23e-6 * 0.015) * 50.0
    k_b, k_p = joint.bolt_stiffness, joint.plate_stiffness
    length, force = np.linalg.solve([[k_b, -1.0], [k_p, 1.0]], [k_b * free_bolt, k_p * free_plates])
    assert length > 0.0
    assert preload_at_temperature(joint, 0.0, WARM) == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {"side2.alpha": 12e-6},
        {"bolt_stiffness": 0.0},
        {"plate_stiffness": 0.0},
        {"side2.clamped_length": 0.0},
        dict.fromkeys(THERMAL, 0.0),
    ],
)
def test_equal_materials_or_no_stiffness_leave_the_preload_as_it_is(changes):
    assert preload_at_temperature(thermal_file(**changes).values, PRELOAD, WARM) == PRELOAD


@pytest.mark.parametrize("memory", [True, False])
def test_a_warm_joint_is_the_joint_with_the_changed_preload(memory):
    spring = BoltedJointSpring.from_joint(thermal_file(memory=memory).values)
    warm, q = spring.preload_at_temperature(PRELOAD, WARM), np.array([1e-6, -5e-7, 2e-7, 1e-6, 2e-6, 3e-6])
    assert advance(spring, q, WARM)[0] == advance(spring, q, TIGHTENED, preload=warm)[0]
    assert advance(spring, q, WARM)[0]["p_mean"] > 1.05 * advance(spring, q, TIGHTENED)[0]["p_mean"]


def test_a_cold_bolt_loses_its_force_but_never_pushes():
    spring = BoltedJointSpring.from_joint(thermal_file().values)
    cold = 200.0
    preload = spring.preload_at_temperature(2e3, cold)
    assert preload < 0.0
    assert spring.bolts.preload_force(spring.joint, preload, 0.0).max() == 0.0
    out, history = advance(spring, STILL, cold, preload=2e3, moment=0.0)
    assert out["p_max"] == out["f_z"] == 0.0
    pulled, _ = advance(spring, 1e-6 * np.eye(6)[2], cold, history, preload=2e3, moment=0.0)
    assert pulled["f_z"] == pytest.approx(-1e-6 * spring.joint.n_bolts * spring.joint.bolt_stiffness)


def test_temperature_at_rest_dissipates_nothing_and_returns_to_the_same_state():
    spring = BoltedJointSpring.from_joint(thermal_file().values)
    first, history = advance(spring, STILL, TIGHTENED)
    for temperature in (WARM, 250.0, 400.0, TIGHTENED):
        out, history = advance(spring, STILL, temperature, history)
        assert (out["E_loss"], out["f_x"]) == (0.0, 0.0)
    assert out == pytest.approx(first, rel=1e-9)


def test_cooling_under_shear_slips_and_the_loss_never_falls():
    spring = BoltedJointSpring.from_joint(thermal_file().values)
    losses, history = [], None
    for temperature in (TIGHTENED, 200.0, WARM, 200.0, TIGHTENED):
        out, history = advance(spring, SHEARED, temperature, history)
        losses.append(out["E_loss"])
    assert np.all(np.diff(losses) >= 0.0)
    assert losses[1] > 1.2 * losses[0]
    assert abs(out["f_x"]) < abs(advance(spring, SHEARED, TIGHTENED)[0]["f_x"])


# Refusals


def test_a_coefficient_in_other_units_is_refused():
    with pytest.raises(ValueError, match=r"side2.alpha = 23 1/K is outside \[-0.001, 0.001\]"):
        thermal_file(**{"side2.alpha": 23.0})


def test_a_ramp_to_a_preload_that_the_temperature_takes_is_refused():
    model, spring = MODELS["BoltedJoint"], BoltedJointSpring.from_joint(thermal_file().values)
    starts = {v.name: v.start for v in model.inputs} | {"preload": 1e3, "temperature": 250.0}
    text = (
        r"preload = 1000 N is outside \(1569.* inf\) N: embedding and temperature = 250 K reduces it by 1569"
    )
    with pytest.raises(ValueError, match=text):
        model.with_load_range(spring, starts)
    assert model.with_load_range(spring, starts | {"temperature": WARM}).ramp.end_value == 1e3


# Commands


@pytest.mark.slow
def test_new_writes_what_the_temperature_needs(tmp_path, capsys):
    file = new(tmp_path / "joint.toml", *STEEL_AND_ALUMINIUM, "--sides", "rigid")
    per_kelvin = preload_at_temperature(file.values, 0.0, TIGHTENED + 1.0)
    assert f"preload_per_kelvin {per_kelvin:.4g} N/K" in capsys.readouterr().out
    assert 50.0 * per_kelvin == pytest.approx(1.9e3, rel=0.05)  # VDI 2230 with 11.5e-6 and 23e-6/K
    alphas = [part.alpha for part in (file.values.bolt, file.values.side1, file.values.side2)]
    assert alphas == [1.2e-5, 1.2e-5, 2.3e-5]


@pytest.mark.slow
def test_washers_expand_as_the_bolt_and_a_thread_ends_the_clamped_length(tmp_path, capsys):
    drawing = [
        "--grip",
        "15",
        "--material",
        "aluminium",
        "steel",
        "--tapped",
        "--washers",
        "--sides",
        "rigid",
    ]
    joint = new(tmp_path / "joint.toml", *drawing, "--json").values
    facts = json.loads(capsys.readouterr().out)["facts"]
    delta_P, delta_W = (1.0 / facts[name]["value"] for name in ("member_stiffness", "washer_stiffness"))
    assert (joint.side1.clamped_length, joint.side2.clamped_length) == (0.015, 0.0)
    gain = 8.25e-6 / (1.0 / joint.bolt_stiffness + delta_P - delta_W)  # bolt_stiffness has the washers
    assert preload_at_temperature(joint, 0.0, WARM) == pytest.approx(gain, rel=1e-6)


def test_old_files_and_their_text_stay_as_they_are():
    file = load_default("bolted_joint")
    assert preload_at_temperature(file.values, PRELOAD, WARM) == PRELOAD
    assert file.start_value("temperature") == TIGHTENED


@pytest.mark.parametrize("content", ["stiffness", "curve"])
def test_exports_take_the_preload_at_the_temperature(content):
    joint = thermal_file().values
    warm = preload_at_temperature(joint, PRELOAD, WARM)
    states = TightenedState(PRELOAD, 0.0, WARM), TightenedState(float(warm)), TightenedState(PRELOAD)
    if content == "stiffness":
        first, same, other = (EXPORTS.stiffness(joint, state) for state in states)
    else:
        first, same, other = (EXPORTS.curve.compute_table(joint, state, 1e-2).table_rows for state in states)
    np.testing.assert_array_equal(first, same)
    assert first.shape != other.shape or np.max(np.abs(first / np.where(other, other, 1.0) - 1.0)) > 0.01
    assert [" K" in str(state) for state in states] == [True, False, False]


# Flavours and finite elements


@pytest.fixture(scope="module", params=["rigid", pytest.param("elastic", marks=needs("gmsh"))], name="file")
def file_of_sides(request, tmp_path_factory):
    if request.param == "rigid":
        return thermal_file()
    path = tmp_path_factory.mktemp("thermal") / "joint.toml"
    return new(path, *STEEL_AND_ALUMINIUM, "--attached", "heads")


@pytest.mark.slow
@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
def test_all_flavours_give_the_numbers_of_the_package(file, tmp_path, flavour):
    with here_alone():
        build_fmus(["BoltedJoint"], [flavour], file, tmp_path)
    (path,) = tmp_path.rglob("BoltedJoint.fmu")
    spring = BoltedJointSpring.from_joint(file.values)
    fmu, history = Fmu(path).start({"preload": PRELOAD}), spring.initial_history()
    _, history = advance(spring, STILL, TIGHTENED, history, moment=0.0)
    for temperature, s_x in ((WARM, 1e-7), (253.15, 2e-7), (400.0, 1e-7), (TIGHTENED, 0.0)):
        expected, history = advance(spring, s_x * SHEARED / SHEARED[0], temperature, history, moment=0.0)
        fmu.set_values({"temperature": temperature, "s_rel_x": s_x})
        fmu.step()
        for name, found in fmu.get(*expected).items():
            least = {"f": 1e-5, "m": 1e-5, "K": 1e-1, "C": 1e-2}.get(name[0], 1e-12)
            assert found == pytest.approx(float(expected[name]), rel=1e-7, abs=least), (name, temperature)
    if flavour == "fmi2":
        fmu.set_values({"temperature": WARM, "s_rel_x": 1e-7})
        found, per_kelvin = jacobian(fmu), preload_at_temperature(file.values, 0.0, TIGHTENED + 1.0)
        for name in fmu.outputs:  # those by the preload are compared with differences elsewhere
            expected = per_kelvin * found[name, "preload"]
            assert found[name, "temperature"] == pytest.approx(expected, rel=1e-9), name
        assert found["K_zz", "temperature"] > 0.0
    fmu.free_instance()


@pytest.mark.slow
@needs("gmsh")
def test_finite_elements_with_a_mismatch_on_the_bolt_gain_as_much_preload(tmp_path):
    """Attached under the heads, bolt and plates are in series: k_b (1 - n Phi_K) times the mismatch."""
    joint = new(tmp_path / "joint.toml", *STEEL_AND_ALUMINIUM, "--attached", "heads").values
    spring = BoltedJointSpring.from_joint(joint)
    factor = spring.compliances(20e3).joint_load_factor
    gain = joint.bolt_stiffness * 8.25e-6 * (1.0 - factor)
    # the coarse elements of the tests are stiffer than the cones of VDI 2230
    assert preload_at_temperature(joint, 0.0, WARM) == pytest.approx(gain, rel=0.08)


@pytest.mark.slow
@needs("gmsh")
def test_the_bolt_force_of_the_complete_joint_shows_the_gain(tmp_path):
    spring = BoltedJointSpring.from_joint(new(tmp_path / "joint.toml", *STEEL_AND_ALUMINIUM).values)
    cold, warm = (advance(spring, STILL, t, moment=0.0)[0] for t in (TIGHTENED, WARM))
    assert warm["F_bolt[1]"] - cold["F_bolt[1]"] == pytest.approx(BY_HAND, rel=2e-3)
    assert warm["f_z"] == 0.0
    lost, _ = advance(spring, STILL, 60.0, preload=5e3, moment=0.0)
    assert lost["F_bolt[1]"] == 0.0


@pytest.mark.slow
def test_a_system_wires_the_temperature_of_its_joint(tmp_path):
    system = assemble_system(load_system("bolted_column").with_joint_parameter_file(thermal_file()))
    fmi2, _ = build_system_fmus(system, tmp_path, platforms=(fmpy.platform_tuple,))
    spring = BoltedJointSpring.from_joint(thermal_file().values)
    for temperature in (TIGHTENED, WARM):
        fmu = Fmu(fmi2).start({"joint.preload": PRELOAD, "joint.temperature": temperature})
        expected = advance(spring, STILL, temperature, moment=0.0)[0]["p_mean"]
        assert fmu.get("joint.p_mean")["joint.p_mean"] == pytest.approx(expected, rel=1e-9)
        fmu.free_instance()
